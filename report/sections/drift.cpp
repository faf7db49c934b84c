#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// Points per curve: as many as a picture can show.
constexpr int bins = 160;

bool is_free_motion(Instance const& instance) {
  return instance.like().problem == "tether_capture" && has_word(instance.like().variant, "free");
}

/// Step or tolerance as a column, coarse last.
struct Control {
  bool adaptive;
  double size;
  std::string label;

  auto operator<=>(Control const&) const = default;
};

Control column_of_run(Record const& run) {
  return {!run.of.h, finite(run.of.h).value_or(finite(run.of.rtol).value_or(0)), control_of(run.of)};
}

/// The runs in quaternions, by integrator and policy.
using Rows = std::map<std::tuple<bool, std::string, std::string>, std::map<Control, Record const*>>;

Rows rows_of(Instance const& instance) {
  Rows rows;
  for (Record const* run : instance.runs) {
    Cell const& c = run->of;
    if (c.formulation == "quaternion")
      rows[{is_rival(c.integrator), c.integrator, c.policy}][column_of_run(*run)] = run;
  }
  return rows;
}

Table drift_table(Instance const& instance, Rows const& rows, std::size_t n) {
  std::set<Control> controls;
  for (auto const& [method, runs] : rows) {
    for (auto const& [control, run] : runs) controls.insert(control);
  }
  Table table{.name = fmt::format("drift-{}", n),
              .caption = fmt::format("{}: largest |q.q - 1|. Under a projecting policy \"raw\" is the defect of a step "
                                     "before its projection, \"delivered\" what the user gets. {} means that there is "
                                     "no such run.",
                                     instance.label, absent),
              .columns = {{"integrator"}, {"policy"}, {"norm drift"}}};
  for (Control const& control : controls) table.columns.push_back({control.label, true});
  for (auto const& [method, runs] : rows) {
    auto const& [rival, integrator, policy] = method;
    auto const line = [&](char const* what, std::optional<double> Record::*member) {
      std::vector<Entry> row{integrator, policy, what};
      for (Control const& control : controls) {
        auto const found = runs.find(control);
        if (found == runs.end()) {
          row.emplace_back(absent);
        } else if (!is_ok(*found->second)) {
          row.emplace_back(std::string(name_of(found->second->status)));
        } else {
          row.push_back(number(found->second->*member, 2));
        }
      }
      table.rows.push_back(std::move(row));
    };
    if (policy != "none") line("raw", &Record::norm_drift_raw_max);
    line("delivered", &Record::norm_drift_max);
  }
  return table;
}

/// The step whose histories are drawn.
std::optional<double> drawn_step(Facts const& facts, Instance const& instance) {
  std::map<double, std::set<std::string>> methods;
  for (Record const* run : instance.runs) {
    if (run->of.h && run->of.formulation == "quaternion" && facts.series_of(*run, "drift")) {
      methods[*run->of.h].insert(method_of(run->of));
    }
  }
  return common_step(methods);
}

/// The largest value in each of many equal shares of log t: no peak is lost, and the picture stays small.
std::vector<Point> thinned(results::Series const& series, std::string_view column) {
  auto const t = column_of(series, "t"), value = column_of(series, column);
  std::map<int, Point> largest;
  if (!t || !value) return {};
  for (auto const& row : series.rows) {
    if (row.size() <= std::max(*t, *value) || !(row[*t] > 0) || !std::isfinite(row[*value])) continue;
    double const y = std::max(std::abs(row[*value]), drawn_zero);
    int const bin = static_cast<int>(std::floor(std::log10(row[*t]) * bins / 4));
    auto const [at, is_new] = largest.try_emplace(bin, Point{row[*t], y});
    if (!is_new && y > at->second.y) at->second = {row[*t], y};
  }
  std::vector<Point> points;
  for (auto const& [bin, point] : largest) points.push_back(point);
  return points;
}

Figure drift_figure(Facts const& facts, Instance const& instance, std::size_t n) {
  Figure figure;
  figure.name = fmt::format("drift-{}", n);
  figure.same_y = true;
  auto const h = drawn_step(facts, instance);
  if (!h) return figure;
  std::map<std::string, Panel> panels;  // by policy; "none" comes before "project"
  for (Sweep const& sweep : instance.sweeps()) {
    for (Record const* run : sweep.runs) {
      Cell const& c = run->of;
      results::Series const* series = facts.series_of(*run, "drift");
      if (!series || c.formulation != "quaternion" || c.h != h) continue;
      Cell plain = c;
      plain.policy = "none";  // the panel tells the policy
      Style style = facts.style_of(plain);
      std::vector<Point> points = thinned(*series, "norm_drift");
      style.every = std::max(1, static_cast<int>(points.size()) / 10);
      if (!points.empty()) panels[c.policy].curves.push_back({c.integrator, style, std::move(points)});
    }
  }
  for (auto& [policy, panel] : panels) {
    panel.x = {"t [s]", true};
    panel.y = {"|q.q - 1|, delivered", true};
    panel.title = fmt::format("policy {}", policy);
    figure.panels.push_back(std::move(panel));
  }
  figure.columns = static_cast<int>(std::clamp<std::size_t>(figure.panels.size(), 1, 2));
  figure.caption = fmt::format(
      "{}: norm drift against time at h = {} s, the largest value in each short interval, for each "
      "norm policy. Exact zeros are drawn at 1e-17.",
      instance.label, significant(*h, 4));
  return figure;
}

}  // namespace

void add_drift(Document& document, Facts const& facts) {
  document.section("Norm drift, with and without projection");
  document.say(
      "Figure 3 of Xu et al. (2017, doi 10.21656/1000-0887.380168) shows a norm violation of the two-stage Gauss "
      "method without projection. A Gauss method keeps quadratic invariants such as q.q if its stage equations are "
      "solved to round-off. A visible drift then comes from elsewhere: initial data that are not normalised (variant "
      "raw_q0), a fixed small number of sweeps (gauss2_sweeps1, gauss2_sweeps2) or a loose stopping tolerance "
      "(gauss2_tol6).");
  std::size_t n = 0;
  std::vector<std::string> single;
  for (Instance const& instance : facts.instances) {
    if (!is_free_motion(instance)) continue;
    Rows const rows = rows_of(instance);
    if (rows.empty() || is_aside(instance.like())) continue;
    if (rows.size() == 1 && rows.begin()->second.size() == 1) {
      Record const& run = *rows.begin()->second.begin()->second;
      single.push_back(fmt::format("{}: at most {} with {} at {}", instance.label, number(run.norm_drift_max, 2).text,
                                   method_of(run.of), control_of(run.of)));
      continue;
    }
    ++n;
    document.heading(3, instance.label);
    document.add(drift_table(instance, rows, n));
    Figure figure = drift_figure(facts, instance, n);
    if (has_points(figure)) {
      document.add(std::move(figure));
    } else {
      document.say("No history of the drift was recorded for this motion, so there is no figure of it against time.");
    }
  }
  if (!single.empty()) document.say(fmt::format("Largest |q.q - 1| of single runs: {}.", fmt::join(single, "; ")));
  if (n == 0 && single.empty())
    document.say("The records hold no run of tether_capture's variant free in quaternions, so there is no table.");
}

}  // namespace polhode::report
