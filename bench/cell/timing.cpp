#include "bench/cell/timing.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include "bench/process/allocations.hpp"
#include "results/statistics.hpp"

namespace polhode::bench {
namespace {

/// Keeps the CPU time per iteration of every repetition, by benchmark name.
class Collector final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(Context const&) override { return true; }
  void ReportRuns(std::vector<Run> const& runs) override {
    for (Run const& run : runs)
      if (run.run_type == Run::RT_Iteration && !run.error_occurred && run.iterations > 0)
        seconds[run.run_name.function_name].push_back(run.cpu_accumulated_time / double(run.iterations));
  }
  std::map<std::string, std::vector<double>> seconds;
};

/// Repetitions in random order: Google Benchmark can be told by a flag alone.
void interleave_repetitions() {
  static std::string program = "polhode";  // it keeps the pointer
  std::string flag = "--benchmark_enable_random_interleaving=true";
  std::array<char*, 3> words{program.data(), flag.data(), nullptr};
  int count = 2;
  benchmark::Initialize(&count, words.data());
}

}  // namespace

results::CpuTime bootstrap(std::vector<double> values) {
  results::CpuTime time{.repetitions = int(values.size()), .samples = values};
  time.median = results::median(values);
  std::ranges::sort(values);  // the interval does not depend on the order of the repetitions
  constexpr int resamples = 1000;
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> pick(0, values.size() - 1);
  std::vector<double> medians, sample(values.size());
  for (int i = 0; i < resamples; ++i) {
    for (double& x : sample) x = values[pick(random)];
    medians.push_back(results::median(sample));
  }
  std::sort(medians.begin(), medians.end());
  time.low = medians[std::size_t(0.025 * resamples)];
  time.high = medians[std::size_t(0.975 * resamples)];
  return time;
}

std::vector<TimedResult> time_cells(std::vector<TimedCell> const& cells, Timing const& timing,
                                    std::atomic<bool> const& stop, std::function<void()> const& progress) {
  std::vector<TimedResult> results(cells.size());
  interleave_repetitions();
  benchmark::ClearRegisteredBenchmarks();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].solve || stop) continue;
    TimedSolve& solve = *cells[i].solve;
    // Warm: a cold first solve would calibrate too few iterations and inflate solves of a microsecond 2-3 times.
    for (int warm = 0; warm < 3; ++warm) solve.solve();
    std::int64_t const before = allocations_of_this_thread();
    solve.solve();
    results[i].allocations = allocations_of_this_thread() - before;
    benchmark::RegisterBenchmark(cells[i].cell.c_str(),
                                 [&, left = timing.repetitions](benchmark::State& state) mutable {
                                   if (stop) state.SkipWithError("interrupted");
                                   for (auto _ : state) benchmark::DoNotOptimize(solve.solve());
                                   if (left-- > 0) progress();  // trials of how long a repetition is come on top
                                 })
        ->MinTime(timing.min_time)
        ->Repetitions(timing.repetitions);
  }
  if (stop || std::ranges::none_of(cells, [](TimedCell const& cell) { return cell.solve != nullptr; }))
    return results;  // Google Benchmark would complain of an empty list
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector, nullptr, "all");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    auto const found = collector.seconds.find(cells[i].cell);
    if (found != collector.seconds.end()) results[i].cpu_time = bootstrap(found->second);
  }
  benchmark::ClearRegisteredBenchmarks();
  return results;
}

}  // namespace polhode::bench
