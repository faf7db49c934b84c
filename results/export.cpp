#include "results/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

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

std::string entry_of(Meta const& meta, std::string const& key) {
  auto const found = meta.find(key);
  return found == meta.end() ? "" : found->second;
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

Json benchmark_of(Record const& record, std::string const& name, int index) {
  constexpr double ns = 1e9;
  Json const fields = to_json(record);
  Json benchmark{{"name", name},
                 {"family_index", index},
                 {"per_family_instance_index", 0},
                 {"run_name", name},
                 {"run_type", "iteration"},
                 {"repetitions", record.cpu_time_s->repetitions},
                 {"repetition_index", 0},
                 {"threads", 1},
                 {"iterations", 1},
                 {"real_time", ns * record.cpu_time_s->median},
                 {"cpu_time", ns * record.cpu_time_s->median},
                 {"time_unit", "ns"},
                 {"cpu_time_low", ns * record.cpu_time_s->low},
                 {"cpu_time_high", ns * record.cpu_time_s->high}};
  for (auto const* counter : {"steps", "evaluations", "norm_drift_max", "attitude_error_max"}) {
    if (fields.at(counter).is_number()) benchmark[counter] = fields.at(counter);
  }
  return benchmark;
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
  for (Record const* record : timed) {
    auto const index = static_cast<int>(json["benchmarks"].size());
    json["benchmarks"].push_back(benchmark_of(*record, unique_name(record->of, uses), index));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::size_t left_out_of_benchmarks(Contents const& contents) {
  return contents.records.size() - timed_runs(contents).size();
}

}  // namespace polhode::results
