/// Ensembles: what a step of one body costs among many, and what the machine's arithmetic allows.
#include "bench/ensemble/ensemble.hpp"

#include "bench/speed/ensemble_size.hpp"
#include "bench/speed/limited_pd.hpp"
#include "bench/speed/speed.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/free_body.hpp"

namespace polhode::bench {
namespace {

constexpr double body_steps = double(ensemble_bodies) * double(ensemble_steps);

/// The bodies of ensemble_size.hpp on a field that `make.operator()<S>()` makes.
template <class Field>
struct Fleet {
  Field field;
  template <class S>
  auto operator()(BodyBlock const& block) const {
    auto p = field.template operator()<S>();
    p.start.second.x = gather<S>(block, [](std::int64_t k) { return ensemble_rate(k); });
    return p;
  }
};
template <class Field>
Fleet(Field) -> Fleet<Field>;

auto free_bodies() {
  return Fleet{[body = FreeBody(Choice{})]<class S>() { return body.field<S, FlatQuaternion, true>(); }};
}
auto free_bodies_on_s3() {
  return Fleet{[body = FreeBody(Choice{})]<class S>() { return body.field<S, S3, true>(); }};
}
auto limited_slews() {
  return Fleet{[body = BodyParameters{}]<class S>() { return limited_slew<S>(body); }};
}
auto sampled_slews() {
  return Fleet{
      [body = BodyParameters{}]<class S>() { return limited_slew<S, FlatQuaternion, SampledLimitedPd<S>>(body); }};
}

using End = Pair<Quat<double>, Vec3<double>>;

/// How an ensemble is run.
struct Way {
  std::int64_t steps_to_stop = 0;
  int threads = 1;
  Registers registers = widest_registers();
  std::int64_t steps = ensemble_steps;
};

template <class T, class Method, class Make>
std::vector<End> ends_of(Make const& make, Way const& way) {
  std::vector<End> ends(ensemble_bodies);
  run_ensemble_on_threads<T>(
      way.threads, Method{}, EnsembleRun{ensemble_h, way.steps, way.steps_to_stop}, ensemble_bodies, make,
      [&](std::int64_t k, End const& x, Status) { ends[std::size_t(k)] = x; }, NoEnsembleWatch{}, way.registers);
  return ends;
}

template <class T, class Method, class Make>
benchmark::internal::Benchmark* add(std::string const& name, Make const& make, Way const& way = {}) {
  return benchmark::RegisterBenchmark(("ensemble/" + name).c_str(),
                                      [=](benchmark::State& state) {
                                        std::vector<End> ends;
                                        for (auto _ : state) {
                                          ends = ends_of<T, Method>(make, way);
                                          benchmark::DoNotOptimize(ends.data());
                                        }
                                        if constexpr (std::same_as<T, float>) {
                                          auto const exact = ends_of<double, Method>(make, way);
                                          double apart = 0;
                                          for (std::size_t k = 0; k < ends.size(); ++k)
                                            apart = std::max(apart, distance<double>(ends[k], exact[k]));
                                          state.counters["lost"] = apart;  // the greatest difference from double
                                        }
                                        count_steps(state, double(ensemble_bodies) * double(way.steps));
                                      })
      ->Unit(benchmark::kMillisecond);
}

/// One thread and two, by the wall clock; and what it takes to start the second and to wait for it, which a short run
/// feels and a long one does not.
void add_threads() {
  constexpr std::int64_t long_run = 20 * ensemble_steps;
  for (int const threads : {1, 2}) {
    std::string const end = "threads_" + std::to_string(threads);
    for (auto const& [name, steps] : {std::pair{"free_body/rk4_", ensemble_steps}, {"free_body/rk4_long_", long_run}})
      add<double, Rk4>(name + end, free_bodies(), {.threads = threads, .steps = steps})
          ->UseRealTime()
          ->MeasureProcessCPUTime();
  }
  benchmark::RegisterBenchmark("ensemble/second_thread",
                               [](benchmark::State& state) {
                                 for (auto _ : state)
                                   on_threads(2, 2, [](std::int64_t part) { benchmark::DoNotOptimize(part); });
                                 count_steps(state, 1);
                               })
      ->UseRealTime()
      ->MeasureProcessCPUTime()
      ->Unit(benchmark::kMicrosecond);
}

// ---- What the arithmetic allows -------------------------------------------------------------------------------------

/// Multiplications of an RK4 step of the free body, as g++ writes it: each takes the place of a fused multiplication
/// and addition; additions have places of their own on the machines of today. (With fusing there are 52 and 81 fused
/// ones.)
constexpr int multiplications_of_step = 133;

/// So many fused operations as the ensemble's steps have multiplications, on independent numbers in registers.
template <int bytes>
struct FusedPeak {
  static constexpr int chains = 12;
  static constexpr std::int64_t rounds = std::int64_t(body_steps) * multiplications_of_step / (bytes / 8) / chains;
};
#if defined(__x86_64__) && !defined(__SSE3__)
/// In lanes V of the registers that the caller is for.
template <class V>
__attribute__((always_inline)) inline double fuse(std::int64_t rounds) {
  constexpr int chains = FusedPeak<int(sizeof(V))>::chains;
  V const m = V{} + 0.999, c = V{} + 1e-3;
  V x[chains];
#pragma GCC unroll 12
  for (int i = 0; i < chains; ++i) x[i] = V{} + double(i);
  for (std::int64_t k = 0; k < rounds; ++k)
#pragma GCC unroll 12
    for (V& one : x) one = one * m + c;
  V sum = x[0];
#pragma GCC unroll 12
  for (int i = 1; i < chains; ++i) sum += x[i];
  return sum[0];
}
using Wide32 [[gnu::vector_size(32)]] = double;
using Wide64 [[gnu::vector_size(64)]] = double;
[[gnu::noinline, gnu::target("arch=x86-64-v3"), gnu::optimize("fp-contract=fast")]] double fuse_avx2(
    std::int64_t rounds) {
  return fuse<Wide32>(rounds);
}
[[gnu::noinline, gnu::target("arch=x86-64-v4"), gnu::optimize("fp-contract=fast")]] double fuse_avx512(
    std::int64_t rounds) {
  return fuse<Wide64>(rounds);
}
#endif

/// The same number of operations in the registers that ensembles use.
void fused_peak(benchmark::State& state, Registers registers) {
  bool const widest = registers == Registers::avx512;
  std::int64_t rounds = widest ? FusedPeak<64>::rounds : FusedPeak<32>::rounds;
  for (auto _ : state) {
    benchmark::DoNotOptimize(rounds);  // or one call would do for all
#if defined(__x86_64__) && !defined(__SSE3__)
    benchmark::DoNotOptimize(widest ? fuse_avx512(rounds) : fuse_avx2(rounds));
#endif
  }
  double const operations = 2.0 * FusedPeak<64>::chains * double(rounds) * (widest ? 8 : 4);
  state.counters["flops"] = benchmark::Counter(operations * double(state.iterations()), benchmark::Counter::kIsRate);
  count_steps(state, body_steps);
}

}  // namespace

void add_ensembles(std::vector<Comparison>& pairs) {
  add<double, Rk4>("free_body/rk4", free_bodies());
  add<float, Rk4>("free_body/rk4_float", free_bodies());
  add<double, Rk4>("limited_slew/rk4", limited_slews());
  add<float, Rk4>("limited_slew/rk4_float", limited_slews());
  add<double, Rk4>("limited_slew_sampled/rk4", sampled_slews(), {.steps_to_stop = 5});
  add<double, CommutatorFree4>("free_body_s3/cf4", free_bodies_on_s3());
  add_threads();
  if (chooses_registers && widest_registers() != Registers::of_the_unit) {
    add<double, Rk4>("free_body/rk4_of_the_unit", free_bodies(), {.registers = Registers::of_the_unit});
    if (widest_registers() == Registers::avx512)
      add<double, Rk4>("free_body/rk4_avx2", free_bodies(), {.registers = Registers::avx2});
    benchmark::RegisterBenchmark("ensemble/fused_peak", fused_peak, widest_registers())->Unit(benchmark::kMillisecond);
  }
  auto const compare = [&](std::string const& what, std::string const& ours, std::string const& rival) {
    pairs.push_back({what, "ensemble/" + ours, "ensemble/" + rival});
  };
  for (std::string const end : {"", "_avx2"}) {
    std::string const rival = end.empty() ? "Odeint's loop" : "Odeint's loop, inlined for AVX2";
    compare("RK4, 4096 free bodies: ensemble / " + rival, "free_body/rk4", "free_body/odeint_rk4" + end);
    compare("RK4, 4096 limited slews: ensemble / " + rival, "limited_slew/rk4", "limited_slew/odeint_rk4" + end);
  }
  compare("RK4, 4096 free bodies: float / double", "free_body/rk4_float", "free_body/rk4");
  compare("RK4, 4096 limited slews: float / double", "limited_slew/rk4_float", "limited_slew/rk4");
  compare("RK4, 4096 free bodies: 133 fused operations at the machine's peak / a step", "fused_peak", "free_body/rk4");
  for (std::string const length : {"", "long_"})
    compare(
        "RK4, 4096 free bodies, wall time: 2 threads / 1, " + std::string(length.empty() ? "200" : "4000") + " steps",
        "free_body/rk4_" + length + "threads_2", "free_body/rk4_" + length + "threads_1");
}

}  // namespace polhode::bench
