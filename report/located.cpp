#include "report/located.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "report/cases.hpp"
#include "report/text.hpp"

namespace polhode::report {

using results::Cell;
using results::Record;

namespace {

Entry error_of(Record const& run) {
  return is_ok(run) ? number(run.attitude_error_end, 2) : Entry(std::string(name_of(run.status)));
}

}  // namespace

std::vector<Sweep> fixed_sweeps(Facts const& facts, std::function<bool(Cell const&)> const& wanted) {
  std::vector<Sweep> list;
  for (Instance const& instance : facts.instances) {
    for (Sweep sweep : instance.sweeps()) {
      std::erase_if(sweep.runs, [&](Record const* run) {
        return !finite(run->of.h) || run->status == results::Status::refused || !wanted(run->of);
      });
      if (!sweep.runs.empty()) list.push_back(std::move(sweep));
    }
  }
  return list;
}

std::vector<Sweep> twins(Facts const& facts, std::string_view problem) {
  auto const of_problem = [&](Cell const& c) {
    return c.problem == problem && c.set.empty() && c.seed == 1 && c.policy == "none";
  };
  // what is compared: the variant without the word, and the horizon
  std::map<std::pair<std::string, double>, int> kinds;
  auto const key = [](Cell const& c) { return std::pair(without_word(c.variant, "unlocated"), c.t_end); };
  for (Record const* run : facts.runs) {
    if (of_problem(run->of) && run->of.h) kinds[key(run->of)] |= has_word(run->of.variant, "unlocated") ? 2 : 1;
  }
  return fixed_sweeps(facts, [&](Cell const& c) { return of_problem(c) && kinds[key(c)] == 3; });
}

std::vector<Sweep> part_of(std::vector<Sweep> sweeps, bool located) {
  std::erase_if(sweeps, [&](Sweep const& s) { return has_word(s.like().variant, "unlocated") == located; });
  return sweeps;
}

std::optional<double> largest(Sweep const& sweep, ErrorKind const& kind) {
  std::optional<double> most;
  for (Record const* run : sweep.runs) {
    auto const error = finite(kind.of(*run));
    if (is_ok(*run) && error) most = std::max(most.value_or(*error), *error);
  }
  return most;
}

results::OrderResult order_of(Sweep const& sweep, double h_most, ErrorKind const& kind) {
  std::vector<results::OrderPoint> points;
  for (Record const* run : sweep.runs) {
    auto const error = finite(kind.of(*run));
    double const bar = kind.has_bar ? finite(run->reference_bar).value_or(0) : 0;
    if (is_ok(*run) && error && *run->of.h <= h_most) points.push_back({*run->of.h, *error, bar});
  }
  results::OrderRules rules;
  rules.round_off *= kind.scale;
  rules.asymptotic *= kind.scale;
  return results::fit_order(std::move(points), rules);
}

std::string slope_of(results::OrderFit const& fit) {
  if (!fit.half_width) return fmt::format("~ {:.1f}", fit.slope);
  return fmt::format("{:.{}f}", fit.slope, *fit.half_width < 0.1 ? 2 : 1);
}

Entry half_width_of(results::OrderFit const& fit) {
  if (!fit.half_width) return absent;
  double const w = *fit.half_width;
  return {w < 0.01 ? "< 0.01" : fmt::format("{:.{}f}", w, w < 0.1 ? 2 : 1), exact(w)};
}

Entry events_of(std::vector<Record const*> const& runs) {
  std::set<std::int64_t> counts;
  for (Record const* run : runs) {
    if (run->events_located) counts.insert(*run->events_located);
  }
  if (counts.empty()) return absent;
  if (counts.size() == 1) return std::to_string(*counts.begin());
  return fmt::format("{} to {}", *counts.begin(), *counts.rbegin());
}

Table error_table(std::string name, std::string caption, std::vector<Sweep> const& sweeps, double h_most) {
  Table table{.name = std::move(name),
              .caption = Text(std::move(caption)),
              .columns = {{"variant"},
                          {"integrator"},
                          {"formulation"},
                          {"events located", true},
                          {"order", true},
                          {"± 95%", true},
                          {"points", true}}};
  std::set<double, std::greater<>> steps;
  for (Sweep const& sweep : sweeps) {
    for (Record const* run : sweep.runs) steps.insert(*run->of.h);
  }
  for (double const h : steps) table.columns.push_back({fmt::format("h = {} s", significant(h, 4)), true});
  for (Sweep const& sweep : sweeps) {
    Cell const& c = sweep.like();
    std::vector<Entry> row{c.variant, c.integrator, c.formulation, events_of(sweep.runs)};
    if (auto const order = order_of(sweep, h_most); order.fit) {
      row.emplace_back(slope_of(*order.fit), exact(order.fit->slope));
      row.push_back(number(order.fit->half_width, 2));
      row.emplace_back(std::to_string(order.fit->points));
    } else {
      row.insert(row.end(), 3, Entry(absent));
    }
    for (double const h : steps) {
      auto const found = std::ranges::find_if(sweep.runs, [&](Record const* run) { return run->of.h == h; });
      row.push_back(found == sweep.runs.end() ? Entry(absent) : error_of(**found));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

Panel error_panel(Facts const& facts, std::string title, std::vector<Sweep> const& sweeps, ErrorKind const& kind) {
  Panel panel{.x = {"h [s]", true},
              .y = {std::string(kind.label), true, least_error * kind.scale},
              .rounding = rounding_rules * kind.scale,
              .title = std::move(title)};
  for (Sweep const& sweep : sweeps) {
    Cell const& c = sweep.like();
    Curve curve{c.integrator, facts.style_of(c)};
    for (Record const* run : sweep.runs) {
      auto const error = finite(kind.of(*run));
      bool const grey = error && kind.has_bar && *error <= finite(run->reference_bar).value_or(0);
      if (is_ok(*run) && error && *error > 0)
        curve.points.push_back({*run->of.h, std::max(*error, panel.y.least), grey});
    }
    if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
  }
  return panel;
}

void add_located(Document& document, Facts const& facts, std::string const& name, std::string_view event,
                 std::string_view events, std::vector<Sweep> const& sweeps) {
  add_figure(document, {.name = name,
                        .caption = fmt::format("Attitude error at the end against the step: steps that end on each "
                                               "{}, and steps across.",
                                               event),
                        .panels = {error_panel(facts, fmt::format("{} located", events), part_of(sweeps, true)),
                                   error_panel(facts, "not located", part_of(sweeps, false))},
                        .columns = 2,
                        .same_y = true});
  document.add(error_table(name,
                           fmt::format("Attitude error at the end [rad] by step, the measured order, and how many {} a "
                                       "run ended a step on.",
                                       events),
                           sweeps));
}

std::string orders_in_words(std::vector<Sweep> const& sweeps, double h_most, ErrorKind const& kind) {
  std::vector<std::string> words;
  for (Sweep const& sweep : sweeps) {
    auto const order = order_of(sweep, h_most, kind);
    if (order.fit) words.push_back(fmt::format("{} {}", sweep.like().integrator, slope_of(*order.fit)));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace polhode::report
