#pragma once
/// What polhode-bench does with the repetitions of its benchmarks: prints what Google Benchmark makes of them, and
/// keeps them, for the ratios and for the result folder.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/cell/timing.hpp"
#include "bench/speed/speed.hpp"
#include "results/benchmarks.hpp"
#include "results/statistics.hpp"

namespace polhode::bench {

/// Prints in the format that was asked for; of several repetitions the aggregates alone, unless each is wanted.
class Reporter final : public benchmark::BenchmarkReporter {
 public:
  explicit Reporter(bool each_repetition) : each_repetition_(each_repetition) {}

  bool ReportContext(Context const& context) override { return printed_->ReportContext(context); }
  void ReportRuns(std::vector<Run> const& runs) override {
    bool brief = !each_repetition_;
    for (Run const& run : runs) {
      brief = brief && run.run_type == Run::RT_Iteration && run.repetitions > 1 && !run.error_occurred;
      if (run.run_type == Run::RT_Iteration && !run.error_occurred && run.iterations > 0) take(run);
    }
    if (!brief) printed_->ReportRuns(runs);
  }
  void Finalize() override { printed_->Finalize(); }

  /// Every benchmark, in the order of their names: medians, intervals, repetitions.
  std::vector<results::Benchmark> benchmarks() const {
    std::vector<results::Benchmark> all;
    for (auto const& [name, taken] : taken_) {
      results::Benchmark one{name, taken.wall, bootstrap(taken.seconds), {}};
      for (auto const& [counter, values] : taken.counters) one.counters[counter] = results::median(values);
      all.push_back(std::move(one));
    }
    return all;
  }

  /// To stdout below the table; to stderr if what stdout gets is for machines.
  void print_ratios(std::vector<Comparison> const& all) const {
    std::FILE* const out = dynamic_cast<benchmark::ConsoleReporter*>(printed_.get()) ? stdout : stderr;
    bool first = true;
    for (Comparison const& pair : all) {
      auto const ours = taken_.find(pair.ours), rival = taken_.find(pair.rival);
      if (ours == taken_.end() || rival == taken_.end()) continue;
      if (first) fmt::print(out, "\nratios of median times in this run (below 1: the first is faster)\n");
      first = false;
      fmt::print(out, "{:<85} {:.3f}\n", pair.what,
                 results::median(ours->second.seconds) / results::median(rival->second.seconds));
    }
  }

 private:
  struct Taken {
    bool wall = false;
    std::vector<double> seconds;  ///< per iteration, of each repetition
    std::map<std::string, std::vector<double>> counters;
  };
  void take(Run const& run) {
    Taken& taken = taken_[run.run_name.function_name];
    taken.wall = run.run_name.time_type.find("real_time") != std::string::npos;
    taken.seconds.push_back((taken.wall ? run.real_accumulated_time : run.cpu_accumulated_time) /
                            double(run.iterations));
    for (auto const& [name, counter] : run.counters) taken.counters[name].push_back(counter.value);
  }

  bool each_repetition_;
  std::unique_ptr<benchmark::BenchmarkReporter> printed_{benchmark::CreateDefaultDisplayReporter()};
  std::map<std::string, Taken> taken_;
};

}  // namespace polhode::bench
