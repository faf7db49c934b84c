/// Coefficients against the identities that define them, in quadruple precision.
#include <gtest/gtest.h>

#include <array>

#include "integrators/gauss.hpp"
#include "integrators/tableaus.hpp"

namespace polhode {
namespace {

double size(Quad x) {
  return double(fabsq(x));
}
constexpr double rounding = 1e-32;  // fifty units in the last place of 1

Quad power(Quad x, int n) {
  Quad p = 1;
  for (int i = 0; i < n; ++i) p = p * x;
  return p;
}

// ---- Explicit tableaus ----------------------------------------------------------------------------------------------

/// Order conditions as far as order 5's simplest: weight . expression(stages) = value.  Hairer-Norsett-Wanner I, II.2
struct Condition {
  int order;
  char const* tree;
  Quad value;
  Quad sum;
};

/// The conditions of the weights `b` on the matrix `a` of n stages.
template <std::size_t n>
std::vector<Condition> conditions(std::array<std::array<Quad, n>, n> const& a, std::array<Quad, n> const& b) {
  std::array<Quad, n> c{}, ac{}, ac2{}, aac{};
  auto const times = [&](auto const& v) {
    std::array<Quad, n> result{};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) result[i] += a[i][j] * v[j];
    return result;
  };
  std::array<Quad, n> one{}, c2{};
  one.fill(1);
  c = times(one);
  for (std::size_t i = 0; i < n; ++i) c2[i] = c[i] * c[i];
  ac = times(c);
  ac2 = times(c2);
  aac = times(ac);
  auto const sum = [&](auto term) {
    Quad total = 0;
    for (std::size_t i = 0; i < n; ++i) total += b[i] * term(i);
    return total;
  };
  return {{1, "1", 1, sum([&](std::size_t) { return Quad(1); })},
          {2, "c", Quad(1) / 2, sum([&](std::size_t i) { return c[i]; })},
          {3, "c^2", Quad(1) / 3, sum([&](std::size_t i) { return c2[i]; })},
          {3, "a c", Quad(1) / 6, sum([&](std::size_t i) { return ac[i]; })},
          {4, "c^3", Quad(1) / 4, sum([&](std::size_t i) { return c2[i] * c[i]; })},
          {4, "c a c", Quad(1) / 8, sum([&](std::size_t i) { return c[i] * ac[i]; })},
          {4, "a c^2", Quad(1) / 12, sum([&](std::size_t i) { return ac2[i]; })},
          {4, "a a c", Quad(1) / 24, sum([&](std::size_t i) { return aac[i]; })},
          {5, "c^4", Quad(1) / 5, sum([&](std::size_t i) { return c2[i] * c2[i]; })},
          {5, "(a c)^2", Quad(1) / 20, sum([&](std::size_t i) { return ac[i] * ac[i]; })}};
}

template <class Tableau>
class ExplicitTableau : public testing::Test {
 public:
  static constexpr std::size_t n = Tableau::stages;
  std::array<std::array<Quad, n>, n> a{};
  std::array<Quad, n> b{}, c{};

  ExplicitTableau() {
    for (std::size_t i = 0; i < n; ++i) {
      b[i] = Tableau::b[i].template as<Quad>();
      c[i] = Tableau::c[i].template as<Quad>();
      for (std::size_t j = 0; j < n; ++j) a[i][j] = Tableau::a[i][j].template as<Quad>();
    }
  }
};
using Tableaus = testing::Types<Euler1, Kutta4, DormandPrince5>;
TYPED_TEST_SUITE(ExplicitTableau, Tableaus);

TYPED_TEST(ExplicitTableau, IsExplicitAndItsRowsSumToC) {
  for (std::size_t i = 0; i < this->n; ++i) {
    Quad sum = 0;
    for (std::size_t j = 0; j < this->n; ++j) {
      sum += this->a[i][j];
      if (j >= i) {
        EXPECT_EQ(size(this->a[i][j]), 0) << i << ", " << j;
      }
    }
    EXPECT_LT(size(sum - this->c[i]), rounding) << "row " << i;
  }
}

TYPED_TEST(ExplicitTableau, MeetsEveryConditionOfItsOrder) {
  bool misses_the_next = false;
  for (Condition const& condition : conditions(this->a, this->b)) {
    double const error = size(condition.sum - condition.value);
    if (condition.order <= TypeParam::order) {
      EXPECT_LT(error, rounding) << condition.tree;
    }
    if (condition.order == TypeParam::order + 1) misses_the_next = misses_the_next || error > 1e-3;
  }
  if (TypeParam::order < 5) {
    EXPECT_TRUE(misses_the_next) << "the order is higher than stated";
  }
}

TEST(DormandPrince, ErrorRowIsTheDifferenceOfTwoMethods) {
  using T = DormandPrince5;
  // Seven stages: the last is f at the step's end, so its row is b.
  std::array<std::array<Quad, 7>, 7> a{};
  std::array<Quad, 7> e{};
  Quad total = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    e[i] = T::e[i].as<Quad>();
    total += e[i];
    for (std::size_t j = 0; j < 6; ++j) a[i][j] = i < 6 ? T::a[i][j].as<Quad>() : T::b[j].as<Quad>();
  }
  EXPECT_LT(size(total), rounding);
  bool sees_order_5 = false;
  for (Condition const& condition : conditions(a, e)) {
    if (condition.order <= T::error_order) {
      EXPECT_LT(size(condition.sum), rounding) << condition.tree;
    }
    if (condition.order == 5) sees_order_5 = sees_order_5 || size(condition.sum) > 1e-4;
  }
  EXPECT_TRUE(sees_order_5) << "an estimate that is always zero";
}

// ---- Gauss ----------------------------------------------------------------------------------------------------------

template <int s>
void expect_gauss_identities() {
  GaussTableau<s> const t;
  for (int k = 1; k <= 2 * s; ++k) {  // B(2s): the quadrature is exact to degree 2s - 1
    Quad sum = 0;
    for (std::size_t i = 0; i < s; ++i) sum += t.b[i] * power(t.c[i], k - 1);
    EXPECT_LT(size(sum - Quad(1) / k), rounding) << "B(" << k << "), s = " << s;
  }
  for (std::size_t i = 0; i < s; ++i) {
    for (int k = 1; k <= s; ++k) {  // C(s); k = 1 says that the rows sum to c
      Quad sum = 0;
      for (std::size_t j = 0; j < s; ++j) sum += t.a[i][j] * power(t.c[j], k - 1);
      EXPECT_LT(size(sum - power(t.c[i], k) / k), rounding) << "C(" << k << "), s = " << s;
    }
    EXPECT_LT(size(t.c[i] + t.c[s - 1 - i] - 1), rounding) << "nodes lie symmetrically, s = " << s;
    EXPECT_LT(size(t.b[i] - t.b[s - 1 - i]), rounding) << "and so do the weights, s = " << s;
    if (i > 0) {
      EXPECT_LT(double(t.c[i - 1]), double(t.c[i]));
    }
    for (std::size_t j = 0; j < s; ++j)
      EXPECT_LT(size(t.b[i] * t.a[i][j] + t.b[j] * t.a[j][i] - t.b[i] * t.b[j]), rounding) << "symplectic, s = " << s;
  }
}

template <int s>
void expect_exact_mu() {
  GaussMu<double, s> const rounded;
  GaussTableau<s> const exact;
  for (std::size_t i = 0; i < s; ++i) {
    EXPECT_EQ(rounded.mu[i][i], 0.5);
    for (std::size_t j = 0; j < s; ++j) {
      // Widened to quadruple precision the sum of two doubles is exact: not even the last bit may be missing.
      EXPECT_TRUE(Quad(rounded.mu[i][j]) + Quad(rounded.mu[j][i]) == 1) << s << " stages, " << i << ", " << j;
      EXPECT_LT(size(rounded.mu[i][j] - exact.a[i][j] / exact.b[j]), 2.3e-16);
    }
    EXPECT_EQ(rounded.b[i], double(exact.b[i]));
    EXPECT_EQ(rounded.c[i], double(exact.c[i]));
  }
}

template <int... s>
void for_each_stage_count(std::integer_sequence<int, s...>) {
  (expect_gauss_identities<s + 1>(), ...);
  (expect_exact_mu<s + 1>(), ...);
}

TEST(GaussTableau, MeetsItsIdentitiesForOneToEightStages) {
  for_each_stage_count(std::make_integer_sequence<int, 8>{});
}

TEST(GaussTableau, TwoStagesByHand) {
  GaussTableau<2> const t;
  Quad const root = sqrtq(3) / 6;
  EXPECT_LT(size(t.c[0] - (Quad(0.5) - root)), rounding);
  EXPECT_LT(size(t.a[0][1] - (Quad(0.25) - root)), rounding);
  EXPECT_LT(size(t.a[1][0] - (Quad(0.25) + root)), rounding);
  EXPECT_LT(size(t.b[0] - Quad(0.5)), rounding);
}

}  // namespace
}  // namespace polhode
