#pragma once
/// What polhode-bench measured: benchmarks.json of a result folder, beside the records. Costs of single steps, of many
/// bodies, of networks, and what the machine's arithmetic allows: figures that are no run of a cell.
///   {"schema": 1, "kind": "benchmarks", "meta": {provenance, as in a file of records}, "benchmarks": [
///     {"name": "step/free_body/quaternion/rk4", "clock": "cpu", "time_s": {as cpu_time_s of a run}, "counters": {}}]}
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "results/record.hpp"

namespace polhode::results {

/// The name of the file in a result folder.
inline constexpr char const* benchmarks_file = "benchmarks.json";

/// One benchmark.
struct Benchmark {
  std::string name;                          ///< "step/free_body/quaternion/rk4"
  bool wall = false;                         ///< wall time; otherwise CPU time of all threads
  CpuTime time;                              ///< of one iteration [s]
  std::map<std::string, double> counters{};  ///< "per_step" [s] and what else it counts: medians over the repetitions
};

/// All of one run of polhode-bench.
struct Benchmarks {
  Meta meta;
  std::vector<Benchmark> all;

  /// The one of that name, or null.
  Benchmark const* find(std::string_view name) const;
};

/// Reads the text of such a file. Throws std::invalid_argument that says what is wrong, and where.
Benchmarks benchmarks_from(std::string const& text);
/// That of a folder; empty if it has none. Throws StoreError, which names the file.
Benchmarks read_benchmarks(std::filesystem::path const& folder);
/// Puts it into a folder, which is made if it does not exist; whole or not at all. Throws StoreError.
void write_benchmarks(std::filesystem::path const& folder, Benchmarks const& benchmarks);

}  // namespace polhode::results
