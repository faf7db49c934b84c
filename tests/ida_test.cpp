/// SUNDIALS IDA on the heavy top as a constrained system: its equations, errors and defects against the tolerance.
#include "integrators/rivals/ida.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/pinned_runs.hpp"
#include "tests/random_numbers.hpp"

namespace polhode {
namespace {

TEST(Ida, NeedsAConstrainedProblemInQuaternions) {
  EXPECT_EQ(refusal<MovingBody<FlatQuaternion<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<MovingBody<S3<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<MovingBody<FlatRotation<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<RigidBody<FlatQuaternion<double>>>(Ida::info.needs), "");
  static_assert(!RunsFixed<Ida, PinnedField<double, FlatQuaternion>>);
}

#ifdef POLHODE_HAS_SUNDIALS
using test::pinned_top;
using test::PinnedDefects;
using test::PinnedErrors;

static_assert(RunsAdaptive<Ida, PinnedField<double, FlatQuaternion>>);
static_assert(!RunsAdaptive<Ida, PinnedField<double, S3>>);

/// The state and the multiplier at t_end [s], the greatest defects at the steps on the way, the counts.
struct IdaRun {
  Point<MovingBody<FlatQuaternion<double>>> x;
  Vec3<double> lambda;
  PinnedDefects defects;
  double norm_defect = 0;
  Work work;
};
IdaRun run_ida(double tolerance, double t_end) {
  auto const problem = pinned_top<double, FlatQuaternion>();
  auto stepper = Ida{}.bind(problem, Adaptive{tolerance, tolerance}, NormPolicy::none);
  IdaRun run{.x = problem.initial(), .lambda = {}, .defects = {}, .work = {}};
  for (double t = 0; t < t_end;) {
    Status const status = stepper.step(run.x, t, t_end);
    EXPECT_EQ(status, Status::ok) << "t = " << t;
    if (status != Status::ok) break;
    PinnedDefects const now = test::defects_of(problem, run.x);
    run.defects.position = std::max(run.defects.position, now.position);
    run.defects.velocity = std::max(run.defects.velocity, now.velocity);
    run.norm_defect = std::max(run.norm_defect, FlatQuaternion<double>::defect(run.x.first.first));
  }
  run.lambda = stepper.multiplier();
  run.work = stepper.work();
  return run;
}

TEST(Ida, MeetsThePublishedRate) {
  IdaRun const run = run_ida(1e-11, 2);
  double const rate = (matrix(run.x.first.first) * run.x.first.second).y;
  EXPECT_NEAR(rate, -106.1638041430, 2e-6);
}

TEST(Ida, ErrorsAndDefectsFallWithTheTolerance) {
  auto const problem = pinned_top<double, FlatQuaternion>();
  auto const exact = test::pinned_reference(problem, 0.5);
  PinnedErrors before;
  before.fill(1e300);
  for (double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    IdaRun const run = run_ida(tolerance, 0.5);
    EXPECT_LT(run.defects.position, 30 * tolerance);
    EXPECT_LT(run.defects.velocity, 1000 * tolerance);  // of 150 rad/s
    EXPECT_LT(run.norm_defect, 30 * tolerance);
    EXPECT_GT(run.defects.position, 1e-3 * tolerance);
    PinnedErrors const errors = test::errors_of(problem, run.x, run.lambda, exact);
    for (std::size_t i = 0; i < errors.size(); ++i)
      EXPECT_LT(errors[i], before[i] / 5) << test::pinned_names[i] << " at " << tolerance;
    before = errors;
  }
  EXPECT_LT(before[0], 1e-7);
  EXPECT_LT(before[4], 1e-4);
}

TEST(Ida, Counts) {
  Work const work = run_ida(1e-6, 0.2).work;
  EXPECT_GT(work.steps, 100);
  EXPECT_GT(work.rejected, 0);
  EXPECT_GT(work.iterations.value(), work.steps);
  EXPECT_GT(work.jacobians.value(), 0);
  EXPECT_GE(work.evaluations, work.iterations.value());
}

TEST(Ida, StopsWhereItIsToldAndStartsAnew) {
  auto const problem = pinned_top<double, FlatQuaternion>();
  auto const exact = test::pinned_reference(problem, 0.1);
  auto stepper = Ida{}.bind(problem, Adaptive{1e-9, 1e-9}, NormPolicy::none);
  auto x = problem.initial();
  ASSERT_EQ(stepper.advance(x, 0, 0.05), Status::ok);
  std::int64_t const steps = stepper.work().steps;
  stepper.restart();
  ASSERT_EQ(stepper.advance(x, 0.05, 0.08), Status::ok);
  ASSERT_EQ(stepper.advance(x, 0.08, 0.1), Status::ok);
  EXPECT_GT(stepper.work().steps, steps);
  PinnedErrors const errors = test::errors_of(problem, x, stepper.multiplier(), exact);
  EXPECT_LT(errors[0], 1e-5);
  EXPECT_LT(errors[4], 1e-2);
}

/// A derivative along y' by a central difference of the residual.
TEST(Ida, ItsJacobianIsThatOfTheResidual) {
  constexpr int size = PinnedUnknowns<double>::size;
  using Slopes = Dual<size>;
  PinnedBody<double> const body = test::heavy_top("dae").pinned<double>();
  PinnedBody<Slopes> const dual = test::heavy_top("dae").pinned<Slopes>();
  test::Random random(7);
  std::array<double, size> y;
  for (double& component : y) component = random.uniform(-1, 1);
  std::array<Slopes, size> point;
  for (std::size_t i = 0; i < size; ++i) {
    point[i] = y[i];
    point[i].slope[i] = 1;
  }
  auto const slopes = pinned_residual(dual, point.data());
  for (std::size_t column = 0; column < size; ++column) {
    auto left = y, right = y;
    left[column] -= 1e-5;
    right[column] += 1e-5;
    auto const low = pinned_residual(body, left.data()), high = pinned_residual(body, right.data());
    for (std::size_t row = 0; row < size; ++row)
      EXPECT_NEAR(slopes[row].slope[column], (high[row] - low[row]) / 2e-5, 1e-7) << row << ", " << column;
  }
}
#endif

}  // namespace
}  // namespace polhode
