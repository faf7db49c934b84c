#include <fmt/format.h>

#include <algorithm>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// The published number, from whatever run has it.
Entry published_of(std::vector<CaseRuns> const& sets, Statement const& s) {
  for (CaseRuns const& cases : sets) {
    Record const* run = cases.find(s.of);
    if (!run) continue;
    auto const claim = run->claims.find(std::string(s.name));
    if (claim != run->claims.end() && finite(claim->second.published)) {
      return number(*claim->second.published * s.factor, 4);
    }
  }
  return absent;
}

/// The rows: what is known of the paper, case by case, then whatever else the records claim.
std::vector<Statement> rows_of(Paper const& paper, std::vector<CaseRuns> const& sets) {
  std::vector<Statement> rows;
  for (auto const of : paper.cases) {
    auto const is_claimed = [&](std::string_view name) {
      return std::ranges::any_of(sets, [&](CaseRuns const& cases) {
        Record const* run = cases.find(of);
        return run && run->claims.contains(std::string(name));
      });
    };
    auto const has_row = [&](std::string_view name) {
      return std::ranges::any_of(paper.statements, [&](Statement const& s) {
        return s.name == name && (s.of.empty() || s.of == of || s.once);
      });
    };
    for (Statement s : paper.statements) {
      if ((!s.of.empty() && s.of != of) || !is_claimed(s.name)) continue;
      s.of = of;
      rows.push_back(s);
    }
    std::vector<Statement> others;
    for (CaseRuns const& cases : sets) {
      Record const* run = cases.find(of);
      if (!run) continue;
      for (auto const& [name, claim] : run->claims) {
        auto const same = [&](Statement const& s) { return s.name == name; };
        if (!has_row(name) && std::ranges::none_of(others, same)) others.push_back({of, name, "", "", 1});
      }
    }
    rows.insert(rows.end(), others.begin(), others.end());
  }
  return rows;
}

Table provenance_table(Paper const& paper) {
  Table table{.name = fmt::format("{}-data", paper.problem),
              .caption =
                  "Where the problem's data come from: printed in the paper; deduced from what is; or chosen here, "
                  "because nothing printed decides.",
              .columns = {{"data"}, {"value"}, {"source"}, {"note"}}};
  for (Datum const& d : paper.data) {
    table.rows.push_back(
        {std::string(d.what), std::string(d.value), std::string(name_of(d.source)), std::string(d.how)});
  }
  return table;
}

Table errata_table(Paper const& paper) {
  Table table{.name = fmt::format("{}-errata", paper.problem),
              .caption = "Errata.",
              .columns = {{"where"}, {"in print"}, {"should be"}}};
  for (Erratum const& e : paper.errata) {
    table.rows.push_back({std::string(e.where), std::string(e.printed), std::string(e.correct)});
  }
  return table;
}

/// What ran: "gauss4 (quaternion), h = 0.02 s", or each case's own.
std::string sources_of(std::vector<CaseRuns> const& sets) {
  std::vector<std::string> words;
  for (CaseRuns const& cases : sets) {
    for (auto const& [of, run] : cases.of) {
      std::string const word = fmt::format("{}, {}", method_of(run->of), control_of(run->of));
      if (std::ranges::find(words, word) == words.end()) words.push_back(word);
    }
  }
  return listed(words);
}

}  // namespace

Entry verdict_of(Record const* run, std::string_view name, double factor) {
  if (!run) return absent;
  auto const found = run->claims.find(std::string(name));
  if (found == run->claims.end()) return absent;
  auto const& verdict = found->second.verdict;
  std::string const mark = verdict == "reproduced" ? ": yes" : verdict == "not reproduced" ? ": no" : "";
  auto const value = finite(found->second.value);
  if (!value) return mark.empty() ? Entry(absent) : Entry("never" + mark);
  return {significant(*value * factor, 4) + mark, exact(*value * factor) + mark};
}

Table claim_table(Paper const& paper, std::vector<CaseRuns> const& sets, std::string name, std::string caption) {
  Table table{.name = std::move(name),
              .caption = Text(std::move(caption)),
              .columns = {{"case"}, {"claim"}, {"the paper"}, {"published", true}, {"unit"}}};
  for (CaseRuns const& cases : sets) table.columns.push_back({cases.title, true});
  for (Statement const& s : rows_of(paper, sets)) {
    std::vector<Entry> row{std::string(s.of.starts_with("case") ? s.of.substr(4) : s.of), std::string(s.name),
                           std::string(s.words), published_of(sets, s), std::string(s.unit)};
    for (CaseRuns const& cases : sets) row.push_back(verdict_of(cases.find(s.of), s.name, s.factor));
    table.rows.push_back(std::move(row));
  }
  return table;
}

void add_paper_head(Document& document, Facts const& facts, Paper const& paper) {
  document.section(std::string(paper.title));
  document.say(Text({{std::string(paper.about) + " Problem "}, {std::string(paper.problem), true}, {"."}}));
  document.say(fmt::format("{}.", paper.citation));
  if (!has_runs(facts, paper.problem)) return;
  if (!paper.data.empty()) document.add(provenance_table(paper));
  if (!paper.errata.empty()) document.add(errata_table(paper));
}

void add_paper_claims(Document& document, Facts const& facts, Paper const& paper) {
  auto const sets = published_runs(facts, paper);
  document.heading(3, "Claims and verdicts");
  Table table = claim_table(
      paper, sets, fmt::format("{}-claims", paper.problem),
      fmt::format(
          "What the paper states, and what we measure: the value, then \"yes\" if it bears the statement out, or "
          "is our own number where the paper prints none, and \"no\" if not. Runs: {}.",
          sources_of(sets)));
  if (table.rows.empty()) {
    document.say("No successful run here was held against a claim of the paper.");
  } else {
    document.add(std::move(table));
  }
}

}  // namespace polhode::report
