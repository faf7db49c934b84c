#include "results/benchmarks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "results/shallow.hpp"
#include "results/whole_file.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr char const* kind = "benchmarks";

[[noreturn]] void complain(std::string const& where, std::string const& right) {
  throw std::invalid_argument(fmt::format("{}: {}", where, right));
}

/// The object's members, which are these and no others.
void expect_members(Json const& json, std::string const& where, std::set<std::string> const& names) {
  if (!json.is_object()) complain(where, "must be an object");
  for (auto const& item : json.items())
    if (!names.contains(item.key())) complain(where, fmt::format("unknown field \"{}\"", item.key()));
  for (std::string const& name : names)
    if (!json.contains(name)) complain(where, fmt::format("\"{}\" is missing", name));
}

CpuTime time_from(Json const& json, std::string const& where) {
  CpuTime const time = cpu_time_from_json(json, where);
  bool const positive = time.low > 0 && time.low <= time.median && time.median <= time.high && std::isfinite(time.high);
  if (!positive) complain(where, "must hold 0 < low <= median <= high");
  return time;
}

Benchmark benchmark_from(Json const& json, std::string const& where) {
  expect_members(json, where, {"name", "clock", "time_s", "counters"});
  Benchmark benchmark;
  if (!json["name"].is_string()) complain(where + ".name", "must be a string");
  benchmark.name = json["name"].get<std::string>();
  benchmark.wall = json["clock"] == "wall";
  if (!benchmark.wall && json["clock"] != "cpu") complain(where + ".clock", "must be \"cpu\" or \"wall\"");
  benchmark.time = time_from(json["time_s"], where + ".time_s");
  if (!json["counters"].is_object()) complain(where + ".counters", "must be an object");
  for (auto const& counter : json["counters"].items()) {
    if (!counter.value().is_number()) complain(fmt::format("{}.counters.{}", where, counter.key()), "must be a number");
    benchmark.counters[counter.key()] = counter.value().get<double>();
  }
  return benchmark;
}

Json to_json(Benchmark const& benchmark) {
  Json json = Json::object();
  json["name"] = benchmark.name;
  json["clock"] = benchmark.wall ? "wall" : "cpu";
  json["time_s"] = to_json(benchmark.time);
  json["counters"] = Json::object();
  for (auto const& [name, value] : benchmark.counters)
    if (std::isfinite(value)) json["counters"][name] = value;
  return json;
}

}  // namespace

Benchmark const* Benchmarks::find(std::string_view name) const {
  auto const found = std::ranges::find(all, name, &Benchmark::name);
  return found == all.end() ? nullptr : &*found;
}

Benchmarks benchmarks_from(std::string const& text) {
  Json const json = Json::parse(text, shallow, false);
  if (json.is_discarded()) throw std::invalid_argument("is not JSON; must be what `polhode-bench --out DIR` writes");
  expect_members(json, kind, {"schema", "kind", "meta", kind});
  if (json["schema"] != schema) complain("schema", fmt::format("must be {}", schema));
  if (json["kind"] != kind) complain("kind", fmt::format("must be \"{}\"", kind));
  Benchmarks benchmarks;
  benchmarks.meta = meta_from_json(json["meta"]);
  if (!json[kind].is_array()) complain(kind, "must be an array");
  std::set<std::string> names;
  for (std::size_t i = 0; i < json[kind].size(); ++i) {
    Benchmark benchmark = benchmark_from(json[kind][i], fmt::format("{}[{}]", kind, i));
    if (!names.insert(benchmark.name).second) complain(fmt::format("{}[{}].name", kind, i), "stands twice");
    benchmarks.all.push_back(std::move(benchmark));
  }
  return benchmarks;
}

Benchmarks read_benchmarks(fs::path const& folder) {
  return read_if_there(folder / benchmarks_file, benchmarks_from).value_or(Benchmarks());
}

void write_benchmarks(fs::path const& folder, Benchmarks const& benchmarks) {
  Json json = Json::object();
  json["schema"] = schema;
  json["kind"] = kind;
  json["meta"] = to_json(benchmarks.meta);
  json[kind] = Json::array();
  for (Benchmark const& benchmark : benchmarks.all) json[kind].push_back(to_json(benchmark));
  write_whole(folder / benchmarks_file, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace polhode::results
