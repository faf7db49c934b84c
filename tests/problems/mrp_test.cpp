/// Modified Rodrigues parameters: the laws, the kinematics, the projection of the sphere and the shadow points.
#include "problems/mrp.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "problems/space_laws.hpp"
#include "tests/problems/kinematics.hpp"

namespace polhode {
namespace {

using test::in;
using test::kinematics_error;
using test::Random;
using test::series_error;

template <template <class> class SpaceOf, class... S>
constexpr bool serves = ((Attitude<SpaceOf<S>> && FlatSpace<SpaceOf<S>> && !SpaceOf<S>::constrained) && ...);
static_assert(serves<Mrp, double, Quad, Dual<1>, Dual<6>, Jet<double, 8>, Jet<Quad, 32>>);
static_assert(serves<MrpShadow, double, Quad, Dual<1>, Dual<6>, Jet<double, 8>, Jet<Quad, 32>>);
static_assert(std::same_as<Mrp<double>::Over<Quad>, Mrp<Quad>>);
static_assert(std::same_as<MrpShadow<double>::Over<Quad>, MrpShadow<Quad>>);
static_assert(Mrp<double>::name == "mrp" && MrpShadow<double>::name == "mrp_shadow");
static_assert(FlatSpace<RigidBody<MrpShadow<double>>>);

using D = Dual<1>;

constexpr double pi = 3.14159265358979323846;
/// Some 30 operations on numbers of size |sigma|^2 <= 10.
constexpr double rounding = 1e-13;
/// |sigma| of the points tried: both sides of the border, near the identity and towards q = -1.
constexpr double sizes[] = {0, 1e-8, 0.3, 0.99, 1.01, 1.7, 3};

double apart(Vec3<double> const& a, Vec3<double> const& b) {
  return distance<double>(a, b);
}
double apart(Quat<double> const& a, Quat<double> const& b) {
  return distance<double>(a, b);
}
double apart(Mat3<double> const& a, Mat3<double> const& b) {
  return distance<double>(a, b);
}
Vec3<double> slopes(Vec3<D> const& v) {
  return {v.x.slope[0], v.y.slope[0], v.z.slope[0]};
}
/// sigma when the body turns at omega, as a function of time: value and first derivative.
Vec3<D> moving(Vec3<double> const& sigma, Vec3<double> const& omega) {
  D s(0.0);
  s.slope[0] = 1;
  Vec3<D> moved = in<D>(sigma);
  add(moved, s, mrp_rate(in<D>(sigma), in<D>(omega)));
  return moved;
}

// ---- The space ------------------------------------------------------------------------------------------------------

TEST(Mrp, ObeysTheLawsOfASpace) {
  Random random(1);
  for (double size : sizes)
    for (double offset : {0.0, 1e-6, 0.5, 2.0}) {
      Vec3<D> const x = in<D>(size * random.direction()), du = in<D>(offset * random.direction());
      Vec3<D> const omega = in<D>(random.vector(1));
      EXPECT_LT(check_space_laws<Mrp>(x, du, omega), rounding) << size;
      EXPECT_LT(check_space_laws<MrpShadow>(x, du, omega), rounding) << size;
    }
}

TEST(Mrp, HasNoConstraint) {
  Vec3<double> sigma{3, -1, 2};
  EXPECT_EQ(Mrp<double>::defect(sigma), 0);
  EXPECT_EQ(Mrp<double>::project(sigma), 0);
  EXPECT_EQ(apart(sigma, {3, -1, 2}), 0);
}

// ---- Kinematics -----------------------------------------------------------------------------------------------------

TEST(Mrp, MovesAsTheQuaternionDoes) {
  Random random(2);
  for (double size : sizes)
    for (int i = 0; i < 50; ++i) {
      Vec3<double> const sigma = size * random.direction(), omega = random.vector(2);
      EXPECT_LT(kinematics_error<Mrp>(sigma, omega), 1e-14) << size;
      EXPECT_LT(kinematics_error<MrpShadow>(sigma, omega), 1e-14) << size;
    }
}

TEST(Mrp, ItsPowerSeriesIsASteadyTurn) {
  Random random(3);
  for (double size : sizes) {
    Vec3<double> const sigma = size * random.direction(), omega = random.vector(1);
    EXPECT_LT(series_error<Mrp>(sigma, omega, 0.05), 1e-25) << size;
    EXPECT_LT(series_error<MrpShadow>(sigma, omega, 0.05), 1e-25) << size;
  }
}

TEST(Mrp, RateByHand) {
  // At sigma = (1, 0, 0): 2 G = hat(sigma) + sigma sigma^T.
  EXPECT_EQ(apart(mrp_rate(Vec3<double>{1, 0, 0}, Vec3<double>{2, 4, 6}), {1, -3, 2}), 0);
  EXPECT_EQ(apart(mrp_rate_transposed(Vec3<double>{1, 0, 0}, Vec3<double>{2, 4, 6}), {1, 3, -2}), 0);
  EXPECT_EQ(apart(mrp_rate(Vec3<double>{0, 0, 0}, Vec3<double>{2, 4, 6}), {0.5, 1, 1.5}), 0);
}

TEST(Mrp, TheKinematicMatrixIsAScaledRotation) {
  Random random(4);
  for (double size : sizes)
    for (int i = 0; i < 50; ++i) {
      Vec3<double> const sigma = size * random.direction(), u = random.vector(1), v = random.vector(1);
      double const scale = (1 + dot(sigma, sigma)) / 4;
      EXPECT_LT(apart(mrp_rate_transposed(sigma, mrp_rate(sigma, v)), (scale * scale) * v), 1e-14) << size;
      EXPECT_NEAR(dot(u, mrp_rate(sigma, v)), dot(mrp_rate_transposed(sigma, u), v), 1e-14) << size;
    }
}

// ---- The projection of the sphere -----------------------------------------------------------------------------------

TEST(Mrp, AQuarterTurnByHand) {
  double const half = std::sqrt(0.5), expected = std::tan(pi / 8);
  EXPECT_LT(apart(mrp_of(Quat<double>{0, 0, half, half}), {0, 0, expected}), 2e-16);
  EXPECT_LT(apart(mrp_of(Quat<double>{0, 0, -half, -half}), {0, 0, -1 / expected}), 1e-15);  // tan(3 pi / 8), turned on
  EXPECT_LT(apart(quaternion_of_mrp(Vec3<double>{0, 0, expected}), Quat<double>{0, 0, half, half}), 3e-16);
}

TEST(Mrp, KeepsTheSignOfTheQuaternion) {
  Random random(5);
  int beyond = 0;
  for (int i = 0; i < 1000; ++i) {
    Quat<double> const q = random.attitude();
    Vec3<double> const sigma = Mrp<double>::from_attitude(q);
    EXPECT_EQ(length(sigma) > 1, q.w < 0);
    EXPECT_LT(apart(Mrp<double>::attitude(sigma), q), 2e-15);
    beyond += length(sigma) > 1 ? 1 : 0;
  }
  EXPECT_GT(beyond, 400);
}

TEST(Mrp, TheOtherWayRound) {
  Random random(6);
  for (double size : sizes) {
    Vec3<double> const sigma = size * random.direction();
    EXPECT_LT(apart(Mrp<double>::from_attitude(Mrp<double>::attitude(sigma)), sigma), 1e-14) << size;
    Vec3<Quad> const fine = in<Quad>(sigma);
    EXPECT_LT(double(distance<Quad>(mrp_of(quaternion_of_mrp(fine)), fine)), 1e-32) << size;
  }
}

TEST(Mrp, KeepsItsDigitsTowardsInfinity) {
  for (double left : {1e-1, 1e-4, 1e-7, 1e-10}) {  // [rad] left to a full turn
    Vec3<double> const sigma = mrp_of(Quat<double>{0, std::sin(left / 2), 0, -std::cos(left / 2)});
    EXPECT_NEAR(sigma.y * std::tan(left / 4), 1, 1e-15) << left;
  }
  EXPECT_FALSE(all_finite(mrp_of(Quat<double>{0, 0, 0, -1})));
}

TEST(Mrp, TheProjectionsDerivativeIsTheRateOnBothHalves) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    Quat<double> q = random.attitude();
    if (q.w < -0.9) q = scaled(-1.0, q);  // sigma' grows like sigma^2
    Vec3<double> const omega = random.vector(1);
    D s(0.0);
    s.slope[0] = 1;
    Quat<D> moved = in<D>(q);
    add(moved, s, quaternion_rate(in<D>(q), in<D>(omega)));
    EXPECT_LT(apart(slopes(mrp_of(moved)), mrp_rate(mrp_of(q), omega)), rounding);
    Vec3<double> const inner = MrpShadow<double>::from_attitude(q);
    EXPECT_LT(apart(slopes(MrpShadow<D>::from_attitude(moved)), mrp_rate(inner, omega)), rounding);
  }
}

// ---- Shadow points --------------------------------------------------------------------------------------------------

TEST(MrpShadow, StartsFromTheInnerPoint) {
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    Quat<double> const q = random.attitude();
    Vec3<double> sigma = MrpShadow<double>::from_attitude(q);
    EXPECT_LE(length(sigma), 1);
    EXPECT_FALSE(MrpShadow<double>::settle(sigma));
    EXPECT_LT(apart(MrpShadow<double>::attitude(sigma), scaled(q.w < 0 ? -1. : 1., q)), 1e-15);
  }
  EXPECT_EQ(length(MrpShadow<double>::from_attitude({0, 0, 0, -1})), 0);  // infinity for `mrp`
}

TEST(MrpShadow, SettlingKeepsTheAttitude) {
  Random random(9);
  for (double size : {1.0001, 1.5, 3.0, 100.0})
    for (int i = 0; i < 50; ++i) {
      Vec3<double> const before = size * random.direction();
      Vec3<double> after = before;
      EXPECT_TRUE(MrpShadow<double>::settle(after));
      EXPECT_NEAR(length(after) * length(before), 1, 1e-15);
      EXPECT_LT(apart(quaternion_of_mrp(after), scaled(-1.0, quaternion_of_mrp(before))), 1e-15);
      EXPECT_LT(apart(matrix(quaternion_of_mrp(after)), matrix(quaternion_of_mrp(before))), 2e-15);
      EXPECT_LT(apart(mrp_shadow_of(after), before), 1e-15 * size);  // an involution
    }
}

TEST(MrpShadow, SettlesOnceEvenAtTheBorder) {
  Random random(10);
  int settled = 0;
  for (int i = 0; i < 100'000; ++i) {
    Vec3<double> sigma = random.direction();
    sigma = ((1 + random.uniform(-1e-15, 3e-15)) / length(sigma)) * sigma;
    settled += MrpShadow<double>::settle(sigma) ? 1 : 0;
    Vec3<double> const once = sigma;
    EXPECT_FALSE(MrpShadow<double>::settle(sigma));
    EXPECT_EQ(apart(sigma, once), 0);
    EXPECT_LE(length(sigma), 1 + 4.5e-16);
  }
  EXPECT_GT(settled, 10'000);
  EXPECT_LT(settled, 90'000);
}

TEST(MrpShadow, LeavesTheInsideAlone) {
  Vec3<double> sigma{0.6, 0, 0.8}, zero{0, 0, 0};
  EXPECT_FALSE(MrpShadow<double>::settle(sigma));
  EXPECT_FALSE(MrpShadow<double>::settle(zero));
  EXPECT_EQ(apart(sigma, {0.6, 0, 0.8}), 0);
  EXPECT_EQ(length(zero), 0);
}

TEST(MrpShadow, SettlesInEveryScalar) {
  Vec3<Quad> fine{Quad(0), Quad(-2), Quad(0)};
  EXPECT_TRUE(MrpShadow<Quad>::settle(fine));
  EXPECT_EQ(double(fine.y), 0.5);
  using J = Jet<Quad, 8>;
  Vec3<J> series{J(0.), J(-2.), J(0.)};
  series.y.degree = 1;
  series.y[1] = Quad(4);  // -1 / (-2 + 4 t) = 1/2 + t + ...
  EXPECT_TRUE(MrpShadow<J>::settle(series));
  EXPECT_LT(std::fabs(double(series.y[0]) - 0.5), 1e-30);
  EXPECT_LT(std::fabs(double(series.y[1]) - 1), 1e-30);
}

TEST(MrpShadow, TheShadowMovesByTheSameKinematics) {
  Random random(11);
  for (double size : {0.5, 1.01, 1.7, 3.0})
    for (int i = 0; i < 50; ++i) {
      Vec3<double> const sigma = size * random.direction(), omega = random.vector(1);
      Vec3<D> moved = moving(sigma, omega);
      Vec3<double> const expected = mrp_rate(mrp_shadow_of(sigma), omega);
      EXPECT_LT(apart(slopes(mrp_shadow_of(moved)), expected), 1e-14) << size;
      EXPECT_EQ(MrpShadow<D>::settle(moved), size > 1);
      EXPECT_LT(apart(slopes(moved), size > 1 ? expected : mrp_rate(sigma, omega)), 1e-14) << size;
    }
}

}  // namespace
}  // namespace polhode
