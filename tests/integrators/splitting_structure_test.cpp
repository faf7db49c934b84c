/// Splittings: what they keep, their symmetry and its limit, evaluations, refusals.
#include <gtest/gtest.h>

#include "problems/mrp.hpp"
#include "tests/integrators/free_body_runs.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/splitting_runs.hpp"

namespace polhode {
namespace {

using test::for_each_splitting;
using test::FreeCase;
using test::top;
using test::top_under;
using test::Weight;

constexpr double eps = 0x1p-52;

// ---- What is kept ---------------------------------------------------------------------------------------------------

TEST(Splitting, KeepsNormAndMomentumOfAFreeBody) {
  FreeCase const c;
  auto const check = [](auto method, auto const& field) {
    test::Drift const drift = test::drift_over(field, method, 0.1, 10, 100);
    EXPECT_LT(drift.norm, 32 * eps) << method.info.name;
    EXPECT_LT(drift.momentum, 32 * eps) << method.info.name;
    EXPECT_LT(drift.direction, 32 * eps) << method.info.name;
    EXPECT_LT(drift.energy, method.info.preserves & keeps_energy ? 256 * eps : 1e-3) << method.info.name;
  };
  for_each_splitting([&](auto method) { check(method, c.field<double, FlatQuaternion>()); });
  check(SplitBm4{}, test::turned_axes().field_of_matrix<double, SO3>());
  check(SplitSrStrang{}, test::turned_axes().field_of_matrix<double, SO3>());
  check(ExactKicks{}, test::turned_axes().field_of_matrix<double, SO3>());
}
/// The greatest and the last of the energy errors of the weighted top in n seconds, and the drift of the vertical
/// momentum and of the norm.
struct TopRun {
  double early = 0, late = 0, vertical = 0, norm = 0;
};
template <class Method>
TopRun long_run(Method const& method, double h, int n) {
  auto const problem = top_under<double, FlatQuaternion>({});
  auto const J = problem.inertia_matrix();
  auto const energy = [&](auto const& x) { return dot(x.second, J * x.second) / 2 + Weight<double>::energy(x.first); };
  auto const vertical = [&](auto const& x) { return to_inertial(x.first, J * x.second).z; };
  auto stepper = method.bind(problem, FixedStep{h}, NormPolicy::none);
  auto x = problem.initial();
  double const energy0 = energy(x), vertical0 = vertical(x);
  TopRun run;
  for (int i = 0; i < n; ++i) {
    EXPECT_EQ(stepper.advance(x, i, i + 1), Status::ok);
    double& worst = 2 * i < n ? run.early : run.late;
    worst = std::max(worst, std::fabs(energy(x) - energy0));
    run.vertical = std::max(run.vertical, std::fabs(vertical(x) - vertical0));
    run.norm = std::max(run.norm, std::fabs(dot(x.first, x.first) - 1));
  }
  return run;
}
TEST(Splitting, BoundsTheEnergyErrorUnderAPotential) {
  for_each_splitting([](auto method) {
    TopRun const run = long_run(method, 0.1, 1000);
    EXPECT_LT(run.late, 1.5 * run.early) << method.info.name;
    EXPECT_LT(run.early, method.info.order == 2 ? 0.02 : 2e-3) << method.info.name;
    EXPECT_LT(run.vertical, 64 * eps) << method.info.name;
    EXPECT_LT(run.norm, 32 * eps) << method.info.name;
  });
}

// ---- Symmetry -------------------------------------------------------------------------------------------------------

TEST(Splitting, ReturnsToTheStart) {
  for_each_splitting([](auto method) {
    EXPECT_LT(test::forth_and_back(method, FreeCase{}.field<Quad, FlatQuaternion>(), 0.5, 20), 1e-30);
    EXPECT_LT(test::forth_and_back(method, top_under<Quad, FlatQuaternion>({.shaken = true}), 0.0625, 50), 1e-28);
  });
  EXPECT_LT(test::forth_and_back(SplitBm4{}, top_under<double, SO3>({}), 0.0625, 50), 1e-11);
}
// The pitfall: a kick by a torque that feels the rate is a step of Kutta's, which has a direction.
TEST(Splitting, DoesNotReturnUnderATorqueThatFeelsTheRate) {
  auto const problem = test::shaken_body<Quad, FlatQuaternion>();
  double const far = test::forth_and_back(SplitStrang{}, problem, 0.25, 20);
  EXPECT_GT(far, 1e-14);
  EXPECT_LT(far, 1e-8);
  EXPECT_LT(test::forth_and_back(SplitStrang{}, problem, 0.125, 40), far / 10);
}

// ---- Work and refusals ----------------------------------------------------------------------------------------------

TEST(Splitting, AsksForTheTorqueOnceAKickOrFourTimes) {
  auto const per_step = [](auto method, bool secretive) {
    std::int64_t asked = 0;
    Weight<double> const weight{.asked = &asked};
    if (secretive)
      test::state_at(method, controlled_body<double, S3, true>(top(), test::SecretiveWeight<double>{weight}), 0.125, 1);
    else
      test::state_at(method, top_under<double, S3>(weight), 0.125, 1);
    return double(asked) / 8;
  };
  EXPECT_EQ(per_step(SplitStrang{}, false), 1);
  EXPECT_EQ(per_step(SplitYoshida4{}, false), 3);
  EXPECT_EQ(per_step(SplitBm4{}, false), 6);
  EXPECT_EQ(per_step(ExactKicks{}, false), 1);
  EXPECT_EQ(per_step(SplitStrang{}, true), 4);
  EXPECT_EQ(per_step(ExactKicks4{}, true), 24);
}
TEST(Splitting, WantsARigidBodyOfQuaternionsOrMatrices) {
  for_each_splitting([](auto method) {
    using Method = decltype(method);
    EXPECT_TRUE((RunsFixed<Method, decltype(test::shaken_body<double, FlatRotation>())>));
    EXPECT_TRUE((RunsFixed<Method, decltype(FreeCase{}.field_of_matrix<double, S3>())>));
    EXPECT_FALSE((RunsFixed<Method, decltype(FreeCase{}.field<double, Mrp>())>));
    EXPECT_EQ(method.info.family, Family::splitting);
  });
}

}  // namespace
}  // namespace polhode
