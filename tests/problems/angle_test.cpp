/// The angle over its sine: accuracy over all angles and scales, smoothness through 0.
#include "problems/angle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "problems/jet.hpp"
#include "problems/lanes.hpp"

namespace polhode {
namespace {

/// Greatest relative error in double at angles up to `most`, of sine and cosine that are both too large by `scale`.
double worst_error(double most, double scale) {
  double worst = 0;
  for (int i = 1; i <= 20'000; ++i) {
    Quad const angle = Quad(most) * i / 20'000, sine = sinq(angle) * scale, cosine = cosq(angle) * scale;
    double const z = double(sine * sine), c = double(cosine);
    Quad const exact = atan2q(sqrtq(Quad(z)), Quad(c)) / sqrtq(Quad(z));  // of the rounded arguments
    worst = std::max(worst, std::fabs(double(angle_over_sine(z, c) / exact - 1)));
  }
  return worst;
}

TEST(AngleOverSine, IsAccurateAtEveryAngle) {
  for (double scale : {1.0, 0.7, 1.0003}) {
    EXPECT_LT(worst_error(0.01, scale), 4.5e-16) << scale;
    EXPECT_LT(worst_error(0.2, scale), 4.5e-16) << "across the end of the series; " << scale;
    EXPECT_LT(worst_error(3.14, scale), 4.5e-16) << scale;
  }
}

TEST(AngleOverSine, OfNoAngleIsTheReciprocalOfTheCosine) {
  EXPECT_EQ(angle_over_sine(0.0, 1.0), 1);
  EXPECT_EQ(angle_over_sine(0.0, 0.5), 2);
  EXPECT_EQ(angle_over_sine(1e-320, 1.0), 1);
}

// theta / sin theta = 1 + z / 6 + 3 z^2 / 40 + ... of z = sine^2 on the unit circle: coefficients of a series in z.
TEST(AngleOverSine, IsSmoothThroughZero) {
  using Series = Jet<Quad, 4>;
  Series z(0.0);
  z.degree = 3;
  z[1] = Quad(1);
  Series const got = angle_over_sine(z, Series(sqrt(Series(1.0) - z)));
  EXPECT_NEAR(double(got[0]), 1, 1e-30);
  EXPECT_NEAR(double(got[1] - Quad(1) / 6), 0, 1e-30);
  EXPECT_NEAR(double(got[2] - Quad(3) / 40), 0, 1e-30);
}

TEST(AngleAndSine, IsAccurateAtEveryAngle) {
  for (double scale : {1.0, 0.7, 1.0003})
    for (int i = 0; i <= 20'000; ++i) {
      Quad const angle = Quad(3.14159) * i / 20'000, sine = sinq(angle) * scale, cosine = cosq(angle) * scale;
      double const z = double(sine * sine), c = double(cosine);
      Quad const exact = atan2q(sqrtq(Quad(z)), Quad(c));
      auto const got = angle_and_sine(z, c);
      ASSERT_LE(std::fabs(double(got.angle - exact)), 4.5e-16 * double(exact)) << double(angle);
      if (i == 0) continue;
      ASSERT_LE(std::fabs(double(got.over_sine * sqrtq(Quad(z)) / exact - 1)), 7e-16) << double(angle);
    }
}

TEST(AngleAndSine, HasLimitsAtBothEnds) {
  EXPECT_EQ(angle_and_sine(0.0, 1.0).angle, 0);
  EXPECT_EQ(angle_and_sine(0.0, 1.0).over_sine, 1);
  EXPECT_EQ(angle_and_sine(0.0, -1.0).angle, std::atan2(0.0, -1.0));
  EXPECT_TRUE(std::isfinite(angle_and_sine(0.0, -1.0).over_sine)) << "times an axis that is 0";
  EXPECT_TRUE(std::isnan(angle_and_sine(std::nan(""), 1.0).angle));
}

TEST(AngleAndSine, LanesGiveTheBitsOfDoubles) {
  using L = Lanes<4>;
  for (double most : {0.1, 0.3, 3.1})  // all near, mixed, mostly far
    for (int i = 0; i < 1000; ++i) {
      auto const angle = [&](int lane) { return most * (4 * i + lane) / 4000; };
      auto const z = [&](int lane) { return std::sin(angle(lane)) * std::sin(angle(lane)); };
      auto const c = [&](int lane) { return std::cos(angle(lane)); };
      auto const got = angle_and_sine(L::of(z), L::of(c));
      for (int lane = 0; lane < 4; ++lane) {
        auto const expected = angle_and_sine(z(lane), c(lane));
        ASSERT_EQ(got.angle[lane], expected.angle) << angle(lane);
        ASSERT_EQ(got.over_sine[lane], expected.over_sine) << angle(lane);
      }
    }
}

}  // namespace
}  // namespace polhode
