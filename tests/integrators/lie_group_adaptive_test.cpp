/// Adaptive steps on groups: the pair's conditions, error in proportion to the tolerance, what a tolerance refers to,
/// ends that are not ok, what an evaluation is spent on.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "bench/process/allocations.hpp"
#include "integrators/commutator_free_pair.hpp"
#include "problems/erased.hpp"
#include "problems/free_body.hpp"
#include "tests/integrators/exponential_conditions.hpp"
#include "tests/support/ending_fields.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using namespace test;

template <class P>
auto adaptive(P const& problem, double rtol, double atol, NormPolicy policy = NormPolicy::none) {
  return CommutatorFreeAdaptive{}.bind(problem, Adaptive{rtol, atol}, policy);
}

// ---- The pair -------------------------------------------------------------------------------------------------------

TEST(CommutatorFreePair, HasOrders4And3) {
  Scheme const scheme = scheme_of<Cf43Tableau>();
  EXPECT_LT(greatest_defect(scheme, 5, 4), 1e-32);
  EXPECT_GT(greatest_defect(scheme, 5, 5), 1e-3);
  EXPECT_LT(greatest_defect(scheme, 6, 3), 1e-32);
  EXPECT_GT(greatest_defect(scheme, 6, 4), 1e-3) << "an estimate that is always too small";
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_LT(double(fabsq(Cf43Tableau::c[i] - weight(scheme, i, Forest{{Forest{}}}))), 1e-32) << i;
}

TEST(CommutatorFreePair, ItsFirstMemberIsCf4) {
  Scheme const pair = scheme_of<Cf43Tableau>(), alone = scheme_of<Cf4Tableau>();
  for (std::size_t i : {1, 2, 3}) EXPECT_TRUE(weight(pair, i, forests(3)[0]) == weight(alone, i, forests(3)[0])) << i;
  for (Forest const& forest : forests(5)) EXPECT_TRUE(weight(pair, 5, forest) == weight(alone, 4, forest));
}

// ---- Error and tolerance --------------------------------------------------------------------------------------------

template <template <class> class A>
void expect_error_in_proportion() {
  auto const in_quad = erase_type(shaken_body<Quad, A>());
  Quat<double> const exact = in<double>(A<Quad>::attitude(by_gauss(*in_quad, 0.0625, 20).first));
  auto const problem = erase_type(shaken_body<double, A>());
  std::vector<double> ratios;
  for (double rtol : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    auto x = problem->initial();
    ASSERT_EQ(adaptive(*problem, rtol, rtol / 100).advance(x, 0, 20), Status::ok);
    ratios.push_back(angle_between(A<double>::attitude(x.first), exact) / rtol);
    EXPECT_LT(A<double>::defect(x.first), 1e-13);
  }
  auto const [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  EXPECT_LT(*most / *least, 10) << A<double>::name;
  EXPECT_LT(*most, 10) << A<double>::name;
  EXPECT_GT(*least, 0.01) << A<double>::name << ": steps far too small";
}

TEST(AdaptiveOnGroups, ErrorIsProportionalToTheTolerance) {
  expect_error_in_proportion<S3>();
  expect_error_in_proportion<SO3>();
}

template <template <class> class A>
std::int64_t steps_of_free_body(Quat<double> const& q0, double rtol, double atol) {
  Choice choice;
  choice.set["q0"] = {q0.x, q0.y, q0.z, q0.w};
  auto const problem = FreeBody(choice).field<double, A, true>();
  auto x = problem.initial();
  auto stepper = adaptive(problem, rtol, atol);
  EXPECT_EQ(stepper.advance(x, 0, 50), Status::ok);
  return stepper.work().steps;
}

// Components of a quaternion or a matrix would make it depend on where the axes point.
TEST(AdaptiveOnGroups, TheToleranceDoesNotKnowWhereTheInertialAxesPoint) {
  std::int64_t const steps = steps_of_free_body<S3>({0, 0, 0, 1}, 1e-6, 0);
  EXPECT_GT(steps, 50);
  for (Quat<double> const& q : {Quat<double>{1, 0, 0, 0}, {0.6, 0, 0, -0.8}, {0.5, 0.5, 0.5, 0.5}, {0, -1, 0, 0}}) {
    EXPECT_EQ(steps_of_free_body<S3>(q, 1e-6, 0), steps);
    EXPECT_EQ(steps_of_free_body<SO3>(q, 1e-6, 0), steps);
  }
}

/// The attitude alone turns, at a rate that changes.
template <class S>
struct Turntable {
  using Space = S3<S>;
  Vec3<S> operator()(S const& t, Quat<S> const&) const { return {sin(t), cos(t), S(0.5)}; }
  Quat<S> initial() const { return {S(0.0), S(0.0), S(0.0), S(1.0)}; }
};

TEST(AdaptiveOnGroups, ARelativeToleranceIsRelativeToOneRadian) {
  Turntable<double> const problem;
  auto const steps = [&](double rtol, double atol) {
    auto x = problem.initial();
    auto stepper = adaptive(problem, rtol, atol);
    EXPECT_EQ(stepper.advance(x, 0, 10), Status::ok);
    return stepper.work().steps;
  };
  EXPECT_EQ(steps(1e-7, 0), steps(0, 1e-7));
  EXPECT_EQ(steps(1e-7, 1e-7), steps(0, 2e-7));
  EXPECT_LT(steps(1e-6, 0), steps(1e-7, 0));
}

TEST(AdaptiveOnGroups, ManyBodiesAreControlledTogether) {
  auto const body = shaken_body<double, S3>();
  Swarm<decltype(shaken_body<double, S3>())> const one{body, 1}, three{body, 3};
  auto x = body.initial();
  auto alone = adaptive(body, 1e-6, 1e-8);
  EXPECT_EQ(alone.advance(x, 0, 10), Status::ok);
  auto xs = one.initial();
  auto swarm_of_one = adaptive(one, 1e-6, 1e-8);
  EXPECT_EQ(swarm_of_one.advance(xs, 0, 10), Status::ok);
  EXPECT_LT(distance<double>(xs[0], x), 1e-13);
  EXPECT_EQ(swarm_of_one.work().steps, alone.work().steps);
  EXPECT_EQ(swarm_of_one.work().rejected, alone.work().rejected);
  auto xxx = three.initial();
  EXPECT_EQ(adaptive(three, 1e-6, 1e-8).advance(xxx, 0, 10), Status::ok);
  EXPECT_LT(angle_apart<S3<double>>(xxx[0], x), 1e-5);
}

// ---- Ends that are not ok -------------------------------------------------------------------------------------------

/// The body rate's first component w grows as w' = w^2 and leaves every bound at 1 s; from `from` on it is no number.
struct Runaway {
  using Space = RigidBody<S3<double>>;
  double from = 9;
  Velocity<Space> operator()(double t, Point<Space> const& x) const {
    double const w = x.second.x;
    return {x.second, {t < from ? w * w : std::numeric_limits<double>::quiet_NaN(), 0, 0}};
  }
  Point<Space> initial() const { return {{0, 0, 0, 1}, {1, 0, 0}}; }
};

TEST(AdaptiveOnGroups, StepsUnderflowWhereTheSolutionEnds) {
  Runaway const problem;
  test::expect_underflow_at_1_s(adaptive(problem, 1e-8, 1e-10), problem.initial());
}

TEST(AdaptiveOnGroups, StepsUnderflowWhereTheFieldEnds) {
  auto const problem = erase_type(Runaway{0.5});
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-8, 1e-10);
  EXPECT_EQ(stepper.advance(x, 0, 2), Status::step_underflow);
  EXPECT_NEAR(x.second.x, 2, 1e-6);
  EXPECT_LT(problem->evaluations(), 1000);
}

TEST(AdaptiveOnGroups, NoNumbersHaveDiverged) {
  auto const problem = erase_type(Runaway{0});
  auto x = problem->initial();
  EXPECT_EQ(adaptive(*problem, 1e-8, 1e-10).advance(x, 0, 2), Status::diverged);
  EXPECT_LT(problem->evaluations(), 1000) << "hopeless, and it should notice";
  Runaway const smooth;
  x.first.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(adaptive(smooth, 1e-8, 1e-10).advance(x, 0, 0.5), Status::diverged);
}

// ---- Evaluations, restarts ------------------------------------------------------------------------------------------

TEST(AdaptiveOnGroups, FiveEvaluationsAStepAndFourARejection) {
  auto const problem = erase_type(shaken_body<double, S3>());
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-7, 1e-9);
  ASSERT_EQ(stepper.advance(x, 0, 20), Status::ok);
  Work const work = stepper.work();
  EXPECT_GT(work.steps, 50);
  EXPECT_EQ(problem->evaluations(), 1 + 5 * work.steps + 4 * work.rejected);
}

TEST(AdaptiveOnGroups, LandsExactlyOnTheEnd) {
  auto const problem = shaken_body<double, S3>();
  auto x = problem.initial();
  auto stepper = adaptive(problem, 1e-7, 1e-9);
  double t = 0;
  while (t < 0.3) {
    ASSERT_EQ(stepper.step(x, t, 0.3), Status::ok);
    ASSERT_LE(t, 0.3);
  }
  EXPECT_EQ(t, 0.3);
}

TEST(AdaptiveOnGroups, ARestartKeepsTheStepABeginningDoesNot) {
  auto const problem = shaken_body<double, S3>();
  auto const steps_of_second_half = [&](auto between) {
    auto x = problem.initial();
    auto stepper = adaptive(problem, 1e-7, 1e-9);
    EXPECT_EQ(stepper.advance(x, 0, 5), Status::ok);
    auto const before = stepper.work().steps;
    between(stepper);
    EXPECT_EQ(stepper.advance(x, 5, 10), Status::ok);
    return stepper.work().steps - before;
  };
  auto fresh_x = problem.initial();
  auto first = adaptive(problem, 1e-7, 1e-9), second = adaptive(problem, 1e-7, 1e-9);
  EXPECT_EQ(first.advance(fresh_x, 0, 5), Status::ok);
  EXPECT_EQ(second.advance(fresh_x, 5, 10), Status::ok);
  EXPECT_EQ(steps_of_second_half([](auto& stepper) { stepper.begin(); }), second.work().steps);
  EXPECT_LT(steps_of_second_half([](auto& stepper) { stepper.restart(); }), second.work().steps);
}

TEST(AdaptiveOnGroups, EveryRunFromABeginningIsTheSame) {
  auto const problem = shaken_body<double, S3>();
  auto stepper = adaptive(problem, 1e-6, 1e-8);
  auto x = problem.initial(), y = x;
  EXPECT_EQ(stepper.advance(x, 0, 7), Status::ok);
  stepper.begin();
  EXPECT_EQ(stepper.advance(y, 0, 7), Status::ok);
  EXPECT_EQ(distance<double>(x, y), 0);
}

TEST(AdaptiveOnGroups, ProjectionIsCountedAndCostsNoEvaluation) {
  auto const problem = erase_type(shaken_body<double, SO3>());
  auto x = problem->initial();
  auto stepper = adaptive(*problem, 1e-6, 1e-8, NormPolicy::project);
  ASSERT_EQ(stepper.advance(x, 0, 20), Status::ok);
  Work const work = stepper.work();
  EXPECT_EQ(stepper.projections().count, work.steps);
  EXPECT_EQ(problem->evaluations(), 1 + 5 * work.steps + 4 * work.rejected);
  EXPECT_LT(stepper.projections().raw_defect, 1e-14) << "the exponential leaves nothing to project";
}

TEST(AdaptiveOnGroups, AllocatesNothing) {
  Swarm<decltype(shaken_body<double, S3>())> const swarm{shaken_body<double, S3>(), 3};
  auto x = swarm.initial();
  auto stepper = adaptive(swarm, 1e-6, 1e-8);
  auto const before = bench::allocations_of_this_thread();
  Status const status = stepper.advance(x, 0, 5);
  EXPECT_EQ(bench::allocations_of_this_thread(), before);
  EXPECT_EQ(status, Status::ok);
}

}  // namespace
}  // namespace polhode
