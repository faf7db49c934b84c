#pragma once
/// One result folder from several: the shards of a suite, the ranks of an allocation.
#include <cstddef>
#include <filesystem>
#include <vector>

namespace polhode::results {

struct MergeSummary {
  std::size_t folders = 0, files = 0, records = 0;
  std::size_t repeated = 0;  ///< runs that a later run of the same cell and build replaces
  /// What the folders hold and `out` does not: reports, files of others, measurements of which a later folder has
  /// others.
  std::vector<std::filesystem::path> left{};
};

/// Writes what the folders hold to `out`, which must not hold records yet. Each file with a meta becomes a file there,
/// numbered in the order of the folders and of its name, so that its provenance stays with its records; of a cell that
/// a build ran several times, the last run is kept. Begins without a run are kept, too. suite.toml and the graphs that
/// it names are copied, catalogues are joined; of benchmarks.json and ensemble.json the last is copied. Everything is
/// read before anything is written. Throws StoreError: damage, with file and line; suites or graphs that differ; an
/// `out` that holds records, or another file of those names.
MergeSummary merge(std::filesystem::path const& out, std::vector<std::filesystem::path> const& folders);

}  // namespace polhode::results
