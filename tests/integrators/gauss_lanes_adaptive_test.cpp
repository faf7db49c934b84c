/// Gauss with its stages in lanes, in steps of its own choice: errors below the tolerance, the same bits whatever the
/// registers, runs that repeat themselves.
#include <cmath>

#include "tests/integrators/lane_runs.hpp"

namespace polhode {
namespace {

using namespace test;

TEST(AdaptiveGaussLanes, ChooseStepsSoThatTheErrorIsBelowTheTolerance) {
  auto const check = [](auto const& definition, double t_end) {
    auto const field = field_of(definition);
    Quat<Quad> const exact = exact_attitude(definition, t_end);
    for (double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
      double const eight = error_of(solve(GaussLawson<8>{}, Adaptive{tolerance, 0}, field, t_end), exact);
      double const four = error_of(solve(GaussLawson<4>{}, Adaptive{tolerance, 0}, field, t_end), exact);
      EXPECT_LT(eight, tolerance);
      EXPECT_GT(eight, 1e-5 * tolerance);
      EXPECT_LT(four, 10 * tolerance);
      EXPECT_GT(four, 1e-5 * tolerance);
    }
  };
  check(FreeBody(Choice{}), 50);
  check(PdSlew(Choice{}), 60);
}

TEST(AdaptiveGaussLanes, GiveTheSameBitsWhateverTheRegisters) {
  auto const check = [](auto const& definition, double t_end) {
    expect_same_bits(definition, t_end, RunWith{GaussLawson<4>{}, Adaptive{1e-6, 1e-8}},
                     RunWith{GaussLawson<8>{}, Adaptive{1e-9, 1e-11}});
  };
  check(FreeBody(Choice{}), 50);
  check(PdSlew(Choice{}), 60);
}

TEST(AdaptiveGaussLanes, NeedFewSweepsUnderFeedback) {
  EXPECT_LT(sweeps_a_step(GaussLawson<8>{}, Adaptive{1e-9, 1e-12}, field_of(PdSlew(Choice{})), 60), 7.5);
}

// A stepper that was used before gives what a new one gives.
TEST(AdaptiveGaussLanes, RepeatARunToTheLastBitFromABeginning) {
  auto const field = field_of(PdSlew(Choice{}));
  for (double tolerance : {1e-4, 1e-7, 1e-10}) {
    auto stepper = GaussLawson<8>{}.bind(field, Adaptive{tolerance, 0}, NormPolicy::none);
    auto const run = [&] {
      BodyPoint x = field.initial();
      EXPECT_EQ(stepper.advance(x, 0, 60), Status::ok);
      return x;
    };
    BodyPoint const first = run();
    stepper.begin();
    EXPECT_TRUE(same_bits(first, run()));
  }
}

// A body at rest on which a torque begins to act; one on which nothing acts.
TEST(AdaptiveGaussLanes, BeginAtRest) {
  Choice choice;
  choice.set["omega0"] = {0, 0, 0};
  PdSlew const slew{choice};
  auto const pushed = field_of(slew);
  EXPECT_LT(error_of(solve(GaussLawson<8>{}, Adaptive{1e-9, 1e-12}, pushed, 60), exact_attitude(slew, 60)), 1e-9);
  auto const still = field_of(FreeBody(choice));
  EXPECT_TRUE(same_bits(solve(GaussLawson<8>{}, Adaptive{1e-9, 1e-12}, still, 50), still.initial()));
}

TEST(AdaptiveGaussLanes, HoldTheTorqueOfTheLastSample) {
  for_each_sampled([](auto const& field) {
    BodyPoint const gauss = sampled_run(field, Gauss<4>{}, FixedStep{0.05}, 0.1, 200);
    BodyPoint const chosen = sampled_run(field, GaussLawson<8>{}, Adaptive{1e-10, 1e-12}, 0.1, 200);
    EXPECT_LT(angle_between(gauss.first, chosen.first), 1e-9);
  });
}

TEST(AdaptiveGaussLanes, SayThatAStateIsNoNumber) {
  auto const field = field_of(PdSlew(Choice{}));
  BodyPoint x = field.initial();
  x.second.x = std::nan("");
  auto stepper = GaussLawson<8>{}.bind(field, Adaptive{1e-9, 1e-12}, NormPolicy::none);
  EXPECT_EQ(stepper.advance(x, 0, 60), Status::diverged);
}

}  // namespace
}  // namespace polhode
