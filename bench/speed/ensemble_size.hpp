#pragma once
/// What is raced, by us and by others: ensembles of the default body, turning at rates that differ a little from body
/// to body, and the gains of the slew whose torque saturates.
#include "problems/rigid_body.hpp"

namespace polhode::bench {

inline constexpr long ensemble_bodies = 4096, ensemble_steps = 200;
inline constexpr double ensemble_h = 0.01;  // [s]

inline constexpr double limited_k_p = 4.0;         ///< [N m]
inline constexpr double limited_k_d = 20.0;        ///< [N m s]
inline constexpr double limited_torque_max = 3.0;  ///< [N m]

/// Of body k about x [rad/s].
inline double ensemble_rate(long k) {
  return (10 + 1e-3 * double(k)) * BodyParameters::degree;
}

}  // namespace polhode::bench
