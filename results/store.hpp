#pragma once
/// A result folder: JSON Lines files, one per writing process, append-only, every record on disk before it counts.
///   {"kind":"meta",...}      once, first: provenance
///   {"kind":"begin",...}     a cell starts;  a begin without its run means that the process died in that cell
///   {"kind":"series",...}    histories for figures, before the run they belong to
///   {"kind":"run",...}       a cell is done: the acknowledgement
/// A torn last line is what a kill leaves: it is forgiven, and cut off before more is written. Any other damage is an
/// error.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/benchmarks.hpp"
#include "results/catalogue.hpp"
#include "results/ensemble_file.hpp"
#include "results/record.hpp"
#include "results/whole_file.hpp"

namespace polhode::results {

/// Everything that a folder (or one file) holds. A cell that was run more than once by a build keeps its last run.
struct Contents {
  std::vector<Meta> metas;      ///< one per file, in file order; a file that was killed before its meta has none
  std::vector<Record> records;  ///< in order of first appearance
  std::vector<Series> series;   ///< a cell that was run more than once keeps its last series of each name
  std::vector<std::string> unfinished;  ///< cells with a begin and no run of the same build after it
  std::size_t repeated = 0;             ///< runs that a later run of the same cell and build replaced
  Catalogue catalogue;                  ///< of the integrators; empty if the folder has none, or for one file
  Benchmarks benchmarks;                ///< of polhode-bench; the same
  std::optional<Ensemble> ensemble;     ///< of polhode ensemble, if the folder has one
};

/// Reads every *.jsonl in `path` (a folder), in the order of their names, and its catalogue; or `path` itself (a file).
/// Throws StoreError.
Contents read(std::filesystem::path const& path);

/// The *.jsonl of a folder, in the order of their names; or `path` itself (a file). Throws StoreError.
std::vector<std::filesystem::path> record_files(std::filesystem::path const& path);

/// Removes the record files of a folder, damaged ones too. Throws StoreError, and removes nothing, if a *.jsonl there
/// does not begin as ours do: it is somebody else's.
void remove_records(std::filesystem::path const& folder);

/// A name that files of a result folder have: nothing else may be put there under it.
bool is_own_name(std::string_view name);

/// Appends to one file. Each call returns after the line is on disk (fsync). Throws StoreError; what was acknowledged
/// stays. What a reader would refuse (a run whose cell is not its cell_id, a ragged series) throws
/// std::invalid_argument.
class Writer {
 public:
  /// Opens `file`, creates it with `meta` first, or continues it after cutting a torn last line. A file that
  /// does not begin with a meta is somebody else's: it is refused and left as it is.
  Writer(std::filesystem::path const& file, Meta const& meta);
  void begin(std::string const& cell, std::string const& build);
  void series(Series const& series);
  void run(Record const& record);

 private:
  void append(std::string const& line);
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, Close> out_;
};

}  // namespace polhode::results
