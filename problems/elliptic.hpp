#pragma once
/// Elliptic integrals and Jacobi's functions for real arguments, to the precision of the scalar (double or Quad).
/// Written for speed at fixed modulus: what depends on the modulus alone is done once. The parameter m = k^2 and its
/// complement m1 = 1 - m are given side by side, so that no end of 0 <= m <= 1 loses digits.
/// Not for complex arguments; not for m < 0 or m > 1.
/// Source: NIST Digital Library of Mathematical Functions (DLMF), chapters 19, 20 and 22
#include <array>
#include <cstddef>

#include "problems/scalar.hpp"

namespace polhode::elliptic {

inline double exp(double x) {
  return std::exp(x);
}
inline Quad exp(Quad x) {
  return expq(x);
}
inline double nearest_integer(double x) {
  return std::nearbyint(x);
}
inline Quad nearest_integer(Quad x) {
  return nearbyintq(x);
}
/// Three doubles hold 113 bits; quadmath's own literals are not C++.
template <class S>
inline constexpr S pi = S(Quad(0x1.921fb54442d18p+1) + Quad(0x1.1a62633145c07p-53) + Quad(-0x1.f1976b7ed8fbcp-109));
/// The distance from 1 to the next number.
template <class S>
inline constexpr S epsilon = S(std::same_as<S, Quad> ? 0x1p-112 : 0x1p-52);

/// Arithmetic-geometric mean of two positive numbers.   DLMF 19.8.1
template <Scalar S>
S agm(S a, S b) {
  for (bool close = false; !close;) {
    close = abs_of(S(a - b)) < S(2e-2) * sqrt(epsilon<S>) * a;  // quadratic: the next mean is exact
    S const mean = S(0.5) * (a + b);
    b = sqrt(a * b);
    a = mean;
  }
  return a;
}

/// Complete integral of the first kind K for the complementary parameter m1 > 0.   DLMF 19.8.5
template <Scalar S>
S complete(S const& m1) {
  return pi<S> / (S(2.0) * agm(S(1.0), sqrt(m1)));
}

/// Carlson's symmetric integral R_F of numbers >= 0, at most one of them 0.   DLMF 19.26.18, 19.36.1
template <Scalar S>
S carlson_rf(S x, S y, S z) {
  S const near = sqrt(sqrt(sqrt(S(0.01) * epsilon<S>)));  // the series stops at the eighth power
  for (;;) {
    S const mean = (x + y + z) / S(3.0);
    S const dx = S(1.0) - x / mean, dy = S(1.0) - y / mean, dz = -(dx + dy);
    if (abs_of(dx) < near && abs_of(dy) < near && abs_of(dz) < near) {
      S const e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
      S const sum = S(1.0) - e2 / S(10.0) + e3 / S(14.0) + e2 * e2 / S(24.0) - S(3.0) * e2 * e3 / S(44.0) -
                    S(5.0) * e2 * e2 * e2 / S(208.0) + S(3.0) * e3 * e3 / S(104.0) + e2 * e2 * e3 / S(16.0);
      return sum / sqrt(mean);
    }
    S const rx = sqrt(x), ry = sqrt(y), rz = sqrt(z);
    S const shift = rx * ry + ry * rz + rz * rx;
    x = S(0.25) * (x + shift);
    y = S(0.25) * (y + shift);
    z = S(0.25) * (z + shift);
  }
}

/// The argument u, |u| <= K, where Jacobi's functions take the values s = sn u, c = cn u >= 0 and d = dn u: the
/// integral of the first kind. Three values, because each is exact where another has lost its digits.   DLMF 19.25.5
template <Scalar S>
S argument_of(S const& s, S const& c, S const& d) {
  return s * carlson_rf(S(c * c), S(d * d), S(1.0));
}

/// sn, cn, dn of one argument.
template <class S>
struct Sncndn {
  S sn, cn, dn;
};

/// Jacobi's functions of one modulus.   Descending Landen transformation, DLMF 22.7.2-4
/// m = 0 are the circular functions, m1 = 0 the hyperbolic ones. Errors: a few units of round-off, relative to 1.
template <Scalar S>
class Jacobi {
 public:
  Jacobi(S const& m, S const& m1) : endless_(!(S(0.0) < m1)) {
    if (endless_) return;
    S k = sqrt(m), kc = sqrt(m1), product(1.0);
    while (S(0.25) * epsilon<S> < k && size_ < most) {
      S const over = S(1.0) / (S(1.0) + kc);
      k = k * k * over * over;  // (1 - kc) / (1 + kc), without its cancellation
      kc = S(2.0) * sqrt(kc) * over;
      product = product * (S(1.0) + k);
      ladder_[size_++] = k;
    }
    quarter_ = S(0.5) * pi<S> * product;
    scale_ = S(1.0) / product;
    over_half_ = S(0.5) / quarter_;
  }

  /// m = 1: the functions have no period.
  bool endless() const { return endless_; }
  /// K: the functions have period 4 K. Only if not endless().
  S const& quarter_period() const { return quarter_; }
  /// The n that brings u - 2 n K into [-K, K], where sn and cn are (-1)^n times what they were; 0 if endless.
  S half_periods(S const& u) const { return endless_ ? S(0.0) : nearest_integer(u * over_half_); }
  /// pi u / (2 K). Only if not endless().
  S phase(S const& u) const { return u * scale_; }

  /// From sine and cosine of phase(u).
  POLHODE_INLINE Sncndn<S> at_phase(S const& sine, S const& cosine) const {
    S const one(1.0);
    S sn = sine, cn = cosine, dn = one;
    for (std::size_t i = size_; i-- > 0;) {
      S const k = ladder_[i], x = k * sn * sn;
      S const over = one / (one + x);
      sn = (one + k) * sn * over;
      cn = cn * dn * over;
      dn = (one - x) * over;
    }
    return {sn, cn, dn};
  }
  /// From e^-|u| and the sign of u. Only if endless().
  POLHODE_INLINE Sncndn<S> at_decay(S const& decay, S const& sign) const {
    S const square = decay * decay, over = S(1.0) / (S(1.0) + square);
    S const sech = S(2.0) * decay * over;
    return {sign * (S(1.0) - square) * over, sech, sech};
  }
  Sncndn<S> operator()(S const& u) const {
    if (endless_) return at_decay(exp(S(-abs_of(u))), sign_of(u));
    return at_phase(sin(phase(u)), cos(phase(u)));
  }

 private:
  static constexpr std::size_t most = 20;  ///< m1 > 1e-4900 needs fewer
  std::array<S, most> ladder_{};           ///< the moduli k_1 > k_2 > ... of the transformation
  std::size_t size_ = 0;
  S quarter_{0.0}, scale_{0.0}, over_half_{0.0};
  bool endless_;
};

}  // namespace polhode::elliptic
