#pragma once
/// Golden columns: the deterministic results of a suite, committed, so that a change of the code that changes a result
/// is seen. Counts and errors; never times. One line per cell:
///   {"schema":1,"kind":"golden","suite":"default"}
///   {"cell":"5f0c...","name":"free_body//quaternion/rk4/none/h=0.1","status":"ok","steps":500,...}
/// A column that does not apply is left out. The rules of comparison are in README.md.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/record.hpp"

namespace polhode::results {

/// The golden results of one cell.
struct GoldenLine {
  std::string cell;  ///< its id
  std::string name;  ///< run_name of the cell, for readers
  std::string status;
  std::map<std::string, double> columns;  ///< those that are not null; errors and drifts with 6 digits

  /// The value of a column, or null.
  std::optional<double> column(std::string const& name_of_column) const;
};

/// The names of the golden columns, in the order in which they are written: counts, then errors and drifts.
std::vector<std::string> const& golden_columns();
/// True for a column that counts: steps, evaluations and the like.
bool is_count(std::string_view column);

GoldenLine golden_of(Record const& record);

/// How much a column may differ; the widest that is given counts, and without any the default of the column.
struct Tolerance {
  std::optional<double> rel;     ///< part of the golden value
  std::optional<double> abs;     ///< in the unit of the column
  std::optional<double> digits;  ///< of log10 of the magnitudes, both raised to golden_floor
};

/// Magnitudes below are round-off: they agree with each other in digits.
inline constexpr double golden_floor = 1e-15;

/// Counts: rel 0.02. Errors and drifts: digits 0.3.
Tolerance default_tolerance(std::string_view column);
/// "golden within 2%", "golden within 0.3 digits".
std::string text_of(Tolerance const& tolerance);

/// How far a value is from the golden one, as a multiple of what is allowed: at most 1 if they agree. Null agrees with
/// null alone. Values of opposite sign agree in digits only where both are below golden_floor.
double deviation(Tolerance const& tolerance, std::optional<double> golden, std::optional<double> value);

/// Reads a golden file; none is one without lines. Throws StoreError with file and line.
std::vector<GoldenLine> read_golden(std::filesystem::path const& file);
/// Replaces a golden file in one piece. Throws StoreError.
void write_golden(std::filesystem::path const& file, std::string const& suite, std::vector<GoldenLine> const& lines);

/// Where `before` agrees with `now` by the default tolerances, it stays: digits that are round-off make no diff.
GoldenLine settled(GoldenLine const& before, GoldenLine const& now);

/// What changes, for a reader: "+ name", "- name", "~ name: column old -> new".
std::vector<std::string> difference(std::vector<GoldenLine> const& before, std::vector<GoldenLine> const& after);

}  // namespace polhode::results
