#pragma once
/// The rotation of one step as the unknown of an implicit method: F = exp(hat f) and Newton for f.
/// Source: Lee, Leok & McClamroch (2007), Comput. Methods Appl. Mech. Engrg. 196, 2907
#include <cstdint>

#include "integrators/integrator.hpp"
#include "problems/pinned_body.hpp"

namespace polhode {

/// The rotation F = exp(hat f) of a step, f [rad], and its derivatives, for maps of the form
/// T(f) = s B f + c f x B f with B linear, s = sin|f| / |f|, c = (1 - cos|f|) / |f|^2:
///   (F - 1) y                   B f = f x y
///   vee(F J_d - J_d F^T)        B f = J f, J_d = tr(J) / 2 - J
template <class S>
class StepRotation {
 public:
  explicit POLHODE_INLINE StepRotation(Vec3<S> const& f) : f_(f) {
    using R = Real<S>;
    S const z = dot(f, f);
    auto const whole = sinc_cos<S>(z);
    S const half = sinc_cos<S>(R(0.25) * z).sinc;
    s_ = whole.sinc;
    c_ = R(0.5) * (half * half);
    bool const near = z < S(1e-3);  // only Newton's matrix needs these
    ds_ = near ? S(-1.0 / 3) + R(1.0 / 30) * z : (whole.cos - s_) / z;
    dc_ = near ? S(-1.0 / 12) + R(1.0 / 180) * z : (s_ - R(2.0) * c_) / z;
  }
  template <class B>
  POLHODE_INLINE Vec3<S> of(B const& b) const {
    Vec3<S> const bf = b(f_);
    return s_ * bf + c_ * cross(f_, bf);
  }
  /// The derivative of T along d.
  template <class B>
  POLHODE_INLINE Vec3<S> slope(B const& b, Vec3<S> const& d) const {
    Vec3<S> const bf = b(f_), bd = b(d);
    S const along = dot(f_, d);
    return s_ * bd + c_ * (cross(d, bf) + cross(f_, bd)) + (along * ds_) * bf + (along * dc_) * cross(f_, bf);
  }
  /// F^T.
  POLHODE_INLINE StepRotation reversed() const {
    StepRotation other = *this;
    other.f_ = -S(1.0) * f_;
    return other;
  }
  /// F y.
  POLHODE_INLINE Vec3<S> turned(Vec3<S> const& y) const { return y + of(by(y)); }
  /// B f = f x y.
  static POLHODE_INLINE auto by(Vec3<S> const& y) {
    return [&y](Vec3<S> const& f) POLHODE_LAMBDA { return cross(f, y); };
  }

 private:
  Vec3<S> f_;
  S s_, c_, ds_, dc_;
};

/// The derivative of a map of three variables as a matrix; slope(d) is the derivative along d.
template <class S, class F>
POLHODE_INLINE Mat3<S> jacobian(F const& slope) {
  S const none(0.0), one(1.0);
  return {slope(Vec3<S>{one, none, none}), slope(Vec3<S>{none, one, none}), slope(Vec3<S>{none, none, one})};
}
/// Newton from f on: f += change(f) until the change after this one would be round-off. Counts its sweeps; false if
/// they do not converge.
template <class S, class F>
POLHODE_INLINE bool newton(Vec3<S>& f, std::int64_t& sweeps, F const& change) {
  S const enough(std::same_as<Real<S>, double> ? 1e-10 : 1e-19);  // convergence is quadratic
  for (int sweep = 0; sweep < 25; ++sweep) {
    Vec3<S> const by = change(f);
    add(f, by);
    ++sweeps;
    if (!(enough * largest<S>(f) < largest<S>(by))) return all_finite(f);
  }
  return false;
}

}  // namespace polhode
