/// Coefficients against the identities that define them, in quadruple precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "integrators/gauss.hpp"
#include "integrators/tableau_dop853.hpp"
#include "integrators/tableaus_verner.hpp"
#include "tests/integrators/rooted_trees.hpp"

namespace polhode {
namespace {

using test::in_quad;
using test::Matrix;
using test::OrderConditions;
using test::Row;

double size(Quad x) {
  return double(fabsq(x));
}
constexpr double rounding = 1e-32;  // fifty units in the last place of 1

Quad power(Quad x, int n) {
  Quad p = 1;
  for (int i = 0; i < n; ++i) p = p * x;
  return p;
}

// ---- Decimals -------------------------------------------------------------------------------------------------------

TEST(Decimal, IsRightInQuadruplePrecision) {
  EXPECT_LT(size((0.1_q).as<Quad>() * 10 - 1), 2e-34);
  EXPECT_LT(size((0.333333333333333333333333333333333333_q).as<Quad>() * 3 - 1), 4e-34);
  EXPECT_LT(size((-12.25_q).as<Quad>() + Quad(49) / 4), 1e-40);
  EXPECT_TRUE((0_q).is_zero());
  EXPECT_EQ((0.1_q).as<double>(), 0.1);
  EXPECT_TRUE((0.8177227988124851838643834157678926_q).value ==
              strtoflt128("0.8177227988124851838643834157678926", nullptr))
      << "to the last bit";
  EXPECT_EQ((0.000802776240922250145361386981080252838_q).as<double>(), 0.000802776240922250145361386981080252838);
}

// ---- Explicit tableaus ----------------------------------------------------------------------------------------------

TEST(RootedTrees, AreAsManyAsThereAre) {
  std::array<int, 10> counts{};
  for (test::Tree const& tree : test::rooted_trees(10)) ++counts[std::size_t(tree.order) - 1];
  EXPECT_EQ(counts, (std::array{1, 1, 2, 4, 9, 20, 48, 115, 286, 719}));
}

/// What rounding leaves of a condition: Verner6 has entries of 200 that cancel.
double rounding_of(Matrix const& a, Row const& weights) {
  auto const sum = [](Row const& row) {
    double total = 0;
    for (Quad entry : row) total += size(entry);
    return total;
  };
  double widest = 1;
  for (Row const& row : a) widest = std::max(widest, sum(row));
  return 3e-34 * widest * std::max(1.0, sum(weights));
}

template <class Tableau>
class ExplicitTableau : public testing::Test {
 public:
  Matrix a = in_quad(Tableau::a);
  Row b = in_quad(Tableau::b), c = in_quad(Tableau::c);
};
using Tableaus = testing::Types<Euler1, Kutta4, DormandPrince5, DormandPrince853, Verner6, Verner7, Verner9>;
TYPED_TEST_SUITE(ExplicitTableau, Tableaus);

TYPED_TEST(ExplicitTableau, IsExplicitAndItsRowsSumToC) {
  for (std::size_t i = 0; i < this->a.size(); ++i) {
    Quad sum = 0;
    for (std::size_t j = 0; j < this->a.size(); ++j) {
      sum += this->a[i][j];
      if (j >= i) {
        EXPECT_EQ(size(this->a[i][j]), 0) << i << ", " << j;
      }
    }
    EXPECT_LT(size(sum - this->c[i]), rounding_of(this->a, {})) << "row " << i;
  }
}

TYPED_TEST(ExplicitTableau, MeetsEveryConditionOfItsOrder) {
  OrderConditions const conditions(this->a, TypeParam::order + 1);
  EXPECT_LT(conditions.defect_up_to(this->b, TypeParam::order), rounding_of(this->a, this->b));
  EXPECT_GT(conditions.defect(this->b, TypeParam::order + 1), 1e-7) << "the order is higher than stated";
}

/// Entries of a that matter to the step, one at a time off by 1e-25.
TYPED_TEST(ExplicitTableau, NoticesAWrongCoefficient) {
  int changed = 0;
  for (std::size_t i = 1; i < this->b.size(); ++i)
    for (std::size_t j = 0; j < i; j += 3) {
      Matrix wrong = this->a;
      if (wrong[i][j] == 0) continue;
      wrong[i][j] += Quad(1e-25);
      EXPECT_GT(OrderConditions(wrong, TypeParam::order).defect_up_to(this->b, TypeParam::order),
                rounding_of(wrong, this->b))
          << i << ", " << j;
      ++changed;
    }
  Row wrong = this->b;
  wrong.back() += Quad(1e-25);
  EXPECT_GT(OrderConditions(this->a, 1).defect(wrong, 1), 9e-26);
  EXPECT_TRUE(changed > 0 || this->b.size() == 1);
}

template <class Tableau>
class PairTableau : public testing::Test {};
using Pairs = testing::Types<DormandPrince5, DormandPrince853, Verner6, Verner7, Verner9>;
TYPED_TEST_SUITE(PairTableau, Pairs);

TYPED_TEST(PairTableau, ErrorRowIsTheDifferenceOfTwoMethods) {
  using T = TypeParam;
  OrderConditions const conditions(test::all_stages<T>(), T::error_order + 1);
  EXPECT_LT(conditions.defect_up_to(in_quad(T::e), T::error_order, 0),
            rounding_of(test::all_stages<T>(), in_quad(T::e)));
  EXPECT_GT(conditions.defect(in_quad(T::e), T::error_order + 1, 0), 1e-6) << "an estimate that is always zero";
}

TEST(DormandPrince853, HasASecondEstimateOfOrderThree) {
  OrderConditions const conditions(in_quad(DormandPrince853::a), 4);
  EXPECT_LT(conditions.defect_up_to(in_quad(DormandPrince853::third), 3, 0), 1e-31);
  EXPECT_GT(conditions.defect(in_quad(DormandPrince853::third), 4, 0), 1e-4);
}

// ---- Gauss ----------------------------------------------------------------------------------------------------------

template <int s>
void expect_gauss_identities() {
  GaussCoefficients const& t = gauss_coefficients(s);
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
  GaussCoefficients const& exact = gauss_coefficients(s);
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

TEST(GaussCoefficients, MeetsItsIdentitiesForOneToEightStages) {
  for_each_stage_count(std::make_integer_sequence<int, 8>{});
}

TEST(GaussCoefficients, TwoStagesByHand) {
  GaussCoefficients const& t = gauss_coefficients(2);
  Quad const root = sqrtq(3) / 6;
  EXPECT_LT(size(t.c[0] - (Quad(0.5) - root)), rounding);
  EXPECT_LT(size(t.a[0][1] - (Quad(0.25) - root)), rounding);
  EXPECT_LT(size(t.a[1][0] - (Quad(0.25) + root)), rounding);
  EXPECT_LT(size(t.b[0] - Quad(0.5)), rounding);
}

}  // namespace
}  // namespace polhode
