#include "results/ensemble_file.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "results/shallow.hpp"
#include "results/whole_file.hpp"

namespace polhode::results {
namespace {

using Json = nlohmann::ordered_json;

std::optional<double> number_or_null(Json const& json) {
  if (json.is_null()) return {};
  return json.get<double>();
}
/// get() would cast 1e300 to one, which is undefined.
template <class Integer = std::int64_t>
Integer integer(Json const& json) {
  if (!json.is_number_integer()) throw std::invalid_argument("counts must be integers");
  return json.get<Integer>();
}
std::vector<std::int64_t> integers(Json const& json) {
  std::vector<std::int64_t> all;
  for (Json const& one : json) all.push_back(integer(one));
  return all;
}
SampleValue sample_from(Json const& json) {
  return {json.at("value").get<double>(), integer(json.at("sample"))};
}
std::optional<SampleValue> sample_or_null(Json const& json) {
  if (json.is_null()) return {};
  return sample_from(json);
}

EnsembleMetric metric_from(std::string const& name, Json const& json) {
  EnsembleMetric metric{.name = name,
                        .unit = json.at("unit"),
                        .count = integer(json.at("count")),
                        .without = integer(json.at("without")),
                        .mean = number_or_null(json.at("mean")),
                        .deviation = number_or_null(json.at("deviation")),
                        .least = sample_or_null(json.at("min")),
                        .greatest = sample_or_null(json.at("max")),
                        .quantiles = {},
                        .worst = {},
                        .histogram = {}};
  for (Json const& q : json.at("quantiles"))
    metric.quantiles.push_back({q.at("p").get<double>(), number_or_null(q.at("value")), number_or_null(q.at("low")),
                                number_or_null(q.at("high"))});
  for (Json const& worst : json.at("worst")) metric.worst.push_back(sample_from(worst));
  for (Json const& bin : json.at("histogram"))
    metric.histogram.push_back({bin.at(0).get<double>(), bin.at(1).get<double>(), integer(bin.at(2))});
  return metric;
}

Ensemble decoded(Json const& json) {
  if (json.at("schema") != schema) throw std::invalid_argument(fmt::format("schema: must be {}", schema));
  if (json.at("kind") != "ensemble") throw std::invalid_argument("kind: must be \"ensemble\"");
  Json const& statistics = json.at("statistics");
  Json const& timing = json.at("timing");
  Ensemble read{.command = json.at("command"),
                .replay = json.at("replay"),
                .problem = json.at("problem"),
                .variant = json.at("variant"),
                .formulation = json.at("formulation"),
                .integrator = json.at("integrator"),
                .h = json.at("h"),
                .t_end = json.at("t_end"),
                .disperse = json.at("disperse"),
                .samples = integer(statistics.at("samples")),
                .in_lanes = json.at("in_lanes"),
                .settle_angle = json.at("settle_angle"),
                .endings = {},
                .metrics = {},
                .seconds = timing.at("seconds"),
                .rate = timing.at("body_steps_per_second"),
                .share_of_plain_rk4 = number_or_null(timing.at("share_of_plain_rk4")),
                .threads = integer<int>(timing.at("threads")),
                .ranks = integer<int>(timing.at("ranks")),
                .peak_memory = integer(timing.at("peak_memory_bytes")),
                .meta = meta_from_json(json.at("provenance"))};
  for (auto const& [name, ending] : statistics.at("endings").items())
    read.endings.emplace_back(name,
                              EndingStatistics{integer(ending.at("count")), integers(ending.at("first_samples"))});
  for (auto const& [name, metric] : statistics.at("metrics").items()) read.metrics.push_back(metric_from(name, metric));
  return read;
}

}  // namespace

Ensemble ensemble_from(std::string const& text) {
  try {
    return decoded(Json::parse(text, shallow));
  } catch (Json::exception const& error) {
    throw std::invalid_argument(fmt::format("is not what `polhode ensemble --out DIR` writes: {}", error.what()));
  }
}

std::optional<Ensemble> read_ensemble(std::filesystem::path const& folder) {
  return read_if_there(folder / ensemble_file, ensemble_from);
}

}  // namespace polhode::results
