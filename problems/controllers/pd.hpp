#pragma once
/// Proportional-derivative attitude control towards the inertial axes.
#include "problems/controller.hpp"

namespace polhode {

/// torque = -k_p q_v sgn(q_4) - k_d omega: smooth while the scalar part keeps its sign.
/// Source: Wie & Barba (1985), J. Guidance 8, 360
/// params  k_p [N m], k_d [N m s]
template <Scalar S>
struct PdController {
  using Scalar = S;
  static constexpr bool sampled = false;

  Real<S> k_p, k_d;

  POLHODE_INLINE Vec3<S> torque(S const&, Quat<S> const& q, Vec3<S> const& omega) const {
    Real<S> const towards = q.w < S(0.0) ? k_p : -k_p;
    return towards * vec(q) - k_d * omega;
  }
};

}  // namespace polhode
