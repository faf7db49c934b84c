#include "bench/job/run_report.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <vector>

#include "results/run_name.hpp"

namespace polhode::bench {
namespace {

using results::Status;
using Rows = std::vector<std::vector<results::TextCell>>;

constexpr std::size_t most_failures = 12;

results::Tone tone_of_count(Status status, std::size_t count) {
  return count == 0 ? results::Tone::quiet : results::tone_of(name_of(status));
}

std::string by_problem(std::vector<results::Record const*> const& records, results::Outlet const& outlet) {
  std::map<std::string, std::map<Status, std::size_t>> counts;
  std::vector<std::string> problems;  // in the order of the suite
  std::set<Status> seen{Status::ok};
  for (auto const* record : records) {
    if (!counts.contains(record->of.problem)) problems.push_back(record->of.problem);
    ++counts[record->of.problem][record->status];
    seen.insert(record->status);
  }
  std::vector<results::TextColumn> columns{{"problem"}, {"cells", true}};
  for (Status const status : seen) columns.push_back({std::string(name_of(status)), true});
  Rows rows;
  for (std::string const& problem : problems) {
    std::size_t all = 0;
    for (auto const& [status, count] : counts[problem]) all += count;
    rows.push_back({problem, std::to_string(all)});
    for (Status const status : seen) {
      std::size_t const count = counts[problem][status];
      rows.back().emplace_back(std::to_string(count), tone_of_count(status, count));
    }
  }
  return text_table(columns, rows, outlet);
}

std::string failures(std::vector<results::Record const*> const& records, results::Outlet const& outlet) {
  Rows rows;
  std::size_t all = 0;
  for (auto const* record : records) {
    if (record->status == Status::ok || record->status == Status::refused) continue;
    if (++all <= most_failures)
      rows.push_back({run_name(record->of), std::string(name_of(record->status)), record->reason});
  }
  if (rows.empty()) return "";
  std::string text = "\n" + text_table({{"run"}, {"status", false, true}, {"reason"}}, rows, outlet);
  if (all > rows.size()) text += fmt::format("and {} more\n", all - rows.size());
  return text;
}

}  // namespace

std::string run_text(results::Contents const& contents, std::string const& build, results::Outlet const& outlet) {
  std::vector<results::Record const*> records;
  for (results::Record const& record : contents.records) {
    if (record.build == build) records.push_back(&record);
  }
  return records.empty() ? "" : by_problem(records, outlet) + failures(records, outlet) + "\n";
}

}  // namespace polhode::bench
