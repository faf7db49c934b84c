#include "report/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/render/render.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Comparison;
using results::Trend;

Table table_of(std::string name, Text caption, std::vector<Column> columns) {
  return {.name = std::move(name), .caption = std::move(caption), .columns = std::move(columns), .has_file = false};
}

/// Adds a table, or a part of it and how much is left.
void add_part(Document& document, Table table, std::size_t most_rows) {
  std::size_t const rows = table.rows.size();
  if (most_rows > 0 && rows > most_rows) table.rows.resize(most_rows);
  document.add(std::move(table));
  if (most_rows > 0 && rows > most_rows)
    document.say(fmt::format("And {} more; --out FILE.md or FILE.html has all.", rows - most_rows));
}

std::string counts_of(auto const& changes) {
  auto const with = [&](Trend trend) {
    return std::ranges::count_if(changes, [&](auto const& change) { return change.trend == trend; });
  };
  return fmt::format("{} worse, {} better, {} otherwise changed", with(Trend::worse), with(Trend::better),
                     with(Trend::changed));
}

std::string name_of_time(Trend trend) {
  return trend == Trend::worse ? "slower" : trend == Trend::better ? "faster" : "same";
}

Entry probability(std::optional<double> p) {
  if (!p) return absent;
  return {*p < 1e-4 ? "< 1e-4" : significant(*p, 2), exact(*p)};
}

void add_sets(Document& document, Comparison const& comparison) {
  Table table = table_of(
      "sets", "What is compared: the records of the build that wrote last.",
      {{"set"}, {"folder"}, {"build"}, {"records", true}, {"of older builds", true}, {"unfinished", true}, {"made"}});
  for (auto const* side : {&comparison.a, &comparison.b}) {
    table.rows.push_back({side == &comparison.a ? "A" : "B", side->path, side->build, std::to_string(side->records),
                          std::to_string(side->of_other_builds), std::to_string(side->unfinished.size()), side->made});
  }
  document.add(std::move(table));
  document.say(fmt::format("{} in both. {}", counted(comparison.common, "cell is", "cells are"),
                           comparison.regressed() ? "B is worse than A in a status, a verdict, an error or a count."
                                                  : "No status, verdict, error or count is worse in B."));
}

void add_statuses(Document& document, Comparison const& comparison, std::size_t most_rows) {
  document.heading(2, "Statuses");
  if (comparison.statuses.empty()) return document.say("Every cell ended as before.");
  Table table = table_of("statuses", counts_of(comparison.statuses) + ".",
                         {{"run"}, {"A"}, {"B"}, {"trend"}, {"reason in B, or else in A"}});
  for (auto const& change : comparison.statuses) {
    table.rows.push_back({change.name, std::string(name_of(change.a)), std::string(name_of(change.b)),
                          std::string(name_of(change.trend)),
                          change.reason_b.empty() ? change.reason_a : change.reason_b});
  }
  add_part(document, std::move(table), most_rows);
}

void add_claims(Document& document, Comparison const& comparison, std::size_t most_rows) {
  if (comparison.claims.empty()) return;
  document.heading(2, "Claims");
  Table table = table_of("claims", counts_of(comparison.claims) + ".", {{"run"}, {"claim"}, {"A"}, {"B"}, {"trend"}});
  for (auto const& change : comparison.claims)
    table.rows.push_back({change.name, change.claim, change.a, change.b, std::string(name_of(change.trend))});
  add_part(document, std::move(table), most_rows);
}

std::string change_of(results::ColumnChange const& change) {
  if (!change.change) return absent;
  return change.count ? fmt::format("{:+.2g}%", 100 * *change.change) : fmt::format("{:+.2f} digits", *change.change);
}

void add_columns(Document& document, Comparison const& comparison, std::size_t most_rows) {
  document.heading(2, "Errors and counts");
  std::string const rules =
      fmt::format("more than {:g} digits of log10 for errors and drifts, more than {:g}% for counts",
                  comparison.rules.digits, 100 * comparison.rules.counts);
  if (comparison.columns.empty()) return document.say(fmt::format("Nothing changes by {}.", rules));
  Table table = table_of("columns", fmt::format("{}; shown is {}.", counts_of(comparison.columns), rules),
                         {{"run"}, {"column"}, {"A", true}, {"B", true}, {"change", true}, {"trend"}});
  for (auto const& change : comparison.columns) {
    auto const value = [&](std::optional<double> v) {
      return change.count && v ? Entry(fmt::format("{:.0f}", *v)) : number(v);
    };
    table.rows.push_back({change.name, change.column, value(change.a), value(change.b),
                          Entry(change_of(change), change.change ? exact(*change.change) : ""),
                          std::string(name_of(change.trend))});
  }
  add_part(document, std::move(table), most_rows);
}

void add_groups(Document& document, Comparison const& comparison) {
  Table table = table_of("groups",
                         "The median of the cells' factors, and Wilcoxon's signed-rank test of them, corrected by "
                         "Holm's method. One factor for all integrators is more likely the machine's than the code's.",
                         {{"integrator"}, {"cells", true}, {"time B / A", true}, {"p", true}, {"trend"}});
  for (auto const& group : comparison.groups) {
    table.rows.push_back({group.integrator.empty() ? "all" : group.integrator, std::to_string(group.cells),
                          number(group.ratio), probability(group.adjusted), name_of_time(group.trend)});
  }
  document.add(std::move(table));
}

void add_times(Document& document, Comparison const& comparison, std::size_t most_rows) {
  document.heading(2, "Times");
  if (!comparison.why_no_times.empty())
    return document.say(fmt::format("Times are not compared: {}.", comparison.why_no_times));
  add_groups(document, comparison);
  auto const untested = std::ranges::count_if(comparison.times, [](auto const& time) { return !time.p; });
  auto const tested = static_cast<std::ptrdiff_t>(comparison.times.size()) - untested;
  if (untested > 0)
    document.say(fmt::format("{} without their repetitions in the records: not tested one by one.",
                             counted(static_cast<std::size_t>(untested), "cell is", "cells are")));
  if (tested == 0) return;
  if (comparison.smallest_p > comparison.rules.alpha) {
    return document.say(
        fmt::format("No single cell can be told slower or faster: with so few repetitions of {}, the smallest p is {} "
                    "after Holm's correction. More repetitions, or fewer cells, would tell.",
                    counted(static_cast<std::size_t>(tested), "cell", "cells"), significant(comparison.smallest_p, 2)));
  }
  Table table = table_of(
      "times",
      fmt::format("Cells that are slower or faster by more than {:g}%, by Mann and Whitney's test of "
                  "their repetitions, p < {:g} corrected by Holm's method over {} cells.",
                  100 * comparison.rules.time, comparison.rules.alpha, tested),
      {{"run"}, {"A", true}, {"B", true}, {"B / A", true}, {"chance that B is slower", true}, {"p", true}, {"trend"}});
  for (auto const& time : comparison.times) {
    if (time.trend == Trend::same) continue;
    table.rows.push_back({time.name, Entry(duration(time.a), exact(time.a)), Entry(duration(time.b), exact(time.b)),
                          number(time.ratio), number(time.superiority, 2), probability(time.adjusted),
                          name_of_time(time.trend)});
  }
  if (table.rows.empty()) return document.say(fmt::format("None of {} cells is slower or faster.", tested));
  add_part(document, std::move(table), most_rows);
}

void add_alone(Document& document, Comparison const& comparison, std::size_t most_rows) {
  if (comparison.only_a.empty() && comparison.only_b.empty()) return;
  document.heading(2, "Cells of one set alone");
  Table table = table_of(
      "alone", fmt::format("{} in A alone, {} in B alone.", comparison.only_a.size(), comparison.only_b.size()),
      {{"run"}, {"in"}, {"cell"}});
  for (auto const& cell : comparison.only_a) {
    bool const lost = std::ranges::find(comparison.b.unfinished, cell.cell) != comparison.b.unfinished.end();
    table.rows.push_back({cell.name, lost ? "A; began in B" : "A", cell.cell});
  }
  for (auto const& cell : comparison.only_b) table.rows.push_back({cell.name, "B", cell.cell});
  add_part(document, std::move(table), most_rows);
}

}  // namespace

Document document_of(Comparison const& comparison, std::size_t most_rows) {
  Document document{.title = "Polhode: comparison"};
  add_sets(document, comparison);
  add_statuses(document, comparison, most_rows);
  add_claims(document, comparison, most_rows);
  add_columns(document, comparison, most_rows);
  add_times(document, comparison, most_rows);
  add_alone(document, comparison, most_rows);
  return document;
}

std::string comparison_markdown(Comparison const& comparison) {
  return to_markdown(document_of(comparison));
}

std::string comparison_html(Comparison const& comparison) {
  return to_html(document_of(comparison));
}

std::string comparison_text(Comparison const& comparison, results::Outlet const& outlet) {
  constexpr std::size_t most_rows = 30;
  return to_terminal(document_of(comparison, most_rows), outlet);
}

}  // namespace polhode::report
