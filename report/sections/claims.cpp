#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// Thruster effort of a run: its claim, else the end of its history.
std::optional<double> energy_of(Facts const& facts, Record const& run) {
  auto const claim = claimed(run, "energy_c");
  return claim ? claim : last_of(facts, run, "energy_c");
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
    std::string_view const name = tether_capture().cases[i];
    Record const* run = cases.find(name);
    if (!run || run->claims.empty()) j.complete = false;
    if (!run) continue;
    j.energy[i] = energy_of(facts, *run);
    for (auto const& [claim, result] : run->claims) {
      if (result.verdict == "not reproduced") j.missed.push_back(fmt::format("{} {}", name, claim));
    }
  }
  if (j.energy[0] && j.energy[1] && j.energy[2]) j.ordered = *j.energy[1] < *j.energy[0] && *j.energy[0] < *j.energy[2];
  if (j.ordered == false) j.missed.emplace_back("E2 < E1 < E3");
  if (!j.ordered) j.complete = false;
  return j;
}

void add_matrix(Document& document, Facts const& facts, std::vector<CaseRuns> const& sets) {
  Table table = claim_table(tether_capture(), sets, "claims",
                            "What the paper says of its three strategies, and what we measure under each gain set and "
                            "sign: the value, then \"yes\" if it bears the statement out and \"no\" if it does not. A "
                            "value without either is not printed in the paper.");
  std::vector<Entry> order{"all", "E2 < E1 < E3", "order of the thruster efforts", absent, ""};
  std::vector<Entry> whole{"all", "every claim", "", absent, ""};
  for (CaseRuns const& cases : sets) {
    Judgement const j = judge(facts, cases);
    order.emplace_back(!j.ordered
                           ? std::string(absent)
                           : fmt::format("{}, {}, {}: {}", significant(*j.energy[1], 4), significant(*j.energy[0], 4),
                                         significant(*j.energy[2], 4), *j.ordered ? "yes" : "no"));
    whole.emplace_back(!j.missed.empty() ? "no" : j.complete ? "yes" : "cannot be judged");
  }
  table.rows.push_back(std::move(order));
  table.rows.push_back(std::move(whole));
  document.add(std::move(table));
}

/// Whether anything satisfies everything.
void add_conclusion(Document& document, Facts const& facts, std::vector<CaseRuns> const& sets) {
  std::vector<std::string> satisfied, failed, open;
  bool stuck = false;
  for (CaseRuns const& cases : sets) {
    Judgement const j = judge(facts, cases);
    if (!j.missed.empty()) {
      failed.push_back(fmt::format("{} misses {}", cases.title, listed(j.missed)));
      stuck = stuck || (cases.title == "g1" && std::ranges::find(j.missed, "case2 alpha_end") != j.missed.end());
    } else {
      (j.complete ? satisfied : open).push_back(cases.title);
    }
  }
  if (!satisfied.empty()) {
    document.say(fmt::format("Every published claim is satisfied by {}.", listed(satisfied)));
  } else if (!failed.empty()) {
    document.say(fmt::format(
        "No gain set and sign in these records satisfies every published claim: {}.{}", fmt::join(failed, "; "),
        stuck ? " While the tether alone acts, the angular momentum along it is conserved, so case "
                "2 with a strong tether cannot come to rest at the target."
              : ""));
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
  document.section("Claims and verdicts");
  auto const sets = case_runs(facts, tether_capture());
  if (sets.empty()) {
    document.say(
        "The records hold no successful run of tether_capture's case1, case2 or case3: nothing can be said about "
        "energy E2 < E1 < E3, nor whether any gain set satisfies every published claim.");
    return;
  }
  document.say(
      "The paper prints no gains: g1 (strong tether, nominal) and g2 (weak tether) were reconstructed by a search for "
      "gains that reproduce its figures. It prints the gyroscopic term with a plus, which as_printed follows; the "
      "others have Euler's minus.");
  bool const any = std::ranges::any_of(sets, [](CaseRuns const& cases) {
    return std::ranges::any_of(cases.of, [](auto const& item) { return !item.second->claims.empty(); });
  });
  if (!any) document.say("No successful run here was held against a published claim.");
  add_matrix(document, facts, sets);
  add_conclusion(document, facts, sets);
}

}  // namespace polhode::report
