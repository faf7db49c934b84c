#pragma once
/// The runs that speak for a paper: of each of its cases, under each choice of the rest, the one to show; and curves
/// from their histories.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "report/facts.hpp"
#include "report/papers.hpp"

namespace polhode::report {

/// Of each initial value problem with one of the paper's cases the most accurate successful run, preferably one with a
/// history.
struct CaseRuns {
  std::string label;                                 ///< what the cases share: gain set, sign, parameters
  std::string title;                                 ///< its short name, "g1" or "g1 as_printed"
  std::map<std::string, results::Record const*> of;  ///< "case1" -> its run

  results::Record const* find(std::string_view name) const {
    auto const found = of.find(std::string(name));
    return found == of.end() ? nullptr : found->second;
  }
};
/// The paper's runs, one entry for everything that its cases share.
std::vector<CaseRuns> case_runs(Facts const& facts, Paper const& paper);
/// The same, of the paper's own parameters alone, and of several horizons the longest.
std::vector<CaseRuns> published_runs(Facts const& facts, Paper const& paper);

/// True if the records hold a run of that problem, of whatever status.
bool has_runs(Facts const& facts, std::string_view problem);

/// A parameter that is one number; `otherwise`, the problem's own, if the cell does not set it.
double parameter(results::Cell const& cell, std::string const& name, double otherwise);

/// The value of a run's claim, if it has one that is finite.
std::optional<double> claimed(results::Record const& run, std::string_view name);

/// The last value of a column of a run's history, if it is finite.
std::optional<double> last_of(Facts const& facts, results::Record const& run, std::string_view column);

/// More samples than this per curve only make the file larger.
inline constexpr std::size_t most_samples = 1200;

/// One curve: `y` of a row against `x` of a row. Rows with a missing number are left out.
template <class X, class Y>
Curve curve_of(std::string label, Style const& style, results::Series const& series, X x, Y y) {
  Curve curve{std::move(label), style, {}};
  std::size_t const stride = series.rows.size() / most_samples + 1;
  for (std::size_t i = 0; i < series.rows.size(); i += stride) {
    auto const& row = series.rows[i];
    if (row.size() != series.columns.size()) continue;
    Point const p{x(row), y(row)};
    if (std::isfinite(p.x) && std::isfinite(p.y)) curve.points.push_back(p);
  }
  return curve;
}

/// What part of a history is drawn, and how.
struct View {
  double factor = 1;                 ///< from the series' unit
  double from = -1e300, to = 1e300;  ///< [s]
  bool magnitude = false;
};
/// A column of a run's history against time; no points if it has no such column.
Curve against_time(Facts const& facts, results::Record const& run, std::string_view column, std::string label,
                   Style const& style, View const& view = {});
/// Adds the curve if it has points.
void add_curve(Panel& panel, Curve curve);
/// Adds the figure without its empty panels; nothing if none is left.
void add_figure(Document& document, Figure figure);

}  // namespace polhode::report
