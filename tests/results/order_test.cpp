/// The fit of an order on errors whose order is known by construction.
#include "results/order.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace polhode::results {
namespace {

using testing::HasSubstr;

std::vector<double> const steps{0.0125, 0.025, 0.05, 0.1, 0.2};

std::vector<OrderPoint> power_law(double constant, double order, std::vector<double> const& at = steps) {
  std::vector<OrderPoint> points;
  for (double const h : at) points.push_back({h, constant * std::pow(h, order), 0});
  return points;
}

TEST(OrderFit, APowerLawIsFoundExactly) {
  for (double const order : {1.0, 2.0, 4.0, 5.0}) {
    auto const [fit, reason] = fit_order(power_law(1e-2, order));
    ASSERT_TRUE(fit) << reason;
    EXPECT_NEAR(fit->slope, order, 1e-12);
    ASSERT_TRUE(fit->half_width);
    EXPECT_LT(*fit->half_width, 1e-6);
    EXPECT_EQ(fit->points, steps.size());
    EXPECT_EQ(fit->h_low, 0.0125);
    EXPECT_EQ(fit->h_high, 0.2);
  }
}

TEST(OrderFit, TheOrderOfThePointsIsOfNoAccount) {
  auto points = power_law(1e-2, 3);
  std::swap(points[0], points[3]);
  std::swap(points[1], points[4]);
  EXPECT_NEAR(fit_order(points).fit->slope, 3, 1e-12);
}

TEST(OrderFit, RoundOffIsDropped) {
  // h^8 falls below 1e-12 at the two smallest steps, where a plateau of round-off stands in for the error.
  auto points = power_law(1, 8);
  points[0].error = 3e-14;
  points[1].error = 5e-14;
  auto const fit = fit_order(points).fit;
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 8, 1e-12);
  EXPECT_EQ(fit->points, 3u);
  EXPECT_EQ(fit->h_low, 0.05);
}

TEST(OrderFit, APlateauAboveTheFloorIsNotFitted) {
  // Round-off that accumulates may stand above the floor: there the slopes disagree.
  auto points = power_law(1, 4);
  for (OrderPoint& point : points) point.error += 1e-6;
  points.insert(points.begin(), {0.00625, 1e-6, 0});
  auto const fit = fit_order(points).fit;
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 4, 0.2);
  EXPECT_EQ(fit->h_low, 0.05);
}

TEST(OrderFit, ErrorsUnderTenBarsAreDropped) {
  auto points = power_law(1, 2);
  for (OrderPoint& point : points) point.bar = 1e-4;
  // 10 bars are 1e-3: 0.0125^2 and 0.025^2 are below.
  EXPECT_EQ(fit_order(points).fit->h_low, 0.05);
  EXPECT_EQ(fit_order(points, {.bars = 1}).fit->h_low, 0.0125);
}

TEST(OrderFit, ErrorsAboveTheAsymptoticRangeAreDropped) {
  auto points = power_law(100, 2);
  EXPECT_EQ(fit_order(points).fit->h_high, 0.025);  // 100 h^2 < 0.1 rad up to h = 0.0316
  EXPECT_EQ(fit_order(points, {.asymptotic = 10}).fit->h_high, 0.2);
}

TEST(OrderFit, OnlyTheStretchWhereSlopesAgreeIsFitted) {
  // Order 4 below h = 0.1, order 2 above.
  auto points = power_law(1, 4, {0.0125, 0.025, 0.05, 0.1});
  points.push_back({0.2, 4e-4, 0});
  points.push_back({0.4, 16e-4, 0});
  auto const fit = fit_order(points).fit;
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 4, 1e-12);
  EXPECT_EQ(fit->h_high, 0.1);
}

TEST(OrderFit, OfEqualStretchesTheOneWithTheSmallestSteps) {
  auto points = power_law(1, 2, {0.0125, 0.025, 0.05});
  points.push_back({0.1, 8 * points.back().error, 0});
  points.push_back({0.2, 8 * points.back().error, 0});
  EXPECT_NEAR(fit_order(points).fit->slope, 2, 1e-12);
}

TEST(OrderFit, SlopesThatDisagreeAreNoOrder) {
  std::vector<OrderPoint> const points{{0.1, 1e-6, 0}, {0.2, 2e-6, 0}, {0.4, 8e-6, 0}, {0.8, 128e-6, 0}};
  auto const result = fit_order(points);
  EXPECT_FALSE(result.fit);
  EXPECT_EQ(result.reason, "no two neighbouring slopes agree: 1.00, 2.00, 4.00");
}

TEST(OrderFit, AnErrorThatDoesNotShrinkHasNoOrder) {
  EXPECT_FALSE(fit_order(power_law(1e-3, 0)).fit);
  EXPECT_FALSE(fit_order(power_law(1e-6, -1)).fit);
}

TEST(OrderFit, TheIntervalHoldsTheOrder) {
  // Errors off the line by 2% up and down: the interval is narrow, and not zero.
  auto points = power_law(1e-2, 4);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].error *= i % 2 == 0 ? 1.02 : 0.98;
  auto const fit = fit_order(points).fit;
  ASSERT_TRUE(fit && fit->half_width);
  EXPECT_LT(std::abs(fit->slope - 4), *fit->half_width);
  EXPECT_LT(*fit->half_width, 0.1);
  // Least squares by hand: x = (-2 .. 2) log 2, residuals (1, -1, 1, -1, 1) d with d = log(1.02 / 0.98) / 2 about their
  // mean; s^2 = 24/5 d^2 / 3, t(3) = 3.182446.
  double const d = std::log(1.02 / 0.98) / 2;
  EXPECT_NEAR(*fit->half_width, 3.182446 * std::sqrt(24.0 / 5 * d * d / 3 / 10) / std::log(2.0), 1e-6);
}

TEST(OrderFit, TwoPointsHaveASlopeWithoutInterval) {
  auto const fit = fit_order(power_law(1, 4, {0.1, 0.2})).fit;
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 4, 1e-12);
  EXPECT_FALSE(fit->half_width);
}

TEST(OrderFit, WhatIsNoNumberIsLeftOut) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  auto points = power_law(1e-2, 4);
  points.push_back({0.3, nan, 0});
  points.push_back({0.4, infinity, 0});
  points.push_back({nan, 1e-3, 0});
  points.push_back({0.5, -1e-3, 0});
  points.push_back({0.6, 0, 0});
  points.push_back({0.2, 1e-3, 0});  // a step that comes twice
  points[0].bar = nan;               // without a bar
  auto const fit = fit_order(points).fit;
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->slope, 4, 1e-12);
  EXPECT_EQ(fit->points, steps.size());
}

TEST(OrderFit, TooFewPointsSaySo) {
  EXPECT_THAT(fit_order({}).reason, HasSubstr("0 of 0 steps"));
  EXPECT_THAT(fit_order({{0.1, 1e-3, 0}, {0.2, 1e-15, 0}}).reason, HasSubstr("1 of 2 steps"));
}

}  // namespace
}  // namespace polhode::results
