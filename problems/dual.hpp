#pragma once
/// A value and N directional derivatives: Jacobians of any problem, and the laws of a space, without differencing.
/// Source: Griewank & Walther (2008), Evaluating Derivatives, ch. 3
#include <array>

#include "problems/scalar.hpp"

namespace polhode {

/// A number and its derivatives in N directions.
template <int N>
struct Dual {
  double value = 0;
  std::array<double, N> slope{};

  Dual() = default;
  Dual(double x) : value(x) {}

  /// slope_of(i) is the i-th derivative.
  template <class F>
  static Dual of(double value, F slope_of) {
    Dual r(value);
    for (int i = 0; i < N; ++i) r.slope[std::size_t(i)] = slope_of(std::size_t(i));
    return r;
  }

  friend Dual operator+(Dual const& x, Dual const& y) {
    return of(x.value + y.value, [&](std::size_t i) { return x.slope[i] + y.slope[i]; });
  }
  friend Dual operator-(Dual const& x, Dual const& y) {
    return of(x.value - y.value, [&](std::size_t i) { return x.slope[i] - y.slope[i]; });
  }
  friend Dual operator*(Dual const& x, Dual const& y) {
    return of(x.value * y.value, [&](std::size_t i) { return x.value * y.slope[i] + y.value * x.slope[i]; });
  }
  friend Dual operator*(double c, Dual const& y) {
    return of(c * y.value, [&](std::size_t i) { return c * y.slope[i]; });
  }
  friend Dual operator/(Dual const& x, Dual const& y) {
    double const q = x.value / y.value;
    return of(q, [&](std::size_t i) { return (x.slope[i] - q * y.slope[i]) / y.value; });
  }
  friend Dual operator-(Dual const& x) { return -1.0 * x; }
  Dual& operator+=(Dual const& y) { return *this = *this + y; }
  friend bool operator<(Dual const& x, Dual const& y) { return x.value < y.value; }
  friend bool operator==(Dual const& x, Dual const& y) { return x.value == y.value; }
  friend bool is_nothing(Dual const& x) { return x.value == 0 && x.slope == std::array<double, N>{}; }

  friend Dual sqrt(Dual const& x) {
    double const r = std::sqrt(x.value);
    return of(r, [&](std::size_t i) { return x.slope[i] / (2 * r); });
  }
  friend Dual sin(Dual const& x) {
    double const c = std::cos(x.value);
    return of(std::sin(x.value), [&](std::size_t i) { return c * x.slope[i]; });
  }
  friend Dual cos(Dual const& x) {
    double const s = std::sin(x.value);
    return of(std::cos(x.value), [&](std::size_t i) { return -s * x.slope[i]; });
  }
  friend Dual atan2(Dual const& y, Dual const& x) {
    double const r2 = x.value * x.value + y.value * y.value;
    return of(std::atan2(y.value, x.value),
              [&](std::size_t i) { return (x.value * y.slope[i] - y.value * x.slope[i]) / r2; });
  }
};
template <int N>
struct ScalarTraits<Dual<N>> {
  using Real = double;
  static constexpr bool short_series = true;
  static constexpr bool flattened = false;
};

}  // namespace polhode
