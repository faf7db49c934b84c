#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;
using results::Series;

/// Changes of the invariants of one run against time.
struct History {
  Record const* run = nullptr;
  std::vector<double> t, energy, momentum;  ///< |H/H0 - 1| and |L - L0| / |L0| in space
};

/// |L - L0| / |L0|: L has changed its length by a part of `length` and has turned by `angle` (law of cosines).
double change_in_space(double length, double angle) {
  return std::hypot(length, 2 * std::sqrt(std::max(0.0, 1 + length)) * std::sin(angle / 2));
}

std::optional<History> history_of(Facts const& facts, Record const& run) {
  Series const* series = facts.series_of(run, "invariants");
  if (!series) return {};
  auto const t = column_of(*series, "t"), energy = column_of(*series, "energy");
  auto const length = column_of(*series, "momentum"), angle = column_of(*series, "momentum_direction");
  if (!t || !energy || !length || !angle) return {};
  History history{&run, {}, {}, {}};
  for (auto const& row : series->rows) {
    bool const whole = row.size() == series->columns.size() && std::isfinite(row[*energy]) &&
                       std::isfinite(row[*length]) && std::isfinite(row[*angle]);
    if (!whole || !(row[*t] > 0)) continue;
    history.t.push_back(row[*t]);
    history.energy.push_back(std::abs(row[*energy]));
    history.momentum.push_back(change_in_space(row[*length], row[*angle]));
  }
  if (history.t.size() < 2) return {};
  return history;
}

/// The runs of the free body, at one step and to one time, that tell; of several choices the one with most runs.
std::vector<History> histories_of(Facts const& facts) {
  std::vector<History> best;
  for (Instance const& instance : facts.instances) {
    if (instance.like().problem != "free_body") continue;
    std::map<double, std::vector<History>> by_step;
    for (Sweep const& sweep : instance.sweeps()) {
      for (Record const* run : sweep.runs) {
        if (!is_ok(*run) || !run->of.h || run->of.policy != "none") continue;
        if (auto history = history_of(facts, *run)) by_step[*run->of.h].push_back(std::move(*history));
      }
    }
    for (auto& [h, histories] : by_step) {
      if (histories.size() > best.size()) best = std::move(histories);
    }
  }
  return best;
}

using Values = std::vector<double> History::*;

Panel panel_of(Facts const& facts, std::vector<History> const& histories, Values values, std::string label) {
  Panel panel{.x = {"t [s]"}, .y = {std::move(label), true, drawn_zero}};
  for (History const& history : histories) {
    Curve curve{method_of(history.run->of), facts.style_of(history.run->of)};
    for (std::size_t i = 0; i < history.t.size(); ++i) {
      curve.points.push_back({history.t[i], std::max((history.*values)[i], drawn_zero)});
    }
    curve.style.every = std::max(1, static_cast<int>(curve.points.size()) / 10);
    panel.curves.push_back(std::move(curve));
  }
  return panel;
}

/// The largest value before the middle of the time, and after it.
std::pair<double, double> halves(History const& history, Values values) {
  double before = 0, after = 0;
  for (std::size_t i = 0; i < history.t.size(); ++i) {
    double& most = history.t[i] <= history.t.back() / 2 ? before : after;
    most = std::max(most, (history.*values)[i]);
  }
  return {before, after};
}

}  // namespace

void add_conservation(Document& document, Facts const& facts) {
  auto const histories = histories_of(facts);
  if (histories.empty()) return;
  auto const& c = histories.front().run->of;
  std::string const where = fmt::format("Free body at h = {} s up to {} s", significant(*c.h), significant(c.t_end));
  document.heading(3, "Energy and angular momentum against time");
  document.say(
      "What theory says of a free body: Gauss methods on (q, omega) keep the quadratic energy and |L|, and L wanders "
      "in space by O(h^2s), s being the stages. In canonical variables the same methods are symplectic: L is kept in "
      "space, and the error of the energy oscillates without growth, at O(h^2s). The discrete Moser-Veselov algorithm, "
      "preprocessed or not, keeps both (Hairer & Vilmart 2006); it errs in the phase. An error that is bounded is as "
      "large in the first half of the time as in the second.");
  Figure figure{.name = "conservation",
                .caption = fmt::format("{}: error of the energy, |H/H0 - 1|, and change of the angular momentum in "
                                       "space, |L - L0|/|L0|, against time. Exact zeros are drawn at 1e-17.",
                                       where),
                .panels = {panel_of(facts, histories, &History::energy, "|H/H0 - 1|"),
                           panel_of(facts, histories, &History::momentum, "|L - L0|/|L0| in space")},
                .columns = 2,
                .same_y = true};
  document.add(std::move(figure));
  Table table{.name = "conservation",
              .caption = fmt::format("{}: the largest values in the first half of the time and in the second.", where),
              .columns = {{"integrator"},
                          {"coordinates"},
                          {"energy, first half", true},
                          {"second half", true},
                          {"L in space, first half", true},
                          {"second half", true}}};
  for (History const& history : histories) {
    std::vector<Entry> row{history.run->of.integrator, history.run->of.formulation};
    for (Values const values : {&History::energy, &History::momentum}) {
      auto const [before, after] = halves(history, values);
      row.push_back(number(before, 2));
      row.push_back(number(after, 2));
    }
    table.rows.push_back(std::move(row));
  }
  document.add(std::move(table));
}

}  // namespace polhode::report
