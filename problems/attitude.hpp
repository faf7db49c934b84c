#pragma once
/// Attitude: quaternions, rotation matrices, the exponential map.
///
/// The convention, stated once for the whole project: Hamilton product, scalar last, q maps body components to inertial
/// (or orbital) ones, q' = 1/2 q (omega, 0) with omega the body rate [rad/s, body axes].
/// Beware: the tether paper's A(q) is the transpose of matrix(q); Markley & Crassidis (2014) multiply in the opposite
/// order.
#include "problems/vectors.hpp"

namespace polhode {

template <class S>
POLHODE_INLINE Quat<S> conj(Quat<S> const& q) {
  return {-q.x, -q.y, -q.z, q.w};
}
/// The vector part.
template <class S>
POLHODE_INLINE Vec3<S> vec(Quat<S> const& q) {
  return {q.x, q.y, q.z};
}
template <class S>
POLHODE_INLINE Quat<S> operator*(Quat<S> const& p, Quat<S> const& q) {
  return {p.w * q.x + p.x * q.w + p.y * q.z - p.z * q.y, p.w * q.y + p.y * q.w + p.z * q.x - p.x * q.z,
          p.w * q.z + p.z * q.w + p.x * q.y - p.y * q.x, p.w * q.w - p.x * q.x - p.y * q.y - p.z * q.z};
}
/// q' at body rate omega [rad/s].
template <class S>
POLHODE_INLINE Quat<S> quaternion_rate(Quat<S> const& q, Vec3<S> const& omega) {
  Vec3<S> const h = Real<S>(0.5) * omega;
  return {q.w * h.x + q.y * h.z - q.z * h.y, q.w * h.y + q.z * h.x - q.x * h.z, q.w * h.z + q.x * h.y - q.y * h.x,
          -(q.x * h.x) - q.y * h.y - q.z * h.z};
}
/// q / |q|: the point of the unit sphere nearest to q. The tether paper's explicit projection, eq. (16): lambda = 1 -
/// |q|, q / (1 - lambda).
template <class S>
POLHODE_INLINE Quat<S> normalised(Quat<S> const& q) {
  S const norm = sqrt(dot(q, q));
  return {q.x / norm, q.y / norm, q.z / norm, q.w / norm};
}
/// q.q - 1 of a quaternion of norm below 1.4, to half the digits of S more than q.q has: near the sphere the rounding
/// of q.q is all that would be left. Every component's head has half the digits, in fixed point, so the sum of the
/// heads' squares less 1 is exact; only the small rest is rounded.
template <class S>
POLHODE_INLINE S norm_excess(Quat<S> const& q) {
  S const shift(ScalarTraits<Real<S>>::head_shift);
  S squares(-1.0), rest(0.0);
  Quat<S>::each(
      [&](S const& a) POLHODE_LAMBDA {
        S const head = (a + shift) - shift;
        squares += head * head;
        rest += (a - head) * (a + head);
      },
      q);
  return squares + rest;
}

/// Rotation matrix of a unit quaternion: columns are the body axes in inertial components.
template <class S>
Mat3<S> matrix(Quat<S> const& q) {
  Real<S> const two(2.0);
  S const one(1.0);
  S const x2 = two * q.x, y2 = two * q.y, z2 = two * q.z;
  return {{one - y2 * q.y - z2 * q.z, x2 * q.y + z2 * q.w, x2 * q.z - y2 * q.w},
          {x2 * q.y - z2 * q.w, one - x2 * q.x - z2 * q.z, y2 * q.z + x2 * q.w},
          {x2 * q.z + y2 * q.w, y2 * q.z - x2 * q.w, one - x2 * q.x - y2 * q.y}};
}
/// Quaternion of a rotation matrix, its largest component positive.   Shepperd (1978), J. Guidance and Control 1, 223
template <class S>
Quat<S> quaternion(Mat3<S> const& m) {
  S const xx = m.e1.x, yy = m.e2.y, zz = m.e3.z, one(1.0);
  auto const pivot = [](S const& diagonal) { return Real<S>(0.5) * sqrt(diagonal); };
  auto const over = [](S const& p) { return S(0.25) / p; };
  if (!(xx + yy + zz < S(0.0))) {
    S const w = pivot(one + xx + yy + zz), k = over(w);
    return {k * (m.e2.z - m.e3.y), k * (m.e3.x - m.e1.z), k * (m.e1.y - m.e2.x), w};
  }
  if (!(xx < yy) && !(xx < zz)) {
    S const x = pivot(one + xx - yy - zz), k = over(x);
    return {x, k * (m.e1.y + m.e2.x), k * (m.e3.x + m.e1.z), k * (m.e2.z - m.e3.y)};
  }
  if (!(yy < zz)) {
    S const y = pivot(one + yy - xx - zz), k = over(y);
    return {k * (m.e1.y + m.e2.x), y, k * (m.e2.z + m.e3.y), k * (m.e3.x - m.e1.z)};
  }
  S const z = pivot(one + zz - xx - yy), k = over(z);
  return {k * (m.e3.x + m.e1.z), k * (m.e2.z + m.e3.y), z, k * (m.e1.y - m.e2.x)};
}
/// Inertial components -> body components.
template <class S>
Vec3<S> to_body(Quat<S> const& q, Vec3<S> const& v) {
  return transposed_times(matrix(q), v);
}
/// Body components -> inertial components.
template <class S>
Vec3<S> to_inertial(Quat<S> const& q, Vec3<S> const& v) {
  return matrix(q) * v;
}
/// The angle between two attitudes [rad], 0 .. pi; q and -q are the same attitude, norms are ignored. Never acos.
template <class S>
S angle_between(Quat<S> const& p, Quat<S> const& q) {
  Quat<S> const e = conj(p) * q;
  return Real<S>(2.0) * atan2(length(vec(e)), abs_of(e.w));
}

// ---- The exponential map: series below 0.4 rad, where every sensible step lies (1e-17 there) ------------------------

/// sin(a)/a and cos(a) of z = a^2.
template <class S>
struct SincCos {
  S sinc, cos;
};
template <class S>
[[gnu::noinline]] SincCos<S> sinc_cos_far(S const& z) {
  S const a = sqrt(z + S(1e-300));  // z = 0 stays in the domain, and rounds to itself otherwise
  return {sin(a) / a, cos(a)};
}
/// c_0 + z (c_1 + z (...)), coefficients given from the highest down.
template <class S, class... C>
POLHODE_INLINE S polynomial(S const& z, C... c) {
  S r(0.0);
  ((r = r * z + S(c)), ...);
  return r;
}
template <class S>
POLHODE_INLINE SincCos<S> sinc_cos(S const& z) {
  if constexpr (short_series<S>)
    if (all_of(z < S(0.04))) [[likely]] {
      return {polynomial(z, -1. / 39916800, 1. / 362880, -1. / 5040, 1. / 120, -1. / 6, 1.),
              polynomial(z, -1. / 3628800, 1. / 40320, -1. / 720, 1. / 24, -.5, 1.)};
    }
  return sinc_cos_far<S>(z);
}
/// Unit quaternion of the rotation vector u [rad].
template <class S>
POLHODE_INLINE Quat<S> exp_quaternion(Vec3<S> const& u) {
  Vec3<S> const h = Real<S>(0.5) * u;
  auto const [s, c] = sinc_cos<S>(dot(h, h));
  return {s * h.x, s * h.y, s * h.z, c};
}
/// Rotation vector [rad] of a quaternion near 1 or -1: the shorter way round, angle at most pi.
template <class S>
Vec3<S> log_quaternion(Quat<S> const& q) {
  S const v2 = dot(vec(q), vec(q));
  if (v2 == S(0.0)) return scaled(Real<S>(2.0) / q.w, vec(q));  // keeps the derivatives of a dual number
  S const v = sqrt(v2);
  S const half = atan2(v, abs_of(q.w));
  return (sign_of(q.w) * Real<S>(2.0) * half / v) * vec(q);
}

/// Returned by reference: lanes as a value would be passed in different places by kernels for different registers.
template <class S>
[[gnu::noinline]] void dexpinv_far(S const& z, S& c) {  // (1 - (a/2) cot(a/2)) / a^2, z = a^2
  S const guarded = z + S(1e-300), half = Real<S>(0.5) * sqrt(guarded);
  S const far = (S(1.0) - half * cos(half) / sin(half)) / guarded;
  S const near = S(1.0) / S(12.0) + z / S(720.0) + z * z / S(30240.0);
  double const switch_at = short_series<S> ? 1e-5 : 1e-11;  // both forms lose equally many digits there
  c = select(z < S(switch_at), near, far);
}
/// u' when exp(u) turns at body rate omega: omega + u x omega / 2 + c u x (u x omega).
/// Iserles, Munthe-Kaas, Norsett & Zanna (2000), eq. (B.12), mirrored for body rates.
template <class S>
POLHODE_INLINE Vec3<S> dexpinv(Vec3<S> const& u, Vec3<S> const& omega) {
  S const z = dot(u, u);
  Vec3<S> const uw = cross(u, omega);
  S c(0.0);
  bool near = false;
  if constexpr (short_series<S>) near = all_of(z < S(0.16));
  if (near) [[likely]] {
    c = polynomial(z, 691. / 1307674368000., 1. / 47900160, 1. / 1209600, 1. / 30240, 1. / 720, 1. / 12);
  } else {
    S far(0.0);
    dexpinv_far<S>(z, far);
    c = far;
  }
  return omega + Real<S>(0.5) * uw + c * cross(u, uw);
}

}  // namespace polhode
