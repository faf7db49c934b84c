/// The generic source against the same step written by hand, and what a controller's period costs at worst.
#include "bench/speed/twins.hpp"

#include <algorithm>
#include <chrono>

#include "bench/speed/limited_pd.hpp"
#include "bench/speed/speed.hpp"

namespace polhode::bench {
namespace {

constexpr double h = 0.01;  // [s]
constexpr long steps = 5000;

void by_hand(benchmark::State& state) {
  PlainBody const body = plain_body();
  for (auto _ : state) {
    PlainState s = plain_start();
    run_by_hand(s, body, h, steps);
    benchmark::DoNotOptimize(s);
  }
  count_steps(state, steps);
}
void generic(benchmark::State& state) {
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto stepper = Rk4{}.bind(field, FixedStep{h}, NormPolicy::none);
  for (auto _ : state) {
    auto x = field.initial();
    benchmark::DoNotOptimize(stepper.advance(x, 0, double(steps) * h));
    benchmark::DoNotOptimize(x);
  }
  count_steps(state, steps);
}

/// One period: the controller is asked, five steps follow. Every period is timed by itself; the clock is in it.
void worst_period(benchmark::State& state) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t periods = 20'000;
  constexpr double period = 5 * h;
  std::vector<double> taken(periods);
  for (auto _ : state) {
    auto field = limited_slew<double, FlatQuaternion, SampledLimitedPd<double>>();
    auto stepper = Rk4{}.bind(field, FixedStep{h}, NormPolicy::none);
    auto x = field.initial();
    for (std::size_t i = 0; i < periods; ++i) {
      double const t = double(i % 1000) * period;
      if (i % 1000 == 0) x = field.initial();
      auto const begin = Clock::now();
      field.sample(t, x);
      stepper.advance(x, t, t + period);
      taken[i] = std::chrono::duration<double>(Clock::now() - begin).count();
    }
    benchmark::DoNotOptimize(x);
  }
  std::sort(taken.begin(), taken.end());
  auto const quantile = [&](double part) { return taken[std::size_t(part * double(periods - 1))]; };
  state.counters["p50"] = quantile(0.5);
  state.counters["p99.9"] = quantile(0.999);
  state.counters["max"] = taken.back();
  count_steps(state, 5.0 * double(periods));
}

}  // namespace

void add_twins(std::vector<Comparison>& pairs) {
  benchmark::RegisterBenchmark("twin/free_body/rk4/by_hand", by_hand)->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("twin/free_body/rk4/generic", generic)->Unit(benchmark::kMicrosecond);
  pairs.push_back({"RK4 step, free body: the generic source / written by hand", "twin/free_body/rk4/generic",
                   "twin/free_body/rk4/by_hand"});
}
void add_worst_cases() {
  benchmark::RegisterBenchmark("worst/limited_slew_sampled/rk4/period", worst_period)->Unit(benchmark::kMillisecond);
}

}  // namespace polhode::bench
