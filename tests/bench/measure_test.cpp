/// The metrics of runs that can be computed by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/bench/turning_ball.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/runs.hpp"

namespace polhode::bench {
namespace {

using polhode::test::a_cell;
using namespace test;

// ---- Norm drift ----------------------------------------------------------------------------------------------------

TEST(NormDrift, ExplicitEulerMultipliesTheSquaredNormByOnePlusTheSquareOfHalfATurn) {
  // q' is perpendicular to q and |q'| = |omega| |q| / 2, so |q + h q'|^2 = |q|^2 (1 + h^2 |omega|^2 / 4).
  int const n = 500;
  double const h = t_end / n, gain = h * h * rate * rate / 4;
  Metrics metrics = metrics_of_the_ball();
  Quat<Quad> q = exact(0);
  double squares = 0, last = 0;
  for (int k = 0; k <= n; ++k) {
    metrics.see(sight(t_end * k / n, q));
    q = q * Quat<Quad>{h * omega.x / 2, h * omega.y / 2, h * omega.z / 2, 1};  // q + h q'
    last = std::expm1(k * std::log1p(gain));
    squares += (k == n ? 0.5 : 1.0) * h * last * last;  // trapezoidal rule; no drift at 0 s
  }
  results::Record record;
  metrics.fill(record);
  EXPECT_NEAR(*record.norm_drift_final / last, 1, 1e-13);
  EXPECT_NEAR(*record.norm_drift_max / last, 1, 1e-13);
  EXPECT_NEAR(*record.norm_drift_raw_max / last, 1, 1e-13) << "nothing was projected";
  EXPECT_NEAR(*record.norm_drift_rms / std::sqrt(squares / t_end), 1, 1e-13);
}

TEST(NormDrift, TheEndHasASignTheMaximumHasNone) {
  auto const record = record_of([](double t) { return sight(t, scaled(Quad(0.999), exact(t))); });
  double const drift = 1 - 0.999 * 0.999;
  EXPECT_NEAR(*record.norm_drift_final, -drift, 1e-15);
  EXPECT_NEAR(*record.norm_drift_max, drift, 1e-15);
  EXPECT_NEAR(*record.norm_drift_rms, drift, 1e-15);
}

TEST(NormDrift, AnExcursionIsRemembered) {
  auto const record = record_of([](double t) { return drifting(t, 1e-6 * std::sin(M_PI * t / t_end)); });
  EXPECT_NEAR(*record.norm_drift_max, 1e-6, 1e-12);
  EXPECT_NEAR(*record.norm_drift_final, 0, 1e-20);
  EXPECT_NEAR(*record.norm_drift_rms, 1e-6 / std::sqrt(2), 1e-12);
}

TEST(NormDrift, ItsMeanSquareIsOverTimeNotOverSteps) {
  for (auto const time : {evenly, ever_longer}) {
    auto const record = record_of([](double t) { return drifting(t, 1e-6 * t / t_end); }, time);
    EXPECT_NEAR(*record.norm_drift_rms, 1e-6 / std::sqrt(3), 1e-11);
  }
}

TEST(NormDrift, RawIsBeforeProjection) {
  auto const record = record_of([](double t) {
    Seen seen = drifting(t, 1e-16);
    seen.raw_defect = 3e-9;
    return seen;
  });
  EXPECT_EQ(*record.norm_drift_raw_max, 3e-9);
  EXPECT_EQ(*record.norm_drift_max, 1e-16);
}

// ---- Errors against the reference ----------------------------------------------------------------------------------

TEST(AttitudeError, AnExactRunHasNone) {
  auto const record = record_of([](double t) { return sight(t, exact(t)); });
  EXPECT_LT(*record.attitude_error_max, 1e-30);
  EXPECT_LT(*record.attitude_error_end, 1e-30);
  EXPECT_LT(*record.attitude_error_l2, 1e-30);
  EXPECT_LT(*record.rate_error_max, 1e-30);
  EXPECT_LT(*record.norm_drift_max, 1e-32);
  EXPECT_LT(*record.momentum_direction_max, 1e-32);
}

TEST(AttitudeError, AConstantAngleIsFoundWhateverTheSignAndTheNorm) {
  for (double const factor : {1.0, -1.0, 1.001, -0.5}) {
    SCOPED_TRACE(factor);
    auto const record = record_of([&](double t) { return sight(t, scaled(Quad(factor), turned(t, small))); });
    EXPECT_NEAR(*record.attitude_error_max / small, 1, 1e-13);
    EXPECT_NEAR(*record.attitude_error_end / small, 1, 1e-13);
    EXPECT_NEAR(*record.attitude_error_l2 / small, 1, 1e-13);
    EXPECT_NEAR(*record.norm_drift_max, std::fabs(factor * factor - 1), 1e-15);
  }
}

TEST(AttitudeError, OfGrowingErrorTheMeanSquareIsAThirdHoweverTheStepsLie) {
  for (auto const time : {evenly, ever_longer}) {
    auto const record = record_of([](double t) { return sight(t, turned(t, small * t / t_end)); }, time);
    EXPECT_NEAR(*record.attitude_error_max / small, 1, 1e-13);
    EXPECT_NEAR(*record.attitude_error_end / small, 1, 1e-13);
    EXPECT_NEAR(*record.attitude_error_l2 / small, 1 / std::sqrt(3), 1e-5) << "trapezoidal rule, 1000 intervals";
  }
}

TEST(AttitudeError, TheMaximumIsNotTheEnd) {
  auto const record = record_of([](double t) { return sight(t, turned(t, small * std::sin(M_PI * t / t_end))); });
  EXPECT_NEAR(*record.attitude_error_max / small, 1, 1e-5);
  EXPECT_LT(*record.attitude_error_end, 1e-15 * small);
}

TEST(AttitudeError, AFullTurnIsNoneAndHalfATurnIsPi) {
  auto const error_of = [](double angle) {
    return *record_of([&](double t) { return sight(t, turned(t, angle)); }).attitude_error_end;
  };
  EXPECT_NEAR(error_of(2 * M_PI), 0, 1e-15);
  EXPECT_NEAR(error_of(M_PI), M_PI, 1e-15);
  EXPECT_NEAR(error_of(4), 2 * M_PI - 4, 1e-14) << "the shorter way round";
}

TEST(RateError, IsRelativeToTheLargestRate) {
  auto const record = record_of([](double t) {
    Quad const error = t < t_end / 2 ? 3e-6 : 1e-6;
    return sight(t, exact(t), omega + Vec3<Quad>{error, 0, 0});
  });
  EXPECT_NEAR(*record.rate_error_max, 3e-6 / rate, 1e-18);
  EXPECT_NEAR(*record.rate_error_end, 1e-6 / rate, 1e-18);
  EXPECT_LT(*record.attitude_error_max, 1e-30) << "the attitude is right";
}

// ---- Growth exponent -----------------------------------------------------------------------------------------------

/// The exponent of a drift told at 1, 2, ... n s.
template <class Drift>
std::optional<double> exponent_of(Drift drift, int n = 3000) {
  std::vector<double> times, drifts;
  for (int k = 1; k <= n; ++k) {
    times.push_back(k);
    drifts.push_back(drift(double(k)));
  }
  return growth_exponent(times, drifts);
}

TEST(GrowthExponent, OfAPowerLawIsItsPower) {
  for (double const power : {0.0, 0.5, 1.0, 2.0}) {
    auto const found = exponent_of([&](double t) { return 1e-12 * std::pow(t, power); });
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, power, 0.05);
  }
}

TEST(GrowthExponent, OfARandomWalkIsAHalf) {
  // One walk says little: 0.5 is the law of the ensemble, and |walk| on log t strays from it for decades at a time. The
  // strays are as likely up as down, so the median is right, with a sampling error that needs the wider margin of 0.1.
  std::vector<double> found;
  for (std::uint64_t seed = 1; seed <= 201; ++seed) {
    polhode::test::Random random(seed);
    double walk = 0;
    auto const exponent = exponent_of([&](double) { return walk += random.uniform(-1e-12, 1e-12); });
    ASSERT_TRUE(exponent) << "seed " << seed;
    found.push_back(*exponent);
  }
  std::nth_element(found.begin(), found.begin() + 100, found.end());
  EXPECT_NEAR(found[100], 0.5, 0.1) << "seeds 1 to 201";
}

TEST(GrowthExponent, OfNoiseIsZero) {
  polhode::test::Random random(1);
  auto const found = exponent_of([&](double) { return random.uniform(-1e-12, 1e-12); });
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0, 0.05) << "seed 1";
}

TEST(GrowthExponent, OnlyTheLastTwoDecadesCount) {
  auto const found = exponent_of([](double t) { return t < 100 ? 1e-3 / t : 1e-12 * t; }, 10000);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1, 0.05);
}

TEST(GrowthExponent, BelowTheRoundingFloorIsNull) {
  constexpr double ulp = std::numeric_limits<double>::epsilon();
  EXPECT_FALSE(exponent_of([](double) { return 0.0; }));
  EXPECT_FALSE(exponent_of([](double) { return 3.9 * ulp; }));
  EXPECT_TRUE(exponent_of([](double) { return 4.1 * ulp; }));
}

TEST(GrowthExponent, ADriftThatRisesFromTheFloorIsFoundAboveIt) {
  // Constant at 1 ulp until 300 s, a tenth of the time; then it is proportional to t, from 5 ulp on.
  auto const found = exponent_of([](double t) { return 2.3e-16 * (t < 300 ? 1 : t / 60); });
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1, 0.05);
}

TEST(GrowthExponent, TakesFiveBinsOfAnEighthOfADecade) {
  std::vector<double> times{2, 4, 8, 16}, drifts{2e-12, 4e-12, 8e-12, 16e-12};
  EXPECT_FALSE(growth_exponent(times, drifts));
  times.push_back(32);
  drifts.push_back(32e-12);
  auto const found = growth_exponent(times, drifts);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1, 1e-12);
  EXPECT_FALSE(growth_exponent({0.4, 0.8, 12.5, 25, 50, 100}, {1, 2, 3, 4, 5, 6})) << "two before the last two decades";
  EXPECT_FALSE(growth_exponent({}, {}));
  EXPECT_FALSE(growth_exponent({0}, {1e-12})) << "a run that never left 0 s";
  EXPECT_FALSE(growth_exponent({96, 97, 98, 99, 100}, {1, 2, 3, 4, 5})) << "all in one bin";
}

TEST(GrowthExponent, IsInTheRecord) {
  auto const growing = record_of([](double t) { return drifting(t, -1e-11 * t); });
  ASSERT_TRUE(growing.norm_growth_exponent);
  EXPECT_NEAR(*growing.norm_growth_exponent, 1, 0.05);
  EXPECT_FALSE(record_of([](double t) { return sight(t, exact(t)); }).norm_growth_exponent);
}

// ---- Series --------------------------------------------------------------------------------------------------------

TEST(DriftSeries, HasAtMost64MomentsInOrderUpToTheEnd) {
  for (int const n : {1, 3, 100, 20000}) {
    SCOPED_TRACE(n);
    Metrics metrics = metrics_of_the_ball();
    for (int k = 0; k <= n; ++k) {
      Seen seen = sight(t_end * k / n, turned(t_end * k / n, small));
      seen.body.drift = -1e-9 * k;
      seen.raw_defect = k > n / 2 ? 1e-3 : 0;
      metrics.see(seen);
    }
    auto const series = metrics.drift_series("a cell");
    EXPECT_EQ(series.cell, "a cell");
    EXPECT_EQ(series.columns, (std::vector<std::string>{"t", "norm_drift", "norm_drift_raw", "attitude_error"}));
    EXPECT_LE(series.rows.size(), 64u);
    EXPECT_GE(series.rows.size(), std::min<std::size_t>(std::size_t(n), 20));
    double before = 0;
    for (auto const& row : series.rows) {
      ASSERT_EQ(row.size(), 4u);
      if (n == 20000 && row[0] > t_end / 10) {
        EXPECT_LT(row[0] / before, 1.2) << "evenly on log t";
      }
      EXPECT_GT(row[0], before);
      EXPECT_NEAR(row[1], 1e-9 * n * row[0] / t_end, 1e-18) << "its magnitude";
      EXPECT_GE(row[2], row[1]);
      EXPECT_NEAR(row[3] / small, 1, 1e-13);
      before = row[0];
    }
    EXPECT_EQ(before, t_end);
    EXPECT_EQ(series.rows.back()[2], 1e-3);
  }
}

// ---- Matrices: real runs -------------------------------------------------------------------------------------------

TEST(MatrixDefect, OfAScaledRotationIsKnown) {
  Mat3<Quad> m = matrix(exact(7));
  m = {Quad(1.001) * m.e1, Quad(1.001) * m.e2, Quad(1.001) * m.e3};
  EXPECT_NEAR(double(FlatRotation<Quad>::defect(m)), std::sqrt(3) * (1.001 * 1.001 - 1), 1e-15);
}

TEST(MatrixDefect, OfRk4AtAConstantRateIsThatOfItsStabilityFunction) {
  // A step scales the plane across the axis by |P(i y)|, y = h omega, |P|^2 = 1 - y^6/72 + y^8/576; the axis stays. So
  // the defect is sqrt(2) |1 - |P|^2n|: of order 6 in a step, 5 in a run; 2^5 when h is halved, not 2^4.
  auto const ball = a_cell("free_body", "rotation", "rk4").set("inertia", {1, 1, 1}).set("omega0", {0, 0, 1}).until(20);
  double const coarse = *ball.with_h(0.1).measured().record.norm_drift_max;
  double const fine = *ball.with_h(0.05).measured().record.norm_drift_max;
  auto const by_hand = [](double y, int n) {
    return -std::sqrt(2) * std::expm1(n * std::log1p(-std::pow(y, 6) / 72 + std::pow(y, 8) / 576));
  };
  EXPECT_NEAR(coarse / by_hand(0.1, 200), 1, 1e-6);
  EXPECT_NEAR(fine / by_hand(0.05, 400), 1, 1e-6);
  EXPECT_NEAR(coarse / fine, 32, 0.1);
}

TEST(MatrixDefect, OfRk4OnATumblingBodyFallsBy32Too) {
  auto const body = a_cell("free_body", "rotation", "rk4").set("omega0", {1, 0.6, 0.8}).until(20);
  double const coarse = *body.with_h(0.1).measured().record.norm_drift_max;
  double const fine = *body.with_h(0.05).measured().record.norm_drift_max;
  EXPECT_GT(coarse / fine, 29);
  EXPECT_LT(coarse / fine, 35);
}

TEST(MatrixDefect, OnTheGroupIsRoundOff) {
  auto const record = a_cell("free_body", "so3", "cf4").with_h(0.1).until(20).measured().record;
  EXPECT_LT(*record.norm_drift_max, 1e-13);
  EXPECT_GT(*record.norm_drift_max, 1e-17) << "200 products of rounded matrices are not exact";
}

}  // namespace
}  // namespace polhode::bench
