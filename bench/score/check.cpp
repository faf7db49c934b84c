#include "bench/score/check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "bench/cell/cell.hpp"
#include "bench/score/check_bound.hpp"

namespace polhode::bench {
namespace {

std::string text_of(Selector const& selector) {
  std::vector<std::string> parts;
  for (auto const& [key, pattern] : selector) parts.push_back(fmt::format("{} = {}", key, pattern));
  return fmt::format("{{{}}}", fmt::join(parts, ", "));
}

/// A golden bound on what has no golden column would fail for ever.
void check_golden(Expectation const& expectation, std::string const& file) {
  auto const& columns = results::golden_columns();
  for (Bound const& bound : expectation.bounds) {
    bool const known = std::ranges::find(columns, record_field(bound.field)) != columns.end();
    if (!bound.golden || known || bound.field == "status") continue;
    throw SuiteError(fmt::format("{}:{}: {}: has no golden column; those are status, {}", file, expectation.line,
                                 bound.field, fmt::join(columns, ", ")));
  }
}

std::size_t count_run(std::vector<CheckedCell const*> const& cells) {
  return static_cast<std::size_t>(
      std::ranges::count_if(cells, [](CheckedCell const* cell) { return cell->record != nullptr; }));
}

/// One bound over the selected cells. Whether a failure was expected is decided later, over all bounds.
class BoundJudge {
 public:
  explicit BoundJudge(Row& row) : row_(row) {}

  void see(Held const& held) {
    missing_ |= held.missing;
    compared_ |= held.comparable;
    if (held.excess > 0) {
      row_.failures.push_back(
          fmt::format("{} [{}]: {} = {}, must be {}", held.run, held.id, row_.field, held.value, row_.bound));
    }
    bool const is_worst = row_.worst.empty() || held.excess > worst_;
    if (!is_worst) return;
    worst_ = held.excess;
    row_.worst = held.value;
    row_.worst_cell = held.run;
  }

  void conclude(Expectation const& expectation) {
    row_.verdict = row_.failures.empty() ? Verdict::passed : Verdict::failed;
    auto const least = static_cast<std::size_t>(expectation.min_cells);
    if (!missing_ && row_.cells < least) {
      row_.verdict = Verdict::vacuous;
      row_.failures.push_back(fmt::format("{}: selects {} cells, min_cells = {}", row_.selector, row_.cells, least));
    } else if (row_.failures.empty() && !compared_) {
      row_.verdict = Verdict::vacuous;
      row_.failures.push_back(
          fmt::format("{}: {} is null in every cell, golden and measured", row_.selector, row_.field));
    }
  }

  /// xfail excuses a value that is out of bounds, not one that was never measured.
  bool is_excusable() const { return !missing_ && row_.verdict != Verdict::vacuous; }

 private:
  Row& row_;
  double worst_ = 0;
  bool missing_ = false;
  bool compared_ = false;
};

void apply_xfail(std::vector<Row>& rows, std::string const& reason) {
  bool const any_failed = std::ranges::any_of(rows, [](Row const& row) { return row.verdict == Verdict::failed; });
  for (Row& row : rows) {
    row.xfail = reason;
    if (row.verdict == Verdict::failed) row.verdict = Verdict::expected_fail;
    if (any_failed) continue;
    row.verdict = Verdict::unexpected_pass;
    row.failures.push_back(
        fmt::format("{}: {} is {} everywhere, though xfail says: {}", row.selector, row.field, row.bound, reason));
  }
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::failed:
      return "FAILED";
    case Verdict::expected_fail:
      return "expected failure";
    case Verdict::unexpected_pass:
      return "UNEXPECTED PASS";
    case Verdict::vacuous:
      return "VACUOUS";
  }
  return "";
}

bool is_good(Verdict verdict) {
  return verdict == Verdict::passed || verdict == Verdict::expected_fail;
}

std::vector<CheckedCell> pair_up(Suite const& suite, results::Contents const& contents, std::string const& build) {
  std::map<std::string, results::Record const*> records;
  for (results::Record const& record : contents.records) {
    if (record.build == build) records[record.cell] = &record;
  }
  std::vector<CheckedCell> cells;
  std::map<std::string, std::size_t> places;
  for (SuiteCell const& wanted : suite.cells) {
    CheckedCell cell;
    try {
      cell.wanted = {prepare(wanted.cell).cell, wanted.tags};
    } catch (UsageError const& error) {
      throw SuiteError(fmt::format("suite '{}': {}", suite.name, error.what()));
    }
    cell.id = results::cell_id(cell.wanted.cell);
    auto const [place, is_new] = places.try_emplace(cell.id, cells.size());
    if (!is_new) {  // a horizon written out that is the default: one cell, with the tags of both
      auto& tags = cells[place->second].wanted.tags;
      tags.insert(tags.end(), wanted.tags.begin(), wanted.tags.end());
      continue;
    }
    auto const found = records.find(cell.id);
    if (found != records.end()) cell.record = found->second;
    cells.push_back(std::move(cell));
  }
  return cells;
}

std::vector<Row> judge(Suite const& suite, std::vector<CheckedCell> const& cells, Vocabulary const& vocabulary,
                       GoldenByCell const& golden, std::string const& file) {
  std::vector<Row> all;
  for (Expectation const& expectation : suite.expectations) {
    check_golden(expectation, file);
    std::vector<CheckedCell const*> selected;
    for (CheckedCell const& cell : cells) {
      if (matches(expectation.select, cell.wanted)) selected.push_back(&cell);
    }
    std::vector<Row> rows;
    bool excusable = true;
    for (Bound const& bound : expectation.bounds) {
      Row& row = rows.emplace_back();
      row.line = expectation.line;
      row.selector = text_of(expectation.select);
      row.field = bound.field;
      row.bound = text_of(bound);
      row.cells = count_run(selected);
      BoundJudge judged(row);
      if (bound.field == "order") {
        for (Held const& held : hold_orders(bound, selected, vocabulary)) judged.see(held);
      } else {
        for (CheckedCell const* cell : selected) judged.see(hold(bound, *cell, golden));
      }
      judged.conclude(expectation);
      excusable &= judged.is_excusable();
    }
    if (expectation.xfail && excusable) apply_xfail(rows, *expectation.xfail);
    std::ranges::move(rows, std::back_inserter(all));
  }
  return all;
}

}  // namespace polhode::bench
