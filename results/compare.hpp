#pragma once
/// Two sets of records, held against each other cell by cell: what ends otherwise, what is more or less accurate, what
/// takes more or less work, and - on the same machine alone - what takes more or less time. Errors and counts are
/// deterministic: a difference is a fact, and how large it must be to be worth saying is a tolerance, the same as for
/// golden columns. Times are samples: a difference is a test on ranks (statistics.hpp), corrected by Holm over all
/// tests of a kind, and an effect of a size that matters.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "results/store.hpp"

namespace polhode::results {

/// What is worth saying.
struct CompareRules {
  double digits = 0.3;   ///< of log10 of errors and drifts, which are raised to round-off or the reference's bar
  double counts = 0.02;  ///< part of a count
  double time = 0.05;    ///< part of a time
  double alpha = 0.05;   ///< the chance that any of the times said to differ does not
};

/// Seen from the second set.
enum class Trend { same, worse, better, changed };
/// "same", "worse", "better", "changed".
std::string_view name_of(Trend trend);

/// One of the two sets: the records of the build that wrote last.
struct Side {
  std::string path, build, made;        ///< made: when, from which commit, as far as the meta tells
  std::string machine;                  ///< its fingerprint; empty if the metas tell none, or more than one
  std::vector<std::string> unfinished;  ///< cells that began and did not finish
  std::size_t records = 0;
  std::size_t of_other_builds = 0;  ///< records that were left out
};

/// A cell, for readers and for tools.
struct NamedCell {
  std::string cell, name;  ///< id and run_name
};

struct StatusChange : NamedCell {
  Status a = Status::ok, b = Status::ok;
  std::string reason_a, reason_b;
  Trend trend = Trend::changed;
};

/// A claim whose verdict is another.
struct ClaimChange : NamedCell {
  std::string claim, a, b;
  Trend trend = Trend::changed;
};

/// A deterministic column that differs by more than the rules allow.
struct ColumnChange : NamedCell {
  std::string column;
  bool count = false;
  std::optional<double> a, b;
  std::optional<double>
      change;  ///< of a count b / a - 1, else log10(b / a) of the raised magnitudes; null if there is none
  Trend trend = Trend::changed;
};

/// The times of one cell.
struct TimeChange : NamedCell {
  std::string integrator;
  double a = 0, b = 0;                ///< medians [s]
  double ratio = 1;                   ///< Hodges and Lehmann's b / a; of the medians if the samples are unfinished
  double superiority = .5;            ///< the chance that a repetition of b takes longer than one of a
  std::optional<double> p, adjusted;  ///< null if a file holds no samples; adjusted by Holm over the cells
  Trend trend = Trend::same;
};

/// The times of all cells of an integrator, or of all cells: each cell's ratio of medians is one observation.
struct GroupChange {
  std::string integrator;  ///< empty: all
  std::size_t cells = 0;
  double ratio = 1;  ///< median of the cells' ratios
  double p = 1, adjusted = 1;
  Trend trend = Trend::same;
};

struct Comparison {
  CompareRules rules;
  Side a, b;
  std::size_t common = 0;  ///< cells in both
  std::vector<StatusChange> statuses;
  std::vector<ClaimChange> claims;
  std::vector<ColumnChange> columns;  ///< of cells that ended alike, with results
  std::string why_no_times;           ///< empty if times were compared
  std::vector<TimeChange> times;      ///< every cell that both timed
  std::vector<GroupChange> groups;    ///< all cells first, then by integrator
  double smallest_p = 1;              ///< what the test of a cell can give, adjusted; above alpha it cannot decide
  std::vector<NamedCell> only_a, only_b;

  /// A status, a verdict, an error or a count is worse, or a cell of A did not finish in B. Seconds never count.
  bool regressed() const;
};

/// In the order of B. `path_a` and `path_b` are for readers.
Comparison compare(Contents const& a, Contents const& b, std::string path_a, std::string path_b,
                   CompareRules const& rules = {});

/// The same for tools: {schema, kind: "comparison", ...}, fields as above; what is not finite is null.
nlohmann::ordered_json to_json(Comparison const& comparison);

}  // namespace polhode::results
