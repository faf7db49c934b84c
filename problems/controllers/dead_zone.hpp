#pragma once
/// A path for modified Rodrigues parameters (MRPs), a sliding law that follows it, and actuators with a dead zone.
/// Source: Li, Chen, Chen & Zhang (2018), Journal of Harbin Institute of Technology 50(4), 21
/// The law's attitude variable is sigma = vec(q) / (1 + q_4), sigma' = G(sigma) omega.
#include "problems/controller.hpp"
#include "problems/mrp.hpp"

namespace polhode {

// ---- Modified Rodrigues parameters ----------------------------------------------------------------------------------

/// sigma of the attitude of q. Of its two quaternions the one in the hemisphere of the MRP `near`: the value is then a
/// function of the attitude, also for descriptions that lose the quaternion's sign, and |sigma| may exceed 1.
/// One expression for all q, unlike mrp_of: on a norm that has drifted two would not join, and the field would jump.
template <class S>
POLHODE_INLINE Vec3<S> mrp_near(Quat<S> const& q, Vec3<S> const& near) {
  S const towards = Real<S>(2.0) * dot(near, vec(q)) + (S(1.0) - dot(near, near)) * q.w;
  bool const other = towards < S(0.0);
  return (S(1.0) / select(other, S(q.w - S(1.0)), S(S(1.0) + q.w))) * vec(q);
}
/// G(sigma)^-1 u = (4 / (1 + sigma.sigma))^2 G^T u.
template <class S>
POLHODE_INLINE Vec3<S> mrp_rate_inverse(Vec3<S> const& sigma, Vec3<S> const& u) {
  S const k = S(4.0) / (S(1.0) + dot(sigma, sigma));
  return (k * k) * mrp_rate_transposed(sigma, u);
}
/// G(sigma)' omega while sigma moves with `rate`.
template <class S>
POLHODE_INLINE Vec3<S> mrp_rate_change(Vec3<S> const& sigma, Vec3<S> const& rate, Vec3<S> const& omega) {
  Vec3<S> const twice =
      cross(rate, omega) + dot(rate, omega) * sigma + dot(sigma, omega) * rate - dot(sigma, rate) * omega;
  return Real<S>(0.5) * twice;
}

// ---- The path -------------------------------------------------------------------------------------------------------

/// The polynomial that the path to rest follows: of degree 3 or 5 in time.
enum class PathKind { cubic, quintic };

/// lambda, lambda', lambda'' [1, 1/s, 1/s^2].
template <class S>
struct PathPoint {
  Vec3<S> at, rate, acceleration;
};

/// lambda(t): from (sigma_0, sigma_0') at 0 s to (0, 0) at t_f, and 0 from then on. Reconstructed: a Hermite
/// polynomial.
///   cubic    lambda'' jumps at t_f, contrary to the paper's condition 1
///   quintic  lambda'' is 0 at both ends
template <Scalar S>
struct DecayingPath {
  using R = Real<S>;
  PathKind kind;
  R t_f;  ///< [s]
  Vec3<S> start, start_rate;
  bool arrived = false;  ///< t_f has come; a phase, because the step before t_f looks at t_f, too

  PathPoint<S> operator()(S const& t) const {
    if (arrived) return {zero<Vec3<S>>(), zero<Vec3<S>>(), zero<Vec3<S>>()};
    S const x = t / S(t_f);
    // Weights of sigma_0 (p) and of t_f sigma_0' (r), and their derivatives by x.
    if (kind == PathKind::cubic)
      return combined(polynomial(x, 2., -3., 0., 1.), polynomial(x, 6., -6., 0.), polynomial(x, 12., -6.),
                      polynomial(x, 1., -2., 1., 0.), polynomial(x, 3., -4., 1.), polynomial(x, 6., -4.));
    return combined(polynomial(x, -6., 15., -10., 0., 0., 1.), polynomial(x, -30., 60., -30., 0., 0.),
                    polynomial(x, -120., 180., -60., 0.), polynomial(x, -3., 8., -6., 0., 1., 0.),
                    polynomial(x, -15., 32., -18., 0., 1.), polynomial(x, -60., 96., -36., 0.));
  }

 private:
  PathPoint<S> combined(S const& p, S const& p1, S const& p2, S const& r, S const& r1, S const& r2) const {
    R const per = R(1.0) / t_f;
    return {p * start + (t_f * r) * start_rate, (per * p1) * start + r1 * start_rate,
            (per * per * p2) * start + (per * r2) * start_rate};
  }
};

// ---- The law --------------------------------------------------------------------------------------------------------

/// Numbers of the law, in plain doubles. Gains are reconstructed; set N2.
struct SlidingGains {
  double c = 100;      ///< pole of sigma - lambda on the sliding surface [1/s]
  double beta = 5e-5;  ///< boundary layer of s [1/s]
  double k = 5e-3;     ///< greatest reaching acceleration [1/s^2]; the other pole is k / beta
};

/// What the law computes.
template <class S>
struct SlidingSignals {
  Vec3<S> v;        ///< command to the actuators [N m]
  Vec3<S> sliding;  ///< s = eta' + c eta,  eta = sigma - lambda [1/s]
};

/// v makes s' = -k sat(s / beta) on a body of inertia J under the torque m v, eq. (19) with its missing dots:
///   v = (G J^-1 M)^-1 (-G' omega + G J^-1 (omega x J omega) - c G omega + lambda'' + c lambda' - k sat(s / beta))
/// written as M^-1 (omega x J omega + J G^-1 (lambda'' - G' omega - c eta' - k sat(s / beta))), M = diag(m).
template <Scalar S>
struct SlidingLaw {
  using R = Real<S>;
  Mat3<R> J;              ///< nominal [kg m^2]
  Vec3<R> inverse_slope;  ///< 1 / m, nominal
  R c, k, inverse_beta;

  SlidingLaw(SlidingGains const& gains, Mat3<R> const& inertia, Vec3<double> const& m)
      : J(inertia),
        inverse_slope{R(1.0) / R(m.x), R(1.0) / R(m.y), R(1.0) / R(m.z)},
        c(gains.c),
        k(gains.k),
        inverse_beta(R(1.0) / R(gains.beta)) {}

  SlidingSignals<S> operator()(PathPoint<S> const& path, Vec3<S> const& sigma, Vec3<S> const& omega) const {
    Vec3<S> const rate = mrp_rate(sigma, omega), eta_rate = rate - path.rate;
    Vec3<S> const s = eta_rate + c * (sigma - path.at);
    Vec3<S> const wanted =
        path.acceleration - mrp_rate_change(sigma, rate, omega) - c * eta_rate - k * saturated(inverse_beta * s);
    Vec3<S> const torque = cross(omega, J * omega) + J * mrp_rate_inverse(sigma, wanted);
    return {{inverse_slope.x * torque.x, inverse_slope.y * torque.y, inverse_slope.z * torque.z}, s};
  }

 private:
  static Vec3<S> saturated(Vec3<S> const& s) {
    S const one(1.0), less(-1.0);
    return {clamp(s.x, less, one), clamp(s.y, less, one), clamp(s.z, less, one)};
  }
};

// ---- The actuators --------------------------------------------------------------------------------------------------

/// What the actuators do to a commanded torque v between and beyond the breakpoints b.
enum class DeadZoneKind {
  printed,     ///< jumps at the breakpoints, by delta(b)
  continuous,  ///< delta(v) - delta(b): kinks at the breakpoints
  smooth       ///< D = M v, no dead zone
};

/// delta(v) = amplitude sin(frequency v), or cos.
struct Ripple {
  double amplitude, frequency;  ///< [N m], [1/(N m)]
  bool cosine = false;

  template <class S>
  S operator()(S const& v) const {
    S const phase = Real<S>(frequency) * v;
    return Real<S>(amplitude) * (cosine ? S(cos(phase)) : S(sin(phase)));
  }
};
/// One axis, as printed. The paper's list of breakpoints calls them delta.
struct DeadZoneAxis {
  double slope, right, left;  ///< m [1], b_r, b_l [N m]
  Ripple right_ripple, left_ripple;
};
inline constexpr Vec3<DeadZoneAxis> dead_zone_axes{{0.95, 0.5, -0.6, {0.1, 1, true}, {0.2, 2}},
                                                   {1.00, 0.6, -0.4, {0.2, 2}, {0.15, 2.5, true}},
                                                   {1.05, 0.4, -0.5, {0.2, 2.5}, {0.1, 3}}};

/// Where the commands lie; of the two flags of an axis at most one is set, but while events are crossed in turn.
struct DeadZoneSides {
  Vec3<bool> right, left;  ///< v >= b_r, v <= b_l
};

/// The torque of the actuators for the commands v, by axis [N m]:
///   m (v - b_r) + delta_r(v) right of the gap, 0 in it, m (v - b_l) + delta_l(v) left of it
template <Scalar S>
class DeadZoneActuator {
  using R = Real<S>;

 public:
  explicit DeadZoneActuator(DeadZoneKind kind) : kind_(kind) {
    if (kind_ != DeadZoneKind::continuous) return;
    Vec3<R>::each(
        [](R& right, R& left, DeadZoneAxis const& axis) {
          right = axis.right_ripple(R(axis.right));
          left = axis.left_ripple(R(axis.left));
        },
        right_jump_, left_jump_, dead_zone_axes);
  }

  DeadZoneKind kind() const { return kind_; }

  /// `sides` decides, not v: a method may look a little past a breakpoint before it has located it.
  Vec3<S> torque(Vec3<S> const& v, DeadZoneSides const& sides) const {
    Vec3<S> torque;
    Vec3<S>::each(
        [&](S& out, S const& in, DeadZoneAxis const& axis, bool right, bool left, R const& right_jump,
            R const& left_jump) {
          if (kind_ == DeadZoneKind::smooth)
            out = R(axis.slope) * in;
          else if (right)
            out = R(axis.slope) * (in - S(axis.right)) + axis.right_ripple(in) - S(right_jump);
          else if (left)
            out = R(axis.slope) * (in - S(axis.left)) + axis.left_ripple(in) - S(left_jump);
          else
            out = S(0.0);
        },
        torque, v, dead_zone_axes, sides.right, sides.left, right_jump_, left_jump_);
    return torque;
  }
  static DeadZoneSides sides_of(Vec3<S> const& v) {
    DeadZoneSides sides;
    Vec3<S>::each(
        [](S const& in, DeadZoneAxis const& axis, bool& right, bool& left) {
          right = !(in < S(axis.right));
          left = !(S(axis.left) < in);
        },
        v, dead_zone_axes, sides.right, sides.left);
    return sides;
  }

 private:
  DeadZoneKind kind_;
  Vec3<R> right_jump_ = zero<Vec3<R>>(), left_jump_ = zero<Vec3<R>>();  ///< what `continuous` takes away [N m]
};

/// The disturbance tau_d(t) [N m, body].
template <class S>
Vec3<S> dead_zone_disturbance(S const& t) {
  using R = Real<S>;
  S const slow = R(0.1) * t;
  return {R(0.1) * S(sin(slow)), R(0.2) * S(cos(slow)), R(0.3) * S(sin(S(R(0.2) * t)))};
}

}  // namespace polhode
