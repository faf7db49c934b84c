#pragma once
/// A truncated power series in time. Evaluating a problem on jets gives the Taylor coefficients of its solution:
/// x_{k+1} = f(x)_k / (k + 1).   Source: Jorba & Zou (2005), Experimental Mathematics 14, sec. 2.
/// A jet of degree 0 is a constant; an operation has the higher degree of its operands, never above `most`.
#include <array>

#include "problems/scalar.hpp"

namespace polhode {

template <class R, int most>
struct Jet {
  std::array<R, most + 1> c{};  ///< coefficients of 1, t, t^2, ..., c[degree]
  int degree = 0;

  Jet() = default;
  Jet(R const& constant) { c[0] = constant; }
  Jet(double constant) requires(!std::same_as<R, double>) { c[0] = R(constant); }

  R const& operator[](int k) const { return c[std::size_t(k)]; }
  R& operator[](int k) { return c[std::size_t(k)]; }

  /// The value at time t after the centre.
  R at(R const& t) const {
    R sum = c[std::size_t(degree)];
    for (int k = degree - 1; k >= 0; --k) sum = sum * t + (*this)[k];
    return sum;
  }
  /// coefficient(k) for k = 0 .. degree, in order.
  template <class F>
  static Jet of(int degree, F coefficient) {
    Jet r;
    r.degree = degree;
    for (int k = 0; k <= degree; ++k) r[k] = coefficient(k);
    return r;
  }

  friend Jet operator+(Jet const& x, Jet const& y) {
    return of(std::max(x.degree, y.degree), [&](int k) { return x[k] + y[k]; });
  }
  friend Jet operator-(Jet const& x, Jet const& y) {
    return of(std::max(x.degree, y.degree), [&](int k) { return x[k] - y[k]; });
  }
  friend Jet operator-(Jet const& x) {
    return of(x.degree, [&](int k) { return -x[k]; });
  }
  friend Jet operator*(R const& a, Jet const& x) {
    return of(x.degree, [&](int k) { return a * x[k]; });
  }
  friend Jet operator*(Jet const& x, Jet const& y) {
    if (x.degree == 0) return x[0] * y;
    if (y.degree == 0) return y[0] * x;
    return of(std::max(x.degree, y.degree), [&](int k) {
      R sum = x[0] * y[k];
      for (int j = 1; j <= k; ++j) sum += x[j] * y[k - j];
      return sum;
    });
  }
  friend Jet operator/(Jet const& x, Jet const& y) {
    Jet q;
    q.degree = std::max(x.degree, y.degree);
    for (int k = 0; k <= q.degree; ++k) {
      R sum = x[k];
      for (int j = 1; j <= k; ++j) sum = sum - y[j] * q[k - j];
      q[k] = sum / y[0];
    }
    return q;
  }
  Jet& operator+=(Jet const& y) { return *this = *this + y; }
  friend bool operator<(Jet const& x, Jet const& y) { return x[0] < y[0]; }
  friend bool operator==(Jet const& x, Jet const& y) { return x[0] == y[0]; }

  friend Jet sqrt(Jet const& x) {
    Jet r;
    r.degree = x.degree;
    r[0] = sqrt(x[0]);
    for (int k = 1; k <= x.degree; ++k) {
      R sum = x[k];
      for (int j = 1; j < k; ++j) sum = sum - r[j] * r[k - j];
      r[k] = sum / (R(2.0) * r[0]);
    }
    return r;
  }
  friend Jet sin(Jet const& x) { return sin_and_cos(x).first; }
  friend Jet cos(Jet const& x) { return sin_and_cos(x).second; }
  /// theta' = (x y' - y x') / (x^2 + y^2).
  friend Jet atan2(Jet const& y, Jet const& x) {
    Jet theta;
    theta.degree = std::max(x.degree, y.degree);
    theta[0] = atan2(y[0], x[0]);
    if (theta.degree == 0) return theta;
    Jet const slope = (x * y.derivative() - y * x.derivative()) / (x * x + y * y);
    for (int k = 1; k <= theta.degree; ++k) theta[k] = slope[k - 1] / R(double(k));
    return theta;
  }

  /// The series of the time derivative, one coefficient short: the last is 0.
  Jet derivative() const {
    return of(degree, [&](int k) { return k < degree ? R(double(k + 1)) * (*this)[k + 1] : R(0.0); });
  }

 private:
  friend std::pair<Jet, Jet> sin_and_cos(Jet const& x) {
    Jet s, c;
    s.degree = c.degree = x.degree;
    s[0] = sin(x[0]);
    c[0] = cos(x[0]);
    for (int k = 1; k <= x.degree; ++k) {
      R ds(0.0), dc(0.0);
      for (int j = 1; j <= k; ++j) {
        ds += R(double(j)) * x[j] * c[k - j];
        dc += R(double(j)) * x[j] * s[k - j];
      }
      s[k] = ds / R(double(k));
      c[k] = -dc / R(double(k));
    }
    return {s, c};
  }
};
template <class R, int most>
struct ScalarTraits<Jet<R, most>> {
  using Real = R;
  static constexpr bool short_series = false;
  static constexpr bool flattened = false;
};

}  // namespace polhode
