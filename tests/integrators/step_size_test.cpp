/// The law of the step size: its approximations of log2 and exp2, its limits, what it remembers.
#include "integrators/step_size.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace polhode {
namespace {

TEST(StepSize, Log2IsNearEnoughOverEveryScale) {
  double worst = 0;
  for (int k = -996; k <= 1023; ++k)
    for (int i = 0; i < 200; ++i) {
      double const x = std::ldexp(1 + i / 200.0, k);
      worst = std::max(worst, std::fabs(log2_nearly(x) - std::log2(x)));
    }
  EXPECT_LT(worst, 5e-6);
  EXPECT_GT(worst, 1e-7) << "it is an approximation: the test can tell";
  EXPECT_EQ(log2_nearly(1), 0);
  EXPECT_EQ(log2_nearly(0x1p-900), -900);
}

TEST(StepSize, Exp2IsNearEnough) {
  double worst = 0;
  for (int i = -100'000; i <= 100'000; ++i) {
    double const y = 0.01 * i;
    worst = std::max(worst, std::fabs(exp2_nearly(y) / std::exp2(y) - 1));
  }
  EXPECT_LT(worst, 8e-6);
  EXPECT_GT(worst, 1e-7);
  for (int k = -1000; k <= 1000; ++k) ASSERT_EQ(exp2_nearly(k), std::ldexp(1.0, k));
}

constexpr StepRule rule{.safety = 0.9, .least = 0.2, .most = 10, .memory = 0.04};
constexpr int order = 5;
using Size = StepSize<double>;

/// A step size of h far from t_end.
Size begun(double h = 0.1) {
  Size size(rule, order);
  size.begin(h);
  return size;
}
double next(Size const& size) {
  return size.trial(0, 1e9).h;
}
/// h by the formula that StepRule prints.
double by_formula(double h, double error, double before, double most = rule.most) {
  double const factor = std::pow(error, -(1.0 / order - 0.75 * rule.memory)) * std::pow(before, rule.memory);
  return h * std::clamp(rule.safety * factor, rule.least, most);
}

TEST(StepSize, FollowsTheFormula) {
  Size size = begun();
  double h = next(size), before = 1e-4;
  EXPECT_NEAR(h, 0.1, 1e-12);
  for (double error : {0.5, 0.03, 0.9, 1.0, 0.2, 1e-6, 0.7}) {
    auto const trial = size.trial(0, 1e9);
    size.accept(trial, error * error);
    EXPECT_NEAR(next(size) / by_formula(h, error, before), 1, 2e-5) << error;
    h = next(size);
    before = std::max(error, 1e-4);
  }
}

TEST(StepSize, ARejectedTrialShortensAndTheNextStepDoesNotGrow) {
  Size size = begun();
  size.reject(size.trial(0, 1e9), 100.0);
  double const shorter = next(size);
  EXPECT_NEAR(shorter, by_formula(0.1, 10, 1), 1e-6);
  size.accept(size.trial(0, 1e9), 1e-8);
  EXPECT_NEAR(next(size), shorter, 1e-12) << "not after a rejection";
  size.accept(size.trial(0, 1e9), 1e-8);
  EXPECT_GT(next(size), 2 * shorter) << "but then";
}

TEST(StepSize, HasLimits) {
  Size size = begun();
  size.accept(size.trial(0, 1e9), 0.0);
  EXPECT_NEAR(next(size), 1, 1e-15) << "ten times longer at most, also without any error";
  size.reject(size.trial(0, 1e9), 1e200);
  EXPECT_NEAR(next(size), 0.2, 1e-15);
  for (double const none : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    Size failing = begun();
    EXPECT_FALSE(Size::accepts(none));
    failing.reject(failing.trial(0, 1e9), none);
    EXPECT_NEAR(next(failing), 0.01, 1e-12) << "no estimate";
  }
}

TEST(StepSize, AStepCutShortIsForgottenUnlessItsErrorIsLarge) {
  Size size = begun();
  auto const cut = size.trial(0, 1e-3);
  EXPECT_TRUE(cut.last);
  EXPECT_EQ(cut.h, 1e-3);
  size.accept(cut, 1e-12);
  EXPECT_NEAR(next(size), 0.1, 1e-12);
  size.restart();
  size.accept(size.trial(0, 1e-3), 1.0);
  EXPECT_LT(next(size), 1e-3) << "the scale has changed";
}

TEST(StepSize, OnlyANewRunForgetsTheSize) {
  Size size = begun();
  size.restart();
  EXPECT_TRUE(size.known());
  size.forget();
  EXPECT_FALSE(size.known());
}

TEST(StepSize, StartsAsSlopeAndCurvatureAllow) {
  Size size(rule, order);
  double tried = 0;
  size.start(2, 5, 1, [&](double h) { return 400 * (tried = h); });
  EXPECT_NEAR(tried, 0.01 * 2 / 5, 1e-15);
  EXPECT_NEAR(next(size), std::pow(0.01 / 400, 1.0 / order), 1e-15) << "the second derivative decides";
  size.start(2, 5, 0.05, [](double h) { return h; });
  EXPECT_EQ(next(size), 0.05) << "and no longer than there is";
}

TEST(StepSize, DividesWhatIsLeftEvenly) {
  Size const size = begun();
  EXPECT_NEAR(size.even_trial(0, 0.35).h, 0.35 / 4, 1e-15);
  EXPECT_FALSE(size.even_trial(0, 0.35).last);
  EXPECT_TRUE(size.even_trial(0, 0.1 * (1 + 5e-11)).last);
  EXPECT_EQ(size.even_trial(0.3, 0.35).h, 0.35 - 0.3);
}

TEST(StepSize, IsHeldWhereItWouldGrowALittle) {
  Size size({.safety = 1, .held = 1.1}, order);
  size.begin(0.1);
  auto const grown_by = [&](double factor) {
    size.accept(size.trial(0, 1e9), std::pow(factor, -2 * order));
    return next(size) / 0.1;
  };
  EXPECT_EQ(grown_by(1.09), 1);
  EXPECT_NEAR(grown_by(1.2), 1.2, 1e-4);
  size.begin(0.1);
  size.accept(size.even_trial(0, 0.11), std::pow(1.2, -2 * order));
  EXPECT_EQ(next(size), 0.1) << "a step that is shorter to be even does not shorten those to come";
}

TEST(StepSize, LeavesNoTinyRest) {
  Size const size = begun();
  EXPECT_TRUE(size.trial(0, 0.1 * (1 + 5e-11)).last);
  EXPECT_FALSE(size.trial(0, 0.1 * (1 + 1e-6)).last);
  EXPECT_TRUE(size.trial(0, 0.105, 1.1).last) << "with the reach of relaxation";
  EXPECT_NEAR(size.trial(0, 0.105, 1.1, 0.05).h, 0.1, 1e-12);
}

}  // namespace
}  // namespace polhode
