/// Gauss collocation: its coefficients to the last bit, one result whoever calls it, starting values, symmetry in time.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/gauss.hpp"
#include "problems/erased.hpp"
#include "problems/free_body.hpp"
#include "problems/heavy_top.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

// ---- Coefficients ---------------------------------------------------------------------------------------------------

template <class R>
void expect_exact_coefficients() {
  for (int stages = 1; stages <= 8; ++stages) {
    GaussMu<R> const table(stages);
    auto const s = std::size_t(stages);
    for (std::size_t i = 0; i < s; ++i) {
      std::size_t const mirror = s - 1 - i;
      EXPECT_TRUE(table.b[i] == table.b[mirror]) << stages;
      EXPECT_TRUE(table.c[i] + table.c[mirror] == R(1.0)) << stages;
      for (std::size_t j = 0; j < s; ++j) {
        auto const [sum, rest] = two_sum(table.mu[i][j], table.mu[j][i]);
        EXPECT_TRUE(sum == R(1.0) && rest == R(0.0)) << stages << ", " << i << ", " << j;
        EXPECT_TRUE(table.mu[mirror][s - 1 - j] == table.mu[j][i]) << stages << ", " << i << ", " << j;
      }
    }
  }
}

TEST(GaussCoefficients, AreSymplecticAndSymmetricToTheLastBit) {
  expect_exact_coefficients<double>();
  expect_exact_coefficients<Quad>();
}

Quad power(Quad x, int k) {
  Quad p = 1;
  for (int i = 0; i < k; ++i) p *= x;
  return p;
}

TEST(GaussCoefficients, ContinuePolynomialsExactly) {
  for (int stages = 1; stages <= 8; ++stages) {
    GaussMu<Quad> const table(stages);
    auto const s = std::size_t(stages);
    for (Quad ratio : {Quad(1), Quad(0.3), Quad(2)}) {
      GaussMu<Quad>::Matrix ahead;
      table.ahead_of(ratio, s, ahead);
      for (int degree = 0; degree < stages; ++degree)
        for (std::size_t i = 0; i < s; ++i) {
          Quad sum = 0, equal = 0, start = 0;  // y' = x^degree on the last step, [0, 1]
          for (std::size_t j = 0; j < s; ++j) {
            Quad const increment = table.b[j] * power(table.c[j], degree);
            sum += ahead[i][j] * increment;
            equal += table.ahead[i][j] * increment;
            start += table.at_start[j] * increment;
          }
          Quad const wanted = (power(1 + ratio * table.c[i], degree + 1) - 1) / (degree + 1);
          EXPECT_LT(double(fabsq(sum - wanted) / wanted), 1e-27) << stages << ", degree " << degree;
          EXPECT_LT(double(fabsq(start - (degree == 0 ? 1 : 0))), 1e-28) << stages << ", degree " << degree;
          if (ratio == 1) {
            EXPECT_LT(double(fabsq(equal - wanted) / wanted), 1e-27) << stages << ", degree " << degree;
          }
        }
    }
  }
}

// ---- One result -----------------------------------------------------------------------------------------------------

/// Where twenty steps of h seconds end: typed and erased, in one advance and in twenty.
template <class P>
void expect_one_result(P const& problem, double h) {
  using M = typename P::Space;
  using S = typename M::Scalar;
  for (int stages = 1; stages <= 8; ++stages) {
    auto const erased = erase_type(problem);
    auto x = problem.initial(), y = x;
    auto typed = GaussOf{stages}.bind(problem, FixedStep{h}, NormPolicy::none);
    auto counted = GaussOf{stages}.bind(*erased, FixedStep{h}, NormPolicy::none);
    EXPECT_EQ(typed.advance(x, 0, 20 * Real<S>(h)), Status::ok) << stages;
    for (int i = 0; i < 20; ++i) EXPECT_EQ(counted.advance(y, i * Real<S>(h), (i + 1) * Real<S>(h)), Status::ok);
    EXPECT_EQ(double(distance<S>(x, y)), 0) << stages;
    EXPECT_EQ(typed.work().iterations, counted.work().iterations) << stages;
    EXPECT_EQ(erased->evaluations(), 1 + stages * *counted.work().iterations) << stages;
  }
}

TEST(Gauss, EndsOnTheSameBitsForTypedAndErasedFields) {
  expect_one_result(PdSlew(Choice{}).field<double, FlatQuaternion, true>(), 0.125);
  expect_one_result(PdSlew(Choice{}).field<double, S3, true>(), 0.125);
  expect_one_result(HeavyTop(Choice{.words = {"potential"}, .set = {}}).field<double, SO3, true>(), 0.0625);
  expect_one_result(FreeBody(Choice{}).field<Quad, FlatQuaternion, true>(), 0.25);
  expect_one_result(PdSlew(Choice{}).field<Quad, S3, true>(), 0.25);
  expect_one_result(QuaternionSync(Choice{}).field<double, FlatQuaternion, true>(), 0.0625);
}

// ---- Starting values ------------------------------------------------------------------------------------------------

/// Sweeps a step, over 100 steps of h seconds: each step beginning from its own slope, or from the last one's
/// polynomial. Both end at the same place.
struct Sweeps {
  double anew = 0, continued = 0;
};
template <class P>
Sweeps sweeps_of(P const& problem, int stages, double h) {
  auto x = problem.initial(), y = x;
  auto anew = GaussOf{stages}.bind(problem, FixedStep{h}, NormPolicy::none);
  auto continued = GaussOf{stages}.bind(problem, FixedStep{h}, NormPolicy::none);
  for (int i = 0; i < 100; ++i) {
    anew.restart();
    EXPECT_EQ(anew.advance(x, i * h, (i + 1) * h), Status::ok);
  }
  EXPECT_EQ(continued.advance(y, 0, 100 * h), Status::ok);
  EXPECT_LT(distance<double>(x, y), 3e-14) << stages << ", h = " << h;
  return {double(*anew.work().iterations) / 100, double(*continued.work().iterations) / 100};
}

// The body turns at .3 rad/s, so h L is about .3 h.
TEST(GaussStartingValues, SaveSweepsAtEveryStepSize) {
  auto const flat = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto const group = FreeBody(Choice{}).field<double, S3, true>();
  for (double h : {1.0 / 6, 0.5, 1.0, 3.0}) {
    for (int stages : {2, 4, 8}) {
      Sweeps const on_flat = sweeps_of(flat, stages, h), on_group = sweeps_of(group, stages, h);
      EXPECT_LT(on_flat.continued, on_flat.anew) << stages << ", h = " << h;
      EXPECT_LT(on_group.continued, on_group.anew) << stages << ", h = " << h;
    }
    Sweeps const four = sweeps_of(flat, 4, h);
    EXPECT_LT(four.continued, four.anew - 1.5) << "h = " << h;
  }
}

TEST(GaussStartingValues, AreForgottenAtARestart) {
  auto const problem = erase_type(FreeBody(Choice{}).field<double, FlatQuaternion, true>());
  auto stepper = Gauss<4>{}.bind(*problem, FixedStep{0.5}, NormPolicy::none);
  auto x = problem->initial();
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(stepper.advance(x, i, i + 1), Status::ok);
    stepper.restart();
  }
  EXPECT_EQ(problem->evaluations(), 10 + 4 * *stepper.work().iterations) << "one slope after each restart";
}

// ---- Symmetry -------------------------------------------------------------------------------------------------------

TEST(Gauss, IsSymmetricInTimeForEveryNumberOfStages) {
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto const start = field.initial();
  for (int stages = 1; stages <= 8; ++stages) {
    auto x = start;
    EXPECT_EQ(GaussOf{stages}.bind(field, FixedStep{0.5}, NormPolicy::none).advance(x, 0, 50), Status::ok);
    EXPECT_GT(distance<double>(x, start), 0.1);
    EXPECT_EQ(GaussOf{stages}.bind(field, FixedStep{-0.5}, NormPolicy::none).advance(x, 50, 0), Status::ok);
    EXPECT_LT(distance<double>(x, start), 1e-13) << stages;
  }
}

}  // namespace
}  // namespace polhode
