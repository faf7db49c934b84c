#pragma once
/// A suite, run: cells are prepared (all mistakes are found before anything is written), grouped by problem, measured
/// in parallel, timed one at a time, and recorded. What a folder already holds from this build is not run again.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/input/suite.hpp"
#include "bench/job/ranks.hpp"

namespace polhode::bench {

struct RunOptions {
  std::filesystem::path out;  ///< empty: default_folder
  std::string filter;         ///< regular expression over "problem/variant/formulation/integrator/policy"; empty: all
  bool fresh = false;         ///< forget what the folder holds
  bool retry_failed = false;  ///< run again what did not end ok
  bool dry_run = false;       ///< say what would run
  bool isolate = false;       ///< the accuracy pass of each cell in a process of its own
  double timeout = 60;        ///< per cell [s]
  int threads = 0;            ///< of the accuracy pass; 0: one per processor, one in each of several ranks
  int shard = 1, shards = 1;  ///< which of how many parts to run
};

struct RunSummary {
  std::filesystem::path out;
  std::size_t cells = 0, skipped = 0, ok = 0, refused = 0, failed = 0;
  std::size_t died = 0;  ///< of the failed: cells whose process ended by a signal or an exit
  bool interrupted = false;
};

/// Where a run of the suite goes if it is not told: polhode-results/SUITE.
std::filesystem::path default_folder(Suite const& suite);

/// Every rank calls it; each writes a file of records of its own, and the manager's summary is that of all. Several
/// ranks take no times. Throws SuiteError, UsageError (bad filter), NothingSelected, results::StoreError,
/// ReferenceError; see Ranks.
RunSummary run_suite(Suite const& suite, RunOptions const& options, Ranks& ranks);

}  // namespace polhode::bench
