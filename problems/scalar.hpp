#pragma once
/// Kinds of number. The only file that knows whether a scalar is a double, a long float or something richer.
///   double     one trajectory
///   Quad       references, 33 digits
///   Dual, Jet  derivatives and power series: dual.hpp, jet.hpp
///   Lanes      several doubles at once: lanes.hpp
/// A problem is a template on its scalar, so the same source runs as each of them.
#include <quadmath.h>

#include <cmath>
#include <concepts>
#include <type_traits>
#include <utility>

/// For the dozen small functions that must vanish into a step. Problem authors never need it: `advance` is flattened.
#define POLHODE_INLINE __attribute__((always_inline)) inline
#define POLHODE_LAMBDA __attribute__((always_inline))

namespace polhode {

/// IEEE binary128: 113 bits, about 33 digits.
__extension__ typedef __float128 Quad;

/// Real: the type of coefficients, parameters and steps.
/// short_series: 53 bits suffice, so the series of the exponential map may stop there.
/// flattened: arithmetic is so cheap that a whole step is worth one function.
/// head_shift: added to and subtracted from a number of size 1, it leaves a head of half the digits.
template <class S>
struct ScalarTraits {
  using Real = S;
  static constexpr bool short_series = false;
  static constexpr bool flattened = false;
  static constexpr double head_shift = 0x1.8p56;
};
template <>
struct ScalarTraits<double> {
  using Real = double;
  static constexpr bool short_series = true;
  static constexpr bool flattened = true;
  static constexpr double head_shift = 0x1.8p26;
};

template <class S>
using Real = typename ScalarTraits<S>::Real;
template <class S>
inline constexpr bool short_series = ScalarTraits<S>::short_series;

/// A number that a problem and a method can compute with.
template <class S>
concept Scalar = std::copyable<S> && std::constructible_from<S, double> && requires(S a, S const b, Real<S> const c) {
  { b + b } -> std::convertible_to<S>;
  { b - b } -> std::convertible_to<S>;
  { b* b } -> std::convertible_to<S>;
  { b / b } -> std::convertible_to<S>;
  { -b } -> std::convertible_to<S>;
  { c* b } -> std::convertible_to<S>;
  a += b;
};

// Named here so that templates in this namespace find them for types without argument-dependent lookup.
inline double sqrt(double x) {
  return std::sqrt(x);
}
inline double sin(double x) {
  return std::sin(x);
}
inline double cos(double x) {
  return std::cos(x);
}
inline double atan2(double y, double x) {
  return std::atan2(y, x);
}
inline Quad sqrt(Quad x) {
  return sqrtq(x);
}
inline Quad sin(Quad x) {
  return sinq(x);
}
inline Quad cos(Quad x) {
  return cosq(x);
}
inline Quad atan2(Quad y, Quad x) {
  return atan2q(y, x);
}
inline double floor(double x) {
  return std::floor(x);
}
inline Quad floor(Quad x) {
  return floorq(x);
}

/// a if the mask is set, else b.
template <class S>
POLHODE_INLINE constexpr S select(bool mask, S const& a, S const& b) {
  return mask ? a : b;
}
POLHODE_INLINE double abs_of(double a) {
  return std::fabs(a);
}
POLHODE_INLINE Quad abs_of(Quad a) {
  return fabsq(a);
}
template <class S>
POLHODE_INLINE S abs_of(S const& a) {
  return select(a < S(0.0), S(-a), a);
}
template <class S>
POLHODE_INLINE S max_of(S const& a, S const& b) {
  return select(a < b, b, a);
}
/// x limited to [low, high].
template <class S>
POLHODE_INLINE S clamp(S const& x, S const& low, S const& high) {
  return select(x < low, low, select(high < x, high, x));
}
/// The sign with sgn(0) = +1.
template <class S>
POLHODE_INLINE S sign_of(S const& x) {
  return select(x < S(0.0), S(-1.0), S(1.0));
}
/// The whole number nearest to x, of two the greater. Of a series or a dual number its value now, a constant.
template <class S>
S nearest_whole(S const& x) {
  if constexpr (std::same_as<S, Real<S>>)
    return floor(x + S(0.5));
  else if constexpr (requires { x.value; })
    return S(floor(x.value + Real<S>(0.5)));
  else
    return S(floor(x[0] + Real<S>(0.5)));
}
/// True everywhere: of a plain number, its truth; of lanes (lanes.hpp), that of all.
POLHODE_INLINE constexpr bool all_of(bool truth) {
  return truth;
}
/// The constant 0: of a dual number or a power series no derivative and no later term either. So it stays what it is.
template <class S>
bool is_nothing(S const& x) {
  return x == S(0.0);
}
/// Neither infinite nor NaN.
template <class S>
POLHODE_INLINE bool is_finite(S const& x) {
  return x - x == S(0.0);
}

/// sum + rest == a + b exactly, sum rounded.  Knuth (1969), TAOCP 2, theorem 4.2.2 B
template <class S>
struct ExactSum {
  S sum, rest;
};
template <class S>
POLHODE_INLINE ExactSum<S> two_sum(S const& a, S const& b) {
  S const sum = a + b;
  S const part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

/// Runs f(0), ..., f(n-1) with the index as a type, so that tables at compile time cost nothing at run time.
template <int n, class F>
POLHODE_INLINE constexpr void unroll(F&& f) {
  [&]<int... i>(std::integer_sequence<int, i...>) POLHODE_LAMBDA {
    (f(std::integral_constant<int, i>{}), ...);
  }
  (std::make_integer_sequence<int, n>{});
}

}  // namespace polhode
