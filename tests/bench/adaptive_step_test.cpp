/// Adaptive steps: error in proportion to the tolerance, ends that are not ok, what an evaluation is spent on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrators/catalog.hpp"
#include "problems/catalog.hpp"
#include "tests/support/ending_fields.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;
using test::Escape;
using test::NotANumber;

template <class P>
auto adaptive(P const& problem, double rtol, NormPolicy policy = NormPolicy::none) {
  return Dopri5{}.bind(problem, Adaptive{rtol, rtol / 100}, policy);
}

TEST(AdaptiveDopri5, ErrorIsProportionalToTheTolerance) {
  std::vector<double> ratios;
  for (double rtol : {1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11}) {
    auto const record = a_cell("pd_slew", "quaternion", "dopri5").with_rtol(rtol).measured().record;
    ASSERT_EQ(record.status, results::Status::ok);
    ratios.push_back(*record.attitude_error_max / rtol);
  }
  auto const [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  EXPECT_LT(*most / *least, 30);
  EXPECT_LT(*most, 100);
}

// ---- Ends that are not ok -------------------------------------------------------------------------------------------

TEST(AdaptiveDopri5, StepsUnderflowWhereTheSolutionEnds) {
  Escape const problem;
  test::expect_underflow_at_1_s(adaptive(problem, 1e-8), problem.initial());
}

TEST(AdaptiveDopri5, AFieldThatIsNoNumberAtTheStartHasDiverged) {
  auto const problem = erase_type(NotANumber{0});
  Vec3<double> x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8);
  EXPECT_EQ(stepper.advance(x, 0, 2), Status::diverged);
  EXPECT_LT(problem->evaluations(), 1000) << "hopeless, and it should notice";
}

TEST(AdaptiveDopri5, StepsUnderflowWhereTheFieldEnds) {
  auto const problem = erase_type(NotANumber{0.5});
  Vec3<double> x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8);
  EXPECT_EQ(stepper.advance(x, 0, 2), Status::step_underflow);
  EXPECT_NEAR(x.x, std::exp(-0.5), 1e-7);
  EXPECT_LT(problem->evaluations(), 1000);
}

TEST(AdaptiveDopri5, AStateThatIsNoNumberHasDiverged) {
  Escape const problem;
  Vec3<double> x{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  EXPECT_EQ(adaptive(problem, 1e-8).advance(x, 0, 2), Status::diverged);
}

/// A turn far too fast for the horizon.
struct Whirl {
  using Space = Euclidean3<double>;
  static constexpr double rate = 1e10;
  Vec3<double> operator()(double, Vec3<double> const& x) const { return {-rate * x.y, rate * x.x, 0}; }
  Vec3<double> initial() const { return {1, 0, 0}; }
};

TEST(AdaptiveDopri5, GivesUpAfterTenMillionSteps) {
  Whirl const problem;
  Vec3<double> x = problem.initial();
  auto stepper = adaptive(problem, 1e-6);
  EXPECT_EQ(stepper.advance(x, 0, 1), Status::max_steps);
  EXPECT_NEAR(double(stepper.work().steps + stepper.work().rejected), 1e7, 10);
}

// ---- Evaluations ----------------------------------------------------------------------------------------------------

auto counted_slew() {
  return erase<double, FlatQuaternion>(PdSlew(Choice{}));
}

TEST(AdaptiveDopri5, TheLastSlopeOfAStepIsTheFirstOfTheNext) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8);
  ASSERT_EQ(stepper.advance(x, 0, 60), Status::ok);
  Work const work = stepper.work();
  EXPECT_GT(work.steps, 50);
  // One for the first slope, one to choose the first step; then six a step, accepted or not.
  EXPECT_EQ(problem->evaluations(), 2 + 6 * (work.steps + work.rejected));
}

TEST(AdaptiveDopri5, ARestartCostsOneSlope) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8);
  for (int i = 0; i < 10; ++i) {
    stepper.restart();
    ASSERT_EQ(stepper.advance(x, i, i + 1), Status::ok);
  }
  EXPECT_EQ(problem->evaluations(), 10 + 1 + 6 * (stepper.work().steps + stepper.work().rejected));
}

TEST(AdaptiveDopri5, GoingOnWithoutARestartCostsNone) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8);
  for (int i = 0; i < 10; ++i) ASSERT_EQ(stepper.advance(x, i, i + 1), Status::ok);
  EXPECT_EQ(problem->evaluations(), 2 + 6 * (stepper.work().steps + stepper.work().rejected));
}

TEST(AdaptiveDopri5, AStateChangedFromOutsideNeedsARestart) {
  auto const problem = counted_slew();
  auto const end_of = [&](bool restart) {
    auto stepper = adaptive(*problem, 1e-8);
    auto x = problem->initial();
    EXPECT_EQ(stepper.advance(x, 0, 1), Status::ok);
    x = problem->initial();
    if (restart) stepper.restart();
    EXPECT_EQ(stepper.advance(x, 1, 2), Status::ok);
    return x;
  };
  auto fresh_x = problem->initial();
  EXPECT_EQ(adaptive(*problem, 1e-8).advance(fresh_x, 1, 2), Status::ok);
  double const error = distance<double>(end_of(true), fresh_x);
  EXPECT_LT(error, 2e-8);
  EXPECT_GT(distance<double>(end_of(false), fresh_x), 10 * error) << "the old slope was used: the test can tell";
}

TEST(AdaptiveDopri5, ProjectionTakesOneMoreSlopeAStepAndHoldsTheNorm) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-6, NormPolicy::project);
  ASSERT_EQ(stepper.advance(x, 0, 60), Status::ok);
  Work const work = stepper.work();
  EXPECT_EQ(problem->evaluations(), 2 + 6 * (work.steps + work.rejected) + work.steps - 1);
  EXPECT_EQ(stepper.projections().count, work.steps);
  EXPECT_LE(FlatQuaternion<double>::defect(x.first), 4.5e-16);
  EXPECT_GT(stepper.projections().raw_defect, 1e-9);
}

TEST(AdaptiveDopri5, LandsExactlyOnTheEnd) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8);
  double t = 0;
  std::int64_t steps = 0;
  while (t < 0.3) {
    ASSERT_EQ(stepper.step(x, t, 0.3), Status::ok);
    ASSERT_LE(t, 0.3);
    ++steps;
  }
  EXPECT_EQ(t, 0.3);
  EXPECT_EQ(stepper.work().steps, steps);
}

}  // namespace
}  // namespace polhode
