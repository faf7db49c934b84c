#pragma once
/// Cells that are run together: of one problem with one choice, or a part of them. They share a reference, and are
/// timed against each other.
#include <atomic>
#include <string>
#include <vector>

#include "bench/cell/references.hpp"
#include "bench/job/isolate.hpp"
#include "bench/job/run.hpp"
#include "bench/job/tasks.hpp"
#include "bench/process/progress.hpp"
#include "results/store.hpp"

namespace polhode::bench {

/// What a group needs besides its cells.
struct Surroundings {
  RunOptions options;  ///< with its threads settled
  Timing timing;
  bool at_once;  ///< each cell is recorded when it is measured, in whatever order; nothing is timed then
  References& references;
  results::Writer& writer;
  Progress& progress;
  std::atomic<bool> const& interrupted;
};

class Group {
 public:
  Group(std::vector<Task*> tasks, Surroundings const& around) : tasks_(std::move(tasks)), around_(around) {}
  /// Measures all cells, times them if that is wanted, and records them, as they end up in their tasks; nothing is
  /// recorded that was interrupted. Throws what the writer and the references throw.
  void run();

 private:
  void measure_all();
  void measure_apart();
  CellResult measured(Task const& task) const;
  void record(Task const& task);
  results::Record died(Task const& task, Ended const& ended) const;
  void time_all();

  std::vector<Task*> tasks_;
  Surroundings around_;
};

}  // namespace polhode::bench
