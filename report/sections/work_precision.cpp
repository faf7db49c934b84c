#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// More lines than this in one picture cannot be told apart: it is split by formulation, then by policy.
constexpr std::size_t most_lines = 14;

std::string line_label(Cell const& c, bool with_formulation) {
  std::string label = c.integrator;
  if (with_formulation) label += ", " + c.formulation;
  if (c.policy != "none") label += ", " + c.policy;
  return label + (!c.h && c.rtol ? ", adaptive" : "");
}

/// The parts of an instance that get a picture each: (what they have in common, their sweeps).
std::map<std::string, std::vector<Sweep>> parts_of(Instance const& instance) {
  std::map<std::string, std::vector<Sweep>> parts;
  auto all = instance.sweeps();
  std::erase_if(all, [](Sweep const& sweep) {
    return std::ranges::none_of(sweep.runs,
                                [](Record const* run) { return is_ok(*run) && finite(run->attitude_error_max); });
  });
  if (all.size() <= most_lines) return {{"", all}};
  for (Sweep const& sweep : all) parts[sweep.like().formulation].push_back(sweep);
  bool const crowded = std::ranges::any_of(parts, [](auto const& part) { return part.second.size() > most_lines; });
  if (!crowded) return parts;
  parts.clear();
  for (Sweep const& sweep : all) {
    Cell const& c = sweep.like();
    parts[fmt::format("{}, policy {}", c.formulation, c.policy)].push_back(sweep);
  }
  return parts;
}

Panel panel_of(Facts const& facts, std::vector<Sweep> const& sweeps, Measure measure) {
  Panel panel{.x = {measure == Measure::time ? "CPU time [s]" : "evaluations", true},
              .y = {"attitude error, max [rad]", true, least_error},
              .rounding = rounding_rules};
  bool const mixed = std::ranges::any_of(
      sweeps, [&](Sweep const& sweep) { return sweep.like().formulation != sweeps.front().like().formulation; });
  for (Sweep const& sweep : sweeps) {
    Cell const& c = sweep.like();
    Curve curve{line_label(c, mixed), facts.style_of(c)};
    for (Record const* run : sweep.runs) {
      auto const error = finite(run->attitude_error_max);
      auto const cost = cost_of(*run, measure);
      if (is_ok(*run) && error && *error > 0 && cost) curve.points.push_back({cost->value, *error, below_bar(*run)});
    }
    if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
  }
  return panel;
}

std::size_t add_figures(Document& document, Facts const& facts, Instance const& instance, std::size_t n) {
  for (auto const& [part, sweeps] : parts_of(instance)) {
    if (sweeps.size() == 1 && sweeps.front().runs.size() == 1) continue;  // a lone point: the table has it
    Figure figure{.name = fmt::format("work-precision-{}", n + 1), .columns = 2};
    std::string missing;
    for (Measure const measure : {Measure::time, Measure::evaluations}) {
      Panel panel = panel_of(facts, sweeps, measure);
      if (panel.curves.empty()) {
        missing += measure == Measure::time ? " None of these runs was timed." : " No evaluations were counted.";
      } else {
        figure.panels.push_back(std::move(panel));
      }
    }
    if (figure.panels.empty()) {
      document.say(fmt::format("{}{}: no run has both an attitude error and a cost, so there is no figure.",
                               instance.label, part.empty() ? "" : ", " + part));
      continue;
    }
    figure.columns = static_cast<int>(figure.panels.size());
    figure.caption = fmt::format(
        "{}{}: attitude error against work. Lower left is better. Open symbols: rivals; dashed: adaptive; dotted: with "
        "a norm policy. The shade below 1e-13 rad is where rounding rules.{}",
        instance.label, part.empty() ? "" : ", " + part, missing);
    document.add(std::move(figure));
    ++n;
  }
  return n;
}

/// With where it lies, if either cost varies.
Entry times_the_best(Cost const& cost, Cost const& best) {
  Estimate const ratio = quotient(cost, best);
  return cost.run != best.run && ratio.low < ratio.high ? number(ratio) : number(ratio.value);
}

Table cheapest_table(Instance const& instance, Measure measure, std::size_t n) {
  bool const timed = measure == Measure::time;
  double bar = 0;
  for (Record const* run : instance.runs) bar = std::max(bar, finite(run->reference_bar).value_or(0));
  std::string const sure =
      bar > 0 ? fmt::format(" Errors are certain to within {} rad, the bar of the reference.", significant(bar)) : "";
  Table table{.name = fmt::format("cheapest-{}", n),
              .caption = fmt::format(
                  "{}: the cheapest run of each integrator whose attitude error stays within the target, by "
                  "{}. \"At the target\" is interpolated in logarithms between that run and the next coarser "
                  "one of its sweep, and ranks; {} means that nothing brackets the target, and the run "
                  "itself ranks.{}",
                  instance.label, timed ? "CPU time" : "evaluations, since nothing was timed", absent, sure),
              .columns = {{"target [rad]", true},
                          {"rank", true},
                          {"integrator"},
                          {"formulation"},
                          {"policy"},
                          {"control"},
                          {"error [rad]", true},
                          {"[arcsec]", true, true},
                          {"evaluations", true},
                          {"CPU time", true},
                          {"low", true, true},
                          {"high", true, true},
                          {"at the target", true},
                          {"times the best", true}}};
  for (double const target : usual_targets) {
    auto const costs = ranking(instance, target, measure);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      Cost const& cost = costs[i];
      Record const& run = *cost.run;
      table.rows.push_back({number(target), std::to_string(i + 1), run.of.integrator, run.of.formulation, run.of.policy,
                            control_of(run.of), number(run.attitude_error_max),
                            number(arcseconds(*run.attitude_error_max)), count(run.evaluations),
                            cpu_time(run.cpu_time_s), run.cpu_time_s ? number(run.cpu_time_s->low) : Entry(absent),
                            run.cpu_time_s ? number(run.cpu_time_s->high) : Entry(absent), at_target(cost, measure),
                            times_the_best(cost, costs.front())});
    }
  }
  return table;
}

}  // namespace

void add_work_precision(Document& document, Facts const& facts) {
  document.section("Work and precision");
  document.say(
      "Runs are compared at the error that was measured, never at the tolerance that was asked for. Only runs with "
      "status ok are ranked. A run that was not timed is ranked by its evaluations alone.");
  document.say(timing_note(facts));
  std::size_t figures = 0, tables = 0;
  std::vector<std::string> single, without_reference;
  for (Instance const& instance : facts.instances) {
    bool const any = std::ranges::any_of(
        instance.runs, [](Record const* run) { return is_ok(*run) && finite(run->attitude_error_max); });
    if (!any || !instance.comparable() || is_aside(instance.like())) {
      (any ? single : without_reference).push_back(instance.label);
      continue;
    }
    document.heading(3, instance.label);
    figures = add_figures(document, facts, instance, figures);
    Measure const measure = measure_of(instance);
    Table table = cheapest_table(instance, measure, tables + 1);
    if (table.rows.empty()) {
      document.say("No run is known to reach 1e-6 rad with its work counted.");
    } else {
      ++tables;
      document.add(std::move(table));
    }
    auto const untimed =
        std::ranges::count_if(instance.runs, [](Record const* run) { return is_ok(*run) && !run->cpu_time_s; });
    if (measure == Measure::time && untimed > 0) {
      document.say(fmt::format("{} not timed; by evaluations alone:",
                               untimed == 1 ? "1 run was" : std::to_string(untimed) + " runs were"));
      Table by_work = cheapest_table(instance, Measure::evaluations, tables + 1);
      ++tables;
      document.add(std::move(by_work));
    }
  }
  if (!single.empty()) {
    document.say(fmt::format("Not compared here, having single runs or a section of their own: {}.",
                             single.size() > 3 ? fmt::format("{} other problems and variants", single.size())
                                               : fmt::format("{}", fmt::join(single, "; "))));
  }
  if (!without_reference.empty()) {
    document.say(
        fmt::format("No successful run with an attitude error, hence nothing to rank: {}.", listed(without_reference)));
  }
  if (facts.instances.empty()) document.say("The records hold no run at all.");
}

}  // namespace polhode::report
