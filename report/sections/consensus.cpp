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

/// The runs as published and those with the shadow point, by start.
struct Runs {
  CaseRuns plain, shadow;
};

Runs runs_of(Facts const& facts) {
  Runs runs;
  for (CaseRuns& cases : published_runs(facts, group_consensus())) {
    if (cases.title == "as published")
      runs.plain = std::move(cases);
    else if (cases.title == "shadow")
      runs.shadow = std::move(cases);
  }
  return runs;
}

void add_rates(Document& document, Facts const& facts, Runs const& runs) {
  constexpr std::array axes{"x", "y", "z"};
  constexpr std::array colours{3, 12, 2};
  Figure figure{.name = "consensus-rates",
                .caption = "Mean body rate of each group against time: bodies 1 to 3 solid, bodies 4 and 5 dashed.",
                .columns = 2};
  for (auto const start : group_consensus().cases) {
    Record const* run = runs.plain.find(start);
    if (!run) continue;
    Panel panel{.x = {"t [s]"}, .y = {"mean rate [rad/s]"}, .title = std::string(start)};
    for (int group = 1; group <= 2; ++group) {
      for (std::size_t k = 0; k < axes.size(); ++k) {
        add_curve(panel,
                  against_time(
                      facts, *run, fmt::format("g{}_{}", group, axes[k]), fmt::format("group {}, {}", group, axes[k]),
                      {.index = colours[k], .dash = group == 1 ? Dash::solid : Dash::dashed, .points = false}));
      }
    }
    figure.panels.push_back(std::move(panel));
  }
  add_figure(document, std::move(figure));
}

void add_decay(Document& document, Facts const& facts, Runs const& runs) {
  Figure figure{.name = "consensus-decay",
                .caption =
                    "Largest difference of rates within a group, and V, against time: as published, and with "
                    "the shadow point of sigma wherever a body has turned through 180 deg.",
                .columns = 2};
  for (auto const start : group_consensus().cases) {
    for (auto const& [column, label] :
         {std::pair("spread", "spread of rates [rad/s]"), std::pair("lyapunov", "V [J]")}) {
      Panel panel{.x = {"t [s]"}, .y = {label, true, 1e-6}, .title = std::string(start)};
      if (Record const* run = runs.plain.find(start))
        add_curve(panel, against_time(facts, *run, column, "as published", {.index = 3, .points = false}));
      if (Record const* run = runs.shadow.find(start))
        add_curve(panel,
                  against_time(facts, *run, column, "shadow", {.index = 12, .dash = Dash::dashed, .points = false}));
      figure.panels.push_back(std::move(panel));
    }
  }
  add_figure(document, std::move(figure));
}

void say_spectrum(Document& document, Runs const& runs) {
  for (auto const& [start, run] : runs.plain.of) {
    auto const greatest = run->claims.find("greatest_eigenvalue");
    auto const least = claimed(*run, "least_eigenvalue"), zeros = claimed(*run, "zero_eigenvalues");
    if (greatest == run->claims.end() || !finite(greatest->second.value) || !finite(greatest->second.published))
      continue;
    double const value = *greatest->second.value, bound = *greatest->second.published;
    document.say(fmt::format(
        "Theorem 1 bounds the Laplacian's eigenvalues by twice the largest in-degree, {}. The paper's own matrix has "
        "{}{}.",
        significant(bound), significant(value, 5), value > bound ? ", and breaks the bound" : ", within the bound"));
    if (least && zeros) {
      document.say(fmt::format("Its least eigenvalue is {} and {} of the five are 0{}.",
                               significant(std::fabs(*least) < 1e-12 ? 0 : *least), significant(*zeros),
                               *zeros == 2 ? ", one for each group" : ""));
    }
    return;
  }
}

void say_shadow(Document& document, Runs const& runs) {
  std::vector<std::string> words;
  for (auto const start : group_consensus().cases) {
    Record const *plain = runs.plain.find(start), *shadow = runs.shadow.find(start);
    auto const rise = shadow ? claimed(*shadow, "lyapunov_rise") : std::nullopt;
    auto const level = plain ? claimed(*plain, "lyapunov_rise") : std::nullopt;
    if (!rise || !level) continue;
    words.push_back(fmt::format("{} J in {} ({} J without, {} events located)", significant(*rise), start,
                                significant(*level, 2), events_of({shadow}).text));
  }
  if (words.empty()) return;
  document.say(
      fmt::format("The law is a function of sigma, not of the attitude: with the shadow point, which is the same "
                  "attitude, it jumps. V, "
                  "which should never increase, then rises by up to {}.",
                  listed(words)));
}

void add_located(Document& document, Facts const& facts) {
  auto const sweeps = twins(facts, group_consensus().problem);
  if (sweeps.empty()) return;
  document.add(error_table(
      "consensus-shadow",
      fmt::format(
          "The shadow point up to {} s: attitude error at the end [rad] by step, with steps that end where a body "
          "has turned through 180 deg, and with steps across (unlocated). {} in \"events located\": the "
          "formulation has no such event.",
          significant(sweeps.front().like().t_end), absent),
      sweeps));
}

void add_escape(Document& document, Facts const& facts) {
  Table table{
      .name = "consensus-escape",
      .caption =
          "The counterexample to theorem 2: all sigma 0 and all rates equal. \"Escape\" is when |sigma| is "
          "largest.",
      .columns = {
          {"formulation"}, {"integrator"}, {"control"}, {"status"}, {"steps", true}, {"escape [s]", true}, {"reason"}}};
  std::set<std::string> ended, went_on;
  std::optional<double> at;
  for (Record const* run : facts.runs) {
    if (run->of.problem != "group_consensus" || !has_word(run->of.variant, "theorem2")) continue;
    table.rows.push_back({run->of.formulation, run->of.integrator, control_of(run->of),
                          std::string(name_of(run->status)), count(run->steps), verdict_of(run, "escape"),
                          is_ok(*run) ? "" : run->reason});
    (is_ok(*run) ? went_on : ended).insert(run->of.formulation);
    if (auto const escape = claimed(*run, "escape")) at = escape;
  }
  if (table.rows.empty()) return;
  document.heading(3, "Theorem 2 and an escape");
  document.say(fmt::format(
      "Bodies that agree feel no torque: each turns on at its constant rate, and sigma, which is infinite at 360 deg, "
      "escapes{}. The theorem does not exclude this start.{}{}",
      at ? fmt::format(" at {} s", significant(*at, 4)) : "",
      ended.empty() ? ""
                    : fmt::format(" Runs that ended there, with a status instead of a NaN: {}.",
                                  listed({ended.begin(), ended.end()})),
      went_on.empty() ? "" : fmt::format(" Runs that went on: {}.", listed({went_on.begin(), went_on.end()}))));
  document.add(std::move(table));
}

}  // namespace

void add_consensus(Document& document, Facts const& facts) {
  if (!has_runs(facts, group_consensus().problem)) return;
  add_paper_head(document, facts, group_consensus());
  add_paper_claims(document, facts, group_consensus());
  add_tolerance(document, facts);
  document.heading(3, "Histories and findings");
  Runs const runs = runs_of(facts);
  say_spectrum(document, runs);
  add_rates(document, facts, runs);
  say_shadow(document, runs);
  add_decay(document, facts, runs);
  add_located(document, facts);
  add_escape(document, facts);
}

}  // namespace polhode::report
