#pragma once
/// Fields whose solution, or which themselves, end before the run does; and how an adaptive method must end there.
#include <gtest/gtest.h>

#include <limits>

#include "integrators/integrator.hpp"

namespace polhode::test {

/// x' = x^2 leaves every bound at 1 s.
struct Escape {
  using Space = Euclidean3<double>;
  Vec3<double> operator()(double, Vec3<double> const& x) const { return {x.x * x.x, 0, 0}; }
  Vec3<double> initial() const { return {1, 0, 0}; }
};
/// The field is not a number from the time `from` on.
struct NotANumber {
  using Space = Euclidean3<double>;
  double from;
  Vec3<double> operator()(double t, Vec3<double> const& x) const {
    return {t < from ? -x.x : std::numeric_limits<double>::quiet_NaN(), 0, 0};
  }
  Vec3<double> initial() const { return {1, 0, 0}; }
};

/// Steps towards 2 s from x at 0 s underflow at 1 s, and leave the last accepted state.
template <class Stepper, class X>
void expect_underflow_at_1_s(Stepper stepper, X x) {
  double t = 0;
  Status status = Status::ok;
  while (status == Status::ok && t < 2) status = stepper.step(x, t, 2);
  EXPECT_EQ(status, Status::step_underflow);
  EXPECT_NEAR(t, 1, 1e-6);
  EXPECT_TRUE(all_finite(x)) << "the last accepted state";
}

}  // namespace polhode::test
