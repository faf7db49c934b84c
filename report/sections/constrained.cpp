#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// Methods that see the constraint; all others run the form of index 1.
bool sees_constraint(std::string_view integrator) {
  return integrator.starts_with("half_explicit") || integrator == "rattle" || integrator == "generalized_alpha" ||
         integrator == "ida";
}

/// The defects of Phi = x - R r and of its derivatives, by the magnitudes of the published top: an arm of 1 m, 150
/// rad/s.
constexpr ErrorKind position{.label = "|Phi| [m]",
                             .of = [](Record const& run) { return run.position_defect_max; },
                             .scale = 1,
                             .has_bar = false};
constexpr ErrorKind velocity{.label = "|dPhi/dt| [m/s]",
                             .of = [](Record const& run) { return run.velocity_defect_max; },
                             .scale = 150,
                             .has_bar = false};
/// Of index 1 it is 0 by construction.
constexpr ErrorKind acceleration{.label = "|d2Phi/dt2| [m/s^2]",
                                 .of =
                                     [](Record const& run) {
                                       return sees_constraint(run.of.integrator) ? run.acceleration_defect_max
                                                                                 : std::nullopt;
                                     },
                                 .scale = 150 * 150,
                                 .has_bar = false};
constexpr ErrorKind multiplier{.label = "error of lambda, relative",
                               .of = [](Record const& run) { return run.multiplier_error_max; },
                               .scale = 1,
                               .has_bar = false};
constexpr std::array kinds{attitude_at_end, position, velocity, acceleration, multiplier};

bool is_constrained(Cell const& c) {
  return c.problem == "heavy_top" && has_word(c.variant, "dae") && c.set.empty() && c.seed == 1 && c.policy == "none";
}

/// The sweeps of one integrator and control in the description that suits it best: groups before flat ones. Those that
/// see the constraint come first.
std::vector<Sweep> best_sweeps(Facts const& facts) {
  auto const place = [](Sweep const& sweep) {
    constexpr std::array order{"s3", "so3", "quaternion"};
    auto const none_ok = std::ranges::none_of(sweep.runs, [](Record const* run) { return is_ok(*run); });
    return std::pair(none_ok, std::ranges::find(order, sweep.like().formulation) - order.begin());
  };
  auto const key = [](Sweep const& sweep) {
    Cell const& c = sweep.like();
    return std::tuple(!sees_constraint(c.integrator), is_rival(c.integrator), c.integrator, !c.h);
  };
  std::vector<Sweep> all;
  for (Instance const& instance : facts.instances) {
    if (!is_constrained(instance.like())) continue;
    for (Sweep& sweep : instance.sweeps()) {
      std::erase_if(sweep.runs, [](Record const* run) { return run->status == results::Status::refused; });
      if (!sweep.runs.empty()) all.push_back(std::move(sweep));
    }
  }
  std::ranges::stable_sort(all, {}, [&](Sweep const& sweep) { return std::pair(key(sweep), place(sweep)); });
  std::vector<Sweep> best;
  for (Sweep& sweep : all) {
    if (best.empty() || key(best.back()) != key(sweep)) best.push_back(std::move(sweep));
  }
  return best;
}

std::vector<Sweep> fixed(std::vector<Sweep> sweeps) {
  std::erase_if(sweeps, [](Sweep const& sweep) { return !sweep.like().h; });
  return sweeps;
}

/// "rattle and ida": the methods, each once.
std::string names_of(std::vector<Sweep> const& sweeps) {
  std::vector<std::string> names;
  for (Sweep const& sweep : sweeps) {
    if (std::ranges::find(names, sweep.like().integrator) == names.end()) names.push_back(sweep.like().integrator);
  }
  return listed(names);
}

/// The finest successful run of a sweep, or null.
Record const* finest(Sweep const& sweep) {
  auto const found =
      std::ranges::find_if(sweep.runs.rbegin(), sweep.runs.rend(), [](auto* run) { return is_ok(*run); });
  return found == sweep.runs.rend() ? nullptr : *found;
}

/// "rk4 3e-11 at h = 0.000125 s (order 4.00)": each method at its finest, and its order if the steps are fixed.
std::string finest_in_words(std::vector<Sweep> const& sweeps, ErrorKind const& kind) {
  std::vector<std::string> words;
  for (Sweep const& sweep : sweeps) {
    Record const* run = finest(sweep);
    auto const error = run ? finite(kind.of(*run)) : std::nullopt;
    if (!error) continue;
    Cell const& c = run->of;
    auto const order = c.h ? order_of(sweep, INFINITY, kind) : results::OrderResult{};
    words.push_back(fmt::format("{} {} at {}{}", c.integrator, significant(*error, 2),
                                c.h ? control_of(c) : fmt::format("rtol = {}", significant(*c.rtol)),
                                order.fit ? fmt::format(" (order {})", slope_of(*order.fit)) : ""));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Who holds one level of the constraint to round-off, and how far off the others are.
void say_level(Document& document, std::vector<Sweep> const& sweeps, ErrorKind const& kind, std::string_view level) {
  std::vector<Sweep> held, off;
  double worst = 0;
  for (Sweep const& sweep : sweeps) {
    auto const most = largest(sweep, kind);
    if (!most) continue;
    bool const is_held = *most <= round_off * kind.scale;
    if (is_held) worst = std::max(worst, *most);
    (is_held ? held : off).push_back(sweep);
  }
  if (held.empty() && off.empty()) return;
  std::string text = held.empty()
                         ? "held to round-off by none"
                         : fmt::format("held to round-off, within {}, by {}", significant(worst, 2), names_of(held));
  if (!off.empty()) text += fmt::format("; at the finest step or tolerance {}", finest_in_words(off, kind));
  document.say(fmt::format("{}: {}.", level, text));
}

/// Runs with one step that hold the constraint, and yet differ in attitude.
void say_attitudes(Document& document, std::vector<Sweep> const& sweeps) {
  std::map<double, std::vector<Record const*>> by_step;
  for (Sweep const& sweep : sweeps) {
    for (Record const* run : sweep.runs) {
      bool const held = finite(run->position_defect_max).value_or(INFINITY) <= round_off;
      if (is_ok(*run) && held && run->of.h && finite(run->attitude_error_end)) by_step[*run->of.h].push_back(run);
    }
  }
  std::erase_if(by_step, [](auto const& item) { return item.second.size() < 2; });
  if (by_step.empty()) return;
  auto const& [h, runs] = *by_step.begin();
  auto const [least, most] = std::ranges::minmax_element(runs, {}, [](auto* run) { return *run->attitude_error_end; });
  document.say(
      fmt::format("A constraint that is held is no accuracy: at h = {} s the attitude errors of methods that hold Phi "
                  "at round-off reach from {} rad ({}) to {} rad ({}).",
                  significant(h, 4), significant(*(*least)->attitude_error_end, 2), (*least)->of.integrator,
                  significant(*(*most)->attitude_error_end, 2), (*most)->of.integrator));
}

Table defect_table(std::vector<Sweep> const& sweeps) {
  Table table{.name = "constrained-defects",
              .caption =
                  "The top in maximal coordinates, by method and step or tolerance: what the constraint Phi and "
                  "its derivatives are violated by at most, and the error of its multiplier over the greatest "
                  "multiplier. Methods see the constraint, or run the form of index 1, where the multiplier is "
                  "eliminated.",
              .columns = {{"integrator"},
                          {"form"},
                          {"formulation"},
                          {"control"},
                          {"status"},
                          {"evaluations", true},
                          {"attitude error [rad]", true}}};
  for (ErrorKind const& kind : kinds) {
    if (kind.label != attitude_at_end.label) table.columns.push_back({std::string(kind.label), true});
  }
  for (Sweep const& sweep : sweeps) {
    for (Record const* run : sweep.runs) {
      Cell const& c = run->of;
      std::vector<Entry> row{c.integrator,
                             sees_constraint(c.integrator) ? "constraint" : "index 1",
                             c.formulation,
                             c.h ? control_of(c) : fmt::format("rtol = {}", significant(c.rtol.value_or(NAN))),
                             std::string(name_of(run->status)),
                             count(run->evaluations)};
      for (ErrorKind const& kind : kinds) row.push_back(is_ok(*run) ? number(kind.of(*run), 2) : Entry(absent));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

void add_order_table(Document& document, Facts const& facts) {
  Table table{.name = "constrained-orders",
              .caption = fmt::format("Measured orders of the attitude error at the end, of the defects and of the "
                                     "multiplier, fixed steps; {} where the numbers are round-off, or do not lie on a "
                                     "line.",
                                     absent),
              .columns = {{"integrator"},
                          {"formulation"},
                          {"attitude", true},
                          {"Phi", true},
                          {"dPhi/dt", true},
                          {"d2Phi/dt2", true},
                          {"lambda", true}}};
  auto sweeps = fixed_sweeps(facts, is_constrained);
  std::ranges::stable_sort(sweeps, {}, [](Sweep const& s) { return !sees_constraint(s.like().integrator); });
  for (Sweep const& sweep : sweeps) {
    if (sweep.runs.size() < 2) continue;
    std::vector<Entry> row{sweep.like().integrator, sweep.like().formulation};
    for (ErrorKind const& kind : kinds) {
      auto const order = order_of(sweep, INFINITY, kind);
      row.push_back(order.fit ? Entry(slope_of(*order.fit), exact(order.fit->slope)) : Entry(absent));
    }
    table.rows.push_back(std::move(row));
  }
  if (!table.rows.empty()) document.add(std::move(table));
}

/// Defects and errors against the evaluations: fixed steps and tolerances in one picture.
Panel work_panel(Facts const& facts, std::vector<Sweep> const& sweeps, ErrorKind const& kind) {
  Panel panel{.x = {"evaluations", true},
              .y = {std::string(kind.label), true, least_error * kind.scale},
              .rounding = rounding_rules * kind.scale};
  for (Sweep const& sweep : sweeps) {
    Cell const& c = sweep.like();
    Curve curve{c.integrator + (c.h ? "" : ", adaptive"), facts.style_of(c)};
    for (Record const* run : sweep.runs) {
      auto const error = finite(kind.of(*run));
      bool const grey = error && kind.has_bar && *error <= finite(run->reference_bar).value_or(0);
      if (is_ok(*run) && error && *error > 0 && run->evaluations)
        curve.points.push_back({double(*run->evaluations), *error, grey});
    }
    add_curve(panel, std::move(curve));
  }
  return panel;
}

void add_figures(Document& document, Facts const& facts, std::vector<Sweep> const& sweeps) {
  auto const steps = fixed(sweeps);
  Figure against_step{.name = "constrained-defects",
                      .caption =
                          "Defects of the constraint, error of its multiplier, and attitude error against the "
                          "step. The shade is where rounding rules.",
                      .columns = 2};
  for (ErrorKind const& kind : {position, velocity, acceleration, multiplier, attitude_at_end})
    against_step.panels.push_back(error_panel(facts, "", steps, kind));
  add_figure(document, std::move(against_step));
  add_figure(document, {.name = "constrained-work",
                        .caption = "The same against the evaluations of the field, with the adaptive methods. Open "
                                   "symbols: rivals; dashed: adaptive.",
                        .panels = {work_panel(facts, sweeps, position), work_panel(facts, sweeps, attitude_at_end)},
                        .columns = 2});
  Figure drift{.name = "constrained-drift",
               .caption = "Violation of the constraint against time, of the runs that left a history.",
               .panels = {{.x = {"t [s]"}, .y = {std::string(position.label), true, 1e-17}},
                          {.x = {"t [s]"}, .y = {std::string(velocity.label), true, 1e-15}}},
               .columns = 2};
  for (Sweep const& sweep : sweeps) {
    for (Record const* run : sweep.runs) {
      Style style = facts.style_of(run->of);
      style.points = false;
      std::string const label = fmt::format("{}, {}", run->of.integrator, control_of(run->of));
      add_curve(drift.panels[0], against_time(facts, *run, "position_defect", label, style));
      add_curve(drift.panels[1], against_time(facts, *run, "velocity_defect", label, style));
    }
  }
  add_figure(document, std::move(drift));
}

}  // namespace

void add_constrained(Document& document, Facts const& facts) {
  auto const sweeps = best_sweeps(facts);
  if (sweeps.empty()) return;
  document.section("A top held by a constraint");
  document.say(
      "The published heavy top in maximal coordinates: its centre of mass x moves in space and a force lambda holds it "
      "at the end of the arm r, Phi = x - R r = 0. Bruels, Cardona & Arnold (2012), Mech. Mach. Theory 48, 121, sec. "
      "6.1. The exact motion satisfies Phi = 0, dPhi/dt = 0 and d2Phi/dt2 = 0; a method keeps some of the three.");
  say_level(document, sweeps, position, "Positions, |Phi| in m");
  say_level(document, sweeps, velocity, "Velocities, |dPhi/dt| in m/s");
  say_level(document, sweeps, acceleration, "Accelerations, |d2Phi/dt2| in m/s^2");
  say_level(document, sweeps, multiplier, "The multiplier, relative error");
  say_attitudes(document, sweeps);
  add_figures(document, facts, sweeps);
  document.add(defect_table(sweeps));
  add_order_table(document, facts);
}

}  // namespace polhode::report
