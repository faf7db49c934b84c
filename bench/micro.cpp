/// polhode-bench: what a step costs, side by side in one run. Google Benchmark with its own flags
/// (--benchmark_filter=...); repetitions are interleaved at random, and the pairs' ratios are printed at the end.
/// Absolute times are this machine's.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <boost/numeric/odeint/stepper/runge_kutta4_classic.hpp>
#include <cstring>
#include <map>

#include "bench/cell.hpp"
#include "bench/provenance.hpp"
#include "bench/reference.hpp"
#include "bench/speed/speed.hpp"

namespace {

using namespace polhode;
using namespace polhode::bench;

constexpr double step_size = 0.01;  // [s]

/// One solve of the problem's horizon with the typed method; the rate is in steps.
void solve_cost(benchmark::State& state, TimedSolve& solve, double steps) {
  for (auto _ : state) benchmark::DoNotOptimize(solve.solve());
  count_steps(state, steps);
}

/// What an Odeint user would write for the free body: a plain array and a lambda, nothing of ours.
void plain_odeint_rk4(benchmark::State& state) {
  using State = std::array<double, 7>;
  auto const chosen = problem_named("free_body").choose({});
  BodyParameters const& body = *chosen->body();
  double const Jx = body.inertia[0], Jy = body.inertia[1], Jz = body.inertia[2];
  double const kx = (Jy - Jz) / Jx, ky = (Jz - Jx) / Jy, kz = (Jx - Jy) / Jz;
  auto const field = [=](State const& y, State& dy, double) {
    double const p = .5 * y[4], q = .5 * y[5], r = .5 * y[6];
    dy[0] = y[3] * p + y[1] * r - y[2] * q;
    dy[1] = y[3] * q + y[2] * p - y[0] * r;
    dy[2] = y[3] * r + y[0] * q - y[1] * p;
    dy[3] = -(y[0] * p) - y[1] * q - y[2] * r;
    dy[4] = kx * (y[5] * y[6]);
    dy[5] = ky * (y[6] * y[4]);
    dy[6] = kz * (y[4] * y[5]);
  };
  Quat<double> const q = body.attitude<double>();
  Vec3<double> const w = body.rate<double>();
  long const steps = std::lround(chosen->horizon() / step_size);
  for (auto _ : state) {
    State y{q.x, q.y, q.z, q.w, w.x, w.y, w.z};
    boost::numeric::odeint::runge_kutta4_classic<State> stepper;
    for (long i = 0; i < steps; ++i) stepper.do_step(field, y, double(i) * step_size, step_size);
    benchmark::DoNotOptimize(y);
  }
  count_steps(state, double(steps));
}

std::vector<Comparison> const comparisons{
    {"RK4 step, free body: polhode / Odeint on std::array", "step/free_body/quaternion/rk4",
     "plain/free_body/odeint_rk4"},
    {"RK4 step, free body: polhode / Odeint behind our face", "step/free_body/quaternion/rk4",
     "step/free_body/quaternion/odeint_rk4"},
    {"RK4 step, PD slew: polhode / Odeint behind our face", "step/pd_slew/quaternion/rk4",
     "step/pd_slew/quaternion/odeint_rk4"},
    {"RK4, tether capture, 2 steps a sample: polhode / Odeint behind our face", "step/tether_capture/quaternion/rk4",
     "step/tether_capture/quaternion/odeint_rk4"},
    {"DP5 step, free body: polhode / Odeint behind our face", "step/free_body/quaternion/dopri5",
     "step/free_body/quaternion/odeint_dopri5"},
    {"RK4, cost per craft and step: 10^5 craft / 100", "network/quaternion_sync/quaternion/rk4/100000",
     "network/quaternion_sync/quaternion/rk4/100"},
    {"CF4 on S3, the same", "network/quaternion_sync/s3/cf4/100000", "network/quaternion_sync/s3/cf4/100"},
    {"Gauss of 2 stages, the same", "network/quaternion_sync/quaternion/gauss2/100000",
     "network/quaternion_sync/quaternion/gauss2/100"},
    {"RK4 step, free body: its type forgotten at every evaluation / at every solve",
     "erased/free_body/quaternion/rk4/evaluation", "step/free_body/quaternion/rk4"},
    {"RK4 step, free body: its type forgotten at every solve / never", "step/free_body/quaternion/rk4",
     "twin/free_body/rk4/generic"}};

/// What Google Benchmark prints in the format that was asked for, and the medians for the ratios.
class Reporter final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(Context const& context) override { return printed_->ReportContext(context); }
  void ReportRuns(std::vector<Run> const& runs) override {
    printed_->ReportRuns(runs);
    for (Run const& run : runs) {
      if (run.run_type != Run::RT_Aggregate || run.aggregate_name != "median" || run.iterations <= 0) continue;
      bool const by_the_wall = run.run_name.time_type.find("real_time") != std::string::npos;
      median_[run.run_name.function_name] =
          (by_the_wall ? run.real_accumulated_time : run.cpu_accumulated_time) / double(run.iterations);
    }
  }
  void Finalize() override { printed_->Finalize(); }

  /// To stdout below the table; to stderr if what stdout gets is for machines.
  void print_ratios(std::vector<Comparison> const& all) const {
    std::FILE* const out = dynamic_cast<benchmark::ConsoleReporter*>(printed_.get()) ? stdout : stderr;
    bool first = true;
    for (Comparison const& pair : all) {
      auto const ours = median_.find(pair.ours), rival = median_.find(pair.rival);
      if (ours == median_.end() || rival == median_.end()) continue;
      if (first) fmt::print(out, "\nratios of median times in this run (below 1: the first is faster)\n");
      first = false;
      fmt::print(out, "{:<85} {:.3f}\n", pair.what, ours->second / rival->second);
    }
  }

 private:
  std::unique_ptr<benchmark::BenchmarkReporter> printed_{benchmark::CreateDefaultDisplayReporter()};
  std::map<std::string, double> median_;  ///< seconds per iteration
};

/// Short steps, so that a solve is a loop over them; those of a sampled problem divide its period.
double step_of(ProblemEntry const& entry) {
  bool const sampled = entry.choose({})->sample_period() > 0;
  return sampled ? entry.info().step : std::min(step_size, entry.info().step);
}

/// Every typed fixed-step method on every problem and formulation.
void register_steps(std::vector<std::unique_ptr<TimedSolve>>& keep) {
  for (ProblemEntry const* entry : all_problems())
    for (std::string_view formulation : entry->formulations())
      for (IntegratorWord const& word : vocabulary().integrators) {
        if (!word.fixed || !word.not_built.empty()) continue;
        results::Cell cell;
        cell.problem = entry->info().name;
        cell.formulation = formulation;
        cell.integrator = word.name;
        cell.h = step_of(*entry);
        PreparedCell const prepared = prepare(cell);
        if (!prepared.refusal.empty()) continue;
        auto solve = prepared.problem->timed(formulation, word.name, prepared.plan);
        if (!solve) continue;
        double const steps = prepared.cell.t_end / *cell.h;
        std::string const name = fmt::format("step/{}/{}/{}", cell.problem, formulation, word.name);
        benchmark::RegisterBenchmark(name.c_str(), [&solve = *solve, steps](benchmark::State& state) {
          solve_cost(state, solve, steps);
        })->Unit(benchmark::kMicrosecond);
        keep.push_back(std::move(solve));
      }
}

/// Networks of 100 to 10^5 craft, all over the same second, so many times that craft times steps is the same: equal
/// times are equal cost per craft and step. (Over longer horizons the smaller would be at rest most of the time, where
/// Gauss needs three sweeps instead of twenty.)
void register_networks(std::vector<std::unique_ptr<TimedSolve>>& keep) {
  constexpr double h = 0.1;
  constexpr int steps = 10, most_craft = 100'000;
  for (auto const& [formulation, integrator] :
       {std::pair{"quaternion", "rk4"}, {"s3", "cf4"}, {"quaternion", "gauss2"}})
    for (int const n : {100, 1000, 10'000, most_craft}) {
      results::Cell cell;
      cell.problem = "quaternion_sync";
      cell.formulation = formulation;
      cell.integrator = integrator;
      cell.h = h;
      cell.t_end = steps * h;
      cell.set["n"] = {double(n)};
      PreparedCell const prepared = prepare(cell);
      auto solve = prepared.problem->timed(formulation, integrator, prepared.plan);
      std::string const name = fmt::format("network/quaternion_sync/{}/{}/{}", formulation, integrator, n);
      benchmark::RegisterBenchmark(name.c_str(), [&solve = *solve, n](benchmark::State& state) {
        for (auto _ : state)
          for (int solved = 0; solved < most_craft; solved += n) benchmark::DoNotOptimize(solve.solve());
        count_steps(state, double(most_craft) * steps);
      })->Unit(benchmark::kMillisecond);
      keep.push_back(std::move(solve));
    }
}

/// The cell of a solve from the catalogue's names alone.
results::Cell cell_of(std::string_view problem, std::string_view formulation, std::string_view integrator, double h) {
  results::Cell cell;
  cell.problem = problem;
  cell.formulation = formulation;
  cell.integrator = integrator;
  cell.h = h;
  return cell;
}

/// The free body's field behind a virtual call at every evaluation.
void register_erased(std::vector<std::unique_ptr<TimedSolve>>& keep) {
  using M = RigidBody<FlatQuaternion<double>>;
  PreparedCell const prepared = prepare(cell_of("free_body", "quaternion", "rk4", step_size));
  auto field = std::get<std::unique_ptr<Erased<M>>>(prepared.problem->in("quaternion"));
  auto solve = method_named<M>("rk4").timed(std::move(field), prepared.plan);
  double const steps = prepared.cell.t_end / step_size;
  benchmark::RegisterBenchmark("erased/free_body/quaternion/rk4/evaluation", [&solve = *solve, steps](auto& state) {
    solve_cost(state, solve, steps);
  })->Unit(benchmark::kMicrosecond);
  keep.push_back(std::move(solve));
}

/// What a changed free body costs before its first run: its reference by Taylor series, and the proof by Gauss.
void register_certification() {
  benchmark::RegisterBenchmark("certify/free_body", [](benchmark::State& state) {
    PreparedCell const prepared = prepare(cell_of("free_body", "quaternion", "rk4", step_size));
    double bar = 0;
    for (auto _ : state) {
      Reference const reference = Reference::solve(*prepared.problem, prepared.schedule);
      bar = certify(prepared.physics, *prepared.problem, prepared.schedule, reference).bar;
    }
    state.counters["bar"] = bar;
  })->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--version") != 0) continue;
    fmt::print("{}", version_text());
    return 0;
  }
  std::vector<char*> arguments(argv, argv + argc);
  // Before the user's own flags, so that these win.
  std::string interleave = "--benchmark_enable_random_interleaving=true", repeat = "--benchmark_repetitions=9",
              brief = "--benchmark_report_aggregates_only=true", short_time = "--benchmark_min_time=0.02";
  arguments.insert(arguments.begin() + 1, {interleave.data(), repeat.data(), brief.data(), short_time.data()});
  int count = int(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;

  std::vector<std::unique_ptr<TimedSolve>> keep;
  register_steps(keep);
  register_networks(keep);
  benchmark::RegisterBenchmark("plain/free_body/odeint_rk4", plain_odeint_rk4)->Unit(benchmark::kMicrosecond);
  register_erased(keep);
  register_certification();
  std::vector<Comparison> compared = comparisons;
  add_twins(compared);
  add_worst_cases();
  add_ensembles(compared);
  add_odeint_loops();
  Reporter reporter;
  if (benchmark::RunSpecifiedBenchmarks(&reporter) == 0) {
    std::fputs("polhode-bench: --benchmark_filter matches nothing\n", stderr);
    return 3;
  }
  reporter.print_ratios(compared);
  return 0;
}
