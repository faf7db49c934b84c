#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Claim;
using results::Record;

constexpr std::string_view reproduced = "reproduced";

/// Claims whose unit and meaning are known here; every other is shown as it is recorded.
struct Words {
  std::string_view name, meaning, unit;
  double factor;  ///< from the record's unit
};

Words words_of(std::string_view name) {
  double const degree = degrees(1);
  Words const known[] = {
      {"alpha_max", "greatest angle", "deg", degree},
      {"alpha_end", "angle at the end: at the target", "deg", degree},
      {"alpha_maxima", "maxima of the angle: one rise, or waves", "", 1},
      {"omega_y_zero", "omega_y first reaches zero", "s", 1},
      {"energy_c", "thruster effort", "N^2 m^2 s", 1},
  };
  auto const found = std::ranges::find(known, name, &Words::name);
  return found == std::end(known) ? Words{name, "", "", 1} : *found;
}

/// The most accurate successful run that was held against claims.
Record const* representative(Instance const& instance) {
  Record const* best = nullptr;
  auto const error = [](Record const* run) { return finite(run->attitude_error_max).value_or(INFINITY); };
  for (Record const* run : instance.runs) {
    if (is_ok(*run) && !run->claims.empty() && (!best || error(run) < error(best))) best = run;
  }
  return best;
}

Table claims_table(Instance const& instance, Record const& shown, std::size_t n) {
  Table table{.name = fmt::format("claims-{}", n),
              .caption = fmt::format("{}: measured with {}, {}, the most accurate run. The last column counts the "
                                     "successful runs that come to the same verdict.",
                                     instance.label, method_of(shown.of), control_of(shown.of)),
              .columns = {{"claim"},
                          {"meaning"},
                          {"unit"},
                          {"measured", true},
                          {"published", true},
                          {"verdict"},
                          {"runs that agree", true}},
              .rows = {}};
  for (auto const& [name, claim] : shown.claims) {
    std::size_t all = 0, same = 0;
    for (Record const* run : instance.runs) {
      auto const other = run->claims.find(name);
      if (!is_ok(*run) || other == run->claims.end()) continue;
      ++all;
      if (other->second.verdict == claim.verdict) ++same;
    }
    Words const words = words_of(name);
    auto const scaled = [&](std::optional<double> value) {
      return value ? number(*value * words.factor, 5) : Entry(absent);
    };
    table.rows.push_back({name, std::string(words.meaning), std::string(words.unit), scaled(claim.value),
                          scaled(claim.published), claim.verdict.empty() ? Entry(absent) : Entry(claim.verdict),
                          fmt::format("{} of {}", same, all)});
  }
  return table;
}

/// Thruster effort of a run: its claim, else the end of its history.
std::optional<double> energy_of(Facts const& facts, Record const& run) {
  auto const claim = run.claims.find("energy_c");
  if (claim != run.claims.end() && finite(claim->second.value)) return claim->second.value;
  results::Series const* series = facts.series_of(run, "history");
  auto const column = series ? column_of(*series, "energy_c") : std::nullopt;
  if (!column || series->rows.empty() || series->rows.back().size() <= *column) return {};
  return finite(series->rows.back()[*column]);
}

/// What the records say about one gain set and sign as a whole.
struct Judgement {
  std::array<std::optional<double>, 3> energy;
  std::optional<bool> ordered;      ///< E2 < E1 < E3
  std::vector<std::string> missed;  ///< claims that are not reproduced
  bool complete = true;             ///< all three cases were held against claims
};

Judgement judge(Facts const& facts, CaseRuns const& cases) {
  Judgement j;
  for (std::size_t i = 0; i < 3; ++i) {
    std::string const name(control_cases[i]);
    auto const found = cases.of.find(name);
    if (found == cases.of.end() || found->second->claims.empty()) j.complete = false;
    if (found == cases.of.end()) continue;
    j.energy[i] = energy_of(facts, *found->second);
    for (auto const& [claim, result] : found->second->claims) {
      if (result.verdict == "not reproduced") j.missed.push_back(fmt::format("{} {}", name, claim));
    }
  }
  if (j.energy[0] && j.energy[1] && j.energy[2]) j.ordered = *j.energy[1] < *j.energy[0] && *j.energy[0] < *j.energy[2];
  if (j.ordered == false) j.missed.emplace_back("E2 < E1 < E3");
  if (!j.ordered) j.complete = false;
  return j;
}

void add_across_cases(Document& document, Facts const& facts) {
  Table table{.name = "claims-across-cases",
              .caption =
                  "Claims that concern all three cases of a gain set and sign: thruster effort E2 < E1 < E3, and "
                  "whether everything published is reproduced at once.",
              .columns = {{"gain set, sign, parameters"},
                          {"E2 (case 2)", true},
                          {"E1 (case 1)", true},
                          {"E3 (case 3)", true},
                          {"E2 < E1 < E3"},
                          {"not reproduced"},
                          {"every claim"}},
              .rows = {}};
  std::vector<std::string> satisfied, failed, open;
  for (CaseRuns const& cases : case_runs(facts)) {
    Judgement const j = judge(facts, cases);
    std::string verdict = "no";
    if (!j.missed.empty()) {
      failed.push_back(fmt::format("{} misses {}", cases.label, listed(j.missed)));
    } else if (!j.complete) {
      verdict = "cannot be judged";
      open.push_back(cases.label);
    } else {
      verdict = "yes";
      satisfied.push_back(cases.label);
    }
    table.rows.push_back({cases.label, number(j.energy[1], 5), number(j.energy[0], 5), number(j.energy[2], 5),
                          !j.ordered   ? absent
                          : *j.ordered ? "yes"
                                       : "no",
                          j.missed.empty() ? Entry("nothing") : Entry(listed(j.missed)), verdict});
  }
  if (table.rows.empty()) {
    document.say(
        "The records hold no successful run of tether_capture's case1, case2 or case3: nothing can be said about "
        "energy E2 < E1 < E3, nor whether any gain set satisfies every published claim.");
    return;
  }
  document.heading(3, "All three cases together");
  document.add(std::move(table));
  if (!satisfied.empty()) {
    document.say(fmt::format("Every published claim is satisfied by {}.", listed(satisfied)));
  } else if (!failed.empty()) {
    document.say(fmt::format("No gain set and sign in these records satisfies every published claim: {}.",
                             fmt::join(failed, "; ")));
  }
  if (!open.empty()) {
    document.say(
        fmt::format("Not all three cases, with claims and energies, are there for {}: whether everything published "
                    "is satisfied cannot be judged.",
                    listed(open)));
  }
}

}  // namespace

void add_claims(Document& document, Facts const& facts) {
  document.heading(2, "5. Claims and verdicts");
  document.say("What papers state, held against our runs. A claim without a published number is a statement.");
  std::size_t n = 0;
  for (Instance const& instance : facts.instances) {
    Record const* shown = representative(instance);
    if (!shown) continue;
    document.heading(3, instance.label);
    document.add(claims_table(instance, *shown, ++n));
  }
  if (n == 0) document.say("No successful run here was held against a published claim.");
  add_across_cases(document, facts);
}

}  // namespace polhode::report
