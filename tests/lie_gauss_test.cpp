/// Gauss on groups, and what every method on groups owes: the constraint, many bodies like one, no allocations.
#include "integrators/lie_gauss.hpp"

#include <gtest/gtest.h>

#include "bench/allocations.hpp"
#include "integrators/lie_group.hpp"
#include "problems/erased.hpp"
#include "problems/free_body.hpp"
#include "tests/lie_group_runs.hpp"
#include "tests/quad_runs.hpp"

namespace polhode {
namespace {

using namespace test;

template <class S, template <class> class A>
auto free_body() {
  return FreeBody(Choice{}).field<S, A, true>();
}

// ---- Coefficients ---------------------------------------------------------------------------------------------------

template <int s>
void expect_antisymmetric() {
  MiddleGauss<double, s> const rounded;
  GaussTableau<s> const exact;
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
  EXPECT_LT(forth_and_back(LieGaussEntry<s>{}, free_body<double, S3>(), 0.5, 100), 1e-13) << s << " stages";
  EXPECT_LT(forth_and_back(LieGaussEntry<s>{}, free_body<double, SO3>(), 0.5, 100), 1e-13) << s << " stages";
  EXPECT_LT(forth_and_back(LieGaussEntry<s>{}, shaken_body<double, S3>(), 0.25, 40), 1e-12) << s << " stages";
}

TEST(LieGauss, IsSymmetricInTimeOnGroups) {
  expect_symmetric<1>();
  expect_symmetric<2>();
  expect_symmetric<3>();
  expect_symmetric<4>();
}

TEST(LieGauss, InAChartAroundTheBeginningItWouldNotBe) {
  EXPECT_GT(forth_and_back(GaussEntry<2>{}, free_body<double, S3>(), 0.5, 100), 1e-11);
  EXPECT_GT(forth_and_back(CommutatorFree4{}, free_body<double, S3>(), 0.5, 100), 1e-11);
}

TEST(LieGauss, OfOneStageIsTheMidpointRule) {
  auto const problem = shaken_body<double, S3>();
  EXPECT_LT(
      distance<double>(state_at(LieGaussEntry<1>{}, problem, 0.1, 10), state_at(GaussEntry<1>{}, problem, 0.1, 10)),
      1e-13);
}

TEST(LieGauss, OnFlatCoordinatesIsGauss) {
  auto const problem = shaken_body<double, FlatQuaternion>();
  EXPECT_LT(distance<double>(state_at(LieGauss<3>{}, problem, 0.1, 10), state_at(GaussEntry<3>{}, problem, 0.1, 10)),
            1e-14);
}

/// Greatest relative drifts of energy and |L| over 10^4 steps of 0.5 s.
template <int s>
void expect_energy_and_momentum_kept() {
  auto const field = free_body<double, S3>();
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
  auto const field = shaken_body<double, S3>();
  auto x = field.initial();
  Status const status = LieGaussEntry<2>{}.bind(field, FixedStep{60}, NormPolicy::none).advance(x, 0, 120);
  EXPECT_TRUE(status == Status::nonlinear_fail || status == Status::diverged);
}

// ---- Every method on groups -----------------------------------------------------------------------------------------

template <class F>
void for_each_method(F f) {
  f(LieEuler{});
  f(Rkmk2{});
  f(Rkmk3{});
  f(Rkmk4{});
  f(CommutatorFree3{});
  f(CommutatorFree4{});
  f(CrouchGrossman3{});
  f(CrouchGrossman4{});
  f(LieGaussEntry<1>{});
  f(LieGaussEntry<2>{});
  f(LieGaussEntry<3>{});
}

template <template <class> class A>
void expect_constraint_kept(auto const& method) {
  auto const problem = erase_type(free_body<double, A>());
  auto x = problem->initial();
  auto stepper = method.bind(*problem, FixedStep{0.1}, NormPolicy::none);
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(stepper.advance(x, 10 * i, 10 * (i + 1)), Status::ok);
    worst = std::max(worst, A<double>::defect(x.first));
  }
  EXPECT_EQ(stepper.work().steps, 10'000);
  EXPECT_LT(worst, 1e-13) << method.info.name << " on " << A<double>::name;
}

TEST(LieGroupMethods, KeepTheConstraintOverTenThousandSteps) {
  for_each_method([](auto const& method) {
    expect_constraint_kept<S3>(method);
    expect_constraint_kept<SO3>(method);
  });
}

/// Ends of three bodies together and of each alone.
template <template <class> class A>
void expect_many_bodies_are_one_body_often(auto const& method) {
  Swarm<decltype(shaken_body<double, A>())> const swarm{shaken_body<double, A>(), 3};
  auto const together = state_at(method, swarm, 0.1, 2);
  for (int i = 0; i < 3; ++i) {
    auto alone = swarm.start(i);
    EXPECT_EQ(method.bind(swarm.body, FixedStep{0.1}, NormPolicy::none).advance(alone, 0, 2), Status::ok);
    EXPECT_LT(distance<double>(together[i], alone), 1e-14) << i;
  }
}

TEST(LieGroupMethods, ManyBodiesAreOneBodyOften) {
  for_each_method([](auto const& method) { expect_many_bodies_are_one_body_often<S3>(method); });
  expect_many_bodies_are_one_body_often<SO3>(CrouchGrossman4{});
  expect_many_bodies_are_one_body_often<SO3>(LieGaussEntry<2>{});
  expect_many_bodies_are_one_body_often<FlatQuaternion>(LieGauss<2>{});
}

TEST(LieGroupMethods, AllocateNothing) {
  Swarm<decltype(shaken_body<double, S3>())> const swarm{shaken_body<double, S3>(), 3};
  auto const erased = erase_type(swarm);
  for_each_method([&](auto const& method) {
    auto x = erased->initial();
    auto stepper = method.bind(*erased, FixedStep{0.1}, NormPolicy::none);
    auto const before = bench::allocations_of_this_thread();
    Status const status = stepper.advance(x, 0, 1);
    EXPECT_EQ(bench::allocations_of_this_thread(), before) << method.info.name;
    EXPECT_EQ(status, Status::ok);
  });
}

}  // namespace
}  // namespace polhode
