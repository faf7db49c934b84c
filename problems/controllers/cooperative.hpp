#pragma once
/// Cooperative sliding-mode laws on SO(3): the attitude that a craft makes of those that it hears, its errors, and
/// three ways to a sliding surface.
///
/// Source: Ma, Dong, Ma & Wang (2018), "SO(3)-based cooperative attitude control of multiple spacecraft", Journal of
/// Astronautics 39(6), 664, doi 10.3873/j.issn.1000-1328.2018.06.009
///
/// The text at hand has lost its equations. Printed: graph, K1, K2, P1, P2, the power |s|^(1/2) sgn(s). Chosen: the
/// form of the command, rho, delta, the far surface, methods 2 and 3. Deduced: the cross term X.
///
/// Frames as in attitude.hpp: R maps body to inertial components.   P = R^T R_d,  Q = P^T
#include <array>

#include "problems/angle.hpp"
#include "problems/controller.hpp"
#include "problems/linear.hpp"
#include "problems/mrp.hpp"

namespace polhode {

// ---- The command ----------------------------------------------------------------------------------------------------

/// v_k = sum_j W_ij R_j e_k, k = 1, 2, with its first derivative and the part of its second that has no Omega_j'.
template <class S>
struct HeardAxes {
  Vec3<S> v1 = zero<Vec3<S>>(), v2 = zero<Vec3<S>>();            ///< [1]
  Vec3<S> rate1 = zero<Vec3<S>>(), rate2 = zero<Vec3<S>>();      ///< [1/s]
  Vec3<S> change1 = zero<Vec3<S>>(), change2 = zero<Vec3<S>>();  ///< [1/s^2]

  /// One link of weight a to a craft at attitude R with rate omega [rad/s, body].
  void hear(Real<S> const& a, Mat3<S> const& R, Vec3<S> const& omega) {
    Mat3<S> const moving = FlatRotation<S>::rate(R, omega), turning = FlatRotation<S>::rate(moving, omega);
    add(v1, a, R.e1);
    add(v2, a, R.e2);
    add(rate1, a, moving.e1);
    add(rate2, a, moving.e2);
    add(change1, a, turning.e1);
    add(change2, a, turning.e2);
  }
};

/// R_d = [b1 b2 b3] with b1 = v1 / |v1|, b3 = v1 x v2 / |v1 x v2|, b2 = b3 x b1: a rotation whatever is heard.
/// Omega_d is linear in v1' and v2', and Omega_d' = n_d + sum_j D_ij Omega_j'.
template <class S>
struct CooperativeCommand {
  Mat3<S> attitude;  ///< R_d
  Vec3<S> rate;      ///< Omega_d [rad/s, axes of R_d]
  Vec3<S> drift;     ///< n_d [rad/s^2, axes of R_d]
  S along;           ///< v2 . b1
  S n1, n3;          ///< |v1|, |v1 x v2|

  explicit CooperativeCommand(HeardAxes<S> const& heard) {
    Vec3<S> const normal = cross(heard.v1, heard.v2);
    n1 = length(heard.v1);
    n3 = length(normal);
    Vec3<S> const b1 = over(n1, heard.v1), b3 = over(n3, normal);
    attitude = {b1, cross(b3, b1), b3};
    along = dot(heard.v2, b1);
    rate = rate_of(heard.rate1, heard.rate2);

    Mat3<S> const turning = FlatRotation<S>::rate(attitude, rate);
    S const n1_rate = dot(b1, heard.rate1);
    S const n3_rate = dot(b3, cross(heard.rate1, heard.v2) + cross(heard.v1, heard.rate2));
    S const along_rate = dot(heard.rate2, b1) + dot(heard.v2, turning.e1);
    Vec3<S> const share = n1 * heard.rate2 - along * heard.rate1;
    Vec3<S> const share_rate =
        n1_rate * heard.rate2 + n1 * heard.change2 - along_rate * heard.rate1 - along * heard.change1;
    drift = {(dot(turning.e3, share) + dot(b3, share_rate) - n3_rate * rate.x) / n3,
             -(dot(turning.e3, heard.rate1) + dot(b3, heard.change1) + n1_rate * rate.y) / n1,
             (dot(turning.e2, heard.rate1) + dot(attitude.e2, heard.change1) - n1_rate * rate.z) / n1};
  }
  /// D_ij, by columns [1]: what Omega_j' of a craft at R adds to Omega_d', heard with weight a.
  Mat3<S> response(Real<S> const& a, Mat3<S> const& R) const {
    Vec3<S> const still = zero<Vec3<S>>(), first = a * R.e1, second = a * R.e2, third = a * R.e3;
    return {rate_of(still, third), rate_of(S(-1.0) * third, still), rate_of(second, S(-1.0) * first)};
  }

 private:
  /// Omega_d of v1', v2'.
  Vec3<S> rate_of(Vec3<S> const& rate1, Vec3<S> const& rate2) const {
    return {dot(attitude.e3, n1 * rate2 - along * rate1) / n3, -dot(attitude.e3, rate1) / n1,
            dot(attitude.e2, rate1) / n1};
  }
  static Vec3<S> over(S const& n, Vec3<S> const& v) { return {v.x / n, v.y / n, v.z / n}; }
};

// ---- The errors -----------------------------------------------------------------------------------------------------

/// Of a craft against its command.
template <class S>
struct CooperativeErrors {
  Mat3<S> Q;      ///< R_d^T R
  Vec3<S> e_R;    ///< 1/2 vee(Q - Q^T): sin(theta) axis
  Vec3<S> fed;    ///< rho P Omega_d [rad/s, body]
  Vec3<S> omega;  ///< e_Omega = Omega - rho P Omega_d [rad/s, body]

  CooperativeErrors(Mat3<S> const& R, Vec3<S> const& rate, CooperativeCommand<S> const& command, Real<S> const& rho)
      : Q{transposed_times(command.attitude, R.e1), transposed_times(command.attitude, R.e2),
          transposed_times(command.attitude, R.e3)},
        e_R(Real<S>(0.5) * Vec3<S>{Q.e2.z - Q.e3.y, Q.e3.x - Q.e1.z, Q.e1.y - Q.e2.x}),
        fed(rho * transposed_times(Q, command.rate)),
        omega(rate - fed) {}

  S trace() const { return Q.e1.x + Q.e2.y + Q.e3.z; }
  /// cos(theta), theta the angle to the command.
  S cosine() const { return Real<S>(0.5) * (trace() - S(1.0)); }
};

// ---- Surfaces and laws ----------------------------------------------------------------------------------------------

/// phi and phi', by component.
template <class S>
struct SmoothedPower {
  Vec3<S> value, slope;
};
/// phi(s) = s / (s^2 + delta^2)^(1/4); delta = 0: |s|^(1/2) sgn(s), whose slope at 0 counts as 0.
template <class S>
SmoothedPower<S> smoothed_power(Vec3<S> const& s, Real<S> const& delta) {
  SmoothedPower<S> power{zero<Vec3<S>>(), zero<Vec3<S>>()};
  S const d2 = S(delta * delta);
  Vec3<S>::each(
      [&](S const& a, S& value, S& slope) {
        S const a2 = a * a, size2 = a2 + d2;
        if (size2 == S(0.0)) return;
        S const root4 = sqrt(sqrt(size2));
        value = a / root4;
        slope = (d2 + Real<S>(0.5) * a2) / (size2 * root4);
      },
      s, power.value, power.slope);
  return power;
}

/// far, near   method 1: log(Q), e_R
/// quaternion  method 2: 2 q_v
/// mrp         method 3: 4 sigma
enum class CooperativeSurface { far, near, quaternion, mrp };

/// What a surface asks for.
template <class S>
struct VirtualControl {
  Vec3<S> s1;          ///< [rad]
  Vec3<S> alpha;       ///< [rad/s, body]
  Vec3<S> alpha_rate;  ///< alpha' of an attitude error that moves with Q' = Q hat(e_Omega) [rad/s^2]
  Vec3<S> cross_term;  ///< X
};

/// Gains, in plain doubles. K1, K2, P1, P2 are multiples of the identity.
struct CooperativeGains {
  double k1 = 1.15, k2 = 0.15;  ///< [1/s]
  double p1 = 0.03, p2 = 0.03;
  double delta = 0.1;  ///< where the power is smoothed
  double rho = 0.8;    ///< share of the command's rate that is fed forward
};

/// s2 = e_Omega - alpha,  alpha = -(K1 s1 + P1 phi(s1)), and what s2' is to be.
template <Scalar S>
struct CooperativeLaw {
  using R = Real<S>;
  R k1, k2, p1, p2, delta, rho;
  bool crosses;  ///< X is there; methods 2 and 3 may be without

  CooperativeLaw(CooperativeGains const& gains, bool cross_term)
      : k1(gains.k1),
        k2(gains.k2),
        p1(gains.p1),
        p2(gains.p2),
        delta(gains.delta),
        rho(gains.rho),
        crosses(cross_term) {}

  VirtualControl<S> virtual_control(CooperativeSurface surface, CooperativeErrors<S> const& e) const {
    switch (surface) {
      case CooperativeSurface::near:
        return near(e);
      case CooperativeSurface::quaternion: {
        Quat<S> const q = shorter(e);
        return usual(R(2.0) * vec(q), q.w * e.omega + cross(vec(q), e.omega));
      }
      case CooperativeSurface::mrp: {
        Vec3<S> const sigma = mrp_of(shorter(e));
        return usual(R(4.0) * sigma, R(4.0) * mrp_rate(sigma, e.omega));
      }
      case CooperativeSurface::far:
        break;
    }
    Vec3<S> const s1 = angle_over_sine(dot(e.e_R, e.e_R), e.cosine()) * e.e_R;
    return usual(s1, dexpinv(s1, e.omega));
  }
  /// e_Omega' [rad/s^2]: alpha' - K2 s2 - P2 phi(s2) - X.
  Vec3<S> wanted(VirtualControl<S> const& control, Vec3<S> const& e_omega) const {
    Vec3<S> const s2 = e_omega - control.alpha;
    return control.alpha_rate - k2 * s2 - p2 * smoothed_power(s2, delta).value - control.cross_term;
  }

 private:
  /// The quaternion of Q with q_4 >= 0.
  static Quat<S> shorter(CooperativeErrors<S> const& e) {
    Quat<S> const q = quaternion(e.Q);
    return q.w < S(0.0) ? scaled(S(-1.0), q) : q;
  }
  VirtualControl<S> usual(Vec3<S> const& s1, Vec3<S> const& s1_rate) const {
    SmoothedPower<S> const power = smoothed_power(s1, delta);
    return {s1, S(-1.0) * (k1 * s1 + p1 * power.value), S(-1.0) * steepened(power, s1_rate),
            crosses ? s1 : zero<Vec3<S>>()};
  }
  /// (K1 + P1 phi') v
  Vec3<S> steepened(SmoothedPower<S> const& power, Vec3<S> const& v) const {
    Vec3<S> const& slope = power.slope;
    return {k1 * v.x + p1 * slope.x * v.x, k1 * v.y + p1 * slope.y * v.y, k1 * v.z + p1 * slope.z * v.z};
  }
  /// s1 = e_R, s1' = C e_Omega, C = 1/2 (tr(P) - P): singular where theta is 90 or 180 deg.
  /// alpha = -C^-1 g,  alpha' = -C^-1 ((K1 + P1 phi') C e_Omega + C' alpha),  C' = 1/2 (tr(P') - P'),
  /// P' = -hat(e_Omega) P,  X = C^T e_R
  VirtualControl<S> near(CooperativeErrors<S> const& e) const {
    R const half(0.5);
    S const trace = e.trace();
    Vec3<S> const& s1 = e.e_R;
    SmoothedPower<S> const power = smoothed_power(s1, delta);
    Vec3<S> const s1_rate = half * (trace * e.omega - transposed_times(e.Q, e.omega));
    Vec3<S> const alpha = divided_by_C(e, S(-1.0) * (k1 * s1 + p1 * power.value));
    S const half_trace_rate = -dot(e.omega, s1);
    Vec3<S> const C_rate_alpha = half_trace_rate * alpha + half * cross(e.omega, transposed_times(e.Q, alpha));
    Vec3<S> const alpha_rate = divided_by_C(e, S(-1.0) * (steepened(power, s1_rate) + C_rate_alpha));
    return {s1, alpha, alpha_rate, half * (trace * s1 - e.Q * s1)};
  }
  /// C^-1 v
  static Vec3<S> divided_by_C(CooperativeErrors<S> const& e, Vec3<S> const& v) {
    R const half(0.5);
    S const trace = e.trace();
    auto const row = [&](Vec3<S> const& column_of_Q) { return S(-half) * column_of_Q; };
    std::array<Vec3<S>, 3> rows{row(e.Q.e1), row(e.Q.e2), row(e.Q.e3)};
    rows[0].x += half * trace;
    rows[1].y += half * trace;
    rows[2].z += half * trace;
    std::array<std::array<S, 3>, 3> C;
    for (std::size_t i = 0; i < 3; ++i) C[i] = {rows[i].x, rows[i].y, rows[i].z};
    std::array<S, 3> b{v.x, v.y, v.z};
    solve(C, b);
    return {b[0], b[1], b[2]};
  }
};

}  // namespace polhode
