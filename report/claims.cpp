#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// What the paper states, and how a claim's value is read. Claims not listed are shown as they are recorded.
struct Words {
  std::string_view of, name, statement, unit;
  double factor;  ///< from the record's unit
};

constexpr std::string_view at_target = "points at the target by 50 s (below 1 deg)";

std::vector<Words> const& vocabulary() {
  static double const degree = degrees(1);
  static std::vector<Words> const words{
      {"case1", "alpha_max", "the angle grows slightly at first", "deg", degree},
      {"case1", "alpha_maxima", "then falls: one maximum at most", "", 1},
      {"case1", "alpha_end", at_target, "deg", degree},
      {"case1", "energy_c", "thruster effort E1", "N^2 m^2 s", 1},
      {"case2", "alpha_max", "greatest angle", "deg", degree},
      {"case2", "alpha_maxima", "the angle falls in waves: two maxima or more", "", 1},
      {"case2", "alpha_end", at_target, "deg", degree},
      {"case2", "energy_c", "thruster effort E2", "N^2 m^2 s", 1},
      {"case3", "alpha_max", "the angle rises to", "deg", degree},
      {"case3", "alpha_maxima", "then falls: one maximum at most", "", 1},
      {"case3", "omega_y_zero", "omega_y is zero near", "s", 1},
      {"case3", "alpha_end", at_target, "deg", degree},
      {"case3", "energy_c", "thruster effort E3", "N^2 m^2 s", 1},
  };
  return words;
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

/// The entry of one claim under one gain set and sign: "18.407: no".
Entry cell_of(Record const* run, std::string_view name, double factor) {
  if (!run) return absent;
  auto const found = run->claims.find(std::string(name));
  if (found == run->claims.end()) return absent;
  auto const& verdict = found->second.verdict;
  std::string const mark = verdict == "reproduced" ? ": yes" : verdict == "not reproduced" ? ": no" : "";
  auto const value = finite(found->second.value);
  if (!value) return mark.empty() ? Entry(absent) : Entry("never" + mark);
  return {significant(*value * factor, 4) + mark, exact(*value * factor) + mark};
}

/// The published number, from whatever run has it.
Entry published_of(std::vector<CaseRuns> const& sets, Words const& words) {
  for (CaseRuns const& cases : sets) {
    auto const run = cases.of.find(std::string(words.of));
    if (run == cases.of.end()) continue;
    auto const claim = run->second->claims.find(std::string(words.name));
    if (claim != run->second->claims.end() && finite(claim->second.published)) {
      return number(*claim->second.published * words.factor, 4);
    }
  }
  return absent;
}

/// The rows: what is known of the paper, then whatever else the records claim.
std::vector<Words> rows_of(std::vector<CaseRuns> const& sets) {
  std::vector<Words> rows;
  auto const claimed = [&](std::string_view of, std::string_view name) {
    return std::ranges::any_of(sets, [&](CaseRuns const& cases) {
      auto const run = cases.of.find(std::string(of));
      return run != cases.of.end() && run->second->claims.contains(std::string(name));
    });
  };
  for (Words const& words : vocabulary()) {
    if (claimed(words.of, words.name)) rows.push_back(words);
  }
  for (CaseRuns const& cases : sets) {
    for (auto const& [of, run] : cases.of) {
      for (auto const& [name, claim] : run->claims) {
        auto const same = [&](Words const& words) { return words.of == of && words.name == name; };
        if (std::ranges::none_of(rows, same)) rows.push_back({of, name, "", "", 1});
      }
    }
  }
  std::ranges::stable_sort(rows, {}, &Words::of);
  return rows;
}

void add_matrix(Document& document, Facts const& facts, std::vector<CaseRuns> const& sets) {
  Table table{.name = "claims",
              .caption =
                  "What the paper says of its three strategies, and what we measure under each gain set and "
                  "sign: the value, then \"yes\" if it bears the statement out and \"no\" if it does not. A "
                  "value without either is not printed in the paper.",
              .columns = {{"case"}, {"claim"}, {"the paper"}, {"published", true}, {"unit"}},
              .rows = {}};
  for (CaseRuns const& cases : sets) table.columns.push_back({cases.title, true});
  for (Words const& words : rows_of(sets)) {
    std::vector<Entry> row{std::string(words.of.substr(0, 4) == "case" ? words.of.substr(4) : words.of),
                           std::string(words.name), std::string(words.statement), published_of(sets, words),
                           std::string(words.unit)};
    for (CaseRuns const& cases : sets) {
      auto const found = cases.of.find(std::string(words.of));
      row.push_back(cell_of(found == cases.of.end() ? nullptr : found->second, words.name, words.factor));
    }
    table.rows.push_back(std::move(row));
  }
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
  document.heading(2, "6. Claims and verdicts");
  auto const sets = case_runs(facts);
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
