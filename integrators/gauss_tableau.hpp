#pragma once
/// Coefficients of Gauss collocation, for 1 to 8 stages.
/// Sources: Hairer, Lubich & Wanner, Geometric Numerical Integration, II.1.3 (nodes, weights); Hairer & Wanner, Solving
/// ODEs II, IV.5 (matrix by the W-transformation); Antonana, Makazaga & Murua (2017), Numer. Algorithms 76, 861
/// (coefficients mu_ij = a_ij / b_j with mu_ij + mu_ji = 1 exactly).
#include <algorithm>
#include <array>

#include "problems/scalar.hpp"

namespace polhode {

inline constexpr int most_gauss_stages = 8;

/// Nodes c, weights b and matrix a of Gauss with `stages` stages, in quadruple precision, with what its collocation
/// polynomial needs: from slopes f_j at the nodes its derivative is sum_j l_j(x) f_j, l_j Lagrange's polynomials.
///   beyond[j][k]  coefficient of z^(k+1) in the integral of l_j from 1 to 1 + z, over b_j
///   at_start[j]   l_j(0) / b_j
struct GaussCoefficients {
  using Row = std::array<Quad, most_gauss_stages>;

  int stages;
  Row b{}, c{}, at_start{};
  std::array<Row, most_gauss_stages> a{}, beyond{};

  [[gnu::cold]] explicit GaussCoefficients(int s) : stages(s) {
    Row x{};
    auto const n = std::size_t(s);
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = root(int(i));
      Quad const slope = legendre_slope(x[i]);
      c[i] = (x[i] + 1) / 2;
      b[i] = 1 / ((1 - x[i] * x[i]) * slope * slope);
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        Quad sum = c[i];
        for (int k = 1; k < s; ++k) sum += legendre(k, x[j]) * (legendre(k + 1, x[i]) - legendre(k - 1, x[i])) / 2;
        a[i][j] = b[j] * sum;
      }
    for (std::size_t j = 0; j < n; ++j) expand(j);
  }

 private:
  static Quad legendre(int n, Quad x) {
    Quad before = 1, now = x;
    if (n == 0) return before;
    for (int k = 1; k < n; ++k) {
      Quad const next = ((2 * k + 1) * x * now - k * before) / (k + 1);
      before = now;
      now = next;
    }
    return now;
  }
  Quad legendre_slope(Quad x) const {
    return stages * (x * legendre(stages, x) - legendre(stages - 1, x)) / (x * x - 1);
  }
  /// The i-th root of the Legendre polynomial of degree `stages`, ascending, by Newton.
  Quad root(int i) const {
    Quad x = -std::cos(3.14159265358979323846 * (i + 0.75) / (stages + 0.5));
    for (int sweep = 0; sweep < 8; ++sweep) x -= legendre(stages, x) / legendre_slope(x);
    return x;
  }
  /// l_j in powers of z = x - 1, one factor (z + 1 - c_m) / (c_j - c_m) after the other.
  void expand(std::size_t j) {
    Row power{};
    power[0] = 1;
    Quad start = 1;
    std::size_t degree = 0;
    for (std::size_t m = 0; m < std::size_t(stages); ++m) {
      if (m == j) continue;
      Quad const apart = c[j] - c[m];
      ++degree;
      for (std::size_t k = degree + 1; k-- > 0;)
        power[k] = ((k > 0 ? power[k - 1] : 0) + (1 - c[m]) * power[k]) / apart;
      start = start * -c[m] / apart;
    }
    for (std::size_t k = 0; k <= degree; ++k) beyond[j][k] = power[k] / (Quad(double(k + 1)) * b[j]);
    at_start[j] = start / b[j];
  }
};

/// The coefficients of s stages, made once.   1 <= s <= 8
inline GaussCoefficients const& gauss_coefficients(int s) {
  static std::array<GaussCoefficients, most_gauss_stages> const all{
      GaussCoefficients(1), GaussCoefficients(2), GaussCoefficients(3), GaussCoefficients(4),
      GaussCoefficients(5), GaussCoefficients(6), GaussCoefficients(7), GaussCoefficients(8)};
  return all[std::size_t(s - 1)];
}

/// Coefficients in scalar R in the form that keeps the symplecticity condition exactly: mu_ii = 1/2, mu_ij + mu_ji = 1;
/// and symmetry, too: mu_ij = mu_ji of the stages counted from the end.
/// The step uses L_j = (h b_j) f(Y_j), Y_i = y + sum_j mu_ij L_j, y' = y + sum_j L_j: one table, never a and b apart.
///   ahead[i][j]   the last step's collocation polynomial at the stages of an equally long next one, less its end:
///                 sum_j ahead_ij L_j
///   beyond, at_start   as in GaussCoefficients
template <class R, int most = most_gauss_stages>
struct GaussMu {
  using Row = std::array<R, most>;
  using Matrix = std::array<Row, most>;

  Row b, c, at_start;
  Matrix mu, ahead, beyond;

  [[gnu::cold]] explicit GaussMu(int stages = most) {
    GaussCoefficients const& exact = gauss_coefficients(stages);
    auto const n = std::size_t(stages);
    for (std::size_t i = 0; i < n; ++i) {
      b[i] = R(exact.b[std::min(i, n - 1 - i)]);
      c[i] = R(exact.c[i]);
      at_start[i] = R(exact.at_start[i]);
      mu[i][i] = R(0.5);
      for (std::size_t j = 0; j < i; ++j) {
        // Below the diagonal, i + j = n - 1 is the axis of symmetry.
        bool const mirrored = i + j >= n;
        std::size_t const row = mirrored ? n - 1 - j : i, column = mirrored ? n - 1 - i : j;
        mu[i][j] = R(exact.a[row][column] / exact.b[column]);
        mu[j][i] = R(1.0) - mu[i][j];
      }
      for (std::size_t j = 0; j < n; ++j) {
        ahead[i][j] = R(polynomial(exact.beyond[j], n, exact.c[i]));
        beyond[i][j] = R(exact.beyond[i][j]);
      }
    }
  }

  /// The same for a next step `ratio` times as long.
  [[gnu::noinline]] void ahead_of(R const& ratio, std::size_t stages, Matrix& weights) const {
    for (std::size_t i = 0; i < stages; ++i)
      for (std::size_t j = 0; j < stages; ++j) weights[i][j] = polynomial(beyond[j], stages, R(ratio * c[i]));
  }

 private:
  /// z p_0 + z^2 p_1 + ... + z^n p_(n-1).
  template <class T, class Coefficients>
  static T polynomial(Coefficients const& p, std::size_t n, T const& z) {
    T sum(0.0);
    for (std::size_t k = n; k-- > 0;) sum = (sum + p[k]) * z;
    return sum;
  }
};

}  // namespace polhode
