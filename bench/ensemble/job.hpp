#pragma once
/// An ensemble from words to statistics: samples are run in parts that are fixed beforehand, on threads and on ranks,
/// in lanes where the combination allows it, and only what is known of them all is kept.
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/cell/cell.hpp"
#include "bench/ensemble/dispersion.hpp"
#include "bench/ensemble/lanes.hpp"
#include "results/ensemble_statistics.hpp"

namespace polhode::bench {

/// What the user asks for.
struct EnsembleRequest {
  results::Cell cell;  ///< fixed steps; without dispersions
  std::vector<std::string> disperse;
  std::uint64_t seed = 1;
  std::int64_t samples = 0;
  double settle_angle = 0.017453292519943295;  ///< settled below [rad]
  double every = 0;                            ///< from look to look [s]; 0: the sample period, else t_end / 500
  std::size_t worst = 5;                       ///< samples kept of each metric
  bool raw = false;                            ///< rows of all samples are wanted, too
};

/// The cell of one sample of an ensemble: an ordinary run replays it. Throws UsageError.
results::Cell sample_cell(results::Cell cell, std::vector<std::string> const& disperse, std::uint64_t seed,
                          std::int64_t sample);

/// What one item of work gives, and what all give together.
struct EnsemblePart {
  results::EnsembleStatistics statistics;
  std::string rows;  ///< of the raw table

  std::string bytes() const;
};

/// Everything checked, nothing run.
class EnsembleJob {
 public:
  /// Throws UsageError: what prepare() and Dispersions refuse; adaptive steps; libraries; a horizon that is no multiple
  /// of h; a distribution that reaches where the parameter's rule forbids; a combination that the integrator refuses.
  explicit EnsembleJob(EnsembleRequest const& request);

  /// Work is dealt out in items; each is independent of all others.
  std::int64_t items() const;
  std::int64_t samples_in(std::int64_t item) const;
  /// Runs an item on so many threads. Ends early, with whatever it has, once `stop` is set.
  std::string work(std::int64_t item, int threads, std::atomic<bool> const& stop) const;
  EnsemblePart nothing() const;
  EnsemblePart part(std::string const& bytes) const;

  EnsembleRequest const& request() const { return request_; }
  PreparedCell const& prepared() const { return *prepared_; }
  Dispersions const& dispersions() const { return dispersions_; }
  bool in_lanes() const { return fleet_ != nullptr; }
  double look_period() const { return period_; }
  std::int64_t steps() const { return steps_; }  ///< of a sample
  /// The header of the raw table.
  std::string columns() const;

 private:
  void check_ends() const;
  void choose_metrics();
  std::string ending_of(SampleResult const& result) const;
  void add(EnsemblePart& part, std::int64_t sample, SampleResult const& result) const;
  EnsemblePart chunk(Bodies const& bodies, std::atomic<bool> const& stop) const;

  EnsembleRequest request_;
  std::unique_ptr<PreparedCell> prepared_;
  Dispersions dispersions_;
  std::unique_ptr<LaneFleet> fleet_;
  double period_ = 0;
  std::int64_t steps_ = 0;
  std::vector<Metric> metrics_;  ///< those that apply
};

/// One sample alone, by the virtual calls that `simulate` runs on: any problem, any integrator with fixed steps.
SampleResult run_alone(PreparedCell const& base, Choice const& choice, double settle_angle);
/// It commands a torque, or shows one.
bool has_torque(ChosenProblem const& problem, std::string_view formulation);

}  // namespace polhode::bench
