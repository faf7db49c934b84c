#pragma once
/// Where states live. A space has points, body-frame velocities and a chart around every point; methods add in charts.
///
///   centre(x)               chart coordinates of x itself: 0 on a group, x on a flat space (whose chart is global)
///   retract(x, u)           the point with coordinates u in the chart around x
///   local(x, y)             the coordinates of y in the chart around x
///   rate(x, v)              the chart's velocity at its centre when x moves with velocity v
///   chart_rate(x, u, v)     the same at u:  dexp^-1_u v on a group | q omega / 2 | v
///   retract_exactly(...)    retract by increments; where that is addition, its rounding error is carried on
///   defect(x)               how far x is from the constraint: |q.q - 1| | Frobenius norm of R^T R - 1 | 0
///   project(x)              the nearest point without defect; returns the distance that it moved
///
/// Laws (space_laws.hpp checks them with dual numbers):
///
///   1. retract(x, centre(x)) = x
///   2. local(x, retract(x, u)) = u
///   3. rate(x, v) = chart_rate(x, centre(x), v)
///   4. moving u by chart_rate(x, u, v) in the chart around x moves y = retract(x, u) by rate(y, v) in its own chart
///
/// So Runge-Kutta in the chart around x is the classical one on a flat space, at no cost (u starts at x: the sum is the
/// textbook's), and Munthe-Kaas on a group.   Source: Munthe-Kaas (1998), BIT 38, 92
#include <string_view>

#include "problems/attitude.hpp"

namespace polhode {

template <class M>
using Point = typename M::Point;
template <class M>
using Chart = typename M::Chart;
template <class M>
using Velocity = typename M::Velocity;

/// `same_as`, not `convertible_to`: a wrong size or frame must be an error here, not a conversion.
template <class M>
concept SmallSpace = Scalar<typename M::Scalar> && requires(Point<M> x, Chart<M> u, Velocity<M> v) {
  { M::centre(x) } -> std::same_as<Chart<M>>;
  { M::retract(x, u) } -> std::same_as<Point<M>>;
  { M::local(x, x) } -> std::same_as<Chart<M>>;
  { M::rate(x, v) } -> std::same_as<Chart<M>>;
  { M::chart_rate(x, u, v) } -> std::same_as<Chart<M>>;
  { M::retract_exactly(x, u, u, u) } -> std::same_as<void>;
  { M::defect(x) } -> std::same_as<typename M::Scalar>;
  { M::project(x) } -> std::same_as<typename M::Scalar>;
  { M::flat } -> std::convertible_to<bool>;
  { M::constrained } -> std::convertible_to<bool>;
};
/// Many bodies, each on a space Factor: power.hpp.
template <class M>
concept PowerSpace = requires {
  typename M::Factor;
  { M::bodies } -> std::convertible_to<int>;
};
/// What methods run on.
template <class M>
concept Space = SmallSpace<M> || PowerSpace<M>;
/// One global chart: what CVODE, Odeint and other libraries can be given.
template <class M>
concept FlatSpace = Space<M> && M::flat;

/// Points are replaced by equivalent ones between steps: settle(x) says whether it did, and methods restart then.
template <class M>
concept Settling = requires(Point<M> x) {
  { M::settle(x) } -> std::same_as<bool>;
};
/// Coordinates that end: singular(x) is true where no step can go on.
template <class M>
concept Singular = requires(Point<M> const x) {
  { M::singular(x) } -> std::same_as<bool>;
};
/// A description of attitude; any of them serves any problem. `name` is the formulation's word on the command line.
template <class A>
concept Attitude = SmallSpace<A> && requires(Point<A> x, Quat<typename A::Scalar> q) {
  { A::attitude(x) } -> std::same_as<Quat<typename A::Scalar>>;
  { A::from_attitude(q) } -> std::same_as<Point<A>>;
  { A::name } -> std::convertible_to<std::string_view>;
};

/// A flat space over the vector type V: the chart is the point. Descriptions derive from it and say their kinematics.
template <class S, class V>
struct Flat {
  using Scalar = S;
  using Point = V;
  using Chart = V;
  static constexpr bool flat = true;

  static POLHODE_INLINE V centre(V const& x) { return x; }
  static POLHODE_INLINE V retract(V const&, V const& u) { return u; }
  static POLHODE_INLINE V local(V const&, V const& y) { return y; }
  /// x + carry becomes x + carry + sum + rest: x is that sum rounded, carry what rounding lost.
  /// Source: Hairer, McLachlan & Razakarivony (2008), BIT 48, sec. 3
  static POLHODE_INLINE void retract_exactly(V& x, V const& sum, V const& rest, V& carry) {
    V::each(
        [](S& a, S const& increment, S const& lost, S& c) POLHODE_LAMBDA {
          auto const first = two_sum(a, increment);
          auto const second = two_sum(first.sum, S(first.rest + lost));
          a = second.sum;
          c = second.rest;
        },
        x, sum, rest, carry);
  }
};

/// Every point is allowed.
template <class S, class V>
struct Unconstrained {
  static constexpr bool constrained = false;
  static POLHODE_INLINE S defect(V const&) { return S(0.0); }
  static POLHODE_INLINE S project(V&) { return S(0.0); }
};

/// R^3 with the identity as kinematics: body rates, positions.
template <class S>
struct Euclidean3 : Flat<S, Vec3<S>>, Unconstrained<S, Vec3<S>> {
  using Velocity = Vec3<S>;
  static POLHODE_INLINE Vec3<S> rate(Vec3<S> const&, Velocity const& v) { return v; }
  static POLHODE_INLINE Vec3<S> chart_rate(Vec3<S> const&, Vec3<S> const&, Velocity const& v) { return v; }
};

/// The defect and the projection that both descriptions by a quaternion share.
template <class S>
struct UnitQuaternion {
  static constexpr bool constrained = true;
  static POLHODE_INLINE S defect(Quat<S> const& q) { return abs_of(S(dot(q, q) - S(1.0))); }
  /// The nearest unit quaternion: the tether paper's explicit projection, eq. (16), which is renormalisation. Dividing
  /// by a rounded norm would leave |q.q - 1| at up to 6e-16 in double; correcting by the excess, formed without
  /// rounding error, leaves 2.3e-16. Returns the distance moved.
  static POLHODE_INLINE S project(Quat<S>& q) {
    S d = norm_excess(q), moved(0.0);
    if (S(0.25) < abs_of(d)) [[unlikely]] {  // too far for the correction to be small
      S const norm = sqrt(dot(q, q));
      moved = norm - S(1.0);
      q = {q.x / norm, q.y / norm, q.z / norm, q.w / norm};
      d = norm_excess(q);
    }
    S const norm = sqrt(S(1.0) + d), s = d / (S(1.0) + norm);  // s = norm - 1, without cancellation
    S const shrink = s / norm;
    q = {q.x - shrink * q.x, q.y - shrink * q.y, q.z - shrink * q.z, q.w - shrink * q.w};
    return abs_of(S(moved + s));
  }
  static POLHODE_INLINE Quat<S> attitude(Quat<S> const& q) { return q; }
  static POLHODE_INLINE Quat<S> from_attitude(Quat<S> const& q) { return q; }
};

/// Formulation `quaternion`: four numbers, nobody holds the norm.   chart q, velocity omega, q' = q omega / 2
template <class S>
struct FlatQuaternion : Flat<S, Quat<S>>, UnitQuaternion<S> {
  static constexpr std::string_view name = "quaternion";
  template <class T>
  using Over = FlatQuaternion<T>;  ///< the same space over another scalar
  using Velocity = Vec3<S>;
  static POLHODE_INLINE Quat<S> rate(Quat<S> const& q, Velocity const& omega) { return quaternion_rate(q, omega); }
  static POLHODE_INLINE Quat<S> chart_rate(Quat<S> const&, Quat<S> const& u, Velocity const& omega) {
    return quaternion_rate(u, omega);
  }
};

/// A rotation group with the rotation vector [rad, body] as its chart.
template <class S, class X>
struct Rotations {
  using Scalar = S;
  using Point = X;
  using Chart = Vec3<S>;
  using Velocity = Vec3<S>;
  static constexpr bool flat = false;
  static POLHODE_INLINE Chart centre(X const&) { return {S(0.0), S(0.0), S(0.0)}; }
  static POLHODE_INLINE Chart rate(X const&, Velocity const& omega) { return omega; }
  static POLHODE_INLINE Chart chart_rate(X const&, Chart const& u, Velocity const& omega) { return dexpinv(u, omega); }
};

/// Formulation `s3`: unit quaternions as a group.   q exp(u / 2)
template <class S>
struct S3 : Rotations<S, Quat<S>>, UnitQuaternion<S> {
  static constexpr std::string_view name = "s3";
  template <class T>
  using Over = S3<T>;  ///< the same space over another scalar
  static POLHODE_INLINE Quat<S> retract(Quat<S> const& q, Vec3<S> const& u) { return q * exp_quaternion(u); }
  static Vec3<S> local(Quat<S> const& q, Quat<S> const& y) { return log_quaternion(conj(q) * y); }
  /// A product of rotations has no rounding error that the next step could add: the carry stays 0.
  static POLHODE_INLINE void retract_exactly(Quat<S>& q, Vec3<S> const& sum, Vec3<S> const& rest, Vec3<S>&) {
    q = retract(q, sum + rest);
  }
};

/// The defect and the projection that both descriptions by a matrix share.
template <class S>
struct OrthogonalMatrix {
  static constexpr bool constrained = true;
  /// Frobenius norm of R^T R - 1.
  static S defect(Mat3<S> const& m) {
    Mat3<S> const g = gram(m);
    S const one(1.0);
    S const xx = g.e1.x - one, yy = g.e2.y - one, zz = g.e3.z - one;
    return sqrt(xx * xx + yy * yy + zz * zz + S(2.0) * (g.e1.y * g.e1.y + g.e1.z * g.e1.z + g.e2.z * g.e2.z));
  }
  /// The nearest rotation: R <- R (3 - R^T R) / 2, quadratic from any small defect.   Higham (2008), Functions of
  /// Matrices, eq. (8.20). Returns the Frobenius distance moved.
  static S project(Mat3<S>& m) {
    Mat3<S> const before = m;
    S last = defect(m);
    for (int sweep = 0; sweep < 8 && S(0.0) < last; ++sweep) {
      Mat3<S> const g = gram(m);
      S const three(3.0), half(0.5);
      Mat3<S> const factor{{half * (three - g.e1.x), -(half * g.e1.y), -(half * g.e1.z)},
                           {-(half * g.e2.x), half * (three - g.e2.y), -(half * g.e2.z)},
                           {-(half * g.e3.x), -(half * g.e3.y), half * (three - g.e3.z)}};
      Mat3<S> const next = m * factor;
      S const now = defect(next);
      if (!(now < last)) break;
      m = next;
      last = now;
    }
    S sum(0.0);
    Mat3<S>::each(
        [&](S const& a, S const& b) {
          S const d = a - b;
          sum += d * d;
        },
        m, before);
    return sqrt(sum);
  }
  static Quat<S> attitude(Mat3<S> const& m) { return quaternion(m); }
  static Mat3<S> from_attitude(Quat<S> const& q) { return matrix(q); }
};

/// Formulation `so3`: rotation matrices as a group.   R exp(hat u)
template <class S>
struct SO3 : Rotations<S, Mat3<S>>, OrthogonalMatrix<S> {
  static constexpr std::string_view name = "so3";
  template <class T>
  using Over = SO3<T>;  ///< the same space over another scalar
  static POLHODE_INLINE Mat3<S> retract(Mat3<S> const& m, Vec3<S> const& u) { return m * matrix(exp_quaternion(u)); }
  static Vec3<S> local(Mat3<S> const& m, Mat3<S> const& y) {
    return log_quaternion(
        quaternion(Mat3<S>{transposed_times(m, y.e1), transposed_times(m, y.e2), transposed_times(m, y.e3)}));
  }
  static POLHODE_INLINE void retract_exactly(Mat3<S>& m, Vec3<S> const& sum, Vec3<S> const& rest, Vec3<S>&) {
    m = retract(m, sum + rest);
  }
};

/// Formulation `rotation`: nine numbers, nobody holds the orthogonality.   chart R, velocity omega, R' = R hat(omega)
template <class S>
struct FlatRotation : Flat<S, Mat3<S>>, OrthogonalMatrix<S> {
  static constexpr std::string_view name = "rotation";
  template <class T>
  using Over = FlatRotation<T>;  ///< the same space over another scalar
  using Velocity = Vec3<S>;
  static POLHODE_INLINE Mat3<S> rate(Mat3<S> const& m, Velocity const& w) {
    return {w.z * m.e2 - w.y * m.e3, w.x * m.e3 - w.z * m.e1, w.y * m.e1 - w.x * m.e2};
  }
  static POLHODE_INLINE Mat3<S> chart_rate(Mat3<S> const&, Mat3<S> const& u, Velocity const& w) { return rate(u, w); }
};

/// The rotation matrix of an attitude in any description. A matrix is taken as it is: a quaternion on the way would
/// branch, and join badly where orthogonality has drifted.
template <Attitude A, class S = typename A::Scalar>
POLHODE_INLINE Mat3<S> rotation_of(Point<A> const& attitude) {
  if constexpr (std::same_as<Point<A>, Mat3<S>>)
    return attitude;
  else
    return matrix(A::attitude(attitude));
}

/// Two spaces as one; the defect is the greater of the two.
template <SmallSpace A, SmallSpace B>
struct Product {
  using Scalar = typename A::Scalar;
  using Point = Pair<typename A::Point, typename B::Point>;
  using Chart = Pair<typename A::Chart, typename B::Chart>;
  using Velocity = Pair<typename A::Velocity, typename B::Velocity>;
  using Factor = A;
  static constexpr bool flat = A::flat && B::flat;
  static constexpr bool constrained = A::constrained || B::constrained;

  static POLHODE_INLINE Chart centre(Point const& x) { return {A::centre(x.first), B::centre(x.second)}; }
  static POLHODE_INLINE Point retract(Point const& x, Chart const& u) {
    return {A::retract(x.first, u.first), B::retract(x.second, u.second)};
  }
  static Chart local(Point const& x, Point const& y) {
    return {A::local(x.first, y.first), B::local(x.second, y.second)};
  }
  static POLHODE_INLINE Chart rate(Point const& x, Velocity const& v) {
    return {A::rate(x.first, v.first), B::rate(x.second, v.second)};
  }
  static POLHODE_INLINE Chart chart_rate(Point const& x, Chart const& u, Velocity const& v) {
    return {A::chart_rate(x.first, u.first, v.first), B::chart_rate(x.second, u.second, v.second)};
  }
  static POLHODE_INLINE void retract_exactly(Point& x, Chart const& sum, Chart const& rest, Chart& carry) {
    A::retract_exactly(x.first, sum.first, rest.first, carry.first);
    B::retract_exactly(x.second, sum.second, rest.second, carry.second);
  }
  static POLHODE_INLINE Scalar defect(Point const& x) { return max_of(A::defect(x.first), B::defect(x.second)); }
  static POLHODE_INLINE Scalar project(Point& x) { return max_of(A::project(x.first), B::project(x.second)); }
  static POLHODE_INLINE bool settle(Point& x) requires Settling<A> { return A::settle(x.first); }
  static POLHODE_INLINE bool singular(Point const& x) requires Singular<A> { return A::singular(x.first); }
};

/// The state of a rigid body: attitude (first) and body rate omega [rad/s] (second).
template <Attitude A>
using RigidBody = Product<A, Euclidean3<typename A::Scalar>>;
/// The state of a rigid body that moves in space: RigidBody (first) and, in inertial axes, the position [m] and the
/// velocity [m/s] of its centre of mass (second).
template <Attitude A>
using MovingBody = Product<RigidBody<A>, Product<Euclidean3<typename A::Scalar>, Euclidean3<typename A::Scalar>>>;

}  // namespace polhode
