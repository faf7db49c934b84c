/// Methods for constrained systems on the heavy top: defects, invariants, symmetry, failures.
#include "integrators/constrained.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "integrators/generalized_alpha.hpp"
#include "problems/erased.hpp"
#include "tests/support/pinned_runs.hpp"

namespace polhode {
namespace {

using test::pinned_top;
using test::PinnedErrors;

// ---- Constraints ----------------------------------------------------------------------------------------------------

template <class Method, template <class> class A>
void expect_both_constraints(double velocity) {
  auto const most = test::greatest_defects(pinned_top<double, A>(), Method{}, 1e-3, 2);
  EXPECT_LT(most.position, 1e-15) << A<double>::name;
  EXPECT_LT(most.velocity, velocity) << A<double>::name;
}
TEST(ConstraintDefects, OfHalfExplicitAreRoundOff) {
  expect_both_constraints<HalfExplicit4, S3>(5e-15);
  expect_both_constraints<HalfExplicit4, SO3>(5e-15);
  expect_both_constraints<HalfExplicit4, FlatQuaternion>(5e-15);
  expect_both_constraints<HalfExplicit4, FlatRotation>(5e-15);
}
TEST(ConstraintDefects, OfRattleAreRoundOff) {
  expect_both_constraints<Rattle, S3>(2e-14);
  expect_both_constraints<Rattle, SO3>(2e-14);
}
TEST(ConstraintDefects, OfGeneralizedAlphaAreRoundOffAndOfOrder2) {
  auto const problem = pinned_top<double, S3>();
  auto const coarse = test::greatest_defects(problem, GeneralizedAlpha{}, 1e-3, 0.5);
  auto const fine = test::greatest_defects(problem, GeneralizedAlpha{}, 5e-4, 0.5);
  EXPECT_LT(std::max(coarse.position, fine.position), 1e-15);
  EXPECT_GT(fine.velocity, 1e-3);
  EXPECT_NEAR(std::log2(coarse.velocity / fine.velocity), 2, 0.1);
}

// ---- Long times -----------------------------------------------------------------------------------------------------

/// Energy error [J] at every step.
template <class Method>
std::vector<double> energy_errors(double h, double until) {
  auto const problem = pinned_top<double, S3>();
  double shown[5];
  problem.show(problem.initial(), shown);
  double const start = shown[0];
  std::vector<double> errors;
  EXPECT_EQ(test::run_pinned(problem, Method{}, h, until,
                             [&](double, auto const& x, auto const&) {
                               problem.show(x, shown);
                               errors.push_back(shown[0] - start);
                             }),
            Status::ok);
  return errors;
}
double largest_of(std::span<double const> errors) {
  double most = 0;
  for (double const error : errors) most = std::max(most, std::fabs(error));
  return most;
}
TEST(ConstrainedEnergy, OfRattleStaysBounded) {
  std::vector<double> const errors = energy_errors<Rattle>(1e-3, 50);
  std::span<double const> const all(errors);
  EXPECT_LT(largest_of(all.last(5000)), 1.05 * largest_of(all.first(5000)));
  EXPECT_GT(largest_of(all), 0.01);
}
TEST(ConstrainedEnergy, OfGeneralizedAlphaDrifts) {
  std::vector<double> const errors = energy_errors<GeneralizedAlpha>(1e-3, 50);
  std::span<double const> const all(errors);
  EXPECT_GT(largest_of(all.last(5000)), 2 * largest_of(all.first(5000)));
}

TEST(Rattle, IsSymmetric) {
  auto const problem = pinned_top<Quad, S3>();
  using M = std::decay_t<decltype(problem)>::Space;
  Rattle::Memory<M> memory;
  Rattle::Frame<M> frame;
  auto x = problem.initial();
  for (Quad const h : {Quad(1e-3), Quad(-1e-3)}) Rattle{}.step(problem, Quad(0), h, x, frame, memory);
  EXPECT_LT(double(distance<Quad>(x, problem.initial())), 1e-29);
}
/// The form dPi_1.xi_2 - dPi_2.xi_1 - Pi.(xi_1 x xi_2) on variations xi of the attitude and dPi of the momentum about
/// the pivot, both in body axes, is the same after a step: variations by central differences.
TEST(Rattle, IsSymplectic) {
  auto const problem = pinned_top<Quad, S3>();
  auto const& body = problem.body;
  using X = Point<std::decay_t<decltype(problem)>::Space>;
  using V = Vec3<Quad>;
  auto const pose = [&](Quat<Quad> const& q, V const& omega) {
    return X{{q, omega}, {matrix(q) * body.arm(), matrix(q) * cross(omega, body.arm())}};
  };
  auto const momentum = [&](V const& omega) {
    return body.inertia().J * omega + body.mass() * cross(body.arm(), cross(omega, body.arm()));
  };
  auto const stepped = [&](X x) {
    Rattle::Memory<std::decay_t<decltype(problem)>::Space> memory;
    Rattle::Frame<std::decay_t<decltype(problem)>::Space> frame;
    Rattle{}.step(problem, Quad(0), Quad(2e-3), x, frame, memory);
    return x;
  };
  auto const form = [&](V const& xi1, V const& pi1, V const& xi2, V const& pi2, V const& pi) {
    return dot(pi1, xi2) - dot(pi2, xi1) - dot(pi, cross(xi1, xi2));
  };
  Quat<Quad> const q = problem.initial().first.first;
  V const omega = problem.initial().first.second;
  X const end = stepped(problem.initial());
  struct Variation {
    V xi, omega;
  };
  auto const after = [&](Variation const& d) {
    Quad const e(1e-9);
    auto const one = [&](Quad const& sign) {
      return stepped(pose(S3<Quad>::retract(q, sign * d.xi), omega + sign * d.omega)).first;
    };
    auto const right = one(e), left = one(-e);
    Quad const half = Quad(0.5) / e;
    return Variation{
        half * (S3<Quad>::local(end.first.first, right.first) - S3<Quad>::local(end.first.first, left.first)),
        half * (right.second - left.second)};
  };
  Variation const a{{.3, -.5, .7}, {.2, .9, -.4}}, b{{-.6, .1, .4}, {.5, -.3, .8}};
  Variation const a1 = after(a), b1 = after(b);
  Quad const before = form(a.xi, momentum(a.omega), b.xi, momentum(b.omega), momentum(omega));
  Quad const now = form(a1.xi, momentum(a1.omega), b1.xi, momentum(b1.omega), momentum(end.first.second));
  EXPECT_GT(std::fabs(double(before)), 1);
  EXPECT_NEAR(double(now - before), 0, 1e-13);
}
/// The greatest change of the vertical angular momentum [N m s].
template <class S>
double momentum_drift(double until) {
  auto const problem = pinned_top<S, S3>();
  auto const vertical = [&](auto const& x) {
    return problem.body.angular_momentum(matrix(x.first.first), x.second.first, x.first.second, x.second.second).z;
  };
  S const start = vertical(problem.initial());
  double most = 0;
  EXPECT_EQ(test::run_pinned(problem, Rattle{}, 1e-3, until,
                             [&](double, auto const& x, auto const&) {
                               most = std::max(most, std::fabs(double(vertical(x) - start)));
                             }),
            Status::ok);
  return most;
}
TEST(Rattle, KeepsTheVerticalMomentum) {
  EXPECT_LT(momentum_drift<Quad>(0.5), 1e-27);
  EXPECT_LT(momentum_drift<double>(2), 1e-9);  // of 70: the rounded norm of q enters every step
}

// ---- The steppers ---------------------------------------------------------------------------------------------------

template <class Method>
void expect_a_good_stepper(std::int64_t evaluations_at_most) {
  auto const problem = pinned_top<double, S3>();
  auto const erased = erase_type(problem);
  auto stepper = Method{}.bind(problem, FixedStep{1e-3}, NormPolicy::none);
  auto hidden = Method{}.bind(*erased, FixedStep{1e-3}, NormPolicy::none);
  auto x = problem.initial(), y = x;
  auto const before = bench::allocations_of_this_thread();
  EXPECT_EQ(stepper.advance(x, 0, 0.1), Status::ok);
  EXPECT_EQ(bench::allocations_of_this_thread(), before) << Method::info.name;
  EXPECT_EQ(hidden.advance(y, 0, 0.1), Status::ok);
  EXPECT_EQ(distance<double>(x, y), 0) << Method::info.name;
  EXPECT_EQ(length(stepper.multiplier() - hidden.multiplier()), 0);
  EXPECT_EQ(stepper.work().steps, 100);
  EXPECT_GE(stepper.work().evaluations, 200);
  EXPECT_LE(stepper.work().evaluations, evaluations_at_most);
  EXPECT_EQ(erased->evaluations(), 0);

  auto wild = Method{}.bind(problem, FixedStep{0.1}, NormPolicy::none);  // 15 rad
  x = problem.initial();
  EXPECT_NE(wild.advance(x, 0, 1), Status::ok) << Method::info.name;
}
TEST(ConstrainedSteppers, CountFailAndAllocateNothing) {
  expect_a_good_stepper<HalfExplicit4>(500);
  expect_a_good_stepper<Rattle>(700);
  expect_a_good_stepper<GeneralizedAlpha>(700);
}
TEST(ConstrainedSteppers, NewtonThatFailsSaysSo) {
  auto const problem = pinned_top<double, S3>();
  auto stepper = Rattle{}.bind(problem, FixedStep{0.03}, NormPolicy::none);  // sin(4.5) < 0: no such rotation
  auto x = problem.initial();
  EXPECT_EQ(stepper.advance(x, 0, 0.3), Status::nonlinear_fail);
}

TEST(ConstrainedSteppers, GeneralizedAlphaTakesStepsOfOtherLengths) {
  auto const problem = pinned_top<double, S3>();
  auto const error = [&](double h) {
    auto stepper = GeneralizedAlpha{}.bind(problem, FixedStep{h}, NormPolicy::none);
    auto x = problem.initial();
    double t = 0;
    for (int i = 0; t < 0.1; ++i) {
      double const next = std::min(0.1, t + (i % 3 == 0 ? 2.5 : 1) * h);  // a step, or two and a half
      EXPECT_EQ(stepper.advance(x, t, next), Status::ok);
      t = next;
      if (i % 20 == 19) stepper.restart();
    }
    return test::errors_of(problem, x, stepper.multiplier(), test::pinned_reference(problem, 0.1));
  };
  PinnedErrors const coarse = error(4e-4), fine = error(1e-4);
  EXPECT_GT(coarse[0] / fine[0], 12);
  EXPECT_LT(coarse[0], 1e-2);
}

TEST(ConstrainedSteppers, AreRefusedElsewhere) {
  using Body = RigidBody<S3<double>>;
  using Moving = MovingBody<S3<double>>;
  using Flat = MovingBody<FlatQuaternion<double>>;
  EXPECT_EQ(refusal<Body>(Needs::constraint), "needs a constrained problem (heavy_top, variant dae)");
  EXPECT_EQ(refusal<Moving>(Needs::constraint), "");
  EXPECT_EQ(refusal<Flat>(Needs::constraint), "");
  EXPECT_EQ(refusal<Moving>(Needs::constraint_on_group), "");
  EXPECT_THAT(std::string(refusal<Flat>(Needs::constraint_on_group)), testing::HasSubstr("rotation group"));
  EXPECT_EQ(refusal<Flat>(Needs::constraint_on_quaternion), "");
  EXPECT_THAT(std::string(refusal<Moving>(Needs::constraint_on_quaternion)), testing::HasSubstr("flat quaternions"));
  static_assert(!RunsFixed<Rattle, PinnedField<double, FlatQuaternion>>);
  static_assert(RunsFixed<HalfExplicit4, PinnedField<double, FlatRotation>>);
}

}  // namespace
}  // namespace polhode
