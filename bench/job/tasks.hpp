#pragma once
/// The cells of a suite on their way through a run.
#include <set>
#include <string>
#include <vector>

#include "bench/cell/cell_result.hpp"
#include "bench/cell/prepare.hpp"
#include "bench/input/suite.hpp"

namespace polhode::bench {

/// One cell of a run.
struct Task {
  PreparedCell prepared;
  std::string id;
  bool keep_history = false;
  CellResult result;
  bool died = false;  ///< its process did
};

/// The cells of a suite that --filter selects, prepared, each once: all mistakes in them are found here. Throws
/// UsageError (bad filter), SuiteError, NothingSelected.
std::vector<Task> tasks_of(Suite const& suite, std::string const& filter);
/// Keeps every n-th cell, so that shards on equal suites are disjoint and together the whole. Throws NothingSelected.
void take_shard(std::vector<Task>& tasks, int shard, int shards);

/// What users should know of their choices, each once.
std::set<std::string> warnings_of(std::vector<Task> const& tasks);
/// --dry-run: each cell on stdout, and about how long all take on so many processors.
void say_what_would_run(std::vector<Task> const& tasks, Timing const& timing, int processors);

}  // namespace polhode::bench
