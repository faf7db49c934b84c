/// Splittings: coefficients, order with and without torque, symmetric bodies.
#include <gtest/gtest.h>

#include "tests/integrators/free_body_runs.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"
#include "tests/support/splitting_runs.hpp"

namespace polhode {
namespace {

using test::for_each_splitting;
using test::FreeCase;
using test::top_under;

// ---- Coefficients ---------------------------------------------------------------------------------------------------

// Blanes & Moan (2002), table 2.
TEST(Splitting, HasThePublishedCoefficients) {
  auto const s = BlanesMoan4::splitting();
  EXPECT_NEAR(double(s.a[0]), 0.0792036964311957, 1e-17);
  EXPECT_NEAR(double(s.a[1]), 0.353172906049774, 1e-16);
  EXPECT_NEAR(double(s.a[2]), -0.0420650803577195, 1e-17);
  EXPECT_NEAR(double(s.b[0]), 0.209515106613362, 5e-16);
  EXPECT_NEAR(double(s.b[1]), -0.143851773179818, 5e-16);
  auto const yoshida = Yoshida4::coefficients<double>();
  EXPECT_NEAR(2 * yoshida[0], 1.3512071919596578, 1e-15);
  EXPECT_NEAR(2 * yoshida[2], -1.7024143839193153, 1e-15);
}

/// The order conditions of a composition of chi and chi*, up to 3: what is left of them.   Symmetry does order 4.
/// Hairer, Lubich & Wanner, III.3, example 3.15
template <std::size_t n>
double defect_of(std::array<Quad, n> const& alpha) {
  Quad sum = 0, cubes = 0, mixed = 0, before = 0;
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i) {
    worst = std::max(worst, std::fabs(double(alpha[i] - alpha[n - 1 - i])));
    Quad const a = alpha[i], sign = i % 2 == 0 ? 1 : -1;
    // A turn of chi has the second factor first, one of chi* the other way round.
    mixed += sign * a * a * (2 * before + a);
    before += a;
    sum += a;
    cubes += a * a * a;
  }
  return std::max({worst, std::fabs(double(sum - 1)), std::fabs(double(cubes)), std::fabs(double(mixed))});
}
TEST(Splitting, MeetsTheOrderConditionsTo33Digits) {
  EXPECT_LT(defect_of(Yoshida4::coefficients<Quad>()), 1e-32);
  EXPECT_LT(defect_of(BlanesMoan4::coefficients<Quad>()), 1e-32);
  EXPECT_GT(defect_of(Strang::coefficients<Quad>()), 0.1);
}

// ---- Order ----------------------------------------------------------------------------------------------------------

template <class P>
double order_on(P const& problem, auto const& method, Point<typename P::Space> const& exact, double h) {
  using A = typename P::Space::Factor;
  auto const error = [&](double step) { return test::angle_apart<A>(test::state_at(method, problem, step, 2), exact); };
  double const coarse = error(h), fine = error(h / 2);
  EXPECT_GT(fine, 1e-27) << "round-off: no order to see";
  return test::order_of(coarse, fine);
}
template <class P>
void expect_orders(P const& problem, double gauss_step, double h) {
  auto const exact = test::by_gauss(problem, gauss_step, 2);
  for_each_splitting([&](auto method) {
    using Method = decltype(method);
    bool const nothing_to_see =
        P::torque_free() && (std::same_as<Method, ExactKicks> || std::same_as<Method, ExactKicks4>);
    if (nothing_to_see) {
      EXPECT_LT(double(distance<Quad>(test::state_at(method, problem, h, 2), exact)), 1e-30);
      return;
    }
    EXPECT_NEAR(order_on(problem, method, exact, h), method.info.order, 0.1) << method.info.name;
    EXPECT_NEAR(order_on(problem, method, exact, h / 4), method.info.order, 0.05) << method.info.name;
  });
}
TEST(Splitting, HasItsOrderOnAFreeBody) {
  expect_orders(FreeCase{}.field<Quad, FlatQuaternion>(), 0.25, 0.125);
  expect_orders(test::turned_axes().field_of_matrix<Quad, SO3>(), 0.25, 0.125);
}
TEST(Splitting, HasItsOrderUnderATorqueOfAttitudeAndTime) {
  expect_orders(top_under<Quad, FlatQuaternion>({}), 0.0625, 0.03125);
  expect_orders(top_under<Quad, S3>({.shaken = true}), 0.0625, 0.03125);
}
TEST(Splitting, HasItsOrderUnderATorqueThatFeelsTheRate) {
  expect_orders(test::shaken_body<Quad, FlatQuaternion>(), 0.0625, 0.03125);
}
// In body axes the held torque is constant: a sample period is an arc of its own.
TEST(Splitting, HasItsOrderUnderAHeldTorque) {
  using Control = SampledPd<Quad>;
  auto problem = controlled_body<Quad, S3, true>(BodyParameters{}, Control(PdController<Quad>{4, 20}, 0, Quad(0)));
  problem.sample(0, problem.initial());
  EXPECT_GT(double(length(problem.held)), 1);
  expect_orders(problem, 0.125, 0.125);
}

/// Coefficients that are wrong in the third digit.
struct BrokenYoshida4 : Yoshida4 {
  template <class R>
  static std::array<R, 6> coefficients() {
    auto alpha = Yoshida4::coefficients<R>();
    alpha[0] = alpha[5] = alpha[0] + R(0.001);
    alpha[2] = alpha[3] = alpha[2] - R(0.001);
    return alpha;
  }
};
struct BrokenBlanesMoan4 : BlanesMoan4 {
  template <class R>
  static std::array<R, 12> coefficients() {
    auto alpha = BlanesMoan4::coefficients<R>();
    alpha[1] = alpha[10] = alpha[1] + R(0.001);
    alpha[2] = alpha[9] = alpha[2] - R(0.001);
    return alpha;
  }
};
TEST(Splitting, LosesItsOrderWithAWrongCoefficient) {
  auto const problem = top_under<Quad, FlatQuaternion>({});
  auto const exact = test::by_gauss(problem, 0.0625, 2);
  EXPECT_NEAR(order_on(problem, Splitting<ThreeRotations, BrokenYoshida4>{}, exact, 0.01), 2, 0.3);
  EXPECT_NEAR(order_on(problem, Splitting<ThreeRotations, BrokenBlanesMoan4>{}, exact, 0.01), 2, 0.3);
  EXPECT_NEAR(order_on(problem, Splitting<ExactFlow, BrokenBlanesMoan4>{}, exact, 0.01), 2, 0.3);
}

// ---- Symmetric bodies -----------------------------------------------------------------------------------------------

TEST(Splitting, IsExactForASymmetricTop) {
  for (std::vector<double> const& inertia :
       {std::vector<double>{2, 3, 2}, {3, 3, 2}, {3, 2, 3}, {2, 2, 3}, {2, 3, 3}, {3, 2, 2}, {2, 2, 2}}) {
    FreeCase c;
    c.inertia = inertia;
    auto const field = c.field<Quad, FlatQuaternion>();
    auto const x = test::state_at(SplitSrStrang{}, field, 1.5, 3);
    auto const expected = c.exact<Quad>().at(3);
    EXPECT_LT(double(distance<Quad>(x.first, expected.first)), 1e-31);
    EXPECT_LT(double(distance<Quad>(x.second, expected.second)), 1e-31);
  }
}
// Whichever axis is the middle one.
TEST(Splitting, TakesTheMomentsInAnyOrder) {
  for (std::vector<double> const& inertia :
       {std::vector<double>{2, 3, 4}, {2, 4, 3}, {3, 2, 4}, {3, 4, 2}, {4, 2, 3}, {4, 3, 2}}) {
    FreeCase c;
    c.inertia = inertia;
    auto const x = test::state_at(SplitSrBm4{}, c.field<Quad, FlatQuaternion>(), 0.01, 1);
    EXPECT_LT(double(distance<Quad>(x.first, c.exact<Quad>().at(1).first)), 1e-11);
  }
}

}  // namespace
}  // namespace polhode
