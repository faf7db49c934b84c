#include <algorithm>
#include <cmath>

#include "report/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// Norm drift is shown at this step [s].
constexpr double step = 0.1;
/// Exact zeros have no place on a logarithmic axis: they are drawn here.
constexpr double least_drift = 1e-17;
/// Curves of cost end where rounding takes over [rad].
constexpr double rounding = 1e-13;

struct Line {
  std::string_view integrator, formulation, label;
};

/// Drift against time: four ways to treat the same equations.
Panel drift_panel(Facts const& facts) {
  constexpr Line lines[] = {{"gauss2_sweeps1", "quaternion", "gauss2, 1 sweep"},
                            {"gauss2_tol6", "quaternion", "gauss2, tol. 1e-6"},
                            {"rk4", "quaternion", "rk4"},
                            {"gauss2", "quaternion", "gauss2, to round-off"}};
  constexpr Dash dashes[] = {Dash::solid, Dash::solid, Dash::dashed, Dash::solid};
  Panel panel{.x = {"t [s]", true},
              .y = {"|q.q - 1|", true, least_drift},
              .curves = {},
              .rounding = 0,
              .title = "Norm drift without projection"};
  for (Instance const& instance : facts.instances) {
    auto const& c = instance.like();
    if (c.problem != "tether_capture" || !has_word(c.variant, "free") || is_aside(c)) continue;
    if (has_word(c.variant, "raw_q0") || !c.set.empty()) continue;
    for (Line const& line : lines) {
      for (Record const* run : instance.runs) {
        auto const& of = run->of;
        auto const* series = facts.series_of(*run, "drift");
        bool const wanted = of.integrator == line.integrator && of.formulation == line.formulation && of.h == step;
        if (!wanted || of.policy != "none" || !is_ok(*run) || !series) continue;
        auto const t = column_of(*series, "t"), drift = column_of(*series, "norm_drift");
        if (!t || !drift) continue;
        Curve curve{std::string(line.label), facts.style_of(of), {}};
        curve.style.dash = dashes[&line - lines];
        for (auto const& row : series->rows) {
          if (row.size() <= std::max(*t, *drift) || !(row[*t] > 0)) continue;
          curve.points.push_back({row[*t], std::max(std::abs(row[*drift]), least_drift)});
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
  constexpr Line lines[] = {{"rk4", "quaternion", "rk4"},
                            {"dopri5", "quaternion", "dopri5"},
                            {"cf4", "s3", "cf4 (on S3)"},
                            {"gauss4", "quaternion", "gauss4"},
                            {"odeint_dopri5", "quaternion", "Odeint dopri5"},
                            {"cvode_adams", "quaternion", "CVODE Adams"}};
  Instance const* instance = facts.headline(headlines[0]);
  Panel panel{.x = {"", true},
              .y = {"attitude error [rad]", true},
              .curves = {},
              .rounding = 0,
              .title = "Accuracy against cost, free body"};
  if (!instance) return panel;
  bool const timed = measure_of(*instance) == Measure::time;
  panel.x.label = timed ? "CPU time of the solve [s]" : "evaluations";
  for (Line const& line : lines) {
    Sweep const* shown = nullptr;
    auto const sweeps = instance->sweeps();
    for (Sweep const& sweep : sweeps) {
      auto const& of = sweep.like();
      bool const wanted = of.integrator == line.integrator && of.formulation == line.formulation;
      if (wanted && of.policy == "none" && (!shown || of.h)) shown = &sweep;
    }
    if (!shown) continue;
    Curve curve{std::string(line.label), facts.style_of(shown->like()), {}};
    for (Record const* run : shown->runs) {
      auto const error = finite(run->attitude_error_max);
      std::optional<double> cost;
      if (timed && run->cpu_time_s) cost = run->cpu_time_s->median;
      if (!timed && run->evaluations) cost = static_cast<double>(*run->evaluations);
      if (!is_ok(*run) || !error || *error <= 0 || !finite(cost) || *cost <= 0) continue;
      curve.points.push_back({*cost, *error, below_bar(*run)});
      if (*error < rounding) break;
    }
    if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
  }
  return panel;
}

}  // namespace

void add_headline(Document& document, Facts const& facts) {
  Figure figure{.name = "headline", .caption = {}, .panels = {}, .poster = true, .svg = {}, .why_not = ""};
  std::string caption;
  if (Panel panel = drift_panel(facts); !panel.curves.empty()) {
    figure.panels.push_back(std::move(panel));
    caption +=
        "Norm drift: the captured target, uncontrolled, at h = 0.1 s; a Gauss method keeps the norm if its stages are "
        "solved to round-off, and not with one sweep or a loose tolerance. Exact zeros are drawn at 1e-17. ";
  }
  if (Panel panel = cost_panel(facts); !panel.curves.empty()) {
    figure.panels.push_back(std::move(panel));
    caption +=
        "Accuracy against cost: largest attitude error over the run; open symbols are other libraries, dashed curves "
        "adaptive; curves end where rounding takes over.";
  }
  figure.caption = Text(std::move(caption));
  figure.columns = std::max(1, static_cast<int>(figure.panels.size()));
  if (has_points(figure)) document.add(std::move(figure));
}

}  // namespace polhode::report
