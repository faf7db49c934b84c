#include "bench/score/check_bound.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "results/order.hpp"
#include "results/run_name.hpp"

namespace polhode::bench {
namespace {

using results::Record;
using Json = nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();
/// `is` on numbers, as in selectors.
constexpr double equality = 1e-12;
/// How far an order may be from nominal if the suite does not say.
constexpr double default_within = 0.2;

/// A judgement of one cell.
Held judged(CheckedCell const& cell, double excess, std::string value) {
  return {.excess = excess, .value = std::move(value), .run = results::run_name(cell.wanted.cell), .id = cell.id};
}

/// Why there is no number to judge.
Held broken(CheckedCell const& cell, std::string why) {
  Held held = judged(cell, infinity, std::move(why));
  held.missing = cell.record == nullptr;
  return held;
}

/// "diverged: the state is not finite", or "" for a run that ended well.
std::string failure_of(Record const& record) {
  if (record.status == results::Status::ok) return "";
  return fmt::format("{}{}{}", results::name_of(record.status), record.reason.empty() ? "" : ": ", record.reason);
}

results::Tolerance tolerance_of(Bound const& bound) {
  bool const given = bound.rel || bound.abs || bound.digits;
  if (!given) return results::default_tolerance(record_field(bound.field));
  return {bound.rel, bound.abs, bound.digits};
}

/// How far beyond min, max and is a number stands, as a part of the bound.
double excess_of(Bound const& bound, double value) {
  double excess = -infinity;
  auto const scale = [](double limit) { return std::max(std::abs(limit), std::numeric_limits<double>::min()); };
  if (bound.max) excess = std::max(excess, (value - *bound.max) / scale(*bound.max));
  if (bound.min) excess = std::max(excess, (*bound.min - value) / scale(*bound.min));
  if (bound.is) {
    double const wanted = std::stod(*bound.is);
    excess = std::max(excess, std::abs(value - wanted) / scale(wanted) - equality);
  }
  return excess;
}

Held hold_number(Bound const& bound, CheckedCell const& cell, Json const& value) {
  std::string const failure = failure_of(*cell.record);
  if (!failure.empty()) return broken(cell, failure);
  if (!value.is_number()) return broken(cell, "null");
  double const number = value.get<double>();
  double const excess = excess_of(bound, number);
  // All digits where they may be what breaks the bound.
  return judged(cell, excess, excess > 0 ? value.dump() : fmt::format("{:.4g}", number));
}

Held hold_text(Bound const& bound, CheckedCell const& cell, Json const& value) {
  std::string const text = value.is_string() ? value.get<std::string>() : value.dump();
  std::string const& reason = cell.record->reason;
  bool const explain = bound.field == "status" && !reason.empty();
  double const excess = text == bound.is.value_or(text) ? -1 : infinity;
  return judged(cell, excess, explain ? fmt::format("{} ({})", text, reason) : text);
}

Held hold_golden_status(CheckedCell const& cell, results::GoldenLine const& line) {
  std::string const status(results::name_of(cell.record->status));
  bool const same = status == line.status;
  if (same) return judged(cell, -1, status);
  return judged(cell, infinity, fmt::format("{} (golden {})", status, line.status));
}

/// What was committed counts, null and failures as well: a run that is refused must go on being refused.
Held hold_golden(Bound const& bound, CheckedCell const& cell, GoldenByCell const& golden) {
  auto const found = golden.find(cell.id);
  if (found == golden.end()) return broken(cell, "without golden line (make it with --update)");
  if (bound.field == "status") return hold_golden_status(cell, found->second);

  auto const value_in = [&](results::GoldenLine const& line) -> std::optional<double> {
    auto const column = line.columns.find(record_field(bound.field));
    return column == line.columns.end() ? std::nullopt : std::optional(column->second);
  };
  Json const json = results::to_json(*cell.record).at(record_field(bound.field));
  auto const value = json.is_number() ? std::optional(json.get<double>()) : std::nullopt;
  auto const expected = value_in(found->second);
  std::string const shown = expected ? fmt::format("{}", *expected) : "null";
  std::string const failure = failure_of(*cell.record);
  bool const explain = !value && !failure.empty();
  double const excess = results::deviation(tolerance_of(bound), expected, value) - 1;
  std::string const measured = explain ? failure : value ? fmt::format("{:.6g}", *value) : "null";
  Held held = judged(cell, excess, fmt::format("{} (golden {})", measured, shown));
  held.comparable = expected || value;
  return held;
}

/// The worse of two judgements of one value.
Held worse(Held const& a, Held const& b) {
  return b.excess > a.excess ? b : a;
}

// --- Orders ----------------------------------------------------------------------------------------------------------

/// One method on one problem: what is the same at every step.
std::string method_of(results::Cell cell) {
  cell.h.reset();
  return results::canonical_text(cell);
}

std::string text_of(results::OrderFit const& fit) {
  std::string const interval = fit.half_width ? fmt::format(" +- {:.2g}", *fit.half_width) : "";
  return fmt::format("{:.3f}{} ({} steps, h = {:g} to {:g})", fit.slope, interval, fit.points, fit.h_low, fit.h_high);
}

/// The bound on an order in numbers: nominal is the method's own. `trouble` says why there is none.
Bound resolved(Bound bound, results::Cell const& cell, Vocabulary const& vocabulary, std::string& trouble) {
  if (!bound.nominal) return bound;
  auto const order = vocabulary.integrator(cell.integrator).order;
  if (!order) {
    trouble = fmt::format("{} has no nominal order", cell.integrator);
    return bound;
  }
  double const within = bound.within.value_or(default_within);
  bound.min = std::max(bound.min.value_or(-infinity), *order - within);
  bound.max = std::min(bound.max.value_or(infinity), *order + within);
  return bound;
}

/// The order of one method, from its cells at all steps.
Held hold_order(Bound const& bound, std::vector<CheckedCell const*> const& cells, Vocabulary const& vocabulary) {
  std::vector<results::OrderPoint> points;
  for (CheckedCell const* cell : cells) {
    if (!cell->record) return broken(*cell, "not run");
    std::string const failure = failure_of(*cell->record);
    if (!failure.empty()) return broken(*cell, failure);
    if (!cell->wanted.cell.h) return broken(*cell, "adaptive, without order; select fixed steps with h = \"*\"");
    if (!cell->record->attitude_error_end) return broken(*cell, "attitude_error_end is null");
    points.push_back({*cell->wanted.cell.h, *cell->record->attitude_error_end,  //
                      cell->record->reference_bar.value_or(0)});
  }
  CheckedCell const& first = *cells.front();
  auto const [fit, reason] = results::fit_order(points);
  if (!fit) return broken(first, reason);
  if (!fit->half_width) return broken(first, text_of(*fit) + ", which are too few");
  std::string trouble;
  Bound const limits = resolved(bound, first.wanted.cell, vocabulary, trouble);
  if (!trouble.empty()) return broken(first, trouble);
  return judged(first, excess_of(limits, fit->slope), text_of(*fit));
}

}  // namespace

std::string text_of(Bound const& bound) {
  std::vector<std::string> parts;
  if (bound.min && bound.max) {
    parts.push_back(fmt::format("from {} to {}", *bound.min, *bound.max));
  } else if (bound.min) {
    parts.push_back(fmt::format(">= {}", *bound.min));
  } else if (bound.max) {
    parts.push_back(fmt::format("<= {}", *bound.max));
  }
  if (bound.is) parts.push_back("= " + *bound.is);
  if (bound.nominal) parts.push_back(fmt::format("nominal +- {}", bound.within.value_or(default_within)));
  if (bound.golden) parts.push_back(bound.field == "status" ? "as golden" : results::text_of(tolerance_of(bound)));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string record_field(std::string const& field) {
  return field == "norm_drift" ? "norm_drift_max" : field;
}

Held hold(Bound const& bound, CheckedCell const& cell, GoldenByCell const& golden) {
  if (!cell.record) return broken(cell, "not run");
  if (bound.golden) {
    Held const held = hold_golden(bound, cell, golden);
    bool const alone = !bound.min && !bound.max && !bound.is;
    if (alone) return held;
    Bound rest = bound;
    rest.golden = false;
    return worse(held, hold(rest, cell, golden));
  }
  Json const value = results::to_json(*cell.record).at(record_field(bound.field));
  bool const textual = value.is_string() || value.is_object();  // neither is ever null
  return textual ? hold_text(bound, cell, value) : hold_number(bound, cell, value);
}

std::vector<Held> hold_orders(Bound const& bound, std::vector<CheckedCell const*> const& cells,
                              Vocabulary const& vocabulary) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<CheckedCell const*>> methods;
  for (CheckedCell const* cell : cells) {
    std::string const method = method_of(cell->wanted.cell);
    if (!methods.contains(method)) order.push_back(method);
    methods[method].push_back(cell);
  }
  std::vector<Held> all;
  for (std::string const& method : order) all.push_back(hold_order(bound, methods.at(method), vocabulary));
  return all;
}

}  // namespace polhode::bench
