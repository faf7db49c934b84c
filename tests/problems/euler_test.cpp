/// Euler angles: the laws, the kinematics, hand values and the singularity.
#include "problems/euler.hpp"

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

template <class... S>
constexpr bool serves = ((Attitude<EulerAngles<S>> && FlatSpace<EulerAngles<S>> && !EulerAngles<S>::constrained) &&
                         ...);
static_assert(serves<double, Quad, Dual<1>, Dual<6>, Jet<double, 8>, Jet<Quad, 32>>);
static_assert(std::same_as<EulerAngles<double>::Over<Quad>, EulerAngles<Quad>>);
static_assert(EulerAngles<double>::name == "euler");
static_assert(FlatSpace<RigidBody<EulerAngles<double>>>);

using D = Dual<1>;
using E = EulerAngles<double>;

constexpr double pi = 3.14159265358979323846;

double apart(Vec3<double> const& a, Vec3<double> const& b) {
  return distance<double>(a, b);
}
double apart(Mat3<double> const& a, Mat3<double> const& b) {
  return distance<double>(a, b);
}
/// (roll, pitch, yaw), 17 deg or more from the singularity, where 1 / cos(pitch) is below 3.5.
Vec3<double> random_angles(Random& random) {
  return {random.uniform(-pi, pi), random.uniform(-1.27, 1.27), random.uniform(-pi, pi)};
}

// ---- The space and its kinematics -----------------------------------------------------------------------------------

TEST(EulerAngles, ObeyTheLawsOfASpace) {
  Random random(1);
  for (double offset : {0.0, 1e-6, 0.2}) {
    Vec3<D> const x = in<D>(random_angles(random)), du = in<D>(offset * random.direction());
    EXPECT_LT(check_space_laws<EulerAngles>(x, du, in<D>(random.vector(1))), 1e-13) << offset;
  }
}

TEST(EulerAngles, MoveAsTheQuaternionDoes) {
  Random random(2);
  for (int i = 0; i < 200; ++i)
    EXPECT_LT(kinematics_error<EulerAngles>(random_angles(random), random.vector(1)), 1e-14);
  EXPECT_LT(kinematics_error<EulerAngles>({0.4, 2.0, -0.3}, random.vector(1)), 1e-14) << "pitch beyond 90 deg";
  EXPECT_LT(kinematics_error<EulerAngles>({7.0, 0.3, -20.0}, random.vector(1)), 1e-14) << "several turns";
}

TEST(EulerAngles, TheirPowerSeriesIsASteadyTurn) {
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    Vec3<double> x = random_angles(random);
    x.y = 0.5 * x.y;  // the series ends at the singularity
    EXPECT_LT(series_error<EulerAngles>(x, random.vector(1), 0.02), 1e-24);
  }
}

TEST(EulerAngles, RateByHand) {
  Vec3<double> const omega{1, 2, 3};
  EXPECT_EQ(apart(E::rate({0, 0, 0.7}, omega), omega), 0);
  EXPECT_LT(apart(E::rate({pi / 2, 0, 0}, omega), {1, -3, 2}), 1e-15);
  // At a pitch of 45 deg: yaw' = 3 / cos, roll' = 1 + 3 tan.
  EXPECT_LT(apart(E::rate({0, pi / 4, 0}, omega), {4, 2, 3 * std::sqrt(2.)}), 2e-15);
}

// ---- Attitude -------------------------------------------------------------------------------------------------------

TEST(EulerAngles, QuarterTurnsByHand) {
  // Columns are the body axes.
  Mat3<double> const roll{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, pitch{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};
  Mat3<double> const yaw{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
  EXPECT_LT(apart(matrix(E::attitude({pi / 2, 0, 0})), roll), 5e-16);
  EXPECT_LT(apart(matrix(E::attitude({0, pi / 2, 0})), pitch), 5e-16);
  EXPECT_LT(apart(matrix(E::attitude({0, 0, pi / 2})), yaw), 5e-16);
  double const half = std::sqrt(0.5);
  EXPECT_LT(apart(E::from_attitude({half, 0, 0, half}), {pi / 2, 0, 0}), 5e-16);
  EXPECT_LT(apart(E::from_attitude({0, 0, half, half}), {0, 0, pi / 2}), 5e-16);
  EXPECT_NEAR(E::from_attitude({0, half, 0, half}).y, pi / 2, 1e-15);
}

TEST(EulerAngles, AreYawThenPitchThenRoll) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    Vec3<double> const a = random_angles(random);
    auto const about = [](Vec3<double> const& u) { return matrix(exp_quaternion(u)); };
    Mat3<double> const expected = about({0, 0, a.z}) * about({0, a.y, 0}) * about({a.x, 0, 0});
    EXPECT_LT(apart(matrix(E::attitude(a)), expected), 2e-15);
  }
}

TEST(EulerAngles, RoundTrips) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    Vec3<double> const angles = random_angles(random);
    EXPECT_LT(apart(E::from_attitude(E::attitude(angles)), angles), 1e-14);

    Quat<double> const q = random.attitude();
    Vec3<double> const got = E::from_attitude(q);
    EXPECT_LE(std::fabs(got.x), pi);
    EXPECT_LE(std::fabs(got.y), pi / 2);
    EXPECT_LE(std::fabs(got.z), pi);
    EXPECT_LT(apart(matrix(E::attitude(got)), matrix(q)), 4e-15);
    EXPECT_LT(apart(matrix(E::attitude(E::from_attitude(scaled(-1.0, q)))), matrix(q)), 4e-15);
  }
}

TEST(EulerAngles, RoundTripInEveryScalar) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    Vec3<double> const angles = random_angles(random);
    Vec3<Quad> const fine = in<Quad>(angles),
                     back = EulerAngles<Quad>::from_attitude(EulerAngles<Quad>::attitude(fine));
    EXPECT_LT(double(distance<Quad>(back, fine)), 1e-32);

    Vec3<D> moved = in<D>(angles);
    Vec3<double> const v = random.vector(1);
    moved.x.slope[0] = v.x, moved.y.slope[0] = v.y, moved.z.slope[0] = v.z;
    Vec3<D> const got = EulerAngles<D>::from_attitude(EulerAngles<D>::attitude(moved));
    EXPECT_LT(apart({got.x.slope[0], got.y.slope[0], got.z.slope[0]}, v), 1e-13);

    using J = Jet<Quad, 4>;
    Vec3<J> series = in<J>(angles);
    series.z.degree = 1;
    series.z[1] = Quad(v.z);
    Vec3<J> const line = EulerAngles<J>::from_attitude(EulerAngles<J>::attitude(series));
    EXPECT_LT(std::fabs(double(line.z[1]) - v.z), 1e-15);
  }
}

TEST(EulerAngles, TheAttitudeKeepsItsDigitsAtTheSingularity) {
  Random random(7);
  for (double short_of : {0.0, 1e-16, 1e-12, 1e-8, 1e-4})
    for (double sign : {-1., 1.}) {
      Quat<double> const q = E::attitude({random.uniform(-3, 3), sign * (pi / 2 - short_of), random.uniform(-3, 3)});
      EXPECT_LT(apart(matrix(E::attitude(E::from_attitude(q))), matrix(q)), 4e-15) << short_of;
    }
}

// ---- The singularity ------------------------------------------------------------------------------------------------

TEST(EulerAngles, AreSingularWithinAMicroradianOf90DegreesOfPitchAndBeyond) {
  for (double sign : {-1., 1.}) {
    EXPECT_TRUE(E::singular({0.3, sign * pi / 2, 0.7}));
    EXPECT_TRUE(E::singular({0.3, sign * (pi / 2 - 0.999e-6), 0.7}));
    EXPECT_FALSE(E::singular({0.3, sign * (pi / 2 - 1.001e-6), 0.7}));
    EXPECT_TRUE(E::singular({0.3, sign * (pi / 2 + 0.1), 0.7})) << "a step has jumped across";
  }
  EXPECT_TRUE(E::singular({0, pi, 0}));
  EXPECT_FALSE(E::singular({pi / 2, 0, pi / 2}));
}

TEST(EulerAngles, AreSingularInEveryScalar) {
  EXPECT_TRUE(EulerAngles<Quad>::singular({Quad(0), Quad(pi / 2), Quad(0)}));
  EXPECT_FALSE(EulerAngles<Quad>::singular({Quad(0), Quad(1.5), Quad(0)}));
  EXPECT_TRUE(EulerAngles<D>::singular({D(0), D(-pi / 2), D(0)}));
  EXPECT_FALSE(EulerAngles<D>::singular({D(0), D(-1.5), D(0)}));
  using J = Jet<Quad, 8>;
  EXPECT_TRUE(EulerAngles<J>::singular({J(0.), J(pi / 2), J(0.)}));
  EXPECT_FALSE(EulerAngles<J>::singular({J(0.), J(1.5), J(0.)}));
}

}  // namespace
}  // namespace polhode
