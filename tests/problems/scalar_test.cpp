/// Scalars: exact sums, dual numbers and power series against closed forms.
#include "problems/scalar.hpp"

#include <gtest/gtest.h>

#include <thread>

#include <cmath>

#include "problems/dual.hpp"
#include "problems/jet.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::Random;

TEST(TwoSum, SumAndRestAreExactlyTheSum) {
  Random random(1);
  int with_rest = 0;
  for (int i = 0; i < 10'000; ++i) {
    double const a = random.uniform(-1, 1) * std::pow(10, random.uniform(-8, 8));
    double const b = random.uniform(-1, 1) * std::pow(10, random.uniform(-8, 8));
    auto const exact = two_sum(a, b);
    EXPECT_EQ(exact.sum, a + b);
    EXPECT_TRUE(Quad(exact.sum) + Quad(exact.rest) == Quad(a) + Quad(b));  // 113 bits hold the exact sum here
    with_rest += exact.rest != 0 ? 1 : 0;
  }
  EXPECT_GT(with_rest, 5000);
}

TEST(TwoSum, ByHand) {
  auto const exact = two_sum(1.0, 0x1p-60);
  EXPECT_EQ(exact.sum, 1.0);
  EXPECT_EQ(exact.rest, 0x1p-60);
  auto const other_order = two_sum(0x1p-60, 1.0);
  EXPECT_EQ(other_order.sum, 1.0);
  EXPECT_EQ(other_order.rest, 0x1p-60);
}

TEST(Scalars, SelectClampAndSign) {
  EXPECT_EQ(sign_of(0.0), 1.0);
  EXPECT_EQ(sign_of(-3.0), -1.0);
  EXPECT_EQ(clamp(7.0, -5.0, 5.0), 5.0);
  EXPECT_EQ(clamp(-7.0, -5.0, 5.0), -5.0);
  EXPECT_EQ(clamp(0.3, -5.0, 5.0), 0.3);
  EXPECT_TRUE(is_finite(1e308));
  EXPECT_FALSE(is_finite(std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(is_finite(std::numeric_limits<double>::quiet_NaN()));
}

// ---- Dual numbers ---------------------------------------------------------------------------------------------------

using D = Dual<2>;
D variable(double value, int which) {
  D x(value);
  x.slope[std::size_t(which)] = 1;
  return x;
}
constexpr double few_ulp = 1e-15;

TEST(Duals, EveryOperationHasItsClosedFormDerivative) {
  double const a = 0.8, b = -1.7;
  D const x = variable(a, 0), y = variable(b, 1);
  struct Case {
    char const* what;
    D result;
    double value, by_x, by_y;
  };
  double const r2 = a * a + b * b;
  for (Case const& c : {Case{"x + y", x + y, a + b, 1, 1},
                        {"x - y", x - y, a - b, 1, -1},
                        {"x y", x * y, a * b, b, a},
                        {"2 x", 2.0 * x, 2 * a, 2, 0},
                        {"-x", -x, -a, -1, 0},
                        {"x / y", x / y, a / b, 1 / b, -a / (b * b)},
                        {"sqrt x", sqrt(x), std::sqrt(a), 0.5 / std::sqrt(a), 0},
                        {"sin x", sin(x), std::sin(a), std::cos(a), 0},
                        {"cos x", cos(x), std::cos(a), -std::sin(a), 0},
                        {"atan2(y, x)", atan2(y, x), std::atan2(b, a), -b / r2, a / r2},
                        {"|y|", abs_of(y), -b, 0, -1},
                        {"max(x, y)", max_of(x, y), a, 1, 0}}) {
    EXPECT_NEAR(c.result.value, c.value, few_ulp) << c.what;
    EXPECT_NEAR(c.result.slope[0], c.by_x, few_ulp) << c.what;
    EXPECT_NEAR(c.result.slope[1], c.by_y, few_ulp) << c.what;
  }
}

TEST(Duals, ChainRule) {
  double const a = 0.4;
  D const y = sin(sqrt(variable(a, 0) * variable(a, 0) + D(1.0)));
  double const r = std::sqrt(a * a + 1);
  EXPECT_NEAR(y.slope[0], std::cos(r) * a / r, few_ulp);
}

// ---- Power series ---------------------------------------------------------------------------------------------------

constexpr int degree = 20;
using J = Jet<Quad, degree>;
constexpr double quad_rounding = 1e-31;  // a hundred units in the last place: sums of 20 terms

/// c0 + c1 t, known to the full degree.
J line(double c0, double c1) {
  J x{Quad(c0)};
  x.degree = degree;
  x[1] = Quad(c1);
  return x;
}
void expect_coefficients(J const& series, auto closed_form, char const* what) {
  ASSERT_EQ(series.degree, degree) << what;
  for (int k = 0; k <= degree; ++k) {
    Quad const expected = closed_form(k);
    double const scale = std::max(1.0, std::fabs(double(expected)));
    EXPECT_LT(std::fabs(double(series[k] - expected)), quad_rounding * scale) << what << ", coefficient " << k;
  }
}
Quad power(Quad x, int n) {
  Quad p = 1;
  for (int i = 0; i < n; ++i) p = p * x;
  return p;
}
Quad factorial(int n) {
  Quad f = 1;
  for (int i = 2; i <= n; ++i) f = f * Quad(i);
  return f;
}
/// The k-th derivative of the sine at x.
Quad sine_derivative(Quad x, int k) {
  Quad const values[] = {sinq(x), cosq(x), -sinq(x), -cosq(x)};
  return values[k % 4];
}

TEST(Jets, GeometricSeriesIsADivision) {
  expect_coefficients(
      J(1.0) / line(1, -0.5), [](int k) { return power(Quad(0.5), k); }, "1 / (1 - t/2)");
}

TEST(Jets, BinomialSeriesIsASquareRoot) {
  Quad coefficient = 1;  // binomial(1/2, k)
  expect_coefficients(
      sqrt(line(1, 1)),
      [&](int k) {
        if (k > 0) coefficient = coefficient * (Quad(1.5) - Quad(k)) / Quad(k);
        return coefficient;
      },
      "sqrt(1 + t)");
}

TEST(Jets, SineAndCosine) {
  J const x = line(0.75, 2);
  expect_coefficients(
      sin(x), [](int k) { return power(2, k) * sine_derivative(Quad(0.75), k) / factorial(k); }, "sin(.75 + 2 t)");
  expect_coefficients(
      cos(x), [](int k) { return power(2, k) * sine_derivative(Quad(0.75), k + 1) / factorial(k); }, "cos(.75 + 2 t)");
}

TEST(Jets, ArcTangentInvertsSineAndCosine) {
  J const x = line(0.75, 2);
  expect_coefficients(
      atan2(sin(x), cos(x)), [](int k) { return k == 0   ? Quad(0.75)
                                                : k == 1 ? Quad(2.0)
                                                         : Quad(0.0); },
      "atan2(sin x, cos x)");
}

TEST(Jets, ArcTangentOfALineOverAConstant) {
  J const y = line(0, 1);
  expect_coefficients(
      atan2(y, J(1.0)), [](int k) { return k % 2 == 0 ? Quad(0.0) : (k % 4 == 1 ? Quad(1.0) : -Quad(1.0)) / Quad(k); },
      "atan t");
}

TEST(Jets, ProductsAndConstants) {
  J const square = line(3, 1) * line(3, 1);
  EXPECT_TRUE(square[0] == 9 && square[1] == 6 && square[2] == 1 && square[3] == 0);
  EXPECT_EQ((J(2.0) * J(3.0)).degree, 0);
  EXPECT_EQ((J(2.0) * line(3, 1)).degree, degree);
  EXPECT_TRUE((J(2.0) * line(3, 1))[1] == 2);
  EXPECT_TRUE(square.at(Quad(0.5)) == Quad(12.25));
}

// What taylor.hpp does: the same expressions on ever longer jets.
TEST(Jets, RememberedResultsAreThoseOfAFreshStart) {
  auto const expressions = [](J const& x) {
    J const y = x * x / (J(2.0) + x) - sqrt(J(3.0) + x * x);
    return atan2(y, J(1.0) + x) + (x[0] > 0.5 ? x * y : y * y / x);
  };
  J x(Quad(0.25));
  for (int k = 1; k <= degree; ++k) x[k] = Quad(1.0) / (3 + k * k);
  typename J::Memory memory;
  for (Quad start : {Quad(0.25), Quad(0.75), Quad(0.25)})  // other values, then the other branch: nothing old is used
    for (int k = 1; k <= degree; ++k) {
      x[0] = start;
      x.degree = k;
      memory.rewind();
      J const remembered = expressions(x);
      J fresh;
      std::thread([&] { fresh = expressions(x); }).join();  // another thread has no memory
      ASSERT_EQ(remembered.degree, fresh.degree);
      for (int j = 0; j <= k; ++j) EXPECT_TRUE(remembered[j] == fresh[j]) << j << " of " << k;
    }
}

TEST(Jets, ComparisonsSeeTheConstantTerm) {
  EXPECT_TRUE(line(1, 5) < line(2, -5));
  EXPECT_FALSE(line(2, -5) < line(1, 5));
  EXPECT_TRUE(line(1, 5) == line(1, -5));
}

}  // namespace
}  // namespace polhode
