#pragma once
/// Expectations of a suite, held against records: every [[expect]] becomes a row per bounded field, with the worst
/// value and every failure. What the rules are stands in README.md; how it is shown, in check_report.hpp.
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "bench/input/suite.hpp"
#include "results/golden.hpp"
#include "results/store.hpp"

namespace polhode::bench {

/// A cell of the suite as a run names it, with the record of it if there is one.
struct CheckedCell {
  SuiteCell wanted;  ///< canonical, the horizon filled in
  std::string id;
  results::Record const* record = nullptr;  ///< null: not run
};

enum class Verdict {
  passed,
  failed,           ///< a value is out of bounds, or missing
  expected_fail,    ///< out of bounds, as xfail says
  unexpected_pass,  ///< xfail, and yet every bound holds
  vacuous           ///< fewer cells than min_cells, or nothing but null to compare
};

/// "passed", "FAILED", "expected failure", "UNEXPECTED PASS", "VACUOUS".
std::string_view name_of(Verdict verdict);
bool is_good(Verdict verdict);

/// What came of one bound of one expectation.
struct Row {
  int line = 0;          ///< of the expectation, in the suite file
  std::string selector;  ///< "{integrator = rk4, h = 0.0*}"
  std::string field;
  std::string bound;  ///< "<= 1e-13"
  std::size_t cells = 0;
  Verdict verdict = Verdict::passed;
  std::string worst;                  ///< the value nearest to its bound, or farthest beyond
  std::string worst_cell;             ///< the run that it is from
  std::vector<std::string> failures;  ///< "RUN [CELL]: FIELD = VALUE, must be BOUND"
  std::string xfail;                  ///< the reason; empty if none
};

/// Golden lines by cell id.
using GoldenByCell = std::map<std::string, results::GoldenLine>;

/// The cells of a suite in canonical form, each with its record of that build. Throws SuiteError: what the problem
/// itself says against a cell.
std::vector<CheckedCell> pair_up(Suite const& suite, results::Contents const& contents, std::string const& build);

/// Judges every expectation of the suite, in file order. `file` is the suite's, for messages. Throws SuiteError: a
/// bound that cannot be judged, such as a golden one on a field without golden column.
std::vector<Row> judge(Suite const& suite, std::vector<CheckedCell> const& cells, Vocabulary const& vocabulary,
                       GoldenByCell const& golden, std::string const& file);

}  // namespace polhode::bench
