/// SUNDIALS IDA on the heavy top as a constrained system, and on one body whose norm is the constraint: their
/// equations, errors and defects against the tolerance.
#include "integrators/rivals/ida.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "integrators/rivals/cvode.hpp"
#include "problems/dual_field.hpp"
#include "problems/free_body.hpp"
#include "problems/mrp.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/pinned_runs.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rival_runs.hpp"

namespace polhode {
namespace {

TEST(Ida, NeedsOneBodyInFlatQuaternions) {
  EXPECT_EQ(refusal<MovingBody<FlatQuaternion<double>>>(Ida::info.needs), "");
  EXPECT_EQ(refusal<RigidBody<FlatQuaternion<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<MovingBody<S3<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<MovingBody<FlatRotation<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<RigidBody<S3<double>>>(Ida::info.needs), "");
  EXPECT_NE(refusal<RigidBody<Mrp<double>>>(Ida::info.needs), "");
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

// ---- The norm as a constraint ---------------------------------------------------------------------------------------

using Body = RigidBody<FlatQuaternion<double>>;
static_assert(RunsAdaptive<Ida, Erased<Body>>);
static_assert(!RunsAdaptive<Ida, Erased<RigidBody<S3<double>>>>);
static_assert(!RunsAdaptive<Ida, Erased<Attitudes<FlatQuaternion<double>>>>);

/// Runs of a definition on quaternions, with the Jacobian or without, and how far they are from the reference.
template <Definition D>
struct NormRun {
  double error = 0, defect = 0;
  Work work;
  std::int64_t evaluations = 0;

  NormRun(D const& definition, double tolerance, double t_end, bool differentiable = true) {
    with_differentiable_field<FlatQuaternion>(definition, [&](auto field) {
      if (differentiable) return run(*erase_type(std::move(field)), definition, tolerance, t_end);
      run(*erase<double, FlatQuaternion>(definition), definition, tolerance, t_end);
    });
  }

 private:
  template <class P>
  void run(P& problem, D const& definition, double tolerance, double t_end) {
    auto const reference = test::reference_state(definition, 0.05, t_end);
    auto const end =
        test::run_rival<Ida>(problem, test::stops_until(definition, t_end), Adaptive{tolerance, tolerance});
    EXPECT_EQ(end.status, Status::ok);
    error = test::error_of(end.x, reference);
    defect = std::fabs(dot(end.x.first, end.x.first) - 1);
    work = end.work;
    evaluations = end.evaluations;
  }
};

TEST(IdaWithTheNorm, ErrorsFallWithTheToleranceAndTheNormHolds) {
  auto const check = [](auto const& definition, double t_end) {
    double before = 1e300;
    for (double const tolerance : {1e-5, 1e-8, 1e-11}) {
      NormRun const run(definition, tolerance, t_end);
      EXPECT_LT(run.defect, 10 * tolerance) << definition.info().name;
      EXPECT_LT(run.error, 200 * tolerance) << definition.info().name;
      EXPECT_LT(run.error, before / 5) << definition.info().name << ", " << tolerance;
      before = run.error;
    }
  };
  check(FreeBody(Choice{}), 10);
  check(PdSlew(Choice{}), 10);
  check(TetherCapture(Choice{}), 2);
}

// BDF alone lets the norm drift by as much as it errs.
TEST(IdaWithTheNorm, HoldsItBetterThanWithout) {
  FreeBody const definition(Choice{});
  auto const problem = erase<double, FlatQuaternion>(definition);
  auto const free = test::run_rival<Cvode<true>>(*problem, test::stops_until(definition, 50), Adaptive{1e-6, 1e-6});
  double const drift = std::fabs(dot(free.x.first, free.x.first) - 1);
  EXPECT_GT(drift, 1e-6);
  EXPECT_LT(NormRun(definition, 1e-6, 50).defect, drift / 50);
}

TEST(IdaWithTheNorm, CountsEvaluationsOnceAndDoesWithoutAJacobian) {
  PdSlew const definition(Choice{});
  NormRun const exact(definition, 1e-8, 10), differenced(definition, 1e-8, 10, false);
  EXPECT_GT(exact.work.jacobians.value(), 0);
  EXPECT_GT(exact.work.iterations.value(), exact.work.steps);
  EXPECT_EQ(exact.work.evaluations, 0) << "the field counts itself";
  EXPECT_GE(exact.evaluations, exact.work.iterations.value());
  EXPECT_LT(exact.evaluations, 3 * exact.work.steps);
  EXPECT_GT(differenced.evaluations, exact.evaluations + 7 * exact.work.jacobians.value());
  EXPECT_LT(differenced.error, 1e-6);
}

/// A derivative along y by central differences of the residual.
TEST(IdaWithTheNorm, ItsJacobianIsThatOfTheResidual) {
  with_differentiable_field<FlatQuaternion>(PdSlew(Choice{}), [](auto const& field) {
    using System = UnitNormSystem<std::decay_t<decltype(field)>>;
    constexpr auto n = std::size_t(System::size);
    System const system(field);
    ASSERT_TRUE(system.has_jacobian());
    test::Random random(11);
    std::array<double, n> y, low, high;
    for (double& component : y) component = random.uniform(-1, 1);
    std::array<double, n * n> columns;
    system.jacobian(0.3, y.data(), columns);
    for (std::size_t j = 0; j < n; ++j) {
      auto left = y, right = y;
      left[j] -= 1e-5;
      right[j] += 1e-5;
      system.residual(0.3, left.data(), low.data());
      system.residual(0.3, right.data(), high.data());
      for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(columns[i + n * j], (high[i] - low[i]) / 2e-5, 1e-8) << i << j;
    }
  });
}
#endif

}  // namespace
}  // namespace polhode
