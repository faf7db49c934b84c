#include "bench/cell/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "results/statistics.hpp"

namespace polhode::bench {
namespace {

constexpr int invariants_kept = 500;
constexpr int moments_kept = 60;
constexpr double decades_kept = 4;

double angle(Vec3<Quad> const& a, Vec3<Quad> const& b) {
  return double(atan2(length(cross(a, b)), dot(a, b)));
}

}  // namespace

Invariants invariants_of(Mat3<Quad> const& J, Quat<Quad> const& q, Vec3<Quad> const& omega) {
  Vec3<Quad> const L = J * omega;
  return {dot(omega, L) / 2, length(L), to_inertial(normalised(q), L)};
}

std::optional<double> growth_exponent(std::vector<double> const& times, std::vector<double> const& drift) {
  if (times.empty() || !(times.back() > 0)) return {};
  constexpr int bins = 16, per_decade = 8;
  constexpr double floor = 4 * std::numeric_limits<double>::epsilon();
  struct Bin {
    double log_t = 0, squares = 0;
    int count = 0;
  };
  std::vector<Bin> all(bins);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(times[i] > 0)) continue;
    double const decades_before_end = std::log10(times.back() / times[i]);
    int const bin = int(decades_before_end * per_decade);
    if (bin < 0 || bin >= bins) continue;
    all[std::size_t(bin)].log_t += std::log(times[i]);
    all[std::size_t(bin)].squares += drift[i] * drift[i];
    ++all[std::size_t(bin)].count;
  }
  std::vector<std::pair<double, double>> points;
  for (Bin const& bin : all) {
    if (bin.count == 0) continue;
    double const rms = std::sqrt(bin.squares / bin.count);
    if (rms > floor) points.emplace_back(bin.log_t / bin.count, std::log(rms));
  }
  if (points.size() < 5) return {};
  std::vector<double> slopes;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      slopes.push_back((points[i].second - points[j].second) / (points[i].first - points[j].first));
  return results::median(std::move(slopes));
}

Metrics::Metrics(UsableReference const* reference, BodyParameters const* free_body, double t_end,
                 std::optional<PinnedBody<Quad>> pinned, int comparisons)
    : reference_(reference), pinned_(pinned), t_end_(t_end), comparisons_(comparisons) {
  if (free_body) inertia_ = free_body->matrix<Quad>();
}

void Metrics::see(Sight const& sight) {
  bool const first = drift_times_.empty();
  double drift = 0;
  for (BodySight const& body : sight.bodies)
    if (std::fabs(body.drift) > std::fabs(drift)) drift = body.drift;
  if (!first)  // trapezoidal rule on the squares
    drift_squares_ += (sight.t - drift_times_.back()) * (drift * drift + drifts_.back() * drifts_.back()) / 2;
  drift_times_.push_back(sight.t);
  drifts_.push_back(drift);
  drift_max_ = std::max(drift_max_, std::fabs(drift));
  drift_final_ = drift;
  raw_max_ = std::max({raw_max_, sight.raw_defect, std::fabs(drift)});

  if (inertia_) see_invariants(sight, first);
  if (pinned_) see_constraint(sight);
  bool const end = sight.t >= t_end_;
  if (sight.t >= next_comparison_ || end) compare(sight);
}

void Metrics::see_invariants(Sight const& sight, bool first) {
  Invariants const now = invariants_of(*inertia_, sight.bodies[0].q, sight.bodies[0].omega);
  if (first) start_ = now;
  auto const relative = [](Quad a, Quad b) { return b == 0 ? double(a) : double(Quad((a - b) / b)); };
  double const energy = relative(now.energy, start_->energy);
  double const momentum = relative(now.momentum, start_->momentum);
  double const direction = angle(now.direction, start_->direction);
  energy_max_ = std::max(energy_max_, std::fabs(energy));
  momentum_max_ = std::max(momentum_max_, std::fabs(momentum));
  direction_max_ = std::max(direction_max_, direction);
  keep_invariants(sight.t, energy, momentum, direction);
}

void Metrics::keep_invariants(double t, double energy, double momentum, double direction) {
  if (t < next_invariants_) return;
  invariant_rows_.push_back({t, energy, momentum, direction});
  double const interval = t_end_ / invariants_kept;
  next_invariants_ = interval * (std::floor(t / interval * (1 + 1e-12)) + 1) * (1 - 1e-12);
}

void Metrics::see_constraint(Sight const& sight) {
  BodySight const& body = sight.bodies[0];
  Mat3<Quad> const& R = body.rotation;
  Vec3<Quad> const lambda = sight.multiplier ? *sight.multiplier : pinned_->multiplier(R, body.omega);
  auto const acceleration =
      pinned_->constraint_acceleration(R, body.omega, pinned_->accelerations(R, body.omega, lambda));
  auto const note = [](double& most, Vec3<Quad> const& defect) { most = std::max(most, double(length(defect))); };
  note(position_defect_, pinned_->constraint(R, body.position));
  note(velocity_defect_, pinned_->constraint_rate(R, body.omega, body.velocity));
  note(acceleration_defect_, acceleration);
}

void Metrics::compare(Sight const& sight) {
  std::vector<double> moment{sight.t, std::fabs(drifts_.back()), raw_max_};
  if (reference_) moment.push_back(errors_of(sight));
  double const interval = t_end_ / comparisons_;
  next_comparison_ = interval * (std::floor(sight.t / interval * (1 + 1e-12)) + 1) * (1 - 1e-12);

  if (sight.t < next_moment_ && sight.t < t_end_) return;
  if (sight.t > 0) moments_.push_back(std::move(moment));
  double const ratio = std::pow(10.0, decades_kept / moments_kept);
  next_moment_ = std::max(sight.t * ratio, t_end_ * std::pow(10.0, -decades_kept));
}

double Metrics::errors_of(Sight const& sight) {
  QuadState const exact = reference_->reference.at(sight.t);
  double const rate_scale = reference_->reference.largest_rate();
  double error = 0, rate_error = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    error = std::max(error, double(angle_between(exact[i].q, sight.bodies[i].q)));
    rate_error = std::max(rate_error, double(length(sight.bodies[i].omega - exact[i].omega)));
  }
  rate_error /= rate_scale > 0 ? rate_scale : 1;
  if (pinned_) compare_multipliers(sight, exact[0]);
  // Trapezoidal rule on the squares.
  attitude_squares_ += (sight.t - last_comparison_) * (error * error + attitude_end_ * attitude_end_) / 2;
  attitude_end_ = error;
  rate_end_ = rate_error;
  attitude_max_ = std::max(attitude_max_, error);
  rate_max_ = std::max(rate_max_, rate_error);
  last_comparison_ = sight.t;
  return error;
}

void Metrics::compare_multipliers(Sight const& sight, QuadBody const& exact) {
  BodySight const& body = sight.bodies[0];
  Vec3<Quad> const right = pinned_->multiplier(matrix(exact.q), exact.omega);
  Vec3<Quad> const lambda = sight.multiplier ? *sight.multiplier : pinned_->multiplier(body.rotation, body.omega);
  multiplier_error_ = std::max(multiplier_error_, double(length(lambda - right)));
  largest_multiplier_ = std::max(largest_multiplier_, double(length(right)));
}

void Metrics::fill(results::Record& record) const {
  bool const attitudes = !reference_ || reference_->reference.layout().attitude;
  if (attitudes) {
    record.norm_drift_raw_max = raw_max_;
    record.norm_drift_max = drift_max_;
    record.norm_drift_final = drift_final_;
    record.norm_drift_rms = std::sqrt(drift_squares_ / t_end_);
    record.norm_growth_exponent = growth_exponent(drift_times_, drifts_);
  }
  if (inertia_) {
    record.energy_drift_max = energy_max_;
    record.momentum_drift_max = momentum_max_;
    record.momentum_direction_max = direction_max_;
  }
  if (pinned_) {
    record.position_defect_max = position_defect_;
    record.velocity_defect_max = velocity_defect_;
    record.acceleration_defect_max = acceleration_defect_;
    if (reference_ && largest_multiplier_ > 0) record.multiplier_error_max = multiplier_error_ / largest_multiplier_;
  }
  if (!reference_) return;
  if (attitudes) {
    record.attitude_error_max = attitude_max_;
    record.attitude_error_end = attitude_end_;
    record.attitude_error_l2 = std::sqrt(attitude_squares_ / t_end_);
  }
  if (!reference_->reference.layout().rate) return;
  record.rate_error_max = rate_max_;
  record.rate_error_end = rate_end_;
}

results::Series Metrics::drift_series(std::string const& cell) const {
  results::Series series{.cell = cell,
                         .name = "drift",
                         .columns = {"t", "norm_drift", "norm_drift_raw"},
                         .units = {"s", "", ""},
                         .rows = moments_};
  if (reference_) {
    series.columns.emplace_back("attitude_error");
    series.units.emplace_back("rad");
  }
  return series;
}

results::Series Metrics::invariant_series(std::string const& cell) const {
  return {.cell = cell,
          .name = "invariants",
          .columns = {"t", "energy", "momentum", "momentum_direction"},
          .units = {"s", "", "", "rad"},
          .rows = invariant_rows_};
}

}  // namespace polhode::bench
