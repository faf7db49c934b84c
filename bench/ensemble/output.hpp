#pragma once
/// What an ensemble tells: ensemble.json for programs and the report, a table for people.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "bench/ensemble/job.hpp"
#include "results/terminal.hpp"

namespace polhode::bench {

/// How it ran: the one part that differs from run to run.
struct EnsembleTiming {
  double seconds = 0;  ///< wall time of all samples
  int threads = 1;     ///< of each rank
  int ranks = 1;
  double cpu_seconds = 0;         ///< processor time that this process spent on its samples
  std::int64_t samples_here = 0;  ///< how many these were
  double kernel_rate = 0;         ///< body-steps per second of processor time of the plain RK4 kernel
  std::int64_t peak_memory = 0;   ///< greatest resident size of this process [B]

  double rate(EnsembleJob const& job) const;  ///< body-steps per second of wall time, all ranks together
  /// Body-steps per second of processor time; nothing if this process had no samples.
  std::optional<double> cpu_rate(EnsembleJob const& job) const;
  std::optional<double> share_of_kernel(EnsembleJob const& job) const;
};

/// The flags of the same ensemble, and of one of its samples.
std::string ensemble_command(EnsembleJob const& job);
std::string replay_command(EnsembleJob const& job, std::int64_t sample);

/// The file ensemble.json; README.md says what is in it. Everything but `timing` and `provenance` is the same for any
/// number of threads and ranks.
nlohmann::ordered_json ensemble_json(EnsembleJob const& job, results::EnsembleStatistics const& statistics,
                                     EnsembleTiming const& timing);
/// The table.
std::string ensemble_text(EnsembleJob const& job, results::EnsembleStatistics const& statistics,
                          EnsembleTiming const& timing, results::Outlet const& outlet);

}  // namespace polhode::bench
