#pragma once
/// Suite files: TOML that names sweeps of cells, exclusions and expectations; the format is in bench/README.md.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/input/vocabulary.hpp"
#include "results/record.hpp"

namespace polhode::bench {

struct Timing {
  bool enabled = true;
  double min_time = 0.02;  ///< per repetition [s]
  int repetitions = 5;
};

/// A cell of a suite, with what the suite says about it beyond its identity.
struct SuiteCell {
  results::Cell cell;
  std::vector<std::string> tags;
  bool reference = true;  ///< false: claims, drift and counts are wanted, errors are not
};

/// Selects records: all keys must match (globs; numbers compared as numbers).
using Selector = std::map<std::string, std::string>;

/// Whether a cell answers to every key of the selector. Numbers agree within 1e-12, relatively; a variant answers to
/// its whole text and to any of its words ("case2" selects "case2,g1"); h, rtol and atol that are null answer to
/// nothing.
bool matches(Selector const& selector, SuiteCell const& cell);

/// Bounds on one field of the selected records. `golden` is compared with a committed value.
struct Bound {
  /// A record field; "norm_drift" means norm_drift_max; "order" is the fitted order of the selection.
  std::string field;
  std::optional<double> min, max;
  std::optional<std::string> is;
  bool nominal = false;          ///< order: the integrator's nominal order
  std::optional<double> within;  ///< order: how far from nominal
  bool golden = false;
  std::optional<double> rel, abs, digits;
};

struct Expectation {
  int line = 0;  ///< in the suite file
  Selector select;
  std::vector<Bound> bounds;
  int min_cells = 1;
  std::optional<std::string> xfail;
};

struct Suite {
  std::string name;
  std::string text;              ///< the file as read: copied into the result folder, hashed into the provenance
  std::filesystem::path file{};  ///< that it was read from
  std::vector<std::filesystem::path> files{};  ///< that it was read with: graphs; copied, too
  Timing timing;
  std::vector<SuiteCell> cells;  ///< in file order, without duplicates
  std::vector<Expectation> expectations;
};

/// A suite file that cannot be used; what() is "file:line: what; what would be right". Exit code 5.
struct SuiteError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads and expands a suite. A cell without t_end gets 0 = the problem's own horizon. Throws SuiteError.
Suite read_suite(std::filesystem::path const& file, Vocabulary const& vocabulary);

}  // namespace polhode::bench
