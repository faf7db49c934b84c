/// Gauss with adaptive steps: error in proportion to the tolerance, on flat spaces and groups, for one and many.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "integrators/gauss.hpp"
#include "problems/erased.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "tests/support/ending_fields.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::NotANumber;
template <Scalar S, template <class> class A>
S attitude_error(int stages, double rtol) {
  static auto const exact = [] {
    auto const field = PdSlew(Choice{}).field<Quad, S3, true>();
    auto x = field.initial();
    EXPECT_EQ(Gauss<8>{}.bind(field, FixedStep{0.25}, NormPolicy::none).advance(x, 0, 20), Status::ok);
    return x.first;
  }();
  auto const field = PdSlew(Choice{}).field<S, A, true>();
  auto x = field.initial();
  auto stepper = GaussOf{stages}.bind(field, Adaptive{rtol, rtol / 100}, NormPolicy::none);
  EXPECT_EQ(stepper.advance(x, 0, 20), Status::ok) << stages << ", " << rtol;
  return S(angle_between(test::in<Quad>(A<S>::attitude(x.first)), exact));
}

template <Scalar S, template <class> class A>
void expect_proportional(int stages, std::initializer_list<double> tolerances, double most) {
  std::vector<double> ratios;
  for (double rtol : tolerances) ratios.push_back(double(attitude_error<S, A>(stages, rtol)) / rtol);
  auto const [low, high] = std::minmax_element(ratios.begin(), ratios.end());
  EXPECT_LT(*high / *low, most) << stages;
  EXPECT_LT(*high, 1) << stages;
}

TEST(AdaptiveGauss, ErrorIsProportionalToTheTolerance) {
  expect_proportional<double, FlatQuaternion>(1, {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}, 3);
  expect_proportional<double, FlatQuaternion>(2, {1e-4, 1e-6, 1e-8, 1e-10}, 3);
  expect_proportional<double, FlatQuaternion>(3, {1e-6, 1e-8, 1e-10, 1e-12}, 5);
  expect_proportional<double, S3>(2, {1e-4, 1e-6, 1e-8, 1e-10}, 3);
  expect_proportional<double, SO3>(3, {1e-6, 1e-8, 1e-10, 1e-12}, 5);
  expect_proportional<double, MrpShadow>(2, {1e-4, 1e-6, 1e-8, 1e-10}, 3);
}

// With more stages steps are so long that double precision ends before they are short.
TEST(AdaptiveGauss, StaysBelowTheToleranceWithManyStages) {
  for (int stages : {4, 6, 8})
    for (double rtol : {1e-4, 1e-7, 1e-10}) {
      EXPECT_LT((attitude_error<double, FlatQuaternion>(stages, rtol)), rtol) << stages;
      EXPECT_LT((attitude_error<double, S3>(stages, rtol)), rtol) << stages;
    }
}

TEST(AdaptiveGauss, CountsOneSlopeAStepBesideTheSweeps) {
  auto const problem = erase_type(PdSlew(Choice{}).field<double, FlatQuaternion, true>());
  auto x = problem->initial();
  auto stepper = Gauss<3>{}.bind(*problem, Adaptive{1e-8, 1e-10}, NormPolicy::none);
  ASSERT_EQ(stepper.advance(x, 0, 20), Status::ok);
  Work const work = stepper.work();
  EXPECT_EQ(work.jacobians, 0);
  EXPECT_EQ(problem->evaluations(), 1 + work.steps + 3 * *work.iterations);
}

TEST(AdaptiveGauss, LandsOnTheEndAndBeginsAnew) {
  auto const field = PdSlew(Choice{}).field<double, S3, true>();
  auto stepper = Gauss<4>{}.bind(field, Adaptive{1e-9, 1e-11}, NormPolicy::project);
  auto x = field.initial(), y = x;
  double t = 0;
  while (t < 3.7) ASSERT_EQ(stepper.step(x, t, 3.7), Status::ok);
  EXPECT_EQ(t, 3.7);
  EXPECT_EQ(stepper.projections().count, stepper.work().steps);
  stepper.begin();
  ASSERT_EQ(stepper.advance(y, 0, 3.7), Status::ok);
  EXPECT_EQ(distance<double>(x, y), 0);
}

TEST(AdaptiveGauss, RunsOnManyBodies) {
  auto const swarm = QuaternionSync(Choice{}).field<double, FlatQuaternion, true>();
  auto const on_group = QuaternionSync(Choice{}).field<double, S3, true>();
  auto x = swarm.initial(), fine = x, y = on_group.initial();
  EXPECT_EQ(Gauss<4>{}.bind(swarm, Adaptive{1e-9, 1e-11}, NormPolicy::none).advance(x, 0, 2), Status::ok);
  EXPECT_EQ(Gauss<4>{}.bind(on_group, Adaptive{1e-9, 1e-11}, NormPolicy::none).advance(y, 0, 2), Status::ok);
  EXPECT_EQ(Gauss<6>{}.bind(swarm, FixedStep{0.02}, NormPolicy::none).advance(fine, 0, 2), Status::ok);
  EXPECT_LT(distance<double>(x, fine), 1e-8);
  EXPECT_LT(distance<double>(y, fine), 1e-8);
}

TEST(AdaptiveGauss, EndsWhereTheFieldEnds) {
  auto x = NotANumber{0}.initial();
  NotANumber const never{0}, until{0.5};
  EXPECT_EQ(Gauss<2>{}.bind(never, Adaptive{1e-8, 1e-8}, NormPolicy::none).advance(x, 0, 1), Status::diverged);
  // Nodes lie within a step, so that its end may be a little beyond the last time that any of them saw.
  EXPECT_NE(Gauss<2>{}.bind(until, Adaptive{1e-8, 1e-8}, NormPolicy::none).advance(x, 0, 1), Status::ok);
  EXPECT_NEAR(x.x, std::exp(-0.5), 0.01);
}

}  // namespace
}  // namespace polhode
