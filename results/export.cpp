#include "results/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "results/meta.hpp"
#include "results/run_name.hpp"

namespace polhode::results {
namespace {

using Json = nlohmann::ordered_json;

std::string quoted(std::string const& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string safe = "\"";
  for (char const c : text) {
    if (c == '"') safe += '"';
    safe += c;
  }
  return safe + '"';
}

std::string csv_value(Json const& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return quoted(value.get<std::string>());
  return quoted(value.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::vector<Record const*> timed_runs(Contents const& contents) {
  std::vector<Record const*> timed;
  if (contents.metas.empty()) return timed;
  std::string const build = entry_of(contents.metas.back(), "build");
  for (Record const& record : contents.records) {
    if (record.build == build && record.cpu_time_s) timed.push_back(&record);
  }
  return timed;
}

/// What compare.py and others look for; what Google Benchmark knows and we do not is left out.
Json context_of(Contents const& contents) {
  Json context = Json::object();
  if (contents.metas.empty()) return context;
  Meta const& meta = contents.metas.back();
  context["date"] = entry_of(meta, "utc");
  context["executable"] = "polhode " + entry_of(meta, "version");
  std::string const processors = entry_of(meta, "cpus_available");
  bool const is_number = !processors.empty() && processors.find_first_not_of("0123456789") == std::string::npos;
  if (is_number && processors.size() < 9) context["num_cpus"] = std::stoi(processors);
  context["library_build_type"] = "release";
  for (auto const& [key, text] : meta) {
    if (!context.contains(key)) context[key] = text;
  }
  return context;
}

/// Names must be unique: runs that differ in their horizon alone say it.
std::string unique_name(Cell const& cell, std::map<std::string, int> const& uses) {
  std::string const name = run_name(cell);
  return uses.at(name) > 1 ? fmt::format("{}/t_end={}", name, cell.t_end) : name;
}

/// What all rows of a run begin with: Google Benchmark's keys, in its order.
Json head_of(CpuTime const& time, std::string const& name, std::string const& run_name, int family) {
  return {{"name", name},         {"family_index", family},  {"per_family_instance_index", 0},
          {"run_name", run_name}, {"run_type", "iteration"}, {"repetitions", time.repetitions}};
}

/// Adds a time of a row [s], and what was counted.
void add_time(Json& row, double seconds, Record const& record) {
  constexpr double ns = 1e9;
  row["real_time"] = ns * seconds;
  row["cpu_time"] = ns * seconds;
  row["time_unit"] = "ns";
  Json const fields = to_json(record);
  for (auto const* counter : {"steps", "evaluations", "norm_drift_max", "attitude_error_max"}) {
    if (fields.at(counter).is_number()) row[counter] = fields.at(counter);
  }
}

/// A row for each repetition, and one for their median with its interval. Older files do not know their repetitions:
/// there the median stands for a single one.
void add_benchmark(Json& rows, Record const& record, std::string const& name, int family) {
  CpuTime const& time = *record.cpu_time_s;
  auto const samples = time.samples.empty() ? std::vector{time.median} : time.samples;
  int repetition = 0;
  for (double const seconds : samples) {
    Json row = head_of(time, name, name, family);
    row["repetition_index"] = repetition++;
    row["threads"] = 1;
    row["iterations"] = 1;
    add_time(row, seconds, record);
    rows.push_back(std::move(row));
  }
  Json row = head_of(time, name + "_median", name, family);
  row["run_type"] = "aggregate";
  row["threads"] = 1;
  row["aggregate_name"] = "median";
  row["aggregate_unit"] = "time";
  row["iterations"] = samples.size();
  add_time(row, time.median, record);
  row["cpu_time_low"] = 1e9 * time.low;
  row["cpu_time_high"] = 1e9 * time.high;
  rows.push_back(std::move(row));
}

}  // namespace

std::string csv_text(std::vector<Record> const& records) {
  std::string text;
  Record const any;
  for_each_field(any, [&](std::string_view name, std::string_view, auto const&) {
    if (!text.empty()) text += ',';
    text += name;
  });
  text += '\n';
  for (Record const& record : records) {
    Json json = to_json(record);
    json.erase("schema");
    json.erase("kind");
    for (auto const& [name, value] : json.items()) {
      text += csv_value(value);
      text += ',';
    }
    text.back() = '\n';
  }
  return text;
}

std::string benchmark_json_text(Contents const& contents) {
  std::vector<Record const*> const timed = timed_runs(contents);
  std::map<std::string, int> uses;
  for (Record const* record : timed) ++uses[run_name(record->of)];
  Json json{{"context", context_of(contents)}, {"benchmarks", Json::array()}};
  int family = 0;
  for (Record const* record : timed) {
    add_benchmark(json["benchmarks"], *record, unique_name(record->of, uses), family++);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::size_t left_out_of_benchmarks(Contents const& contents) {
  return contents.records.size() - timed_runs(contents).size();
}

}  // namespace polhode::results
