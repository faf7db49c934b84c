#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// Orders are fitted up to this step [s]: above, where the events cut the steps is chance.
constexpr double most_step = 0.025;

/// A protocol under one preparation of the data.
struct Shown {
  std::string label;
  Style style;
  Record const* run;
};

std::string_view number_of(std::string_view protocol) {
  return protocol == "protocol7" ? "(7)" : "(13)";
}

/// The runs with a history, of the wanted preparations: colour by protocol, dash by preparation.
std::vector<Shown> shown_runs(Facts const& facts, std::vector<std::string_view> const& wanted) {
  constexpr Dash dashes[] = {Dash::solid, Dash::dashed, Dash::dotted};
  std::vector<Shown> list;
  for (CaseRuns const& cases : published_runs(facts, quaternion_sync())) {
    auto const at = std::ranges::find(wanted, cases.title);
    if (at == wanted.end()) continue;
    for (auto const protocol : quaternion_sync().cases) {
      Record const* run = cases.find(protocol);
      if (!run || !facts.series_of(*run, "history")) continue;
      Style const style{.index = protocol == "protocol7" ? 3 : 12,
                        .dash = dashes[(at - wanted.begin()) % std::ssize(dashes)],
                        .points = false};
      list.push_back({fmt::format("{} {}", number_of(protocol), cases.title), style, run});
    }
  }
  return list;
}

Panel panel_of(Facts const& facts, std::vector<Shown> const& shown, std::string_view column, std::string label,
               bool log) {
  Panel panel{.x = {"t [s]"}, .y = {std::move(label), log, log ? 1e-6 : 0}};
  for (Shown const& s : shown) add_curve(panel, against_time(facts, *s.run, column, s.label, s.style));
  return panel;
}

void add_histories(Document& document, Facts const& facts) {
  auto const shown = shown_runs(facts, {"normalized", "raw"});
  add_figure(document, {.name = "sync-history",
                        .caption = "The network under both protocols, from normalised data and from the printed ones "
                                   "(raw): largest distance of two quaternions, spread of the scalar parts, least "
                                   "scalar part, V.",
                        .panels = {panel_of(facts, shown, "disagreement", "largest |q_i - q_j|", true),
                                   panel_of(facts, shown, "scalar_spread", "spread of scalar parts", true),
                                   panel_of(facts, shown, "scalar_min", "least scalar part", false),
                                   panel_of(facts, shown, "lyapunov", "V", false)},
                        .columns = 2});
  auto const trapped = shown_runs(facts, {"normalized trap"});
  add_figure(document, {.name = "sync-trap",
                        .caption = "From the trap: (7) stays, (13) gets out.",
                        .panels = {panel_of(facts, trapped, "disagreement", "largest |q_i - q_j|", false)}});
}

/// The data are not of length one, and so the scalar parts cannot agree.
void say_norms(Document& document, Facts const& facts) {
  std::vector<std::string> raw, normalised;
  for (CaseRuns const& cases : published_runs(facts, quaternion_sync())) {
    if (cases.title != "raw" && cases.title != "normalized") continue;
    for (auto const protocol : quaternion_sync().cases) {
      Record const* run = cases.find(protocol);
      auto const spread = run ? claimed(*run, "scalar_consensus") : std::nullopt;
      if (!spread) continue;
      (cases.title == "raw" ? raw : normalised)
          .push_back(fmt::format("{} under {}", significant(*spread, 4), number_of(protocol)));
    }
  }
  if (raw.empty()) return;
  document.say(
      fmt::format("A rate turns a quaternion and cannot change its norm. The printed quaternions have different norms: "
                  "at 20 s their vector parts have met, and their scalar parts differ by {}, for ever{}. The scalar "
                  "consensus of figures 1 and 2 "
                  "does not follow from the printed data.",
                  listed(raw), normalised.empty() ? "" : fmt::format("; normalised, by {}", listed(normalised))));
}

void say_trap(Document& document, Facts const& facts) {
  for (CaseRuns const& cases : published_runs(facts, quaternion_sync())) {
    if (cases.title != "normalized trap") continue;
    Record const *seven = cases.find("protocol7"), *thirteen = cases.find("protocol13");
    if (!seven || !thirteen) continue;
    auto const apart = last_of(facts, *seven, "disagreement"), together = last_of(facts, *thirteen, "disagreement");
    if (!apart || !together) continue;
    // |p - q|^2 = 2 - 2 p.q, and the angle between the attitudes is 2 acos |p.q|
    double const product = std::min(1.0, std::fabs(1 - *apart * *apart / 2));
    document.say(fmt::format(
        "From the trap (7) ends with quaternions {} apart, attitudes that differ by {} deg: an equilibrium, though an "
        "unstable one. (13) ends {} apart{}.",
        significant(*apart, 6), significant(degrees(2 * std::acos(product)), 4), significant(*together),
        thirteen->events_located.value_or(0) > 0
            ? fmt::format(" after {}", counted(std::size_t(*thirteen->events_located), "located change of sign",
                                               "located changes of sign"))
            : ""));
  }
  document.say(
      "The price of (13): q and -q are one attitude, but turning one craft's quaternion to its negative turns its "
      "commanded rate around. The protocol is no function of the attitudes, and jumps where a scalar part reaches 0.");
}

/// "At h = 0.003 s the largest error is 7e-13 rad with events located and 4e-4 rad without.": at the finest step.
std::string finest_in_words(std::vector<Sweep> const& located, std::vector<Sweep> const& not_located) {
  auto const at_step = [](std::vector<Sweep> const& sweeps, double h) {
    double most = 0;
    for (Sweep const& sweep : sweeps) {
      for (Record const* run : sweep.runs) {
        if (is_ok(*run) && run->of.h == h) most = std::max(most, finite(run->attitude_error_end).value_or(0));
      }
    }
    return most;
  };
  double finest = INFINITY;
  for (Sweep const& sweep : not_located) finest = std::min(finest, *sweep.runs.back()->of.h);
  double const with = at_step(located, finest), without = at_step(not_located, finest);
  if (with == 0 || without == 0) return "";
  return fmt::format("At h = {} s the largest error is {} rad with events located and {} rad without.",
                     significant(finest, 4), significant(with, 2), significant(without, 2));
}

void add_order(Document& document, Facts const& facts) {
  auto const of = [&](std::string_view protocol, bool located) {
    return fixed_sweeps(facts, [=](Cell const& c) {
      return c.problem == "quaternion_sync" && c.formulation == "quaternion" && c.set.empty() && c.policy == "none" &&
             has_word(c.variant, protocol) && has_word(c.variant, "normalized") && !has_word(c.variant, "trap") &&
             has_word(c.variant, "unlocated") != located;
    });
  };
  auto const smooth = of("protocol7", true), located = of("protocol13", true), not_located = of("protocol13", false);
  if (located.empty() || not_located.empty()) return;
  document.heading(3, "Order with and without location of events");
  Figure figure{.name = "sync-order",
                .caption =
                    "Attitude error at 20 s against the step: (7), which is smooth; (13) with steps that end "
                    "where a scalar part reaches 0; (13) with steps across. Open symbols: rivals. The shade is "
                    "where rounding rules.",
                .panels = {error_panel(facts, "(7)", smooth), error_panel(facts, "(13), events located", located),
                           error_panel(facts, "(13), not located", not_located)},
                .columns = 2,
                .same_y = true};
  add_figure(document, std::move(figure));
  std::vector<Sweep> all = smooth;
  all.insert(all.end(), located.begin(), located.end());
  all.insert(all.end(), not_located.begin(), not_located.end());
  document.add(
      error_table("sync-order",
                  fmt::format("Attitude error at the end [rad] by step, and the order fitted at steps up to {} "
                              "s, where the error is neither round-off nor the reference's; ~ marks a slope "
                              "through two points. \"Events located\" is the count of a run; {} means that the "
                              "problem has none.",
                              significant(most_step), absent),
                  all, most_step));
  auto const own = [](std::vector<Sweep> sweeps) {
    std::erase_if(sweeps, [](Sweep const& sweep) { return is_rival(sweep.like().integrator); });
    return sweeps;
  };
  std::string const with = orders_in_words(own(located), most_step),
                    without = orders_in_words(own(not_located), most_step);
  document.say(fmt::format("Measured orders on (13): with events located {}; not located {}. {}",
                           with.empty() ? "none" : with,
                           without.empty() ? "none, the errors do not lie on a line" : without,
                           finest_in_words(own(located), own(not_located))));
}

void add_networks(Document& document, Facts const& facts) {
  Table table{.name = "sync-networks",
              .caption =
                  "Large networks: seeded strongly connected digraphs, no reference. An evaluation is one of the "
                  "whole network.",
              .columns = {{"craft", true},
                          {"formulation"},
                          {"integrator"},
                          {"control"},
                          {"status"},
                          {"steps", true},
                          {"evaluations", true},
                          {"per step", true},
                          {"norm drift", true},
                          {"allocations per step", true},
                          {"events located", true},
                          {"CPU time", true}}};
  std::vector<Record const*> runs;
  for (Record const* run : facts.runs) {
    auto const n = run->of.set.find("n");
    bool const is_network = run->of.problem == "quaternion_sync" && n != run->of.set.end() && n->second.size() == 1;
    if (is_network && run->status != results::Status::refused) runs.push_back(run);
  }
  std::ranges::stable_sort(runs, {}, [](Record const* run) {
    return std::tuple(run->of.set.at("n").front(), run->of.formulation, run->of.integrator);
  });
  for (Record const* run : runs) {
    bool const both = run->steps && run->evaluations && *run->steps > 0;
    table.rows.push_back(
        {exact(run->of.set.at("n").front()), run->of.formulation, run->of.integrator, control_of(run->of),
         std::string(name_of(run->status)), count(run->steps), count(run->evaluations),
         both ? number(double(*run->evaluations) / double(*run->steps)) : Entry(absent), number(run->norm_drift_max, 2),
         number(run->allocations_per_step), events_of({run}), cpu_time(run->cpu_time_s)});
  }
  if (table.rows.empty()) return;
  document.heading(3, "Large networks");
  document.add(std::move(table));
}

}  // namespace

void add_sync(Document& document, Facts const& facts) {
  if (!has_runs(facts, quaternion_sync().problem)) return;
  add_paper_head(document, facts, quaternion_sync());
  add_paper_claims(document, facts, quaternion_sync());
  document.heading(3, "Histories and findings");
  say_norms(document, facts);
  say_trap(document, facts);
  add_histories(document, facts);
  add_order(document, facts);
  add_networks(document, facts);
}

}  // namespace polhode::report
