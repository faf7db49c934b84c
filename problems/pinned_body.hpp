#pragma once
/// A rigid body that turns about a fixed point, in maximal coordinates: six degrees of freedom, three constraints.
///
///   Phi = x - R r = 0            the arm r (body axes) ends in the centre of mass x (inertial axes, pivot at 0)
///   m v' = m g - lambda          lambda [N, inertial axes]: what the body does to the pivot
///   J omega' = J omega x omega + r x R^T lambda
///
/// that is M u' = f - G^T lambda with u = (omega, v) and G u = v - R (omega x r).
/// Source: Bruels, Cardona & Arnold (2012), Mech. Mach. Theory 48, 121
///
/// state   (attitude, omega [rad/s, body]), (x [m], v [m/s], inertial)
#include "problems/rigid_body.hpp"

namespace polhode {

/// The x with m x = b, by Cramer's rule.
template <class S>
POLHODE_INLINE Vec3<S> solve(Mat3<S> const& m, Vec3<S> const& b) {
  Vec3<S> const row = cross(m.e2, m.e3);
  S const inverse = S(1.0) / dot(m.e1, row);
  return {inverse * dot(row, b), inverse * dot(cross(m.e3, m.e1), b), inverse * dot(cross(m.e1, m.e2), b)};
}

/// The mechanics alone, as functions of R, x, omega, v. R is used as it is, orthogonal or not: its columns turn with
/// R' = R hat(omega).
template <Scalar S>
class PinnedBody {
 public:
  /// omega' [rad/s^2, body] and v' [m/s^2, inertial]; also changes of omega and v.
  using Accelerations = Pair<Vec3<S>, Vec3<S>>;

  /// mass [kg], inertia about the centre of mass [kg m^2], arm r [m, body], gravity [m/s^2, inertial]
  PinnedBody(Real<S> const& mass, Mat3<Real<S>> const& inertia, Vec3<Real<S>> const& arm, Vec3<Real<S>> const& gravity)
      : mass_(mass), inertia_(inertia), arm_(arm), gravity_(gravity) {
    Mat3<Real<S>> const& inverse = inertia_.inverse;
    Real<S> const none(0.0);
    Vec3<Real<S>> const ex{none, arm.z, -arm.y};
    Vec3<Real<S>> const ey{-arm.z, none, arm.x};
    Vec3<Real<S>> const ez{arm.y, -arm.x, none};
    auto const column = [&](Vec3<Real<S>> const& torque) { return cross(inverse * torque, arm); };
    yielding_ = {column(ex), column(ey), column(ez)};
  }

  Real<S> const& mass() const { return mass_; }
  FullInertia<Real<S>> const& inertia() const { return inertia_; }
  Vec3<Real<S>> const& arm() const { return arm_; }
  Vec3<Real<S>> const& gravity() const { return gravity_; }

  /// Phi [m].
  POLHODE_INLINE Vec3<S> constraint(Mat3<S> const& R, Vec3<S> const& x) const { return x - R * lifted(arm_); }
  /// G u = d/dt Phi [m/s].
  POLHODE_INLINE Vec3<S> constraint_rate(Mat3<S> const& R, Vec3<S> const& omega, Vec3<S> const& v) const {
    return v - R * cross(omega, lifted(arm_));
  }
  /// d^2/dt^2 Phi [m/s^2].
  POLHODE_INLINE Vec3<S> constraint_acceleration(Mat3<S> const& R, Vec3<S> const& omega, Accelerations const& a) const {
    Vec3<S> const r = lifted(arm_);
    return a.second - R * (cross(a.first, r) + cross(omega, cross(omega, r)));
  }
  /// omega' and v' under the force lambda at the pivot.
  POLHODE_INLINE Accelerations accelerations(Mat3<S> const& R, Vec3<S> const& omega, Vec3<S> const& lambda) const {
    Vec3<S> const torque = cross(lifted(arm_), transposed_times(R, lambda));
    return {inertia_.acceleration(omega, torque), lifted(gravity_) - (Real<S>(1.0) / mass_) * lambda};
  }
  /// omega' and v' without the force at the pivot.
  POLHODE_INLINE Accelerations free_accelerations(Vec3<S> const& omega) const {
    return {inertia_.acceleration(omega), lifted(gravity_)};
  }
  /// -M^-1 G^T mu: what the impulse mu [N s] at the pivot does to omega and v.
  POLHODE_INLINE Accelerations impulse(Mat3<S> const& R, Vec3<S> const& mu) const {
    Vec3<S> const torque = cross(lifted(arm_), transposed_times(R, mu));
    return {inertia_.inverse * torque, (Real<S>(-1.0) / mass_) * mu};
  }
  /// The mu with G M^-1 G_before^T mu = rate [m/s], G at R, G_before at R_before: the impulse, given at R_before, that
  /// takes `rate` out of G u at R.
  POLHODE_INLINE Vec3<S> impulse_against(Mat3<S> const& R, Mat3<S> const& R_before, Vec3<S> const& rate) const {
    Mat3<S> const left = R * lifted(yielding_);
    S const share(Real<S>(1.0) / mass_);
    Mat3<S> yielding = left * transposed(R_before);
    yielding.e1.x += share;
    yielding.e2.y += share;
    yielding.e3.z += share;
    return solve(yielding, rate);
  }
  /// The lambda [N] with which d^2/dt^2 Phi = 0 (index 1).
  POLHODE_INLINE Vec3<S> multiplier(Mat3<S> const& R, Vec3<S> const& omega) const {
    return impulse_against(R, R, constraint_acceleration(R, omega, free_accelerations(omega)));
  }

  /// Kinetic and potential energy [J].
  S energy(Vec3<S> const& x, Vec3<S> const& omega, Vec3<S> const& v) const {
    S const kinetic = dot(omega, inertia_.J * omega) + mass_ * dot(v, v);
    return Real<S>(0.5) * kinetic - mass_ * dot(x, lifted(gravity_));
  }
  /// Angular momentum about the pivot [N m s, inertial].
  Vec3<S> angular_momentum(Mat3<S> const& R, Vec3<S> const& x, Vec3<S> const& omega, Vec3<S> const& v) const {
    return R * (inertia_.J * omega) + mass_ * cross(x, v);
  }

  /// A constant as it enters the arithmetic of states.
  static POLHODE_INLINE Vec3<S> lifted(Vec3<Real<S>> const& v) { return {S(v.x), S(v.y), S(v.z)}; }
  static POLHODE_INLINE Mat3<S> lifted(Mat3<Real<S>> const& m) { return {lifted(m.e1), lifted(m.e2), lifted(m.e3)}; }

 private:
  static POLHODE_INLINE Mat3<S> transposed(Mat3<S> const& m) {
    return {{m.e1.x, m.e2.x, m.e3.x}, {m.e1.y, m.e2.y, m.e3.y}, {m.e1.z, m.e2.z, m.e3.z}};
  }

  Real<S> mass_;
  FullInertia<Real<S>> inertia_;
  Vec3<Real<S>> arm_, gravity_;
  Mat3<Real<S>> yielding_;  ///< -hat(r) J^-1 hat(r) [1/kg]: how the arm's end gives way to a force, by turning
};

/// Takes Phi out of attitude and position along M^-1 G^T, by Newton until it no longer falls; false if more than 1e-9
/// of the position is left.
template <Attitude A, class S = typename A::Scalar>
bool put_on_constraint(PinnedBody<S> const& body, Point<A>& attitude, Vec3<S>& position) {
  Mat3<S> R = rotation_of<A>(attitude);
  Vec3<S> defect = body.constraint(R, position);
  S size = largest<S>(defect);
  for (int sweep = 0; sweep < 8 && S(0.0) < size; ++sweep) {
    auto const change = body.impulse(R, body.impulse_against(R, R, defect));
    Chart<A> u = A::centre(attitude);
    add(u, A::rate(attitude, change.first));
    Point<A> const next = A::retract(attitude, u);
    R = rotation_of<A>(next);
    defect = body.constraint(R, position + change.second);
    S const now = largest<S>(defect);
    if (!(now < size)) break;
    size = now;
    attitude = next;
    add(position, change.second);
  }
  return size < S(1e-9) * largest<S>(position) + S(1e-12);
}

/// A problem with constraints that methods may look at.
template <class P>
concept ConstrainedProblem = Problem<P> && requires(P const& p) {
  { p.mechanics() } -> std::same_as<PinnedBody<typename P::Space::Scalar> const&>;
};

/// The field of index 1: lambda is eliminated, nothing is stabilised, so Phi drifts.
template <Scalar S, template <class> class A>
  requires Attitude<A<S>>
struct PinnedField {
  using Space = MovingBody<A<S>>;
  using State = Point<Space>;

  PinnedBody<S> body;
  State start;

  Velocity<Space> operator()(S const&, State const& x) const {
    Mat3<S> const R = rotation_of<A<S>>(x.first.first);
    Vec3<S> const& omega = x.first.second;
    auto const a = body.accelerations(R, omega, body.multiplier(R, omega));
    return {{omega, a.first}, {x.second.second, a.second}};
  }
  State initial() const { return start; }
  PinnedBody<S> const& mechanics() const { return body; }

  /// energy [J], momentum_z: vertical angular momentum about the pivot [N m s], omega_inertial_y [rad/s],
  /// position_defect |Phi| [m], velocity_defect |G u| [m/s]
  void show(State const& x, std::span<double> out) const {
    Mat3<S> const R = rotation_of<A<S>>(x.first.first);
    Vec3<S> const &omega = x.first.second, &position = x.second.first, &v = x.second.second;
    out[0] = double(body.energy(position, omega, v));
    out[1] = double(body.angular_momentum(R, position, omega, v).z);
    out[2] = double((R * omega).y);
    out[3] = double(length(body.constraint(R, position)));
    out[4] = double(length(body.constraint_rate(R, omega, v)));
  }
};

}  // namespace polhode
