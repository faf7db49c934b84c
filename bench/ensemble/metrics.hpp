#pragma once
/// What an ensemble measures of each sample, written once for a body alone and for bodies in lanes.
///
/// A sample is looked at at the samples of its controller, or at equal times if that is continuous, and at its end.
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "problems/vectors.hpp"

namespace polhode::bench {

/// The metrics in their order. Which of them apply follows from the problem.
enum class Metric {
  settle_time,     ///< first look from which on the angle stays below the threshold to the end [s]
  peak_angle,      ///< [rad]
  final_angle,     ///< [rad]
  peak_torque,     ///< greatest |M| [N m]
  control_effort,  ///< integral of M.M [N^2 m^2 s]
  control_work,    ///< integral of M.omega [J]
  final_rate,      ///< |omega| at the end [rad/s]
  norm_drift       ///< greatest distance from the attitude's constraint at a look
};
inline constexpr std::size_t metric_count = 8;
/// Names and units, in their order.
inline std::vector<std::pair<std::string, std::string>> const& metric_names() {
  static std::vector<std::pair<std::string, std::string>> const names{{"settle_time", "s"},
                                                                      {"peak_angle", "rad"},
                                                                      {"final_angle", "rad"},
                                                                      {"peak_torque", "N m"},
                                                                      {"control_effort", "N^2 m^2 s"},
                                                                      {"control_work", "J"},
                                                                      {"final_rate", "rad/s"},
                                                                      {"norm_drift", ""}};
  return names;
}

/// What is seen of a body: S is double or lanes.
template <class S>
struct Look {
  S angle;         ///< [rad]
  Vec3<S> torque;  ///< [N m]; of sampled control the one that is held from now on
  Vec3<S> omega;   ///< [rad/s]
  S defect;        ///< of the attitude's constraint, >= 0
};

/// The metrics of one sample, or of those in the lanes of a block.
///   held  the torque is that of the last look until the next; else it is taken linearly between looks
template <class S>
class SampleMetrics {
 public:
  SampleMetrics() = default;
  SampleMetrics(double threshold, bool held) : threshold_(threshold), held_(held) {}

  /// The next look, at time t [s]; `last` at the end, where sampled control commands nothing more.
  POLHODE_INLINE void see(double t, Look<S> const& look, bool last) {
    settled_ = select(look.angle < S(threshold_), min_of(settled_, S(t)), S(never));
    peak_angle_ = max_of(peak_angle_, look.angle);
    drift_ = max_of(drift_, look.defect);
    if (!first_) {
      S const dt(t - time_);
      Vec3<S> const& after = held_ ? before_.torque : look.torque;
      S const half_dt = S(0.5) * dt;
      effort_ += half_dt * (dot(before_.torque, before_.torque) + dot(after, after));
      work_ += half_dt * (dot(before_.torque, before_.omega) + dot(after, look.omega));
    }
    if (!(held_ && last)) peak_torque2_ = max_of(peak_torque2_, dot(look.torque, look.torque));
    before_ = look;
    time_ = t;
    first_ = false;
  }
  /// After the last look.
  POLHODE_INLINE S of(Metric metric) const {
    switch (metric) {
      case Metric::settle_time:
        return settled_;
      case Metric::peak_angle:
        return peak_angle_;
      case Metric::final_angle:
        return before_.angle;
      case Metric::peak_torque:
        return sqrt(peak_torque2_);
      case Metric::control_effort:
        return effort_;
      case Metric::control_work:
        return work_;
      case Metric::final_rate:
        return length(before_.omega);
      default:
        return drift_;
    }
  }

  static constexpr double never = std::numeric_limits<double>::infinity();

 private:
  static POLHODE_INLINE S min_of(S const& a, S const& b) { return select(b < a, b, a); }

  double threshold_ = 0, time_ = 0;
  bool held_ = false, first_ = true;
  Look<S> before_{};
  S settled_{never}, peak_angle_{0.0}, drift_{0.0}, peak_torque2_{0.0}, effort_{0.0}, work_{0.0};
};

}  // namespace polhode::bench
