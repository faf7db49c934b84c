#pragma once
/// Modified Rodrigues parameters: three numbers for attitude, sigma = vec(q) / (1 + q.w) = tan(angle / 4) axis.
/// They are the sphere of unit quaternions projected from q = -1: all of it but that one point, which lies at infinity.
/// So sigma has no constraint to drift from, q and -q are two points sigma and -sigma / |sigma|^2, and a body that
/// turns through 360 deg leaves the chart. `mrp` lets it; `mrp_shadow` changes over to the other point in time.
/// Frames as in attitude.hpp: q maps body to inertial components, omega is the body rate [rad/s]; sigma has no unit.
/// Source: Schaub & Junkins, Analytical Mechanics of Space Systems, sec. 3.6
#include "problems/space.hpp"

namespace polhode {

/// sigma of a unit quaternion. The sign of q counts: |sigma| > 1 where q.w < 0. Not finite at q = -1.
template <class S>
POLHODE_INLINE Vec3<S> mrp_of(Quat<S> const& q) {
  S const one(1.0);
  // 1 + w = |v|^2 / (1 - w) has no cancellation where w is negative.
  S const k = q.w < S(0.0) ? S((one - q.w) / dot(vec(q), vec(q))) : S(one / (one + q.w));
  return k * vec(q);
}
/// The unit quaternion that sigma stands for: (2 sigma, 1 - |sigma|^2) / (1 + |sigma|^2).
template <class S>
POLHODE_INLINE Quat<S> quaternion_of_mrp(Vec3<S> const& sigma) {
  S const one(1.0), z = dot(sigma, sigma), k = one / (one + z), twice = Real<S>(2.0) * k;
  return {twice * sigma.x, twice * sigma.y, twice * sigma.z, k * (one - z)};
}
/// The shadow point, -sigma / |sigma|^2: the same attitude, minus the quaternion. Not finite at 0.
template <class S>
POLHODE_INLINE Vec3<S> mrp_shadow_of(Vec3<S> const& sigma) {
  return (S(-1.0) / dot(sigma, sigma)) * sigma;
}

/// sigma' [1/s] at body rate omega [rad/s]: G(sigma) omega.
/// 2 G = (1 - |sigma|^2) / 2 + hat(sigma) + sigma sigma^T, so G^T G = ((1 + |sigma|^2) / 4)^2.
template <class S>
POLHODE_INLINE Vec3<S> mrp_rate(Vec3<S> const& sigma, Vec3<S> const& omega) {
  Vec3<S> const h = Real<S>(0.5) * omega;
  S const diagonal = Real<S>(0.5) * (S(1.0) - dot(sigma, sigma));
  return diagonal * h + cross(sigma, h) + dot(sigma, h) * sigma;
}
/// G(sigma)^T v: a gradient with respect to sigma as a torque about the body axes.
template <class S>
POLHODE_INLINE Vec3<S> mrp_rate_transposed(Vec3<S> const& sigma, Vec3<S> const& v) {
  Vec3<S> const h = Real<S>(0.5) * v;
  S const diagonal = Real<S>(0.5) * (S(1.0) - dot(sigma, sigma));
  return diagonal * h - cross(sigma, h) + dot(sigma, h) * sigma;
}

/// Formulation `mrp`: the projected sphere as it is.   chart sigma, velocity omega, sigma' = G(sigma) omega
/// fails   Status::diverged within 4e-6 rad of a full turn, q = -1, where sigma goes to infinity
template <class S>
struct Mrp : Flat<S, Vec3<S>>, Unconstrained<S, Vec3<S>> {
  static constexpr std::string_view name = "mrp";
  template <class T>
  using Over = Mrp<T>;  ///< the same space over another scalar
  using Velocity = Vec3<S>;
  static POLHODE_INLINE Vec3<S> rate(Vec3<S> const& sigma, Velocity const& omega) { return mrp_rate(sigma, omega); }
  static POLHODE_INLINE Vec3<S> chart_rate(Vec3<S> const&, Vec3<S> const& u, Velocity const& omega) {
    return mrp_rate(u, omega);
  }
  static POLHODE_INLINE Quat<S> attitude(Vec3<S> const& sigma) { return quaternion_of_mrp(sigma); }
  static POLHODE_INLINE Vec3<S> from_attitude(Quat<S> const& q) { return mrp_of(q); }
  /// |sigma| = tan(angle / 4) above 1e6.
  static POLHODE_INLINE bool singular(Vec3<S> const& sigma) { return S(1e12) < dot(sigma, sigma); }
};

/// Formulation `mrp_shadow`: sigma of the shorter way round, |sigma| <= 1 between steps. Stages may go beyond; the
/// chart does not end at 1. A method that keeps increments or history starts anew when `settle` says that it moved x.
template <class S>
struct MrpShadow : Mrp<S> {
  static constexpr std::string_view name = "mrp_shadow";
  template <class T>
  using Over = MrpShadow<T>;  ///< the same space over another scalar
  static POLHODE_INLINE Vec3<S> from_attitude(Quat<S> const& q) {
    return (sign_of(q.w) / (S(1.0) + abs_of(q.w))) * vec(q);  // of q or -q, whichever has w >= 0
  }
  /// Between steps: changes over to the shadow point where |sigma| > 1; says whether it did. The attitude stays.
  static POLHODE_INLINE bool settle(Vec3<S>& sigma) {
    // By more than round-off, or the shadow of a point at the border could be outside again.
    if (!(S(1.0 + 0x1p-50) < dot(sigma, sigma))) return false;
    sigma = mrp_shadow_of(sigma);
    return true;
  }
};

}  // namespace polhode
