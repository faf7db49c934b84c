#pragma once
/// The folder that a run writes to, before the first record.
#include <filesystem>
#include <set>
#include <string>

#include "bench/job/run.hpp"
#include "results/folder_lock.hpp"

namespace polhode::bench {

/// Holds the folder's lock; two runs in one folder would take each other's cells.
class ResultFolder {
 public:
  /// Makes the folder and locks it, for the shard alone if it is one; forgets the records with --fresh. Throws
  /// results::StoreError.
  ResultFolder(std::filesystem::path const& folder, RunOptions const& options);
  /// Ids of the cells that it already holds from this build. retry_failed: those that ended ok or were refused.
  std::set<std::string> finished(bool retry_failed) const;
  /// What belongs to the suite: its text, the graphs that it names, the catalogue.
  void write_suite(Suite const& suite) const;

 private:
  std::filesystem::path folder_;
  results::FolderLock lock_;
};

}  // namespace polhode::bench
