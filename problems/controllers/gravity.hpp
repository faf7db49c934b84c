#pragma once
/// The weight of a body that turns about a fixed point.
#include "problems/controller.hpp"

namespace polhode {

/// torque = r x m R^T g about the pivot.
/// params  moment m r [kg m, body axes], gravity [m/s^2, inertial axes], inertia about the pivot [kg m^2] for show()
template <Scalar S>
struct GravityTorque {
  using Scalar = S;
  static constexpr bool sampled = false;
  static constexpr bool feels_rate = false;

  Vec3<S> moment;
  Vec3<S> gravity;
  Mat3<S> inertia;

  POLHODE_INLINE Vec3<S> torque(S const&, Quat<S> const& q, Vec3<S> const&) const {
    return cross(moment, to_body(q, gravity));
  }
  /// energy [J], momentum_z: vertical angular momentum about the pivot [N m s], omega_inertial_y [rad/s]
  void show(Quat<S> const& q, Vec3<S> const& omega, std::span<double> out) const {
    Mat3<S> const R = matrix(q);
    Vec3<S> const momentum = inertia * omega;
    out[0] = double(Real<S>(0.5) * dot(omega, momentum) - dot(R * moment, gravity));
    out[1] = double((R * momentum).z);
    out[2] = double((R * omega).y);
  }
};

}  // namespace polhode
