#pragma once
/// What `polhode ensemble --out DIR` left: ensemble.json of a folder, as far as the report shows it. README.md says
/// what else is in the file.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "results/ensemble_statistics.hpp"
#include "results/record.hpp"

namespace polhode::results {

/// The name of the file in a result folder.
inline constexpr char const* ensemble_file = "ensemble.json";

/// One metric as it was written down.
struct EnsembleMetric {
  std::string name, unit;
  std::int64_t count = 0, without = 0;  ///< samples with a value, and those that have none
  std::optional<double> mean, deviation;
  std::optional<SampleValue> least, greatest;
  std::vector<Quantile> quantiles;
  std::vector<SampleValue> worst;
  std::vector<Histogram::Bin> histogram;
};

/// One ensemble.
struct Ensemble {
  std::string command, replay;  ///< how to have it again, and one of its samples
  std::string problem, variant, formulation, integrator;
  double h = 0, t_end = 0;  ///< [s]
  std::vector<std::string> disperse;
  std::int64_t samples = 0;
  bool in_lanes = false;
  double settle_angle = 0;  ///< [rad]
  std::vector<std::pair<std::string, EndingStatistics>> endings;
  std::vector<EnsembleMetric> metrics;
  double seconds = 0, rate = 0;              ///< body-steps per second
  std::optional<double> share_of_plain_rk4;  ///< by processor time
  int threads = 1, ranks = 1;
  std::int64_t peak_memory = 0;  ///< [B]
  Meta meta;
};

/// Reads the text of such a file. Throws std::invalid_argument that says what is wrong.
Ensemble ensemble_from(std::string const& text);
/// That of a folder; nothing if it has none. Throws StoreError, which names the file.
std::optional<Ensemble> read_ensemble(std::filesystem::path const& folder);

}  // namespace polhode::results
