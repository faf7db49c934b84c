#pragma once
/// The angle of a rotation, and the angle over its sine, from the square of the sine and the cosine: what control laws
/// steer by.
#include "problems/arctangent.hpp"
#include "problems/scalar.hpp"

namespace polhode {

/// Up to which square of the tangent atan_over() holds: 10 deg.
inline constexpr double near_angle = 0.03;
/// atan(t) / t of w = t^2 <= near_angle, within 1 ulp: ten terms of the series, summed in pairs (Estrin), which takes a
/// third of the time of Horner's chain.
template <class S>
POLHODE_INLINE S atan_over(S const& w) {
  S const w2 = w * w, w4 = w2 * w2;
  S const a = (S(1.0) - S(1. / 3) * w) + w2 * (S(1. / 5) - S(1. / 7) * w);
  S const b = (S(1. / 9) - S(1. / 11) * w) + w2 * (S(1. / 13) - S(1. / 15) * w);
  return a + w4 * (b + w4 * (S(1. / 17) - S(1. / 19) * w));
}

/// theta over the sine of theta, from sine^2 = z and cosine = c. Of a matrix that has drifted sine and cosine are both
/// too large or too small: theta is that of their ratio. Smooth through 0: in doubles below 10 deg by atan_over(), in
/// other scalars below 7 deg by the series of 4 atan(tan(theta / 4)).
template <class S>
S angle_over_sine(S const& z, S const& c) {
  using R = Real<S>;
  if constexpr (short_series<S>)
    if (S(0.0) < c && z < S(near_angle) * c * c) [[likely]]
      return atan_over(z / (c * c)) * (S(1.0) / c);  // two quotients at once
  if (short_series<S> || !(S(0.0) < c) || S(0.015) * c * c < z) {
    S const sine = sqrt(z);
    return atan2(sine, c) / sine;
  }
  S const one(1.0), half = one / (sqrt(z + c * c) + c);          // tan(theta / 2) over the sine
  S const quarter = half / (one + sqrt(one + z * half * half));  // tan(theta / 4) over the sine
  S const y = z * quarter * quarter;                             // below 1e-3
  S series(0.0);
  for (int k = 11; k >= 0; --k) series = S(R(1.0) / R(double(2 * k + 1))) - y * series;
  return R(4.0) * quarter * series;
}

/// theta, and theta over its sine, 0 if the sine is.
template <class S>
struct AngleAndSine {
  S angle, over_sine;
};
/// Of sine^2 = z and cosine = c, which may both have drifted. Doubles, and lanes of doubles with the same bits: below
/// 10 deg by atan_over() without a square root in the way, in a third of the time; within 2 ulp. Other scalars:
/// atan2.
template <class S>
POLHODE_INLINE AngleAndSine<S> angle_and_sine(S const& z, S const& c) {
  constexpr bool is_lanes = !std::same_as<decltype(z < z), bool>;
  if constexpr (!is_lanes && !std::same_as<S, double>) {
    S const sine = S(0.0) < z ? S(sqrt(z)) : S(0.0);  // a series has no square root at 0
    S const angle = atan2(sine, c);
    return {angle, S(0.0) < sine ? S(angle / sine) : S(0.0)};
  } else {
    S const sine = sqrt(z);
    auto const near_over = [&]() POLHODE_LAMBDA { return atan_over<S>(z / (c * c)) * (S(1.0) / c); };
    auto const near = (S(0.0) < c) & (z < S(near_angle) * c * c);
    if (all_of(near)) [[likely]] {
      S const over = near_over();
      return {over * sine, over};
    }
    S const angle = arctangent(sine, c), over = angle / select(S(0.0) < sine, sine, S(1.0));
    if constexpr (is_lanes) {
      S const closer = near_over();
      return {select(near, closer * sine, angle), select(near, closer, over)};
    }
    return {angle, over};
  }
}

}  // namespace polhode
