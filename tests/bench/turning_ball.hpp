#pragma once
/// A run that can be computed by hand: a ball that turns about z at a constant rate, with errors and drifts of known
/// size put in.
#include "bench/cell/measure.hpp"

namespace polhode::bench::test {

inline constexpr double rate = 0.2;    // [rad/s]
inline constexpr double t_end = 50;    // [s]
inline constexpr double small = 1e-5;  // an error to be found [rad]
inline constexpr int steps = 2000;
inline Vec3<Quad> const omega{0, 0, rate};

inline ChosenProblem const& turning_ball() {
  static auto const problem =
      problem_named("free_body")
          .choose({.words = {}, .set = {{"inertia", {1, 1, 1}}, {"q0", {0, 0, 0, 1}}, {"omega0", {0, 0, rate}}}});
  return *problem;
}
inline UsableReference const& its_reference() {
  static UsableReference const reference{
      .id = "turning ball",
      .bar = 0,
      .reference = Reference::solve(turning_ball(), {.t_end = t_end, .sample_period = 0, .jumps = {}})};
  return reference;
}
inline Metrics metrics_of_the_ball(bool torque_free = true) {
  return {&its_reference(), torque_free ? turning_ball().body() : nullptr, t_end};
}

/// Its attitude: half the angle in the quaternion.
inline Quat<Quad> exact(double t) {
  Quad const half = Quad(rate) * t / 2;
  return {0, 0, sin(half), cos(half)};
}
/// That attitude, turned by `angle` [rad] about the body's x axis, across the rotation.
inline Quat<Quad> turned(double t, double angle) {
  return exact(t) * Quat<Quad>{sin(Quad(angle) / 2), 0, 0, cos(Quad(angle) / 2)};
}

/// What a run shows in this state; the drift is told as the harness tells it.
struct Seen {
  double t;
  BodySight body;
  double raw_defect = 0;
  operator Sight() const { return {.t = t, .bodies = std::span(&body, 1), .raw_defect = raw_defect}; }
};
inline Seen sight(double t, Quat<Quad> const& q, Vec3<Quad> const& w = omega) {
  return {.t = t, .body = {{.q = q, .omega = w}, double(dot(q, q) - 1)}};
}
inline Seen drifting(double t, double drift) {
  Seen seen = sight(t, exact(t));
  seen.body.drift = drift;
  return seen;
}

inline double evenly(double part) {
  return t_end * part;
}
/// As an adaptive run steps: short steps first.
inline double ever_longer(double part) {
  return t_end * part * part * part;
}

/// The record of a run; sight_at(t) says what it shows at time t.
template <class SightAt>
results::Record record_of(SightAt sight_at, double (*time)(double) = evenly, bool torque_free = true) {
  Metrics metrics = metrics_of_the_ball(torque_free);
  for (int k = 0; k <= steps; ++k) metrics.see(sight_at(time(double(k) / steps)));
  results::Record record;
  metrics.fill(record);
  return record;
}

}  // namespace polhode::bench::test
