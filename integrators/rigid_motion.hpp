#pragma once
/// What methods for one rigid body share: what they ask of a problem, its principal axes, and its motion by turns.
///
/// Every flow of theirs is a turn of the body, a unit quaternion: the attitude is multiplied by it, the angular
/// momentum in body axes turned back. So the norm and the momentum in space are kept whatever the turn, to its rounding
/// error. Turns are added as small changes, with what rounding took from the last one.
///
/// Source: Vilmart (2008), J. Comput. Phys. 227, 7083 (compensated sums, the scalar part less 1)
#include <array>

#include "integrators/integrator.hpp"

namespace polhode {

/// A problem that is one rigid body under Euler's equation,  J omega' = J omega x omega + torque.
///   inertia_matrix()       J [kg m^2, body]
///   torque_free()          no torque, ever
///   torque_feels_rate()    the torque depends on the body rate, and not on time and attitude alone
///   torque(t, x)           [N m, body]; of sampled control the one that is held
template <class P>
concept RigidBodyProblem = Problem<P> && TurningBody<typename P::Space> &&
    requires(P const& p, typename P::Space::Scalar t, Point<typename P::Space> const x) {
  { p.inertia_matrix() } -> std::same_as<Mat3<Real<typename P::Space::Scalar>>>;
  { p.torque_free() } -> std::same_as<bool>;
  { p.torque_feels_rate() } -> std::same_as<bool>;
  { p.torque(t, x) } -> std::same_as<Vec3<typename P::Space::Scalar>>;
};

/// Principal moments [kg m^2] and axes of an inertia matrix by cyclic Jacobi rotations, as exact as the scalar.
/// Source: Golub & Van Loan (2013), Matrix Computations, sec. 8.5
template <class R>
class PrincipalAxes {
 public:
  explicit PrincipalAxes(Mat3<R> const& J) {
    std::array<std::array<R, 3>, 3> a{{{J.e1.x, J.e2.x, J.e3.x}, {J.e1.y, J.e2.y, J.e3.y}, {J.e1.z, J.e2.z, J.e3.z}}};
    std::array<std::array<R, 3>, 3> v{{{R(1.0), R(0.0), R(0.0)}, {R(0.0), R(1.0), R(0.0)}, {R(0.0), R(0.0), R(1.0)}}};
    for (int sweep = 0; sweep < 12; ++sweep)
      for (auto const& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) rotate(a, v, p, q);
    moments_ = {a[0][0], a[1][1], a[2][2]};
    axes_ = {{v[0][0], v[1][0], v[2][0]}, {v[0][1], v[1][1], v[2][1]}, {v[0][2], v[1][2], v[2][2]}};
  }

  /// In the order of the axes, which are the body's own if the matrix is diagonal.
  Vec3<R> const& moments() const { return moments_; }
  /// Principal components of a vector in body components, and back.
  template <class S>
  POLHODE_INLINE Vec3<S> to_principal(Vec3<S> const& v) const {
    if (aligned_) [[likely]]
      return v;
    return {times(axes_.e1, v), times(axes_.e2, v), times(axes_.e3, v)};
  }
  template <class S>
  POLHODE_INLINE Vec3<S> to_body(Vec3<S> const& v) const {
    if (aligned_) [[likely]]
      return v;
    return {axes_.e1.x * v.x + axes_.e2.x * v.y + axes_.e3.x * v.z,
            axes_.e1.y * v.x + axes_.e2.y * v.y + axes_.e3.y * v.z,
            axes_.e1.z * v.x + axes_.e2.z * v.y + axes_.e3.z * v.z};
  }
  /// I_k omega_k, and back.
  template <class S>
  POLHODE_INLINE Vec3<S> momentum(Vec3<S> const& omega) const {
    return {moments_.x * omega.x, moments_.y * omega.y, moments_.z * omega.z};
  }
  template <class S>
  POLHODE_INLINE Vec3<S> rate(Vec3<S> const& L) const {
    return {L.x / S(moments_.x), L.y / S(moments_.y), L.z / S(moments_.z)};
  }

 private:
  template <class S>
  static POLHODE_INLINE S times(Vec3<R> const& axis, Vec3<S> const& v) {
    return axis.x * v.x + axis.y * v.y + axis.z * v.z;
  }
  /// a <- G^T a G with a_pq = 0, v <- v G.
  void rotate(std::array<std::array<R, 3>, 3>& a, std::array<std::array<R, 3>, 3>& v, std::size_t p, std::size_t q) {
    if (a[p][q] == R(0.0)) return;
    aligned_ = false;
    R const tau = (a[q][q] - a[p][p]) / (R(2.0) * a[p][q]);
    R const t = sign_of(tau) / (abs_of(tau) + sqrt(R(1.0) + tau * tau));
    R const c = R(1.0) / sqrt(R(1.0) + t * t), s = t * c;
    a[p][p] = a[p][p] - t * a[p][q];
    a[q][q] = a[q][q] + t * a[p][q];
    a[p][q] = a[q][p] = R(0.0);
    std::size_t const k = 3 - p - q;
    R const kp = a[k][p], kq = a[k][q];
    a[k][p] = a[p][k] = c * kp - s * kq;
    a[k][q] = a[q][k] = s * kp + c * kq;
    for (auto& row : v) {
      R const vp = row[p], vq = row[q];
      row[p] = c * vp - s * vq;
      row[q] = s * vp + c * vq;
    }
  }

  Vec3<R> moments_;
  Mat3<R> axes_;  ///< columns: the principal axes in body components
  bool aligned_ = true;
};

/// A turn of the body by the unit quaternion (e, 1 + less).
template <class S>
struct Turn {
  Vec3<S> e;  ///< sin(angle / 2) times the axis
  S less;     ///< cos(angle / 2) - 1

  /// By the rotation vector u [rad].
  static Turn by(Vec3<S> const& u) {
    Vec3<S> const h = Real<S>(0.5) * u;
    auto const [sinc, cosine] = sinc_cos<S>(dot(h, h));
    Vec3<S> const e = sinc * h;
    return {e, -(dot(e, e) / (S(1.0) + cosine))};
  }
  /// Whose e is tan(angle / 2) times the axis.
  static Turn by_tangent(Vec3<S> const& c) {
    S const square = dot(c, c), norm = sqrt(S(1.0) + square), over = S(1.0) / norm;
    return {over * c, -(square * over / (S(1.0) + norm))};
  }
  /// By a unit quaternion. Of turns by less than 120 degrees the scalar part follows from the others.
  static Turn by_quaternion(Quat<S> const& q) {
    Vec3<S> const e = vec(q);
    S const square = dot(e, e);
    bool const small = S(0.5) < q.w;
    return {e, small ? S(-(square / (S(1.0) + sqrt(S(1.0) - square)))) : S(q.w - S(1.0))};
  }
};

/// q <- q (turn), lost being what rounding took.
template <class S>
void turn_by(Quat<S>& q, Quat<S>& lost, Turn<S> const& turn) {
  Quat<S> const change = q * Quat<S>{turn.e.x, turn.e.y, turn.e.z, turn.less};
  FlatQuaternion<S>::retract_exactly(q, change, lost, lost);
}
template <class S>
void turn_by(Mat3<S>& m, Mat3<S>& lost, Turn<S> const& turn) {
  Real<S> const two(2.0);
  auto const& [x, y, z] = turn.e;
  S const w = S(1.0) + turn.less, x2 = two * x, y2 = two * y, z2 = two * z;
  Mat3<S> const less_one{{-(y2 * y) - z2 * z, x2 * y + z2 * w, x2 * z - y2 * w},
                         {x2 * y - z2 * w, -(x2 * x) - z2 * z, y2 * z + x2 * w},
                         {x2 * z + y2 * w, y2 * z - x2 * w, -(x2 * x) - y2 * y}};
  FlatRotation<S>::retract_exactly(m, m * less_one, lost, lost);
}

/// What a step on the space M of a rigid body leaves for the next: the angular momentum, and what rounding took.
template <TurningBody M>
struct Motion {
  using S = typename M::Scalar;
  using R = Real<S>;

  Vec3<S> momentum;       ///< [N m s, principal axes]
  Vec3<S> momentum_lost;  ///< belongs to momentum + momentum_lost
  decltype(Point<M>::first) attitude_lost;
  bool known = false;  ///< the three above are of the state in hand

  void restart() { known = false; }
  void fit(Point<M> const&) {}

  /// Takes the momentum from the state, after a restart. Returns whether it did.
  bool open(PrincipalAxes<R> const& body, Point<M> const& x) {
    if (known) [[likely]]
      return false;
    momentum = body.momentum(body.to_principal(x.second));
    momentum_lost = zero<Vec3<S>>();
    attitude_lost = zero<decltype(Point<M>::first)>();
    known = true;
    return true;
  }
  /// Turns the body; the turn is in principal axes.
  void turn(PrincipalAxes<R> const& body, Point<M>& x, Turn<S> const& turn) {
    Vec3<S> const& L = momentum;
    Vec3<S> const back = cross(turn.e, L) - (S(1.0) + turn.less) * L;
    accelerate(R(2.0) * cross(turn.e, back));
    turn_by(x.first, attitude_lost, Turn<S>{body.to_body(turn.e), turn.less});
  }
  /// Adds to the momentum [N m s, principal axes].
  void accelerate(Vec3<S> const& change) {
    Euclidean3<S>::retract_exactly(momentum, change, momentum_lost, momentum_lost);
  }
  /// The body rate of the momentum, into the state.
  void close(PrincipalAxes<R> const& body, Point<M>& x) const { x.second = body.to_body(body.rate(momentum)); }
};

}  // namespace polhode
