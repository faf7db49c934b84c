#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

constexpr std::array axes{"x", "y", "z"};

double arrival_of(Cell const& c) {
  return parameter(c, "t_f", 50);  // the problem's own
}
double inertia_error_of(Cell const& c) {
  return parameter(c, "inertia_error", 0);
}

/// "printed", "printed, quintic": actuators, and the path if it is not the paper's.
std::string actuators_of(Cell const& c) {
  std::string variant = c.variant;
  for (auto const word : dead_zone().unsaid) variant = without_word(variant, word);
  std::ranges::replace(variant, ',', ' ');
  return variant;
}

/// The runs that left a history: one for each variant and set of parameters.
std::vector<Record const*> shown_runs(Facts const& facts) {
  std::vector<Record const*> runs;
  for (Record const* run : facts.runs) {
    if (run->of.problem == dead_zone().problem && facts.series_of(*run, "history")) runs.push_back(run);
  }
  std::ranges::stable_sort(runs, {}, [](Record const* run) {
    return std::tuple(arrival_of(run->of), actuators_of(run->of) != "printed", actuators_of(run->of),
                      inertia_error_of(run->of));
  });
  return runs;
}

void add_bounds(Document& document, std::vector<Record const*> const& runs) {
  Table table{.name = "dead_zone-claims",
              .caption =
                  "The paper's bounds for each variant, error p of the inertia and end t_f of the path: the value, "
                  "then \"yes\" if it bears the bound out and \"no\" if not. Rest: greatest |sigma_i| from t_f on, "
                  "to be below 1e-6. Layer: greatest |s_i| / beta, to be below 1. Then the greatest |sigma| (at 1 "
                  "the body has turned by 180 deg) and the greatest commands.",
              .columns = {{"t_f [s]", true},
                          {"actuators, path"},
                          {"p", true},
                          {"method"},
                          {"status"},
                          {"rest", true},
                          {"layer", true},
                          {"greatest |sigma|", true},
                          {"v_x [N m]", true},
                          {"v_y", true},
                          {"v_z", true},
                          {"events located", true}}};
  std::size_t judged = 0, rest = 0, layer = 0;
  double worst = 0;
  for (Record const* run : runs) {
    Cell const& c = run->of;
    table.rows.push_back({number(arrival_of(c)), actuators_of(c), number(inertia_error_of(c)),
                          fmt::format("{}, {}", method_of(c), control_of(c)), std::string(name_of(run->status)),
                          verdict_of(run, "sigma_rest"), verdict_of(run, "layer"), verdict_of(run, "sigma_max"),
                          verdict_of(run, "v_x_peak"), verdict_of(run, "v_y_peak"), verdict_of(run, "v_z_peak"),
                          events_of({run})});
    auto const holds = [&](char const* name) {
      auto const claim = run->claims.find(name);
      return claim != run->claims.end() && claim->second.verdict == "reproduced";
    };
    auto const off = claimed(*run, "sigma_rest");
    if (!off) continue;
    ++judged;
    rest += holds("sigma_rest") ? 1 : 0;
    layer += holds("layer") ? 1 : 0;
    worst = std::max(worst, *off);
  }
  if (table.rows.empty()) {
    document.say("No run here left a history, so no bound was looked at.");
    return;
  }
  document.say(
      fmt::format("At rest within 1e-6 from t_f on: {} of {}, the worst |sigma_i| being {}. In the boundary layer "
                  "throughout: {} of {}.",
                  rest, counted(judged, "run", "runs"), significant(worst), layer, counted(judged, "run", "runs")));
  document.add(std::move(table));
}

Style style_of(Cell const& c) {
  bool const quintic = has_word(c.variant, "quintic");
  if (has_word(c.variant, "smooth")) return {.index = 2, .dash = Dash::dashed, .points = false};
  if (has_word(c.variant, "continuous")) return {.index = 3, .points = false};
  return {.index = quintic ? 6 : 12, .dash = quintic ? Dash::dash_dot : Dash::solid, .points = false};
}

void add_histories(Document& document, Facts const& facts, std::vector<Record const*> const& runs) {
  std::set<double> arrivals;
  for (Record const* run : runs) arrivals.insert(arrival_of(run->of));
  for (double const t_f : arrivals) {
    Figure command{.name = fmt::format("dead-zone-command-{:.0f}", t_f),
                   .caption = fmt::format("Commands around t_f = {} s, for the nominal inertia: on the cubic path they "
                                          "jump, on the quintic they do not.",
                                          significant(t_f)),
                   .columns = 2};
    Figure rest{.name = fmt::format("dead-zone-rest-{:.0f}", t_f),
                .caption = fmt::format("Around and after t_f = {} s: attitude, and the sliding variable whose layer is "
                                       "beta wide.",
                                       significant(t_f)),
                .columns = 2};
    for (auto const* axis : axes) {
      Panel v{.x = {"t [s]"}, .y = {fmt::format("v_{} [N m]", axis)}};
      Panel sigma{.x = {"t [s]"}, .y = {fmt::format("|sigma_{}|", axis), true, 1e-12}};
      Panel sliding{.x = {"t [s]"}, .y = {fmt::format("|s_{}| [1/s]", axis), true, 1e-12}};
      for (Record const* run : runs) {
        Cell const& c = run->of;
        if (arrival_of(c) != t_f || inertia_error_of(c) != 0) continue;
        std::string const label = actuators_of(c);
        View const around{.from = t_f - 4, .to = t_f + 4}, after{.from = t_f - 4, .to = t_f + 20, .magnitude = true};
        add_curve(v, against_time(facts, *run, fmt::format("v_{}", axis), label, style_of(c), around));
        add_curve(sigma, against_time(facts, *run, fmt::format("sigma_{}", axis), label, style_of(c), after));
        add_curve(sliding, against_time(facts, *run, fmt::format("sliding_{}", axis), label, style_of(c), after));
      }
      command.panels.push_back(std::move(v));
      rest.panels.push_back(std::move(sigma));
      rest.panels.push_back(std::move(sliding));
    }
    add_figure(document, std::move(command));
    add_figure(document, std::move(rest));
  }
}

/// A column's jump at a time: the straight lines through the two rows before it and the two after it, met there. Rows
/// at that very time belong to neither side.
std::optional<double> jump_of(Facts const& facts, Record const& run, std::string_view column, double at) {
  results::Series const* series = facts.series_of(run, "history");
  auto const t = series ? column_of(*series, "t") : std::nullopt;
  auto const y = series ? column_of(*series, column) : std::nullopt;
  if (!t || !y) return {};
  std::vector<Point> before, after;
  for (auto const& row : series->rows) {
    if (row.size() != series->columns.size()) continue;
    if (row[*t] < at - 1e-6) before.push_back({row[*t], row[*y]});
    if (row[*t] > at + 1e-6 && after.size() < 2) after.push_back({row[*t], row[*y]});
  }
  if (before.size() < 2 || after.size() < 2) return {};
  auto const meet = [&](Point const& a, Point const& b) { return a.y + (b.y - a.y) * (at - a.x) / (b.x - a.x); };
  return finite(meet(after[0], after[1]) - meet(before[before.size() - 2], before.back()));
}

void add_jumps(Document& document, Facts const& facts, std::vector<Record const*> const& runs) {
  Table table{.name = "dead-zone-jumps",
              .caption =
                  "Jump of the command at t_f [N m], from straight lines through the samples on either side of it, "
                  "for the nominal inertia. Where commands chatter it is no better than the chatter.",
              .columns = {{"t_f [s]", true}, {"actuators, path"}, {"v_x", true}, {"v_y", true}, {"v_z", true}}};
  for (Record const* run : runs) {
    Cell const& c = run->of;
    if (inertia_error_of(c) != 0) continue;
    std::vector<Entry> row{number(arrival_of(c)), actuators_of(c)};
    for (auto const* axis : axes) row.push_back(number(jump_of(facts, *run, fmt::format("v_{}", axis), arrival_of(c))));
    table.rows.push_back(std::move(row));
  }
  if (table.rows.empty()) return;
  document.say(
      "The second derivative of the cubic path jumps at t_f, against the paper's condition 1, and the command with it. "
      "It does not on the quintic path. t_f is announced, so every method ends a step on it.");
  document.add(std::move(table));
}

/// One adaptive method at one tolerance, on the printed actuators and on smooth ones.
struct Pair {
  Record const *printed = nullptr, *smooth = nullptr;
};

void add_step_control(Document& document, Facts const& facts) {
  std::map<std::tuple<std::string, std::string, double>, Pair> pairs;
  for (Record const* run : facts.runs) {
    Cell const& c = run->of;
    if (c.problem != dead_zone().problem || !finite(c.rtol) || !c.set.empty()) continue;
    auto& pair = pairs[{c.integrator, c.formulation, *c.rtol}];
    if (actuators_of(c) == "printed") pair.printed = run;
    if (actuators_of(c) == "smooth") pair.smooth = run;
  }
  std::erase_if(pairs, [](auto const& item) { return !item.second.printed || !item.second.smooth; });
  if (pairs.empty()) return;
  document.heading(3, "Step control where the loop slides");
  Table table{.name = "dead-zone-step-control",
              .caption = "Adaptive runs on the printed actuators and on smooth ones.",
              .columns = {{"integrator"},
                          {"rtol", true},
                          {"printed: status"},
                          {"steps", true},
                          {"rejected", true},
                          {"evaluations", true},
                          {"events located", true},
                          {"smooth: status"},
                          {"steps", true},
                          {"rejected", true},
                          {"evaluations", true},
                          {"steps, printed over smooth", true}}};
  std::size_t ended = 0;
  double least = INFINITY, most = 0;
  std::vector<std::string> reasons;
  for (auto const& [key, pair] : pairs) {
    auto const& [printed, smooth] = pair;
    std::vector<Entry> row{std::get<0>(key), number(std::get<2>(key))};
    for (Record const* run : {printed, smooth}) {
      row.insert(row.end(),
                 {std::string(name_of(run->status)), count(run->steps), count(run->rejected), count(run->evaluations)});
      if (run == printed) row.push_back(events_of({run}));
    }
    bool const both = is_ok(*printed) && is_ok(*smooth) && printed->steps && smooth->steps && *smooth->steps > 0;
    double const ratio = both ? double(*printed->steps) / double(*smooth->steps) : NAN;
    row.push_back(number(ratio));
    table.rows.push_back(std::move(row));
    if (!is_ok(*printed)) {
      reasons.push_back(fmt::format("{} at {}: {}", method_of(printed->of), control_of(printed->of),
                                    printed->reason.empty() ? name_of(printed->status) : printed->reason));
      continue;
    }
    ++ended;
    if (both) {
      least = std::min(least, ratio);
      most = std::max(most, ratio);
    }
  }
  document.say(fmt::format(
      "On the printed actuators the closed loop chatters in the gaps (it slides, in the sense of Filippov), however "
      "short the steps: {} of {} adaptive runs reach the end there{}. A run that does not get on ends with a status.",
      ended, pairs.size(),
      most > 0 ? fmt::format(", with {:.1f} to {:.1f} times the steps of the smooth problem", least, most) : ""));
  document.add(std::move(table));
  if (!reasons.empty()) document.say(fmt::format("Not at the end: {}.", fmt::join(reasons, "; ")));
}

void add_kinks(Document& document, Facts const& facts) {
  auto const sweeps = twins(facts, dead_zone().problem);
  if (sweeps.empty()) return;
  document.heading(3, "Kinks, located and not");
  add_located(document, facts, "dead-zone-kinks", "kink", "kinks", sweeps);
  std::string const with = orders_in_words(part_of(sweeps, true)), without = orders_in_words(part_of(sweeps, false));
  if (with.empty() && without.empty()) {
    double bar = 0;
    for (Sweep const& sweep : sweeps) bar = std::max(bar, finite(sweep.runs.front()->reference_bar).value_or(0));
    document.say(
        fmt::format("No order can be measured: too few errors are above ten times the reference's bar, {} rad.",
                    significant(bar, 2)));
    return;
  }
  document.say(fmt::format("Measured orders: with the kinks located {}; not located {}.", with.empty() ? "none" : with,
                           without.empty() ? "none" : without));
}

}  // namespace

void add_dead_zone(Document& document, Facts const& facts) {
  if (!has_runs(facts, dead_zone().problem)) return;
  add_paper_head(document, facts, dead_zone());
  auto const runs = shown_runs(facts);
  document.heading(3, "Claims and verdicts");
  add_bounds(document, runs);
  add_jumps(document, facts, runs);
  add_histories(document, facts, runs);
  add_step_control(document, facts);
  add_kinks(document, facts);
}

}  // namespace polhode::report
