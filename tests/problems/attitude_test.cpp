/// Attitude: the convention, conversions, the angle between two attitudes, the exponential map and its derivative.
#include "problems/attitude.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "problems/space.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::in;
using test::Random;

constexpr double pi = 3.14159265358979323846;

template <class V>
double apart(V const& a, V const& b) {
  using S = std::decay_t<decltype([](auto const& v) {
    if constexpr (requires { v.e1; })
      return v.e1.x;
    else
      return v.x;
  }(a))>;
  return double(distance<S>(a, b));
}

// ---- The convention -------------------------------------------------------------------------------------------------

TEST(Convention, HamiltonProduct) {
  Quat<double> const i{1, 0, 0, 0}, j{0, 1, 0, 0}, k{0, 0, 1, 0}, one{0, 0, 0, 1};
  EXPECT_EQ(apart(i * j, k), 0);
  EXPECT_EQ(apart(j * k, i), 0);
  EXPECT_EQ(apart(k * i, j), 0);
  EXPECT_EQ(apart(i * i, scaled(-1.0, one)), 0);
}

TEST(Convention, MapsBodyToInertial) {
  double const half = std::sqrt(0.5);
  Quat<double> const quarter_about_z{0, 0, half, half};
  Vec3<double> const body_x{1, 0, 0}, inertial_y{0, 1, 0};
  EXPECT_LT(apart(to_inertial(quarter_about_z, body_x), inertial_y), 1e-15);
  EXPECT_LT(apart(to_body(quarter_about_z, inertial_y), body_x), 1e-15);
  EXPECT_LT(apart(matrix(quarter_about_z).e1, inertial_y), 1e-15);  // columns are the body axes
}

TEST(Convention, RateIsHalfTheProductWithTheBodyRate) {
  Quat<double> const q{0.1, -0.5, 0.3, 0.8};
  Vec3<double> const omega{0.7, -0.2, 1.1};
  Quat<double> const pure{omega.x, omega.y, omega.z, 0};
  EXPECT_LT(apart(quaternion_rate(q, omega), scaled(0.5, q * pure)), 1e-16);
}

TEST(Convention, ProductOfQuaternionsIsProductOfMatrices) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    Quat<double> const p = random.attitude(), q = random.attitude();
    EXPECT_LT(apart(matrix(p * q), matrix(p) * matrix(q)), 2e-15);
  }
}

// ---- Conversions ----------------------------------------------------------------------------------------------------

TEST(Conversions, RoundTripInEveryBranchOfShepperd) {
  Random random(3);
  std::array<int, 4> branches{};
  for (int i = 0; i < 4000; ++i) {
    Quat<double> const q = random.attitude();
    Mat3<double> const m = matrix(q);
    double const trace = m.e1.x + m.e2.y + m.e3.z;
    bool const x_largest = m.e1.x >= m.e2.y && m.e1.x >= m.e3.z;
    ++branches[trace >= 0 ? 3 : x_largest ? 0 : m.e2.y >= m.e3.z ? 1 : 2];
    Quat<double> const back = quaternion(m);
    double const sign = dot(back, q) < 0 ? -1 : 1;
    EXPECT_LT(apart(back, scaled(sign, q)), 2e-15);
    EXPECT_LT(apart(matrix(back), m), 4e-15);
  }
  for (int count : branches) EXPECT_GT(count, 100);
}

TEST(Conversions, HalfTurnsAboutEveryAxis) {
  for (Quat<double> const& q : {Quat<double>{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}})
    EXPECT_EQ(apart(quaternion(matrix(q)), q), 0);
}

// ---- The angle between two attitudes --------------------------------------------------------------------------------

TEST(AngleBetween, SmallAnglesKeepTheirDigits) {
  Quat<double> const one{0, 0, 0, 1};
  for (double angle : {1.0, 1e-3, 1e-8, 1e-16, 1e-100}) {
    Vec3<double> const axis{2. / 3, -1. / 3, 2. / 3};
    EXPECT_NEAR(angle_between(one, exp_quaternion(angle * axis)) / angle, 1, 1e-15) << angle;
  }
}

TEST(AngleBetween, SignsAndNormsDoNotMatter) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    Quat<double> const p = random.attitude(), q = random.attitude();
    double const angle = angle_between(p, q);
    EXPECT_EQ(angle_between(p, scaled(-1.0, q)), angle);
    EXPECT_EQ(angle_between(scaled(-1.0, p), q), angle);
    EXPECT_NEAR(angle_between(scaled(3.0, p), scaled(0.2, q)), angle, 1e-15);
    EXPECT_NEAR(angle_between(q, p), angle, 1e-15);
    EXPECT_GE(angle, 0);
    EXPECT_LE(angle, pi);
  }
}

TEST(AngleBetween, KnownAngles) {
  Quat<double> const q{0.5, 0.5, 0.5, 0.5};
  EXPECT_EQ(angle_between(q, q), 0);
  EXPECT_NEAR(angle_between(Quat<double>{0, 0, 0, 1}, q), 2 * pi / 3, 1e-15);
  EXPECT_NEAR(angle_between(Quat<double>{0, 0, 0, 1}, Quat<double>{0, 1, 0, 0}), pi, 1e-15);
}

// ---- The exponential map --------------------------------------------------------------------------------------------

TEST(Exponential, AgreesWithSineAndCosineOnBothSidesOfTheSeries) {
  for (double angle : {0.0, 1e-12, 1e-3, 0.1, 0.399, 0.3999999, 0.4000001, 0.41, 1.0, 2.5, pi, 6.0}) {
    Vec3<double> const u{0, angle, 0};  // exact: no rounding of the axis
    Quat<double> const q = exp_quaternion(u);
    EXPECT_NEAR(q.y, std::sin(angle / 2), 3e-16) << angle;
    EXPECT_NEAR(q.w, std::cos(angle / 2), 3e-16) << angle;
    EXPECT_EQ(q.x, 0);
    EXPECT_EQ(q.z, 0);
  }
}

TEST(Exponential, IsTheIdentityAtZeroInEveryScalar) {
  EXPECT_EQ(apart(exp_quaternion(Vec3<double>{0, 0, 0}), Quat<double>{0, 0, 0, 1}), 0);
  EXPECT_EQ(apart(exp_quaternion(zero<Vec3<Quad>>()), Quat<Quad>{0, 0, 0, 1}), 0);
}

TEST(Logarithm, InvertsTheExponential) {
  Random random(5);
  for (double angle : {1e-12, 1e-5, 0.1, 0.4, 1.0, 2.5, 3.1}) {
    Vec3<double> const u = angle * random.direction();
    Quat<double> const q = exp_quaternion(u);
    EXPECT_LT(apart(log_quaternion(q), u), 4e-15 * std::min(1.0, angle * 10)) << angle;
    EXPECT_LT(apart(log_quaternion(scaled(-1.0, q)), u), 4e-15 * std::min(1.0, angle * 10)) << "the shorter way round";
  }
  EXPECT_EQ(apart(log_quaternion(Quat<double>{0, 0, 0, 1}), zero<Vec3<double>>()), 0);
}

TEST(Logarithm, GoesTheShorterWayRound) {
  double const angle = 2 * pi - 0.5;
  Vec3<double> const u = log_quaternion(exp_quaternion(Vec3<double>{angle, 0, 0}));
  EXPECT_NEAR(u.x, -0.5, 2e-15);
}

TEST(Exponential, QuadIsGoodToThirtyDigits) {
  for (double angle : {1e-20, 1e-8, 0.3, 2.5}) {
    Vec3<Quad> const u{0, 0, Quad(angle)};
    Quat<Quad> const q = exp_quaternion(u);
    EXPECT_LT(double(fabsq(q.z - sinq(u.z / 2))), 1e-33) << angle;
    EXPECT_LT(double(fabsq(q.w - cosq(u.z / 2))), 1e-33) << angle;
    EXPECT_LT(apart(log_quaternion(q), u), 1e-32) << angle;
  }
}

// ---- Its inverse derivative -----------------------------------------------------------------------------------------

/// omega + u x omega / 2 + sum_k B_2k / (2k)! ad_u^2k omega, with Bernoulli's numbers: the definition, term by term.
Vec3<Quad> bernoulli_series(Vec3<Quad> const& u, Vec3<Quad> const& omega) {
  constexpr double over[] = {1, -1, 1, -1, 5, -691, 7, -3617, 43867, -174611};
  constexpr double under[] = {6, 30, 42, 30, 66, 2730, 6, 510, 798, 330};
  Vec3<Quad> sum = omega + Quad(0.5) * cross(u, omega), commutator = omega;
  Quad factorial = 1;
  for (int k = 1; k <= 10; ++k) {
    commutator = cross(u, cross(u, commutator));
    factorial = factorial * Quad(2 * k - 1) * Quad(2 * k);
    sum = sum + (Quad(over[k - 1]) / Quad(under[k - 1]) / factorial) * commutator;
  }
  return sum;
}

TEST(InverseDerivative, IsBernoullisSeriesInQuad) {
  Random random(6);
  // Below 0.1 rad the ten terms leave (0.1 / 2 pi)^22 = 3e-40; 1e-7 and 3e-6 lie on either side of the switch.
  for (double angle : {0.0, 1e-7, 3e-6, 4e-6, 1e-3, 0.1}) {
    Vec3<Quad> const u = in<Quad>(angle * random.direction()), omega = in<Quad>(random.vector(1));
    EXPECT_LT(apart(dexpinv(u, omega), bernoulli_series(u, omega)), 1e-32) << angle;
  }
}

TEST(InverseDerivative, InDoubleAgreesWithQuadOnBothSidesOfTheSeries) {
  Random random(7);
  for (double angle : {0.0, 1e-8, 0.01, 0.2, 0.399, 0.401, 1.0, 2.5, 5.0}) {
    Vec3<double> const u = angle * random.direction(), omega = random.vector(1);
    Vec3<Quad> const exact = dexpinv(in<Quad>(u), in<Quad>(omega));
    EXPECT_LT(apart(in<Quad>(dexpinv(u, omega)), exact), 1e-14) << angle;
  }
}

TEST(InverseDerivative, IsTheDerivativeOfTheLogarithm) {
  Random random(8);
  Quad const step = 1e-10;  // the central difference errs by step^2
  for (double angle : {1e-3, 0.3, 1.0, 2.5}) {
    Vec3<Quad> const u = in<Quad>(angle * random.direction()), omega = in<Quad>(random.vector(1));
    Quat<Quad> const at = exp_quaternion(u);
    Vec3<Quad> const ahead = log_quaternion(at * exp_quaternion(step * omega));
    Vec3<Quad> const behind = log_quaternion(at * exp_quaternion(-step * omega));
    Vec3<Quad> const difference = (Quad(0.5) / step) * (ahead - behind);
    EXPECT_LT(apart(dexpinv(u, omega), difference), 1e-18) << angle;
  }
}

// ---- The two groups -------------------------------------------------------------------------------------------------

TEST(Groups, QuaternionsAndMatricesAgree) {
  using Q = S3<double>;
  using R = SO3<double>;
  Random random(9);
  for (double angle : {0.0, 1e-6, 0.3, 2.5}) {
    Quat<double> const q = random.attitude();
    Mat3<double> const m = matrix(q);
    Vec3<double> const u = angle * random.direction(), omega = random.vector(1);
    EXPECT_LT(apart(matrix(Q::retract(q, u)), R::retract(m, u)), 4e-15);
    EXPECT_LT(apart(Q::local(q, Q::retract(q, u)), R::local(m, R::retract(m, u))), 1e-14);
    EXPECT_EQ(apart(Q::chart_rate(q, u, omega), R::chart_rate(m, u, omega)), 0);
    EXPECT_LT(angle_between(R::attitude(R::from_attitude(q)), q), 4e-15);
  }
}

}  // namespace
}  // namespace polhode
