#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// Norm drift is shown at this step [s].
constexpr double step = 0.1;

struct Line {
  std::string_view integrator, formulation, label;

  bool is(results::Cell const& c) const {
    return c.integrator == integrator && c.formulation == formulation && c.policy == "none";
  }
};
/// Few methods, own and rival, for accuracy against cost.
constexpr Line raced[] = {{"rk4", "quaternion", "rk4"},
                          {"dopri5", "quaternion", "dopri5"},
                          {"cf4", "s3", "cf4 (on S3)"},
                          {"gauss4", "quaternion", "gauss4"},
                          {"odeint_dopri5", "quaternion", "Odeint dopri5"},
                          {"cvode_adams", "quaternion", "CVODE Adams"}};

/// The captured target without control, as the paper's data have it.
bool is_captured_target(results::Cell const& c) {
  return c.problem == "tether_capture" && has_word(c.variant, "free") && !is_aside(c) &&
         !has_word(c.variant, "raw_q0") && c.set.empty();
}

/// Drift against time: four ways to treat the same equations.
Panel drift_panel(Facts const& facts) {
  constexpr Line lines[] = {{"gauss2_sweeps1", "quaternion", "gauss2, 1 sweep"},
                            {"gauss2_tol6", "quaternion", "gauss2, tol. 1e-6"},
                            {"rk4", "quaternion", "rk4"},
                            {"gauss2", "quaternion", "gauss2, to round-off"}};
  constexpr Dash dashes[] = {Dash::solid, Dash::solid, Dash::dashed, Dash::solid};
  Panel panel{.x = {"t [s]", true}, .y = {"|q.q - 1|", true, drawn_zero}, .title = "Norm drift without projection"};
  for (Instance const& instance : facts.instances) {
    if (!is_captured_target(instance.like())) continue;
    for (Line const& line : lines) {
      for (Record const* run : instance.runs) {
        auto const& of = run->of;
        auto const* series = facts.series_of(*run, "drift");
        if (!line.is(of) || of.h != step || !is_ok(*run) || !series) continue;
        auto const t = column_of(*series, "t"), drift = column_of(*series, "norm_drift");
        if (!t || !drift) continue;
        Curve curve{std::string(line.label), facts.style_of(of)};
        curve.style.dash = dashes[&line - lines];
        for (auto const& row : series->rows) {
          if (row.size() <= std::max(*t, *drift) || !(row[*t] > 0)) continue;
          curve.points.push_back({row[*t], std::max(std::abs(row[*drift]), drawn_zero)});
        }
        curve.style.every = std::max(1, static_cast<int>(curve.points.size()) / 8);
        if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
      }
    }
    if (!panel.curves.empty()) return panel;
  }
  return panel;
}

/// Error against cost on the free body: few methods, own and rival.
Panel cost_panel(Facts const& facts) {
  Instance const* instance = facts.headline(headlines[0]);
  Panel panel{.x = {"", true}, .y = {"attitude error [rad]", true}, .title = "Accuracy against cost, free body"};
  if (!instance) return panel;
  Measure const measure = measure_of(*instance);
  panel.x.label = measure == Measure::time ? "CPU time of the solve [s]" : "evaluations";
  for (Line const& line : raced) {
    Sweep const* shown = nullptr;
    auto const sweeps = instance->sweeps();
    for (Sweep const& sweep : sweeps) {
      if (line.is(sweep.like()) && (!shown || sweep.like().h)) shown = &sweep;
    }
    if (!shown) continue;
    Curve curve{std::string(line.label), facts.style_of(shown->like())};
    for (Record const* run : shown->runs) {
      auto const error = finite(run->attitude_error_max);
      auto const cost = cost_of(*run, measure);
      if (!is_ok(*run) || !error || *error <= 0 || !cost) continue;
      curve.points.push_back({cost->value, *error, below_bar(*run)});
      if (*error < rounding_rules) break;
    }
    if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
  }
  return panel;
}

/// What each method's norm, accuracy and work come to, in one row: nothing in it depends on the machine.
Table headline_table(Facts const& facts) {
  Table table{.name = "headline",
              .caption = Text("Norm drift: the captured target, uncontrolled, without projection. The rest: the free "
                              "body; evaluations of the field in the cheapest run that reaches the error."),
              .columns = {{"method"},
                          {"|q.q - 1|, h = 0.1 s", true},
                          {"attitude error [rad], h = 0.1 s", true},
                          {"evaluations to 1e-6 rad", true},
                          {"to 1e-9 rad", true}}};
  Instance const* body = facts.headline(headlines[0]);
  for (Line const& line : raced) {
    std::optional<double> drift, error;
    for (Record const* run : facts.runs) {
      if (!line.is(run->of) || run->of.h != step || !is_ok(*run)) continue;
      if (is_captured_target(run->of)) drift = finite(run->norm_drift_max);
      if (body && std::ranges::find(body->runs, run) != body->runs.end()) error = finite(run->attitude_error_max);
    }
    std::vector<Entry> row{std::string(line.label), number(drift, 2), number(error, 2)};
    for (double const target : usual_targets) {
      std::optional<Cost> least;
      for (Sweep const& sweep : body ? body->sweeps() : std::vector<Sweep>{}) {
        if (!line.is(sweep.like())) continue;
        auto const cost = cheapest(sweep, target, Measure::evaluations);
        if (cost && (!least || cost->measured < least->measured)) least = cost;
      }
      row.push_back(number(least ? std::optional(least->measured) : std::nullopt, 6));
    }
    bool const known = std::ranges::any_of(row | std::views::drop(1), [](Entry const& e) { return e.text != absent; });
    if (known) table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

void add_headline(Document& document, Facts const& facts) {
  Figure figure{.name = "headline", .poster = true};
  std::vector<std::string> captions;
  if (Panel panel = drift_panel(facts); !panel.curves.empty()) {
    figure.panels.push_back(std::move(panel));
    captions.emplace_back(
        "Norm drift: the captured target, uncontrolled, at h = 0.1 s; a Gauss method keeps the norm if its stages are "
        "solved to round-off, and not with one sweep or a loose tolerance. Exact zeros are drawn at 1e-17.");
  }
  if (Panel panel = cost_panel(facts); !panel.curves.empty()) {
    figure.panels.push_back(std::move(panel));
    captions.emplace_back(
        "Accuracy against cost: largest attitude error over the run; open symbols are other libraries, dashed curves "
        "adaptive; curves end where rounding takes over.");
  }
  figure.caption = fmt::format("{}", fmt::join(captions, " "));
  figure.columns = std::max(1, static_cast<int>(figure.panels.size()));
  if (has_points(figure)) document.add(std::move(figure));
  if (Table table = headline_table(facts); !table.rows.empty()) document.add(std::move(table));
}

}  // namespace polhode::report
