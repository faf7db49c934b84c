/// GSL's steppers: their errors, orders and counts, what restarts forget, how they fail, and whose error handler stays.
#include "integrators/rivals/gsl.hpp"

#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/rival_runs.hpp"

namespace polhode {
namespace {

using test::error_of;
using test::reference_state;
using test::run_rival;

#ifdef POLHODE_HAS_GSL
std::vector<bench::Stop> until(double t_end) {
  return {bench::Stop{.time = 0}, bench::Stop{.time = t_end}};
}

/// Error at 10 s of the slew and steps taken, at most.
struct Bound {
  double rtol, error;
  std::int64_t steps;
};
template <class Method>
void expect_bounds(std::vector<Bound> const& bounds) {
  PdSlew const slew(Choice{});
  auto const reference = reference_state(slew, 0.25, 10);
  for (Bound const& bound : bounds) {
    auto const run = run_rival<Method>(slew, 10, Adaptive{bound.rtol, 1e-2 * bound.rtol});
    ASSERT_EQ(run.status, Status::ok);
    EXPECT_LT(error_of(run.x, reference), bound.error) << bound.rtol;
    EXPECT_GT(error_of(run.x, reference), bound.error / 30) << bound.rtol;
    EXPECT_LE(run.work.steps, bound.steps) << bound.rtol;
    EXPECT_GT(run.work.steps, bound.steps / 2) << bound.rtol;
  }
}

TEST(GslRk8pd, ErrsLessTheTighterTheTolerance) {
  expect_bounds<GslRk8pd>({{1e-4, 2e-7, 8}, {1e-6, 4e-9, 10}, {1e-8, 1e-10, 12}, {1e-10, 3e-12, 17}});
}
TEST(GslMsadams, ErrsLessTheTighterTheTolerance) {
  expect_bounds<GslMsadams>({{1e-4, 6e-4, 50}, {1e-6, 1e-5, 70}, {1e-8, 3e-7, 100}, {1e-10, 5e-9, 140}});
}

TEST(GslRk8pd, IsOfOrderEight) {
  PdSlew const slew(test::brisk());
  auto const reference = reference_state(slew, 1.0 / 32, 4);
  auto const error_at = [&](double steps_a_second) {
    return error_of(run_rival<GslRk8pd>(slew, 4, FixedStep{1 / steps_a_second}).x, reference);
  };
  EXPECT_NEAR(std::log(error_at(1.5) / error_at(3)) / std::log(2), 8, 0.2);
  EXPECT_NEAR(std::log(error_at(2.5) / error_at(5)) / std::log(2), 8, 0.2);
  EXPECT_LT(error_at(5), 2e-11);
}

TEST(GslRk8pd, TakesThirteenEvaluationsAStep) {
  PdSlew const slew(Choice{});
  auto const fixed = run_rival<GslRk8pd>(slew, 1, FixedStep{0.3});
  EXPECT_EQ(fixed.work.steps, 4) << "the last is shortened";
  EXPECT_EQ(fixed.evaluations, 4 * 13);
  auto const chosen = run_rival<GslRk8pd>(slew, 10, Adaptive{1e-8, 1e-10});
  EXPECT_EQ(chosen.evaluations, 13 * (chosen.work.steps + chosen.work.rejected) + 1);
  EXPECT_FALSE(chosen.work.iterations);
  EXPECT_FALSE(chosen.work.jacobians);
}

TEST(GslRk8pd, OneStepIsAStepOfAnyLength) {
  auto const problem = erase<double, FlatQuaternion>(PdSlew(Choice{}));
  auto stepper = GslRk8pd{}.bind(*problem, FixedStep{0.1}, NormPolicy::none);
  auto x = problem->initial(), y = x;
  EXPECT_EQ(stepper.one_step(x, 0, 0.25), Status::ok);
  EXPECT_EQ(stepper.work().steps, 1);
  auto quarter = GslRk8pd{}.bind(*problem, FixedStep{0.25}, NormPolicy::none);
  EXPECT_EQ(quarter.advance(y, 0, 0.25), Status::ok);
  EXPECT_EQ(distance<double>(x, y), 0);
}

// ---- Restarts -------------------------------------------------------------------------------------------------------

template <class Method>
void expect_sampled(double rtol, double error) {
  TetherCapture const tether(Choice{});
  auto const reference = reference_state(tether, 0.1, 10);
  auto const run = run_rival<Method>(tether, 10, Adaptive{rtol, 1e-2 * rtol});
  ASSERT_EQ(run.status, Status::ok);
  EXPECT_LT(error_of(run.x, reference), error);
  EXPECT_GE(run.work.steps, 100) << "one from sample to sample at least";
  EXPECT_GE(run.evaluations, run.work.steps);
}
TEST(GslRk8pd, StartsAnewAtSamples) {
  expect_sampled<GslRk8pd>(1e-8, 1e-14);
}
TEST(GslMsadams, StartsAnewAtSamples) {
  expect_sampled<GslMsadams>(1e-6, 1e-3);
  expect_sampled<GslMsadams>(1e-10, 1e-7);
}

TEST(GslMsadams, ARestartForgetsItsHistory) {
  EXPECT_GT(test::slew_in_pieces<GslMsadams>(true).work.steps, 3 * test::slew_in_pieces<GslMsadams>(false).work.steps);
}
TEST(GslRk8pd, KeepsItsStepSizeOverARestart) {
  EXPECT_EQ(test::slew_in_pieces<GslRk8pd>(true).work.steps, test::slew_in_pieces<GslRk8pd>(false).work.steps);
  EXPECT_LE(test::slew_in_pieces<GslRk8pd>(true).work.steps, 125) << "one a piece, once the step has grown";
}

TEST(GslMsadams, ANewRunRepeatsTheLastToTheBit) {
  auto const problem = erase<double, FlatQuaternion>(PdSlew(Choice{}));
  auto stepper = GslMsadams{}.bind(*problem, Adaptive{1e-8, 1e-10}, NormPolicy::none);
  auto const end = [&] {
    auto x = problem->initial();
    stepper.begin();
    EXPECT_EQ(stepper.advance(x, 0, 20), Status::ok);
    return x;
  };
  auto const first = end();
  Work const once = stepper.work();
  EXPECT_EQ(distance<double>(end(), first), 0);
  EXPECT_EQ(stepper.work().steps, 2 * once.steps);
  EXPECT_EQ(stepper.work().rejected, 2 * once.rejected) << "the library's own counter started anew; ours must not";
}

TEST(GslRk8pd, ProjectsAfterEveryStep) {
  for (auto const& run : {run_rival<GslRk8pd>(PdSlew(Choice{}), 10, Adaptive{1e-5, 1e-7}, NormPolicy::project),
                          run_rival<GslRk8pd>(PdSlew(Choice{}), 10, FixedStep{0.5}, NormPolicy::project)}) {
    EXPECT_EQ(run.projections.count, run.work.steps);
    EXPECT_GE(run.projections.raw_defect, FlatQuaternion<double>::defect(run.x.first));
    EXPECT_LE(FlatQuaternion<double>::defect(run.x.first), 4.4e-16);
  }
}

// ---- Failures -------------------------------------------------------------------------------------------------------

TEST(Gsl, ASingularityIsAnUnderflowOfTheStep) {
  test::Pole pole;
  EXPECT_EQ(run_rival<GslRk8pd>(pole, until(2), Adaptive{1e-8, 1e-10}).status, Status::step_underflow);
  EXPECT_EQ(run_rival<GslMsadams>(pole, until(2), Adaptive{1e-8, 1e-10}).status, Status::step_underflow);
}
TEST(Gsl, AFieldThatIsNoNumberDiverges) {
  test::EndsInNaN field;
  EXPECT_EQ(run_rival<GslRk8pd>(field, until(2), Adaptive{1e-8, 1e-10}).status, Status::diverged);
  EXPECT_EQ(run_rival<GslMsadams>(field, until(2), Adaptive{1e-8, 1e-10}).status, Status::step_underflow)
      << "its iteration converges with no step";
  EXPECT_EQ(run_rival<GslRk8pd>(field, until(2), FixedStep{0.125}).status, Status::diverged);
  EXPECT_EQ(run_rival<GslRk8pd>(field, until(1), FixedStep{0.125}).status, Status::diverged) << "its last stage";
}

int handled = 0;
void count_errors(char const*, char const*, int, int) {
  ++handled;
}
TEST(Gsl, LeavesTheErrorHandlerOfOthersInPlace) {
  gsl_error_handler_t* const before = gsl_set_error_handler(count_errors);
  test::Pole pole;
  run_rival<GslMsadams>(pole, until(2), Adaptive{1e-8, 1e-10});
  EXPECT_EQ(gsl_set_error_handler(before), count_errors);
  EXPECT_EQ(handled, 0);
}

TEST(Gsl, AllocatesNothingOnceBound) {
  auto const count = [](auto stepper, auto x) {
    auto const before = bench::allocations_of_this_thread();
    stepper.restart();
    EXPECT_EQ(stepper.advance(x, 0, 10), Status::ok);
    return bench::allocations_of_this_thread() - before;
  };
  auto const slew = PdSlew(Choice{}).field<double, FlatQuaternion, true>();
  EXPECT_EQ(count(GslRk8pd{}.bind(slew, Adaptive{1e-8, 1e-10}, NormPolicy::none), slew.initial()), 0);
  EXPECT_EQ(count(GslRk8pd{}.bind(slew, FixedStep{0.1}, NormPolicy::none), slew.initial()), 0);
  EXPECT_EQ(count(GslMsadams{}.bind(slew, Adaptive{1e-8, 1e-10}, NormPolicy::none), slew.initial()), 0);
}

// ---- Events ---------------------------------------------------------------------------------------------------------

TEST(GslRk8pd, LocatesEvents) {
  QuaternionSync const sync(Choice{.words = {"protocol13"}, .set = {}});
  for (auto const& run :
       {run_rival<GslRk8pd>(sync, 2, Adaptive{1e-12, 1e-14}), run_rival<GslRk8pd>(sync, 2, FixedStep{0.02})}) {
    ASSERT_EQ(run.located.events, 3);
    EXPECT_NEAR(run.located.times[0], .2116516346, 1e-9);  // scalar parts of craft 5, 3 and 1 reach zero
    EXPECT_NEAR(run.located.times[1], .4855026743, 1e-9);
    EXPECT_NEAR(run.located.times[2], 1.0050253857, 1e-9);
  }
}
TEST(GslMsadams, RunsOverEvents) {
  QuaternionSync const sync(Choice{.words = {"protocol13"}, .set = {}});
  auto const run = run_rival<GslMsadams>(sync, 2, Adaptive{1e-8, 1e-10});
  EXPECT_EQ(run.status, Status::ok);
  EXPECT_EQ(run.located.events, 0) << "its history does not bear a shorter step";
}
#else
TEST(Gsl, SaysWhyItIsNotThere) {
  EXPECT_NE(GslRk8pd::info.not_built.find("POLHODE_GSL=ON"), std::string_view::npos);
  EXPECT_NE(GslMsadams::info.not_built.find("GPL"), std::string_view::npos);
}
#endif

}  // namespace
}  // namespace polhode
