/// Gauss where the fixed point diverges: Newton takes over, the order stays.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/gauss.hpp"
#include "problems/erased.hpp"
#include "problems/pd_slew.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

/// The slew of a body so light that its rate settles at 20 to 40 1/s.
PdSlew light_slew() {
  Choice choice;
  choice.set["inertia"] = {0.5, 0.85, 1};
  return PdSlew(choice);
}
Quat<Quad> const& reference() {
  static Quat<Quad> const q = [] {
    auto const field = light_slew().field<Quad, S3, true>();
    auto x = field.initial();
    EXPECT_EQ(Gauss<8>{}.bind(field, FixedStep{1.0 / 64}, NormPolicy::none).advance(x, 0, 2), Status::ok);
    return x.first;
  }();
  return q;
}
template <template <class> class A, Scalar S = double, class Control>
double error_of(int stages, Control const& control) {
  auto const field = light_slew().field<S, A, true>();
  auto x = field.initial();
  EXPECT_EQ(GaussOf{stages}.bind(field, control, NormPolicy::none).advance(x, 0, 2), Status::ok) << stages;
  return double(angle_between(test::in<Quad>(A<S>::attitude(x.first)), reference()));
}

/// Steps of one body in double, 2 s long, and what they took.
template <template <class> class A>
GaussMemory<RigidBody<A<double>>> memory_of(PdSlew const& slew, int stages, double h) {
  auto const field = slew.field<double, A, true>();
  GaussMethod<RigidBody<A<double>>> method(stages, {});
  GaussMemory<RigidBody<A<double>>> memory;
  auto x = field.initial();
  for (int i = 0; i < std::lround(2 / h); ++i) method.step(field, i * h, h, x, memory, false);
  return memory;
}

TEST(GaussNewton, RunsWhereTheFixedPointDiverges) {
  for (int stages = 1; stages <= 8; ++stages)
    for (double h : {0.5, 0.25, 0.125}) {
      EXPECT_EQ(memory_of<FlatQuaternion>(light_slew(), stages, h).jacobians, 2 / h) << stages << ", h = " << h;
      EXPECT_EQ(memory_of<S3>(light_slew(), stages, h).jacobians, 2 / h) << stages << ", h = " << h;
      double const bound = stages == 1 ? 5e-3 : 1e-3;  // h times the fastest rate is 5 to 20: no order to see yet
      EXPECT_LT(error_of<FlatQuaternion>(stages, FixedStep{h}), bound) << stages << ", h = " << h;
      EXPECT_LT(error_of<S3>(stages, FixedStep{h}), bound) << stages << ", h = " << h;
    }
}

// From h = 1/32 s on the fixed point may serve again, where it does not crawl.
TEST(GaussNewton, LeavesTheOrderAsItIs) {
  for (int stages = 1; stages <= 4; ++stages) {
    auto const error = [&](double h) { return error_of<FlatQuaternion, Quad>(stages, FixedStep{h}); };
    EXPECT_NEAR(std::log2(error(1.0 / 64) / error(1.0 / 128)), 2 * stages, 0.15) << stages;
    EXPECT_LT(error(1.0 / 16), error(1.0 / 8) / 3) << stages;
    EXPECT_LT(error(1.0 / 32), error(1.0 / 16) / 3) << stages;
  }
}

TEST(GaussNewton, ServesAdaptiveSteps) {
  for (int stages : {2, 4, 6}) EXPECT_LT(error_of<FlatQuaternion>(stages, Adaptive{1e-8, 1e-10}), 1e-7) << stages;
}

TEST(GaussNewton, SolvesTheSameEquationsInQuadruplePrecision) {
  auto const field = light_slew().field<Quad, FlatQuaternion, true>();
  auto x = field.initial(), back = x;
  EXPECT_EQ(Gauss<3>{}.bind(field, FixedStep{0.125}, NormPolicy::none).advance(x, 0, 0.5), Status::ok);
  back = x;
  EXPECT_EQ(Gauss<3>{}.bind(field, FixedStep{-0.125}, NormPolicy::none).advance(back, 0.5, 0), Status::ok);
  EXPECT_LT(double(distance<Quad>(back, field.initial())), 1e-24) << "symmetric only as far as stages are solved";
}

/// The rate wants to jump by more than any step: there is no solution to find.
struct Jumping {
  using Space = Euclidean3<double>;
  Vec3<double> operator()(double, Vec3<double> const& x) const { return {x.x < 1 ? 100.0 : -100.0, 0, 0}; }
  Vec3<double> initial() const { return {0, 0, 0}; }
};

TEST(GaussNewton, SaysSoWhereThereIsNoSolution) {
  Jumping const problem;
  auto x = problem.initial();
  EXPECT_EQ(Gauss<1>{}.bind(problem, FixedStep{0.1}, NormPolicy::none).advance(x, 0, 1), Status::nonlinear_fail);
}

TEST(GaussNewton, IsLeftAloneWhereTheFixedPointServes) {
  for (int stages = 1; stages <= 8; ++stages) {
    auto const memory = memory_of<FlatQuaternion>(PdSlew(Choice{}), stages, 0.125);
    EXPECT_EQ(memory.jacobians, 0) << stages;
    EXPECT_FALSE(memory.unconverged) << stages;
  }
}

}  // namespace
}  // namespace polhode
