#pragma once
/// A trajectory of another simulator, scored against a problem's certified reference.
#include <optional>
#include <string>
#include <vector>

#include "bench/cell/cell.hpp"
#include "bench/input/trajectory.hpp"

namespace polhode::bench {

/// How the numbers of a file are to be read.
struct Reading {
  bool scalar_first = false;      ///< q1 is the scalar
  bool inertial_to_body = false;  ///< q maps inertial to body axes
  bool degrees = false;           ///< rates are in deg/s

  bool operator==(Reading const&) const = default;
};

/// What a trajectory is worth.
struct Score {
  results::Record record;     ///< errors, drifts, status and reference; energy and momentum relative to the first row
  std::size_t points = 0;     ///< rows that were scored
  double begin = 0, end = 0;  ///< [s]
  /// What the user should know, each one line: of the file's times, and which other reading would fit far better.
  std::vector<std::string> remarks;
};

/// The columns that `simulate` writes of this problem on quaternions: the state is required. Rates that are no state
/// are not, nor what follows from the state.
ColumnNames columns_to_import(PreparedCell const& prepared);

/// Scores the rows until the horizon of `prepared`. reference null: errors stay null. Throws TrajectoryError for a
/// quaternion that is zero.
Score score(TrajectoryTable const& table, PreparedCell const& prepared, UsableReference const* reference,
            Reading const& reading);

/// The contract's JSON, and the same for people.
std::string json_text(Score const& score);
std::string score_text(Score const& score, std::string const& file, std::string const& problem);

}  // namespace polhode::bench
