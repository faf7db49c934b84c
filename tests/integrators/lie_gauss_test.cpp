/// Gauss on groups: its order, its symmetry, what it keeps of a free body.
#include "integrators/lie_gauss.hpp"

#include <gtest/gtest.h>

#include "problems/erased.hpp"
#include "problems/free_body.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using namespace test;

/// In double, the types forgotten: a method is compiled once for each space.
template <template <class> class A>
auto const& free_body() {
  static auto const field = erase_type(FreeBody(Choice{}).field<double, A, true>());
  return *field;
}
template <template <class> class A>
auto const& erased_shaken_body() {
  static auto const field = erase_type(shaken_body<double, A>());
  return *field;
}

// ---- Coefficients ---------------------------------------------------------------------------------------------------

template <int s>
void expect_antisymmetric() {
  MiddleGauss<double, s> const rounded;
  GaussCoefficients const& exact = gauss_coefficients(s);
  for (std::size_t i = 0; i < s; ++i)
    for (std::size_t j = 0; j < s; ++j) {
      EXPECT_EQ(rounded.middle[i][j], -rounded.middle[j][i]);
      EXPECT_LT(double(fabsq(rounded.middle[i][j] - (exact.a[i][j] / exact.b[j] - Quad(0.5)))), 2.3e-16);
    }
}

TEST(MiddleGauss, IsAntisymmetricToTheLastBit) {
  expect_antisymmetric<1>();
  expect_antisymmetric<2>();
  expect_antisymmetric<3>();
  expect_antisymmetric<4>();
}

// ---- Order and symmetry ---------------------------------------------------------------------------------------------

template <template <class> class A, int s>
void expect_order(double h) {
  static auto const problem = erase_type(shaken_body<Quad, A>());
  static auto const exact = by_gauss(*problem, 0.0625, 1);
  auto const error = [&](double step) {
    return angle_apart<A<Quad>>(state_at(LieGaussEntry<s>{}, *problem, step, 1), exact);
  };
  EXPECT_NEAR(order_of(error(h), error(h / 2)), 2 * s, 0.1) << A<Quad>::name;
}

TEST(LieGauss, HasTwiceAsManyOrdersAsStages) {
  expect_order<S3, 1>(1. / 16);
  expect_order<S3, 2>(1. / 16);
  expect_order<S3, 3>(1. / 8);
  expect_order<S3, 4>(1. / 8);
  expect_order<SO3, 2>(1. / 16);
  expect_order<SO3, 3>(1. / 8);
}

template <int s>
void expect_symmetric() {
  EXPECT_LT(forth_and_back(LieGaussEntry<s>{}, free_body<S3>(), 0.5, 100), 1e-13) << s << " stages";
  EXPECT_LT(forth_and_back(LieGaussEntry<s>{}, free_body<SO3>(), 0.5, 100), 1e-13) << s << " stages";
  EXPECT_LT(forth_and_back(LieGaussEntry<s>{}, erased_shaken_body<S3>(), 0.25, 40), 1e-12) << s << " stages";
}

TEST(LieGauss, IsSymmetricInTimeOnGroups) {
  expect_symmetric<1>();
  expect_symmetric<2>();
  expect_symmetric<3>();
  expect_symmetric<4>();
}

TEST(LieGauss, InAChartAroundTheBeginningItWouldNotBe) {
  EXPECT_GT(forth_and_back(GaussEntry<2>{}, free_body<S3>(), 0.5, 100), 1e-11);
}

TEST(LieGauss, OfOneStageIsTheMidpointRule) {
  auto const& problem = erased_shaken_body<S3>();
  EXPECT_LT(
      distance<double>(state_at(LieGaussEntry<1>{}, problem, 0.1, 10), state_at(GaussEntry<1>{}, problem, 0.1, 10)),
      1e-13);
}

TEST(LieGauss, OnFlatCoordinatesIsGauss) {
  auto const& problem = erased_shaken_body<FlatQuaternion>();
  EXPECT_LT(distance<double>(state_at(LieGauss<3>{}, problem, 0.1, 10), state_at(GaussEntry<3>{}, problem, 0.1, 10)),
            1e-14);
}

/// Greatest relative drifts of energy and |L| over 10^4 steps of 0.5 s.
template <int s>
void expect_energy_and_momentum_kept() {
  auto const& field = free_body<S3>();
  auto x = field.initial();
  auto stepper = LieGaussEntry<s>{}.bind(field, FixedStep{0.5}, NormPolicy::none);
  auto const invariants = [&] {
    Vec3<double> const w = x.second, L{100 * w.x, 120 * w.y, 110 * w.z};
    return std::array{dot(L, w) / 2, length(L)};
  };
  auto const start = invariants();
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(stepper.advance(x, 0.5 * i, 0.5 * (i + 1)), Status::ok);
    auto const now = invariants();
    ASSERT_LT(std::fabs(now[0] / start[0] - 1), 3e-14) << s << " stages";
    ASSERT_LT(std::fabs(now[1] / start[1] - 1), 3e-14) << s << " stages";
  }
  EXPECT_GT(*stepper.work().iterations, 10'000);
  EXPECT_LT(*stepper.work().iterations, 30 * 10'000);
}

TEST(LieGauss, KeepsEnergyAndMomentumOfAFreeBodyToRoundOff) {
  expect_energy_and_momentum_kept<1>();
  expect_energy_and_momentum_kept<2>();
  expect_energy_and_momentum_kept<3>();
}

TEST(LieGauss, SaysSoWhereItsIterationDiverges) {
  auto const& field = erased_shaken_body<S3>();
  auto x = field.initial();
  Status const status = LieGaussEntry<2>{}.bind(field, FixedStep{60}, NormPolicy::none).advance(x, 0, 120);
  EXPECT_TRUE(status == Status::nonlinear_fail || status == Status::diverged);
}

}  // namespace
}  // namespace polhode
