#include "report/cases.hpp"

#include <fmt/format.h>

#include <tuple>

#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// "tether_capture case1,g1, 50 s" without its case.
std::string label_without(std::string label, std::string_view word) {
  auto const at = label.find(word);
  if (at == std::string::npos) return label;
  std::size_t length = word.size();
  if (label.substr(at + length).starts_with(',')) ++length;
  return label.erase(at, length);
}

/// What stands before the parameters and the horizon: "tether_capture g1".
std::string_view without_parameters(std::string_view label) {
  return label.substr(0, label.find(", "));
}

bool is_better(Facts const& facts, Record const& a, Record const& b) {
  auto const merit = [&](Record const& run) {
    double const error = finite(run.attitude_error_max).value_or(INFINITY);
    return std::tuple(facts.series_of(run, "history") == nullptr, run.claims.empty(), error);
  };
  return merit(a) < merit(b);
}

/// A short name for each entry: what the words say, or the whole label where they say too little.
void name_all(std::vector<CaseRuns>& list) {
  for (CaseRuns& a : list) {
    auto const same = [&](CaseRuns const& b) { return without_parameters(a.label) == without_parameters(b.label); };
    if (a.title.empty() || std::ranges::count_if(list, same) > 1) a.title = a.label;
  }
}

double horizon_of(CaseRuns const& cases) {
  return cases.of.begin()->second->of.t_end;
}

std::vector<CaseRuns> unnamed_runs(Facts const& facts, Paper const& paper) {
  std::map<std::string, CaseRuns> groups;
  for (Instance const& instance : facts.instances) {
    Cell const& c = instance.like();
    auto const said = [&](std::string_view word) { return has_word(c.variant, word); };
    if (c.problem != paper.problem || std::ranges::any_of(paper.apart, said)) continue;
    for (auto const name : paper.cases) {
      if (!said(name)) continue;
      std::string const label = label_without(instance.label, name);
      CaseRuns& group = groups.try_emplace(label, CaseRuns{label, "", {}}).first->second;
      group.title = without_word(c.variant, name);
      for (auto const word : paper.unsaid) group.title = without_word(group.title, word);
      std::ranges::replace(group.title, ',', ' ');
      for (Record const* run : instance.runs) {
        if (!is_ok(*run)) continue;
        auto const [at, is_new] = group.of.try_emplace(std::string(name), run);
        if (!is_new && is_better(facts, *run, *at->second)) at->second = run;
      }
    }
  }
  std::vector<CaseRuns> list;
  for (auto& [label, group] : groups) {
    if (!group.of.empty()) list.push_back(std::move(group));
  }
  // the nominal sign first
  std::ranges::stable_sort(list, {}, [](CaseRuns const& c) { return c.label.find("as_printed") != std::string::npos; });
  return list;
}

}  // namespace

std::vector<CaseRuns> case_runs(Facts const& facts, Paper const& paper) {
  auto list = unnamed_runs(facts, paper);
  name_all(list);
  return list;
}

std::vector<CaseRuns> published_runs(Facts const& facts, Paper const& paper) {
  auto list = unnamed_runs(facts, paper);
  std::erase_if(list, [](CaseRuns const& cases) {
    Cell const& c = cases.of.begin()->second->of;
    return !c.set.empty() || c.seed != 1;
  });
  auto const all = list;
  std::erase_if(list, [&](CaseRuns const& cases) {
    return std::ranges::any_of(all, [&](CaseRuns const& other) {
      return other.title == cases.title && horizon_of(other) > horizon_of(cases);
    });
  });
  for (CaseRuns& cases : list) {
    if (cases.title.empty()) cases.title = "as published";
  }
  return list;
}

bool has_runs(Facts const& facts, std::string_view problem) {
  return std::ranges::any_of(facts.runs, [&](Record const* run) { return run->of.problem == problem; });
}

double parameter(Cell const& cell, std::string const& name, double otherwise) {
  auto const found = cell.set.find(name);
  return found == cell.set.end() || found->second.size() != 1 ? otherwise : found->second.front();
}

std::optional<double> claimed(Record const& run, std::string_view name) {
  auto const claim = run.claims.find(std::string(name));
  return claim == run.claims.end() ? std::nullopt : finite(claim->second.value);
}

std::optional<double> last_of(Facts const& facts, Record const& run, std::string_view column) {
  results::Series const* series = facts.series_of(run, "history");
  auto const at = series ? column_of(*series, column) : std::nullopt;
  if (!at || series->rows.empty() || series->rows.back().size() <= *at) return {};
  return finite(series->rows.back()[*at]);
}

Curve against_time(Facts const& facts, Record const& run, std::string_view column, std::string label,
                   Style const& style, View const& view) {
  results::Series const* series = facts.series_of(run, "history");
  auto const t = series ? column_of(*series, "t") : std::nullopt;
  auto const value = series ? column_of(*series, column) : std::nullopt;
  if (!t || !value) return {std::move(label), style};
  auto const y = [&](std::vector<double> const& row) {
    double const v = view.factor * row[*value];
    bool const inside = view.from <= row[*t] && row[*t] <= view.to;
    return !inside ? NAN : view.magnitude ? std::fabs(v) : v;
  };
  return curve_of(
      std::move(label), style, *series, [&](std::vector<double> const& row) { return row[*t]; }, y);
}

void add_curve(Panel& panel, Curve curve) {
  if (!curve.points.empty()) panel.curves.push_back(std::move(curve));
}

void add_figure(Document& document, Figure figure) {
  std::erase_if(figure.panels, [](Panel const& panel) { return panel.curves.empty(); });
  if (!figure.panels.empty()) document.add(std::move(figure));
}

}  // namespace polhode::report
