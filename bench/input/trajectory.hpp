#pragma once
/// Trajectories that another program made, as CSV. The first line that is no comment names the columns; each further
/// line is one time. Lines that begin with # and empty lines are passed over.
#include <filesystem>
#include <istream>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace polhode::bench {

/// A file that is no such trajectory; what() is "file:line: what; what would be right". Exit code 5.
struct TrajectoryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The columns that a trajectory must have, and those that it may have besides. `t` need not be named.
struct ColumnNames {
  std::vector<std::string> required, optional;
};

/// The required columns of a file, in the order in which they are required; rows in order of time.
struct TrajectoryTable {
  std::string file;
  std::vector<double> times;       ///< [s], from 0 on; never decreasing
  std::vector<double> values;      ///< row after row
  std::vector<std::size_t> lines;  ///< in the file, of each row
  std::size_t width = 0;
  std::vector<std::string> remarks;  ///< rows out of order, times that are there twice, gaps; each one line

  std::size_t rows() const { return times.size(); }
  std::span<double const> row(std::size_t i) const { return std::span(values).subspan(i * width, width); }
};

/// Reads a trajectory of at least two rows; `name` is the file in messages. A file may hold 5e7 numbers (400 MB) and
/// 64 MiB in a line. Throws TrajectoryError.
TrajectoryTable read_trajectory(std::istream& in, std::string const& name, ColumnNames const& wanted);
TrajectoryTable read_trajectory(std::filesystem::path const& file, ColumnNames const& wanted);

}  // namespace polhode::bench
