#pragma once
/// The ensembles that are raced: the default body, turning at rates that differ a little from body to body.
#include "problems/rigid_body.hpp"

namespace polhode::bench {

inline constexpr long ensemble_bodies = 4096, ensemble_steps = 200;
inline constexpr double ensemble_h = 0.01;  // [s]

/// Of body k about x [rad/s].
inline double ensemble_rate(long k) {
  return (10 + 1e-3 * double(k)) * BodyParameters::degree;
}

}  // namespace polhode::bench
