/// Gauss on canonical variables: order, torques, momentum in space to round-off, energy that oscillates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "integrators/gauss_canonical.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

template <class P, class Method>
auto end_of(P const& problem, Method const& method, double h, double t_end) {
  auto x = problem.initial();
  EXPECT_EQ(method.bind(problem, FixedStep{h}, NormPolicy::none).advance(x, 0, t_end), Status::ok);
  return x;
}

TEST(GaussCanonical, IsTheSameMotionOnEveryDescriptionAndUnderTorque) {
  Choice choice;
  choice.set["inertia"] = {100, 120, 110, 5, -4, 3};
  auto const expect_same = [](auto const& field) {
    EXPECT_LT(distance<double>(end_of(field, GaussCanonical<8>{}, 0.25, 10), end_of(field, Gauss<8>{}, 0.25, 10)),
              1e-14);
  };
  expect_same(PdSlew(Choice{}).field<double, FlatQuaternion, true>());
  expect_same(PdSlew(Choice{}).field<double, S3, true>());
  expect_same(PdSlew(Choice{}).field<double, SO3, true>());
  expect_same(PdSlew(choice).field<double, FlatRotation, false>());
  expect_same(FreeBody(choice).field<double, FlatQuaternion, false>());
}

template <int s>
void expect_order() {
  auto const field = PdSlew(Choice{}).field<Quad, FlatQuaternion, true>();
  static auto const exact = end_of(field, Gauss<8>{}, 1.0 / 16, 2);
  double const h = s < 3 ? 1.0 / 64 : 1.0 / 4;
  double const coarse = double(distance<Quad>(end_of(field, GaussCanonical<s>{}, h, 2), exact));
  double const fine = double(distance<Quad>(end_of(field, GaussCanonical<s>{}, h / 2, 2), exact));
  EXPECT_NEAR(std::log2(coarse / fine), 2 * s, 0.1) << s << " stages";
}

TEST(GaussCanonical, HasOrderTwoS) {
  expect_order<1>();
  expect_order<2>();
  expect_order<3>();
  expect_order<4>();
}

struct Drifts {
  double norm = 0, momentum = 0, energy = 0, late_energy = 0;
};
/// Over 10^5 steps of 0.5 s; late: over the last tenth.
template <int s>
Drifts drifts() {
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto x = field.initial();
  auto stepper = GaussCanonical<s>{}.bind(field, FixedStep{0.5}, NormPolicy::none);
  auto const momentum = [&] {
    Vec3<Quad> const w = test::in<Quad>(x.second);
    return to_inertial(test::in<Quad>(x.first), Vec3<Quad>{100 * w.x, 120 * w.y, 110 * w.z});
  };
  auto const energy = [&] {
    return 50 * x.second.x * x.second.x + 60 * x.second.y * x.second.y + 55 * x.second.z * x.second.z;
  };
  Vec3<Quad> const momentum_before = momentum();
  double const energy_before = energy();
  Drifts most;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(stepper.advance(x, 50.0 * i, 50.0 * (i + 1)), Status::ok);
    double const change = std::fabs(energy() / energy_before - 1);
    most.norm = std::max(most.norm, FlatQuaternion<double>::defect(x.first));
    most.momentum = std::max(most.momentum, double(length(momentum() - momentum_before) / length(momentum_before)));
    most.energy = std::max(most.energy, change);
    if (i >= 900) most.late_energy = std::max(most.late_energy, change);
  }
  return most;
}

TEST(GaussCanonical, KeepsMomentumInSpaceWhileEnergyOscillates) {
  Drifts const two = drifts<2>(), four = drifts<4>();
  for (Drifts const& most : {two, four}) {
    EXPECT_LT(most.norm, 1e-14);
    EXPECT_LT(most.momentum, 2e-14);
  }
  EXPECT_GT(two.energy, 1e-10) << "it does oscillate";
  EXPECT_LT(two.energy, 1e-7);
  EXPECT_LT(two.late_energy, 1.1 * two.energy) << "and does not grow";
  EXPECT_LT(four.energy, 1e-12);
}

TEST(GaussCanonical, TakesUpAStateThatWasChangedFromOutside) {
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto stepper = GaussCanonical<3>{}.bind(field, FixedStep{0.5}, NormPolicy::none);
  auto x = field.initial(), y = x;
  stepper.advance(x, 0, 10);
  x = field.initial();
  stepper.advance(x, 10, 20);
  GaussCanonical<3>{}.bind(field, FixedStep{0.5}, NormPolicy::none).advance(y, 10, 20);
  EXPECT_EQ(distance<double>(x, y), 0);
}

}  // namespace
}  // namespace polhode
