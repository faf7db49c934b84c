/// ARKODE's diagonally implicit method: its errors, order and counts, what restarts forget, how it fails, its events.
#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "integrators/rivals/arkode.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/rival_runs.hpp"

namespace polhode {
namespace {

using test::error_of;
using test::reference_state;
using test::run_rival;

#ifdef POLHODE_HAS_SUNDIALS
std::vector<bench::Stop> until(double t_end) {
  return {bench::Stop{.time = 0}, bench::Stop{.time = t_end}};
}
/// The slew with a rate loop that settles within 10 ms: stiff for 10 s.
Choice stiff() {
  Choice choice;
  choice.set["k_p"] = {400};
  choice.set["k_d"] = {20000};
  return choice;
}

/// Error at 10 s, steps and Jacobians, at most.
struct Bound {
  double rtol, error;
  std::int64_t steps, jacobians;
};
void expect_bounds(Choice const& choice, double reference_step, std::vector<Bound> const& bounds) {
  PdSlew const slew(choice);
  auto const reference = reference_state(slew, reference_step, 10);
  for (Bound const& bound : bounds) {
    auto const run = run_rival<ArkodeDirk>(slew, 10, Adaptive{bound.rtol, 1e-2 * bound.rtol});
    ASSERT_EQ(run.status, Status::ok);
    EXPECT_LT(error_of(run.x, reference), bound.error) << bound.rtol;
    EXPECT_GT(error_of(run.x, reference), bound.error / 30) << bound.rtol;
    EXPECT_LE(run.work.steps, bound.steps) << bound.rtol;
    EXPECT_GT(run.work.steps, bound.steps / 2) << bound.rtol;
    EXPECT_LE(run.work.jacobians, bound.jacobians) << bound.rtol;
    EXPECT_GE(run.work.jacobians, 1) << bound.rtol;
    EXPECT_GE(run.work.iterations, 6 * run.work.steps) << "six implicit stages a step";
    EXPECT_GE(run.evaluations, *run.work.iterations) << bound.rtol;
  }
}
TEST(Dirk, ErrsLessTheTighterTheTolerance) {
  expect_bounds({}, 0.25, {{1e-4, 4e-5, 9, 5}, {1e-6, 3e-7, 18, 5}, {1e-8, 8e-10, 50, 6}, {1e-10, 2e-11, 100, 12}});
}
TEST(Dirk, TakesLongStepsOnAStiffSlew) {
  expect_bounds(stiff(), 1.0 / 64, {{1e-4, 3e-6, 30, 3}, {1e-6, 5e-9, 55, 4}, {1e-8, 6e-11, 120, 6}});
  auto const run = run_rival<ArkodeErk<5>>(PdSlew(stiff()), 10, Adaptive{1e-6, 1e-8});
  EXPECT_GT(run.work.steps, 400) << "stability, not accuracy, limits an explicit method";
}

TEST(Dirk, IsOfOrderFive) {
  PdSlew const slew(test::brisk());
  auto const reference = reference_state(slew, 1.0 / 32, 4);
  auto const error_at = [&](double steps_a_second) {
    auto const run = run_rival<ArkodeDirk>(slew, 4, FixedStep{1 / steps_a_second});
    EXPECT_EQ(run.work.steps, std::lround(4 * steps_a_second));
    EXPECT_LT(run.work.iterations, 70 * run.work.steps);
    return error_of(run.x, reference);
  };
  double const at16 = error_at(16);
  EXPECT_NEAR(std::log(error_at(8) / at16) / std::log(2), 5, 0.1);
  EXPECT_NEAR(std::log(at16 / error_at(32)) / std::log(2), 5, 0.1);
}

// ---- Restarts -------------------------------------------------------------------------------------------------------

TEST(Dirk, FixedStepsAreShortenedAtStopsAlone) {
  for (bool restart : {false, true}) {
    auto const problem = erase<double, FlatQuaternion>(PdSlew(Choice{}));
    std::vector<bench::Stop> stops{{.time = 0}, {.time = 1}, {.time = 2}};
    stops[1].sample = restart;
    EXPECT_EQ(run_rival<ArkodeDirk>(*problem, stops, FixedStep{0.3}).work.steps, 8) << restart;
  }
}

TEST(Dirk, StartsAnewAtSamples) {
  TetherCapture const tether(Choice{});
  auto const reference = reference_state(tether, 0.1, 10);
  for (auto const& [rtol, error] : {std::pair{1e-6, 1e-9}, {1e-10, 4e-11}}) {
    auto const run = run_rival<ArkodeDirk>(tether, 10, Adaptive{rtol, 1e-2 * rtol});
    ASSERT_EQ(run.status, Status::ok);
    EXPECT_LT(error_of(run.x, reference), error);
    EXPECT_GE(run.work.steps, 100) << "one from sample to sample at least";
    EXPECT_LT(run.work.steps, 150) << "the step size survives";
  }
}

TEST(Dirk, KeepsItsStepSizeOverARestart) {
  auto const steps = [](bool restart_at_each) {
    auto const problem = erase<double, FlatQuaternion>(PdSlew(Choice{}));
    auto stepper = ArkodeDirk{}.bind(*problem, Adaptive{1e-8, 1e-10}, NormPolicy::none);
    auto x = problem->initial();
    for (int i = 0; i < 120; ++i) {
      if (restart_at_each) stepper.restart();
      EXPECT_EQ(stepper.advance(x, 0.5 * i, 0.5 * (i + 1)), Status::ok);
    }
    EXPECT_LT(angle_between(x.first, Quat<double>{0, 0, 0, 1}), 0.0065);
    return stepper.work().steps;
  };
  EXPECT_LE(std::llabs(steps(true) - steps(false)), 5);
}

TEST(Dirk, ARestartReadsTheStateAndANewRunRepeatsTheLast) {
  auto const problem = erase<double, FlatQuaternion>(PdSlew(Choice{}));
  auto stepper = ArkodeDirk{}.bind(*problem, Adaptive{1e-10, 1e-12}, NormPolicy::none);
  auto const end = [&](bool anew) {
    auto x = problem->initial();
    if (anew)
      stepper.begin();
    else
      stepper.restart();
    EXPECT_EQ(stepper.advance(x, 0, 20), Status::ok);
    return x;
  };
  auto const first = end(true);
  Work const once = stepper.work();
  EXPECT_EQ(distance<double>(end(true), first), 0);
  EXPECT_EQ(stepper.work().steps, 2 * once.steps) << "the library's own counter started anew; ours must not";
  EXPECT_EQ(stepper.work().iterations, 2 * *once.iterations);
  EXPECT_LT(distance<double>(end(false), first), 1e-10);
  EXPECT_GT(stepper.work().steps, 2 * once.steps);
}

// ---- Failures -------------------------------------------------------------------------------------------------------

TEST(Dirk, ASingularityIsAnUnderflowOfTheStep) {
  test::Pole pole;
  EXPECT_EQ(run_rival<ArkodeDirk>(pole, until(2), Adaptive{1e-8, 1e-10}).status, Status::step_underflow);
}
TEST(Dirk, AFieldThatIsNoNumberFails) {
  test::EndsInNaN field;
  auto const chosen = run_rival<ArkodeDirk>(field, until(2), Adaptive{1e-8, 1e-10});
  EXPECT_EQ(chosen.status, Status::step_underflow) << "no step passes the error test";
  EXPECT_LT(chosen.work.steps, 1000);
  EXPECT_EQ(run_rival<ArkodeDirk>(field, until(2), FixedStep{0.125}).status, Status::nonlinear_fail);
}

TEST(Dirk, AllocatesNothingOnceBound) {
  auto const slew = PdSlew(Choice{}).field<double, FlatQuaternion, true>();
  auto stepper = ArkodeDirk{}.bind(slew, Adaptive{1e-8, 1e-10}, NormPolicy::none);
  auto x = slew.initial();
  auto const before = bench::allocations_of_this_thread();
  EXPECT_EQ(stepper.advance(x, 0, 10), Status::ok);
  EXPECT_EQ(bench::allocations_of_this_thread() - before, 0);
}

// ---- Events ---------------------------------------------------------------------------------------------------------

TEST(Dirk, LocatesEvents) {
  QuaternionSync const sync(Choice{.words = {"protocol13"}, .set = {}});
  for (auto const& run :
       {run_rival<ArkodeDirk>(sync, 2, Adaptive{1e-12, 1e-14}), run_rival<ArkodeDirk>(sync, 2, Adaptive{1e-8, 1e-10}),
        run_rival<ArkodeDirk>(sync, 2, FixedStep{0.02})}) {
    ASSERT_EQ(run.status, Status::ok);
    ASSERT_EQ(run.located.events, 3);
    EXPECT_NEAR(run.located.times[0], .2116516346, 1e-9);  // scalar parts of craft 5, 3 and 1 reach zero
    EXPECT_NEAR(run.located.times[1], .4855026743, 1e-9);
    EXPECT_NEAR(run.located.times[2], 1.0050253857, 1e-9);
  }
}
#else
TEST(Dirk, SaysWhyItIsNotThere) {
  EXPECT_FALSE(ArkodeDirk::info.not_built.empty());
}
#endif

}  // namespace
}  // namespace polhode
