#pragma once
/// Euler angles, 3-2-1: yaw about z, then pitch about the new y, then roll about the new x. A foil: what many
/// simulators use, with trigonometry in every evaluation and a singularity in the middle of the attitudes.
/// Frames as in attitude.hpp: matrix(q) = Rz(yaw) Ry(pitch) Rx(roll) maps body to inertial components.
/// Source: Schaub & Junkins, Analytical Mechanics of Space Systems, sec. 3.3
#include "problems/space.hpp"

namespace polhode {

/// Formulation `euler`: (roll, pitch, yaw) [rad] in this order, not wrapped: a body that keeps turning counts its
/// turns.   chart the angles, velocity omega [rad/s, body]; the kinematic matrix has 1 / cos(pitch)
/// fails   Status::diverged within 1e-6 rad of |pitch| = 90 deg, where roll and yaw turn about the same axis
template <class S>
struct EulerAngles : Flat<S, Vec3<S>>, Unconstrained<S, Vec3<S>> {
  static constexpr std::string_view name = "euler";
  template <class T>
  using Over = EulerAngles<T>;  ///< the same space over another scalar
  using Velocity = Vec3<S>;
  static POLHODE_INLINE Vec3<S> rate(Vec3<S> const& angles, Velocity const& omega) {
    S const s = sin(angles.x), c = cos(angles.x);
    S const yaw = (s * omega.y + c * omega.z) / cos(angles.y);
    return {omega.x + sin(angles.y) * yaw, c * omega.y - s * omega.z, yaw};
  }
  static POLHODE_INLINE Vec3<S> chart_rate(Vec3<S> const&, Vec3<S> const& u, Velocity const& omega) {
    return rate(u, omega);
  }
  static Quat<S> attitude(Vec3<S> const& angles) {
    Vec3<S> const half = Real<S>(0.5) * angles;
    S const zero(0.0);
    Quat<S> const roll{sin(half.x), zero, zero, cos(half.x)}, pitch{zero, sin(half.y), zero, cos(half.y)};
    Quat<S> const yaw{zero, zero, sin(half.z), cos(half.z)};
    return yaw * pitch * roll;
  }
  /// |pitch| <= 90 deg, roll and yaw within 180 deg. Half the sum of yaw and roll and half their difference are
  /// arguments of quaternion components, so the attitude keeps its digits even where only one of the two is defined.
  static Vec3<S> from_attitude(Quat<S> const& q) {
    S const a = q.w - q.y, b = q.z + q.x, c = q.w + q.y, d = q.z - q.x;
    S const sum = atan2(b, a), difference = atan2(d, c);
    S const sine = Real<S>(2.0) * (q.w * q.y - q.x * q.z), cosine = sqrt((a * a + b * b) * (c * c + d * d));
    return {wrapped(sum - difference), atan2(sine, cosine), wrapped(sum + difference)};
  }
  /// Within 1e-6 rad of a pitch of 90 deg, up or down, or beyond it: no attitude is there, a step has jumped across.
  static POLHODE_INLINE bool singular(Vec3<S> const& angles) { return cos(angles.y) < S(1e-6); }

 private:
  /// An angle of at most a turn, brought within half a turn.
  static S wrapped(S const& angle) {
    S const half = atan2(S(0.0), S(-1.0)), turn = half + half;
    return select(half < angle, S(angle - turn), select(angle < -half, S(angle + turn), angle));
  }
};

}  // namespace polhode
