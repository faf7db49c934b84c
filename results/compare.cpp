#include "results/compare.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "results/golden.hpp"
#include "results/meta.hpp"
#include "results/run_name.hpp"
#include "results/statistics.hpp"

namespace polhode::results {
namespace {

/// Records by cell, and cells in order.
struct Set {
  Side side;
  std::vector<Record const*> records;
  std::map<std::string, Record const*> by_cell;
};

/// What times depend on. The compiler is no part of it: it may be what is compared.
std::string machine_of(Meta const& meta) {
  std::vector<std::string> parts;
  for (auto const* key : {"cpu_model", "cpu_cache", "cpus_available", "cpu_governor", "virtualised", "kernel"}) {
    std::string const text = entry_of(meta, key);
    if (!text.empty()) parts.push_back(fmt::format("{} {}", key, text));
  }
  return entry_of(meta, "cpu_model").empty() ? "" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string made_of(Meta const& meta) {
  std::vector<std::string> parts;
  auto const note = [&](std::string const& what) {
    if (!what.empty()) parts.push_back(what);
  };
  note(entry_of(meta, "utc"));
  std::string const commit = entry_of(meta, "git_commit");
  if (!commit.empty()) note("commit " + commit + (entry_of(meta, "git_dirty") == "true" ? ", modified" : ""));
  note(entry_of(meta, "compiler"));
  return fmt::format("{}", fmt::join(parts, ", "));
}

Set set_of(Contents const& contents, std::string path) {
  Set set;
  set.side.path = std::move(path);
  if (!contents.metas.empty()) {
    Meta const& newest = contents.metas.back();
    set.side.build = entry_of(newest, "build");
    set.side.made = made_of(newest);
  }
  std::set<std::string> machines;
  for (Meta const& meta : contents.metas) {
    if (entry_of(meta, "build") == set.side.build) machines.insert(machine_of(meta));
  }
  if (machines.size() == 1) set.side.machine = *machines.begin();
  for (Record const& record : contents.records) {
    if (!contents.metas.empty() && record.build != set.side.build) {
      ++set.side.of_other_builds;
      continue;
    }
    set.records.push_back(&record);
    set.by_cell[record.cell] = &record;
  }
  for (std::string const& cell : contents.unfinished) {
    if (!set.by_cell.contains(cell)) set.side.unfinished.push_back(cell);
  }
  set.side.records = set.records.size();
  return set;
}

NamedCell named(Record const& record) {
  return {record.cell, run_name(record.of)};
}

Trend trend_of(bool was_good, bool is_good) {
  return was_good == is_good ? Trend::changed : is_good ? Trend::better : Trend::worse;
}

// --- Deterministic columns -------------------------------------------------------------------------------------------

bool has_results(Status status) {
  return status == Status::ok || status == Status::inaccurate;
}

/// How often somebody else was asked is a matter of the problem: neither better nor worse.
bool is_neutral(std::string const& column) {
  return column == "controller_calls" || column == "projections";
}

/// Below this an error says nothing.
double floor_of(std::string const& column, Record const& a, Record const& b) {
  if (!column.starts_with("attitude_error")) return golden_floor;
  return std::max({golden_floor, a.reference_bar.value_or(0), b.reference_bar.value_or(0)});
}

double log_ratio(double a, double b, double floor) {
  return std::log10(std::max(std::abs(b), floor) / std::max(std::abs(a), floor));
}

void compare_columns(Comparison& to, Record const& a, Record const& b) {
  GoldenLine const before = golden_of(a), now = golden_of(b);
  for (std::string const& column : golden_columns()) {
    ColumnChange change{named(b),           column, is_count(column), before.column(column),
                        now.column(column), {},     Trend::changed};
    if (!change.a && !change.b) continue;
    if (change.a && change.b) {
      double const from = *change.a, to_value = *change.b;
      if (change.count && from == to_value) continue;
      if (!change.count || from != 0) {
        change.change = change.count ? to_value / from - 1 : log_ratio(from, to_value, floor_of(column, a, b));
        double const allowed = change.count ? to.rules.counts : to.rules.digits;
        if (std::abs(*change.change) <= allowed * (1 + 1e-12)) continue;
      }
      if (!is_neutral(column)) change.trend = std::abs(to_value) > std::abs(from) ? Trend::worse : Trend::better;
    }
    to.columns.push_back(std::move(change));
  }
}

void compare_claims(Comparison& to, Record const& a, Record const& b) {
  for (auto const& [name, claim] : b.claims) {
    auto const before = a.claims.find(name);
    if (before == a.claims.end() || before->second.verdict == claim.verdict) continue;
    constexpr auto good = "reproduced";
    to.claims.push_back({named(b), name, before->second.verdict, claim.verdict,
                         trend_of(before->second.verdict == good, claim.verdict == good)});
  }
}

// --- Times -----------------------------------------------------------------------------------------------------------

bool is_timed(Record const& record) {
  return record.status == Status::ok && record.cpu_time_s && std::isfinite(record.cpu_time_s->median) &&
         record.cpu_time_s->median > 0;
}

Trend trend_of_time(double ratio, double adjusted, CompareRules const& rules) {
  bool const matters = ratio > 1 + rules.time || ratio < 1 / (1 + rules.time);
  if (!matters || adjusted > rules.alpha) return Trend::same;
  return ratio > 1 ? Trend::worse : Trend::better;
}

TimeChange time_of(Record const& a, Record const& b) {
  CpuTime const &before = *a.cpu_time_s, &now = *b.cpu_time_s;
  TimeChange change{named(b), b.of.integrator, before.median, now.median, now.median / before.median, 0.5, {}, {}, {}};
  if (before.samples.empty() || now.samples.empty()) return change;
  change.ratio = shift_ratio(before.samples, now.samples);
  change.superiority = superiority(before.samples, now.samples);
  change.p = mann_whitney(before.samples, now.samples).p;
  return change;
}

void judge_cells(Comparison& to, std::vector<double> const& smallest) {
  std::vector<double> p;
  for (TimeChange const& change : to.times) {
    if (change.p) p.push_back(*change.p);
  }
  std::vector<double> const adjusted = holm(p);
  std::size_t next = 0;
  for (TimeChange& change : to.times) {
    if (!change.p) continue;
    change.adjusted = adjusted[next++];
    change.trend = trend_of_time(change.ratio, *change.adjusted, to.rules);
  }
  if (!smallest.empty()) {
    to.smallest_p = std::min(1.0, *std::ranges::min_element(smallest) * static_cast<double>(smallest.size()));
  }
}

void judge_groups(Comparison& to) {
  std::map<std::string, std::vector<double>> logs;
  for (TimeChange const& change : to.times) {
    logs[""].push_back(std::log(change.b / change.a));
    logs[change.integrator].push_back(std::log(change.b / change.a));
  }
  std::vector<double> p;
  for (auto const& [integrator, values] : logs) {
    p.push_back(signed_rank(values).p);
    to.groups.push_back({integrator, values.size(), std::exp(median(values)), p.back(), 1, {}});
  }
  std::vector<double> const adjusted = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    to.groups[i].adjusted = adjusted[i];
    to.groups[i].trend = trend_of_time(to.groups[i].ratio, adjusted[i], to.rules);
  }
}

void compare_times(Comparison& to, std::vector<std::pair<Record const*, Record const*>> const& pairs) {
  if (to.a.machine.empty() || to.b.machine.empty()) {
    to.why_no_times = fmt::format("of {} it is not known that all was made on one machine",
                                  to.a.machine.empty() ? to.a.path : to.b.path);
    return;
  }
  if (to.a.machine != to.b.machine) {
    to.why_no_times = fmt::format("the machines differ: {}; {}", to.a.machine, to.b.machine);
    return;
  }
  std::vector<double> smallest;
  for (auto const& [a, b] : pairs) {
    if (!is_timed(*a) || !is_timed(*b)) continue;
    to.times.push_back(time_of(*a, *b));
    if (to.times.back().p) {
      smallest.push_back(smallest_p(a->cpu_time_s->samples.size(), b->cpu_time_s->samples.size()));
    }
  }
  if (to.times.empty()) {
    to.why_no_times = "no cell was timed in both";
    return;
  }
  judge_cells(to, smallest);
  judge_groups(to);
}

// --- JSON ------------------------------------------------------------------------------------------------------------

using Json = nlohmann::ordered_json;

Json json_of(std::optional<double> number) {
  return number && std::isfinite(*number) ? Json(*number) : Json(nullptr);
}

Json json_of(Side const& side) {
  return {{"path", side.path},
          {"build", side.build},
          {"made", side.made},
          {"machine", side.machine},
          {"unfinished", side.unfinished},
          {"records", side.records},
          {"records_of_other_builds", side.of_other_builds}};
}

Json json_of(NamedCell const& cell) {
  return {{"cell", cell.cell}, {"name", cell.name}};
}

Json json_of(StatusChange const& change) {
  Json json = json_of(static_cast<NamedCell const&>(change));
  json.update({{"a", name_of(change.a)},
               {"b", name_of(change.b)},
               {"reason_a", change.reason_a},
               {"reason_b", change.reason_b},
               {"trend", name_of(change.trend)}});
  return json;
}

Json json_of(ClaimChange const& change) {
  Json json = json_of(static_cast<NamedCell const&>(change));
  json.update({{"claim", change.claim}, {"a", change.a}, {"b", change.b}, {"trend", name_of(change.trend)}});
  return json;
}

Json json_of(ColumnChange const& change) {
  Json json = json_of(static_cast<NamedCell const&>(change));
  json.update({{"column", change.column},
               {"a", json_of(change.a)},
               {"b", json_of(change.b)},
               {change.count ? "relative" : "digits", json_of(change.change)},
               {"trend", name_of(change.trend)}});
  return json;
}

Json json_of(TimeChange const& change) {
  Json json = json_of(static_cast<NamedCell const&>(change));
  json.update({{"a", json_of(change.a)},
               {"b", json_of(change.b)},
               {"ratio", json_of(change.ratio)},
               {"superiority", json_of(change.superiority)},
               {"p", json_of(change.p)},
               {"adjusted_p", json_of(change.adjusted)},
               {"trend", name_of(change.trend)}});
  return json;
}

Json json_of(GroupChange const& group) {
  return {{"integrator", group.integrator.empty() ? Json(nullptr) : Json(group.integrator)},
          {"cells", group.cells},
          {"ratio", json_of(group.ratio)},
          {"p", json_of(group.p)},
          {"adjusted_p", json_of(group.adjusted)},
          {"trend", name_of(group.trend)}};
}

template <class T>
Json json_of(std::vector<T> const& list) {
  Json array = Json::array();
  for (T const& item : list) array.push_back(json_of(item));
  return array;
}

bool any_worse(auto const& changes) {
  return std::ranges::any_of(changes, [](auto const& change) { return change.trend == Trend::worse; });
}

}  // namespace

std::string_view name_of(Trend trend) {
  switch (trend) {
    case Trend::worse:
      return "worse";
    case Trend::better:
      return "better";
    case Trend::changed:
      return "changed";
    default:
      return "same";
  }
}

bool Comparison::regressed() const {
  bool const lost = std::ranges::any_of(
      only_a, [&](NamedCell const& cell) { return std::ranges::find(b.unfinished, cell.cell) != b.unfinished.end(); });
  return lost || any_worse(statuses) || any_worse(claims) || any_worse(columns);
}

Comparison compare(Contents const& a, Contents const& b, std::string path_a, std::string path_b,
                   CompareRules const& rules) {
  Set const first = set_of(a, std::move(path_a)), second = set_of(b, std::move(path_b));
  Comparison result;
  result.rules = rules;
  result.a = first.side;
  result.b = second.side;
  std::vector<std::pair<Record const*, Record const*>> pairs;
  for (Record const* now : second.records) {
    auto const found = first.by_cell.find(now->cell);
    if (found == first.by_cell.end()) {
      result.only_b.push_back(named(*now));
      continue;
    }
    Record const* before = found->second;
    pairs.emplace_back(before, now);
    if (before->status != now->status) {
      result.statuses.push_back({named(*now), before->status, now->status, before->reason, now->reason,
                                 trend_of(before->status == Status::ok, now->status == Status::ok)});
    } else if (has_results(now->status)) {
      compare_columns(result, *before, *now);
      compare_claims(result, *before, *now);
    }
  }
  for (Record const* before : first.records) {
    if (!second.by_cell.contains(before->cell)) result.only_a.push_back(named(*before));
  }
  // What is worse is read first.
  auto const worst_first = [](auto const& change) { return change.trend != Trend::worse; };
  std::ranges::stable_sort(result.statuses, {}, worst_first);
  std::ranges::stable_sort(result.claims, {}, worst_first);
  std::ranges::stable_sort(result.columns, {}, worst_first);
  result.common = pairs.size();
  compare_times(result, pairs);
  return result;
}

Json to_json(Comparison const& comparison) {
  auto const& rules = comparison.rules;
  return {{"schema", schema},
          {"kind", "comparison"},
          {"rules", {{"digits", rules.digits}, {"counts", rules.counts}, {"time", rules.time}, {"alpha", rules.alpha}}},
          {"a", json_of(comparison.a)},
          {"b", json_of(comparison.b)},
          {"common", comparison.common},
          {"regressed", comparison.regressed()},
          {"statuses", json_of(comparison.statuses)},
          {"claims", json_of(comparison.claims)},
          {"columns", json_of(comparison.columns)},
          {"times_not_compared", comparison.why_no_times.empty() ? Json(nullptr) : Json(comparison.why_no_times)},
          {"times", json_of(comparison.times)},
          {"groups", json_of(comparison.groups)},
          {"only_a", json_of(comparison.only_a)},
          {"only_b", json_of(comparison.only_b)}};
}

}  // namespace polhode::results
