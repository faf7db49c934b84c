#pragma once
/// The timing pass: Google Benchmark as the timer. The solves of one problem are timed together, their repetitions in
/// random order, so that a drift of the machine's speed meets all of them alike: what counts are ratios within a group.
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/input/suite.hpp"
#include "bench/solve/problems.hpp"

namespace polhode::bench {

/// Something to time.
struct TimedCell {
  std::string cell;  ///< its id
  std::unique_ptr<TimedSolve> solve;
};

/// What came of it, in the order of the input.
struct TimedResult {
  std::optional<results::CpuTime> cpu_time;
  std::optional<std::int64_t> allocations;  ///< in one solve
};

/// Times the cells, one at a time on this thread. progress() is called as many times for each cell as there are
/// repetitions; once `stop` is set, what is left is skipped.
std::vector<TimedResult> time_cells(std::vector<TimedCell> const& cells, Timing const& timing,
                                    std::atomic<bool> const& stop, std::function<void()> const& progress);

/// Median and 95% percentile-bootstrap interval of the median [same unit as the values], and the values themselves.
/// Deterministic.
results::CpuTime bootstrap(std::vector<double> values);

}  // namespace polhode::bench
