#pragma once
/// What a run is worth: norm drift, errors against the reference, invariants. Computed in quadruple precision from the
/// states of the run, so that the metric adds no rounding of its own.
#include <optional>
#include <vector>

#include "bench/cell/reference.hpp"
#include "problems/pinned_body.hpp"
#include "results/record.hpp"

namespace polhode::bench {

/// A run at one time.
struct Sight {
  double t = 0;  ///< [s]
  std::span<BodySight const> bodies;
  double raw_defect = 0;                   ///< the greatest defect of a step before projection, so far
  std::optional<Vec3<Quad>> multiplier{};  ///< that the method carries
};

/// Energy and angular momentum of a rigid body with inertia matrix J [kg m^2].
struct Invariants {
  Quad energy;           ///< [J]
  Quad momentum;         ///< |L| [N m s]
  Vec3<Quad> direction;  ///< L in space [N m s]
};
Invariants invariants_of(Mat3<Quad> const& J, Quat<Quad> const& q, Vec3<Quad> const& omega);

/// Theil-Sen slope of log(drift) on log(t) over the last two decades, from the RMS in eighths of a decade, above a
/// floor of 4 ulp; null where fewer than five bins are left. About 1 for a systematic drift, 1/2 for a random walk, 0
/// for noise.
std::optional<double> growth_exponent(std::vector<double> const& times, std::vector<double> const& drift);

/// Collects the metrics of one run, step by step. Of many bodies the worst counts.
class Metrics {
 public:
  /// reference null: nothing to hold the run against. free_body: its energy and angular momentum are invariants; null
  /// if the problem has no such body. pinned: a constrained body. comparisons with the reference are made, at most,
  /// over the horizon: one costs more than a step.
  Metrics(UsableReference const* reference, BodyParameters const* free_body, double t_end,
          std::optional<PinnedBody<Quad>> pinned = {}, int comparisons = 1000);
  /// At 0 s and after every accepted step, in order of time.
  void see(Sight const& sight);
  /// Writes what was measured into the record.
  void fill(results::Record& record) const;
  /// At most 64 moments, evenly on log t: t, norm_drift, norm_drift_raw (greatest so far), and attitude_error if there
  /// is a reference.
  results::Series drift_series(std::string const& cell) const;
  /// Of a free body, at about 500 moments, evenly in t: t, energy and momentum (changes relative to the start, with
  /// their signs), momentum_direction (the angle that L has turned in space).
  results::Series invariant_series(std::string const& cell) const;

 private:
  void see_invariants(Sight const& sight, bool first);
  void keep_invariants(double t, double energy, double momentum, double direction);
  void see_constraint(Sight const& sight);
  void compare_multipliers(Sight const& sight, QuadBody const& exact);
  void compare(Sight const& sight);
  /// Notes the errors against the reference; the attitude error [rad].
  double errors_of(Sight const& sight);

  UsableReference const* reference_;
  std::optional<Mat3<Quad>> inertia_;       ///< of a free body: its energy and angular momentum are invariants
  std::optional<PinnedBody<Quad>> pinned_;  ///< a constrained body
  double t_end_;
  int comparisons_;
  std::optional<Invariants> start_;

  double drift_max_ = 0, drift_final_ = 0, drift_squares_ = 0, raw_max_ = 0;
  std::vector<double> drift_times_, drifts_;
  double energy_max_ = 0, momentum_max_ = 0, direction_max_ = 0;
  std::vector<std::vector<double>> invariant_rows_;
  double next_invariants_ = 0;
  double position_defect_ = 0, velocity_defect_ = 0, acceleration_defect_ = 0;
  double multiplier_error_ = 0, largest_multiplier_ = 0;

  double next_comparison_ = 0, last_comparison_ = 0;
  double attitude_max_ = 0, attitude_end_ = 0, attitude_squares_ = 0, rate_max_ = 0, rate_end_ = 0;
  std::vector<std::vector<double>> moments_;
  double next_moment_ = 0;
};

}  // namespace polhode::bench
