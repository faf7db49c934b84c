/// Spaces: the laws on dual numbers, the constraint's defect and the projection onto it.
#include "problems/space.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/norm_policy.hpp"
#include "problems/space_laws.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::in;
using test::Random;

// ---- The laws -------------------------------------------------------------------------------------------------------

template <class S>
using BodyOnQuaternion = RigidBody<FlatQuaternion<S>>;
template <class S>
using BodyOnS3 = RigidBody<S3<S>>;
template <class S>
using BodyOnSO3 = RigidBody<SO3<S>>;

using D = Dual<1>;

/// The laws hold to round-off: an evaluation of both sides is some 50 operations on numbers below 10, each good to
/// 1e-16; the derivative of the exponential map at 2.5 rad magnifies them by less than 10.
constexpr double rounding = 1e-13;

/// Offsets [rad] in the chart: none, near the identity, across the switch of the series (0.4), large.
constexpr double offsets[] = {0, 1e-12, 1e-6, 1e-3, 0.3, 0.399, 0.401, 1.5, 2.5};

Quat<D> random_quaternion(Random& random, double size) {
  return scaled(D(size), in<D>(random.attitude()));
}

TEST(SpaceLaws, Euclidean3) {
  Random random(1);
  for (double size : offsets) {
    Vec3<D> const x = in<D>(random.vector(2)), du = in<D>(size * random.direction()), v = in<D>(random.vector(1));
    EXPECT_LT(check_space_laws<Euclidean3>(x, du, v), rounding) << size;
  }
}

TEST(SpaceLaws, FlatQuaternion) {
  Random random(2);
  for (double size : offsets) {
    Vec3<D> const omega = in<D>(random.vector(1));
    Quat<D> const du = random_quaternion(random, size);
    EXPECT_LT(check_space_laws<FlatQuaternion>(random_quaternion(random, 1), du, omega), rounding) << size;
    EXPECT_LT(check_space_laws<FlatQuaternion>(random_quaternion(random, 1.3), du, omega), rounding) << "not unit";
  }
}

TEST(SpaceLaws, S3) {
  Random random(3);
  for (double size : offsets)
    for (int i = 0; i < 20; ++i) {
      Vec3<D> const du = in<D>(size * random.direction()), omega = in<D>(random.vector(1));
      EXPECT_LT(check_space_laws<S3>(random_quaternion(random, 1), du, omega), rounding) << size;
      EXPECT_LT(check_space_laws<S3>(Quat<D>{0., 0., 0., 1.}, du, omega), rounding) << size << " at 1";
    }
}

TEST(SpaceLaws, SO3) {
  Random random(4);
  for (double size : offsets)
    for (int i = 0; i < 20; ++i) {
      Vec3<D> const du = in<D>(size * random.direction()), omega = in<D>(random.vector(1));
      Mat3<D> const x = matrix(random_quaternion(random, 1));
      EXPECT_LT(check_space_laws<SO3>(x, du, omega), rounding) << size;
      EXPECT_LT(check_space_laws<SO3>(matrix(Quat<D>{0., 0., 0., 1.}), du, omega), rounding) << size << " at 1";
    }
}

TEST(SpaceLaws, RigidBodyOnEveryAttitudeSpace) {
  Random random(5);
  for (double size : offsets)
    for (int i = 0; i < 10; ++i) {
      Quat<D> const q = random_quaternion(random, 1);
      Vec3<D> const omega = in<D>(random.vector(1)), acceleration = in<D>(random.vector(1));
      Vec3<D> const turn = in<D>(size * random.direction()), faster = in<D>(size * random.direction());
      Pair<Vec3<D>, Vec3<D>> const v{omega, acceleration};
      EXPECT_LT(check_space_laws<BodyOnS3>({q, omega}, {turn, faster}, v), rounding) << size;
      EXPECT_LT(check_space_laws<BodyOnSO3>({matrix(q), omega}, {turn, faster}, v), rounding) << size;
      Quat<D> const du = random_quaternion(random, size);
      EXPECT_LT(check_space_laws<BodyOnQuaternion>({q, omega}, {du, faster}, v), rounding) << size;
    }
}

/// The same as S3, but for the sign of the commutator: what a mix-up of body and space rates gives.
template <class S>
struct MixedUpS3 : S3<S> {
  static Vec3<S> chart_rate(Quat<S> const&, Vec3<S> const& u, Vec3<S> const& omega) {
    return dexpinv(Real<S>(-1.0) * u, omega);
  }
};

TEST(SpaceLaws, FindAMixUpOfBodyAndSpaceRates) {
  Random random(6);
  Vec3<D> const du = in<D>(0.3 * random.direction()), omega = in<D>(random.direction());
  EXPECT_GT(check_space_laws<MixedUpS3>(random_quaternion(random, 1), du, omega), 1e-2);
}

// ---- Defect and projection, by hand ---------------------------------------------------------------------------------

TEST(Defect, OfAQuaternionIsThatOfItsSquare) {
  Quat<double> const q{1, 2, 3, 4};
  EXPECT_EQ(S3<double>::defect(q), 29);
  EXPECT_EQ(FlatQuaternion<double>::defect(q), 29);
  EXPECT_EQ(S3<double>::defect({0, 0, 0, 0.5}), 0.75);
  EXPECT_EQ(S3<double>::defect({0.5, 0.5, 0.5, 0.5}), 0);
}

TEST(Defect, OfAMatrixIsTheFrobeniusNormOfItsGramMatrixMinusOne) {
  // Columns (2,0,0), (1,1,0), (0,0,1): gram - 1 = [[3, 2, 0], [2, 1, 0], [0, 0, 0]].
  EXPECT_NEAR(SO3<double>::defect({{2, 0, 0}, {1, 1, 0}, {0, 0, 1}}), std::sqrt(9. + 1 + 4 + 4), 1e-15);
  EXPECT_EQ(SO3<double>::defect({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), 0);
}

TEST(Defect, OfAProductIsTheGreaterOne) {
  using M = RigidBody<S3<double>>;
  EXPECT_EQ(M::defect({{0, 0, 0, 0.5}, {9, 9, 9}}), 0.75);
  EXPECT_EQ(Euclidean3<double>::defect({9, 9, 9}), 0);
  EXPECT_TRUE(M::constrained);
  EXPECT_FALSE(Euclidean3<double>::constrained);
}

TEST(Project, AQuaternionByHand) {
  Quat<double> q{0, 3, 0, 4};
  EXPECT_EQ(S3<double>::project(q), 4);  // the distance moved: from norm 5 to norm 1
  EXPECT_EQ(distance<double>(q, Quat<double>{0, 0.6, 0, 0.8}), 0);
}

TEST(Project, ABodyLeavesItsRateAlone) {
  using M = RigidBody<FlatQuaternion<double>>;
  Point<M> x{{0, 3, 0, 4}, {7, 8, 9}};
  EXPECT_EQ(M::project(x), 4);
  EXPECT_EQ(distance<double>(x.second, Vec3<double>{7, 8, 9}), 0);
}

TEST(Project, IsIdempotent) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    Quat<double> q = scaled(random.uniform(0.5, 2), random.attitude());
    S3<double>::project(q);
    EXPECT_LE(S3<double>::project(q), 2.3e-16);  // one unit in the last place of the norm

    Mat3<double> m = scaled(random.uniform(0.8, 1.2), matrix(random.attitude()));
    SO3<double>::project(m);
    EXPECT_LE(SO3<double>::project(m), 1e-15);
  }
}

/// R S with S symmetric and positive has R as its nearest rotation (the polar factor).
template <class Scalar>
void expect_polar_factor(Random& random, double size, double most_defect, double rounding_error) {
  Mat3<Scalar> const rotation = matrix(normalised(in<Scalar>(random.attitude())));
  Vec3<double> const diagonal = random.vector(size), off = random.vector(size);
  Mat3<double> const stretch{
      {1 + diagonal.x, off.x, off.y}, {off.x, 1 + diagonal.y, off.z}, {off.y, off.z, 1 + diagonal.z}};
  Mat3<Scalar> m = rotation * in<Scalar>(stretch);
  double const moved = double(SO3<Scalar>::project(m));
  EXPECT_LT(double(SO3<Scalar>::defect(m)), most_defect) << size;
  EXPECT_LT(double(distance<Scalar>(m, rotation)), rounding_error) << size;
  EXPECT_GT(moved, 0) << size;
}

TEST(Project, AMatrixGoesToTheNearestRotation) {
  Random random(8);
  for (double size : {1e-9, 1e-4, 1e-2, 0.1})
    for (int i = 0; i < 200; ++i) {
      expect_polar_factor<double>(random, size, 1e-15, 3e-15);
      expect_polar_factor<Quad>(random, size, 1e-31, 1e-31);
    }
}

// ---- The policy `project` -------------------------------------------------------------------------------------------

double ulp(double x) {
  return std::nextafter(std::fabs(x), HUGE_VAL) - std::fabs(x);
}
double ulps_apart(Quat<double> const& a, Quat<double> const& b) {
  double worst = 0;
  Quat<double>::each([&](double p, double q) { worst = std::max(worst, std::fabs(p - q) / ulp(q)); }, a, b);
  return worst;
}

TEST(ProjectPolicy, IsRenormalisationAndThePapersEquation16) {
  Random random(9);
  double worst_renormalised = 0, worst_paper = 0, worst_defect = 0;
  for (int i = 0; i < 100'000; ++i) {
    double const size = i % 2 ? random.uniform(0.5, 2) : 1 + random.uniform(-1e-6, 1e-6);  // far, and as in a run
    Quat<double> const q = scaled(size, random.attitude());
    double const norm = std::sqrt(dot(q, q)), lambda = 1 - norm;
    Quat<double> const renormalised{q.x / norm, q.y / norm, q.z / norm, q.w / norm};
    Quat<double> const paper{q.x / (1 - lambda), q.y / (1 - lambda), q.z / (1 - lambda), q.w / (1 - lambda)};

    Projections projections;
    Quat<double> projected = q;
    projections.apply<FlatQuaternion<double>>(projected, NormPolicy::project);
    worst_renormalised = std::max(worst_renormalised, ulps_apart(projected, renormalised));
    worst_paper = std::max(worst_paper, ulps_apart(projected, paper));
    worst_defect = std::max(worst_defect, double(S3<Quad>::defect(in<Quad>(projected))));
  }
  EXPECT_LE(worst_renormalised, 2);
  EXPECT_LE(worst_paper, 2);
  EXPECT_LE(worst_defect, 4.4e-16);  // dividing by the rounded norm reaches 6.6e-16
}

TEST(ProjectPolicy, CountsAndReportsTheRawDefect) {
  using M = RigidBody<FlatQuaternion<double>>;
  Projections projections;
  Point<M> big{{0, 3, 0, 4}, {0, 0, 0}}, small{{0, 0, 0, 0.5}, {0, 0, 0}};
  projections.apply<M>(big, NormPolicy::project);
  projections.apply<M>(small, NormPolicy::project);
  EXPECT_EQ(projections.count, 2);
  EXPECT_EQ(projections.raw_defect, 24);  // the greatest, before it was hidden
  EXPECT_EQ(projections.work, 4.5);
}

}  // namespace
}  // namespace polhode
