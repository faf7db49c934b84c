/// Gauss with its stages in lanes, in equal steps: the solution, its order, what it keeps, the same bits whatever the
/// registers.
#include <cmath>

#include "problems/gravity_gradient.hpp"
#include "tests/integrators/lane_runs.hpp"

namespace polhode {
namespace {

using namespace test;

TEST(GaussLanes, ReachesRoundOffInFewSteps) {
  FreeBody const free{Choice{}};
  PdSlew const slew{Choice{}};
  auto const one = field_of(free);
  auto const other = field_of(slew);
  EXPECT_LT(error_of(solve(GaussLawson<8>{}, FixedStep{5}, one, 50), exact_attitude(free, 50)), 5e-15);
  EXPECT_LT(error_of(solve(GaussLawson<4>{}, FixedStep{0.5}, one, 50), exact_attitude(free, 50)), 2e-14);
  EXPECT_LT(error_of(solve(GaussLawson<8>{}, FixedStep{5}, other, 60), exact_attitude(slew, 60)), 5e-14);
  EXPECT_LT(error_of(solve(GaussLawson<4>{}, FixedStep{0.5}, other, 60), exact_attitude(slew, 60)), 2e-14);
}

// Steps that turn by up to two radians and more: the frame carries them.
TEST(GaussLanes, HasOrderTwiceItsStages) {
  FreeBody const free{Choice{}};
  auto const field = field_of(free);
  Quat<Quad> const exact = exact_attitude(free, 50);
  auto const slope = [&](auto const& method, double h) {
    double const coarse = error_of(solve(method, FixedStep{h}, field, 50), exact);
    double const fine = error_of(solve(method, FixedStep{h / 2}, field, 50), exact);
    return std::log2(coarse / fine);
  };
  EXPECT_NEAR(slope(GaussLawson<4>{}, 2.5), 8, 0.3);
  EXPECT_NEAR(slope(GaussLawson<8>{}, 12.5), 16, 1);
}

TEST(GaussLanes, GiveTheSameBitsWhateverTheRegisters) {
  auto const check = [](auto const& definition, double t_end) {
    expect_same_bits(definition, t_end, RunWith{GaussLawson<4>{}, FixedStep{0.7}},
                     RunWith{GaussLawson<8>{}, FixedStep{4}}, RunWith{Gauss8LawsonSweeps6{}, FixedStep{4}},
                     RunWith{Gauss8LawsonBalanced{}, FixedStep{4}});
  };
  check(FreeBody(Choice{}), 50);
  check(PdSlew(Choice{}), 60);
}

TEST(GaussLanes, RunProblemsThatKnowNothingOfLanes) {
  GravityGradient const definition{Choice{}};
  auto const field = field_of(definition);
  BodyPoint const gauss = solve(Gauss<6>{}, FixedStep{0.25}, field, 100);
  EXPECT_LT(angle_between(solve(GaussLawson<8>{}, FixedStep{5}, field, 100).first, gauss.first), 1e-12);
}

TEST(GaussLanes, KeepNormEnergyAndMomentumToRoundOff) {
  auto const field = field_of(FreeBody(Choice{}));
  Mat3<double> const J = field.inertia_matrix();
  auto const energy = [&](BodyPoint const& x) { return dot(x.second, J * x.second); };
  auto const momentum = [&](BodyPoint const& x) { return length(J * x.second); };
  BodyPoint const start = field.initial();
  for (int stages : {4, 8}) {
    BodyPoint x = start;
    auto const run = [&](auto stepper) { EXPECT_EQ(stepper.advance(x, 0, 10'000), Status::ok); };
    if (stages == 4)
      run(GaussLawson<4>{}.bind(field, FixedStep{1}, NormPolicy::none));
    else
      run(GaussLawson<8>{}.bind(field, FixedStep{1}, NormPolicy::none));
    // A random walk: over 34 step sizes its rms was 1.6e-14, its greatest value 4.5e-14.
    EXPECT_LT(std::fabs(dot(x.first, x.first) - 1), 6e-14) << stages;
    EXPECT_LT(std::fabs(energy(x) / energy(start) - 1), 1e-14) << stages;
    EXPECT_LT(std::fabs(momentum(x) / momentum(start) - 1), 1e-14) << stages;
  }
}

// Feedback couples rates and attitude: without what speeds them up it takes 14 sweeps to round-off.
TEST(GaussLanes, NeedFewSweepsUnderFeedback) {
  auto const slew = field_of(PdSlew(Choice{}));
  EXPECT_LT(sweeps_a_step(GaussLawson<8>{}, FixedStep{10}, slew, 60), 12.5);
  EXPECT_LT(sweeps_a_step(GaussLawson<8>{}, FixedStep{5}, slew, 60), 10);
  EXPECT_LT(sweeps_a_step(Gauss8LawsonBalanced{}, FixedStep{10}, slew, 60), 6.6);
}
// What steers the sweeps does not enter their result.
TEST(GaussLanes, SolveTheStagesOfGauss) {
  auto const compare = [](auto const& field, double h, double t_end) {
    BodyPoint const gauss = solve(Gauss<8>{}, FixedStep{h}, field, t_end);
    BodyPoint const lanes = solve(GaussLawson<8>{}, FixedStep{h}, field, t_end);
    EXPECT_LT(angle_between(lanes.first, gauss.first), 2e-15);
    EXPECT_LT(length(lanes.second - gauss.second), 1e-15);
  };
  compare(field_of(FreeBody(Choice{})), 2, 50);
  compare(field_of(PdSlew(Choice{})), 2, 60);
}
TEST(GaussLanes, BalanceTheErrorOfTheSweepsWithThatOfTheSteps) {
  auto const check = [](auto const& field, double h, int steps) {
    auto solved = GaussLawson<8>{}.bind(field, FixedStep{h}, NormPolicy::none);
    auto exact = GaussLawson<8>{}.bind(field, FixedStep{h / 4}, NormPolicy::none);
    auto balanced = Gauss8LawsonBalanced{}.bind(field, FixedStep{h}, NormPolicy::none);
    BodyPoint x = field.initial(), y = x, z = x;
    double error = 0, more = 0;
    for (int i = 0; i < steps; ++i) {
      EXPECT_EQ(solved.advance(x, i * h, (i + 1) * h), Status::ok);
      EXPECT_EQ(exact.advance(y, i * h, (i + 1) * h), Status::ok);
      EXPECT_EQ(balanced.advance(z, i * h, (i + 1) * h), Status::ok);
      error = std::max(error, angle_between(x.first, y.first));
      more = std::max(more, angle_between(x.first, z.first));
    }
    EXPECT_GT(error, 1e-13) << h;
    EXPECT_LT(more, 2 * error) << h;
    EXPECT_LT(*balanced.work().iterations, 0.85 * double(*solved.work().iterations)) << h;
  };
  for (int steps : {3, 4, 5, 6, 7}) check(field_of(FreeBody(Choice{})), 50. / steps, steps);
  for (int steps : {5, 6, 8, 10}) check(field_of(PdSlew(Choice{})), 60. / steps, steps);
}
// A stepper that was used before gives what a new one gives.
TEST(GaussLanes, RepeatARunToTheLastBit) {
  auto const field = field_of(PdSlew(Choice{}));
  auto const twice = [&](auto stepper) {
    BodyPoint first = field.initial(), second = first;
    EXPECT_EQ(stepper.advance(first, 0, 60), Status::ok);
    stepper.restart();
    EXPECT_EQ(stepper.advance(second, 0, 60), Status::ok);
    EXPECT_TRUE(same_bits(first, second));
  };
  twice(GaussLawson<8>{}.bind(field, FixedStep{7}, NormPolicy::none));
  twice(Gauss8LawsonBalanced{}.bind(field, FixedStep{10}, NormPolicy::none));
}

TEST(GaussLanes, LeaveABodyAtRest) {
  Choice choice;
  choice.set["omega0"] = {0, 0, 0};
  auto const still = field_of(FreeBody(choice));
  EXPECT_TRUE(same_bits(solve(GaussLawson<8>{}, FixedStep{10}, still, 50), still.initial()));
}

TEST(GaussLanes, HoldTheTorqueOfTheLastSample) {
  for_each_sampled([](auto const& field) {
    BodyPoint const gauss = sampled_run(field, Gauss<4>{}, FixedStep{0.05}, 0.1, 200);
    BodyPoint const fixed = sampled_run(field, GaussLawson<4>{}, FixedStep{0.1}, 0.1, 200);
    EXPECT_LT(angle_between(gauss.first, fixed.first), 1e-13);
    BodyPoint const erased = [&] {
      auto problem = erase_type(field);
      BodyPoint x = problem->initial();
      auto stepper = GaussLawson<4>{}.bind(std::as_const(*problem), FixedStep{0.1}, NormPolicy::none);
      for (int i = 0; i < 200; ++i) {
        problem->sample(i * 0.1, x);
        stepper.restart();
        EXPECT_EQ(stepper.advance(x, i * 0.1, (i + 1) * 0.1), Status::ok);
      }
      return x;
    }();
    EXPECT_TRUE(same_bits(fixed, erased));
  });
}

TEST(GaussLanes, TakeAShorterLastStepAndProject) {
  FreeBody const free{Choice{}};
  auto const field = field_of(free);
  EXPECT_LT(error_of(solve(GaussLawson<8>{}, FixedStep{3}, field, 50), exact_attitude(free, 50)), 1e-14);
  BodyPoint x = field.initial();
  auto stepper = GaussLawson<8>{}.bind(field, FixedStep{5}, NormPolicy::project);
  EXPECT_EQ(stepper.advance(x, 0, 50), Status::ok);
  EXPECT_EQ(stepper.projections().count, 10);
  EXPECT_LT(std::fabs(dot(x.first, x.first) - 1), 4e-16);
  EXPECT_LT(error_of(x, exact_attitude(free, 50)), 1e-14);
}

TEST(GaussLanes, SayWhenStagesCannotBeSolved) {
  auto const field = field_of(PdSlew(Choice{}));
  BodyPoint x = field.initial();
  auto stepper = GaussLawson<8>{}.bind(field, FixedStep{2000}, NormPolicy::none);
  EXPECT_NE(stepper.advance(x, 0, 4000), Status::ok);
  x = field.initial();
  x.second.x = std::nan("");
  EXPECT_EQ(stepper.advance(x, 0, 2000), Status::diverged);
}

}  // namespace
}  // namespace polhode
