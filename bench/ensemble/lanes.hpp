#pragma once
/// Fleets of one problem in lanes over bodies, with their types forgotten once per chunk: what an ensemble runs where
/// problem, formulation and method allow it.
#include <array>
#include <memory>
#include <span>
#include <string>

#include "bench/ensemble/dispersion.hpp"
#include "bench/ensemble/metrics.hpp"
#include "integrators/ensemble.hpp"
#include "problems/parameters.hpp"

namespace polhode::bench {

/// What came of one sample. If a rule of a parameter refuses its numbers it is not run.
struct SampleResult {
  bool refused = false;
  Status status = Status::ok;
  std::array<double, metric_count> metrics{};
  std::array<double, 7> end{};  ///< q1 q2 q3 q4 (body to inertial), wx wy wz [rad/s, body]; of one body alone
};

/// What a fleet is made of, and how it is watched.
struct FleetPlan {
  Choice choice;  ///< without dispersions
  Dispersions const* dispersions = nullptr;
  std::string formulation, integrator;
  EnsembleRun run;       ///< stops are looks
  double period = 0;     ///< from look to look [s]
  double t_end = 0;      ///< [s]
  bool sampled = false;  ///< the controller is asked at each look
  double threshold = 0;  ///< settled below [rad]
};

/// Samples of one problem by one method, run in lanes over bodies; the types are forgotten.
class LaneFleet {
 public:
  virtual ~LaneFleet() = default;
  /// Runs the samples of `bodies`, on this thread; results[i] is that of sample bodies.first + i. May be called by
  /// several threads at once.
  virtual void run(Bodies const& bodies, std::span<SampleResult> results) const = 0;
};

/// Null if this combination does not run in lanes: then each sample runs alone.
std::unique_ptr<LaneFleet> lane_fleet(std::string const& problem, FleetPlan const& plan);

/// The same of one problem; each is compiled in a unit of its own.
std::unique_ptr<LaneFleet> fleet_of_free_bodies(FleetPlan const& plan);
std::unique_ptr<LaneFleet> fleet_of_slews(FleetPlan const& plan);
std::unique_ptr<LaneFleet> fleet_of_captures(FleetPlan const& plan);

/// Body-steps per second of processor time of the plain RK4 kernel on free bodies, so many threads at once: what a rate
/// is compared with.
double plain_kernel_rate(int threads);

}  // namespace polhode::bench
