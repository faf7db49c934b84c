/// The libraries behind our face: they agree with the references, and their counters and memory do what ours do.
#include <gtest/gtest.h>

#include "integrators/catalog.hpp"
#include "problems/catalog.hpp"
#include "tests/support/rival_runs.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;
using test::CellUnderTest;

std::vector<std::string> adaptive_rivals() {
  std::vector<std::string> names;
  for (bench::IntegratorWord const& word : bench::vocabulary().integrators)
    if (word.rival && word.adaptive && word.needs == "flat" && word.not_built.empty()) names.push_back(word.name);
  return names;
}
std::string name_of(testing::TestParamInfo<std::string> const& info) {
  return info.param;
}

class AdaptiveRival : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, AdaptiveRival, testing::ValuesIn(adaptive_rivals()), name_of);

TEST_P(AdaptiveRival, AgreesWithTheReference) {
  for (char const* problem : {"free_body", "pd_slew", "tether_capture"}) {
    auto const record = a_cell(problem, "quaternion", GetParam()).with_rtol(1e-10).measured().record;
    ASSERT_EQ(record.status, results::Status::ok) << problem << ": " << record.reason;
    EXPECT_LT(*record.attitude_error_max, 3e-7) << problem;
    EXPECT_LT(*record.rate_error_max, 3e-7) << problem;
  }
}

#ifdef POLHODE_HAS_SUNDIALS
/// A restart at every sample, at any tolerance: with its own first steps IDA got stuck at most of these.
TEST(Ida, StartsAnewAtSamples) {
  for (double const rtol : {1e-6, 1e-8, 1e-9, 3e-10, 1e-10, 5e-11, 1e-11})
    EXPECT_EQ(a_cell("tether_capture", "quaternion", "ida").with_rtol(rtol).measured().record.reason, "") << rtol;
}
#endif

TEST_P(AdaptiveRival, CountsWhatItDoes) {
  auto const record = a_cell("pd_slew", "quaternion", GetParam()).with_rtol(1e-8).measured().record;
  EXPECT_GT(*record.steps, 5);  // extrapolation takes few, long steps of many evaluations
  EXPECT_LT(*record.steps, 20'000);
  EXPECT_GE(*record.evaluations, *record.steps);
  EXPECT_LT(*record.evaluations, 100 * (*record.steps + *record.rejected));
  EXPECT_LE(*record.rejected, *record.steps);
  bool const newton = GetParam() == "cvode_bdf" || GetParam() == "arkode_dirk" || GetParam() == "ida";
  EXPECT_EQ(record.jacobians.value_or(0) > 0, newton);
  EXPECT_EQ(record.iterations.value_or(0) >= *record.steps, newton || GetParam() == "cvode_adams");
}

TEST_P(AdaptiveRival, CountersAddUpOverTheRestartsOfASampledLoop) {
  auto const record = a_cell("tether_capture", "quaternion", GetParam()).until(5).with_rtol(1e-8).measured().record;
  EXPECT_EQ(*record.controller_calls, 51);
  EXPECT_GE(*record.steps, 50) << "one from sample to sample at least";
  EXPECT_GE(*record.evaluations, *record.steps);
  auto const half = a_cell("tether_capture", "quaternion", GetParam()).until(2.5).with_rtol(1e-8).measured().record;
  EXPECT_GT(*record.steps, *half.steps);
  EXPECT_GT(*record.evaluations, *half.evaluations);
}

TEST_P(AdaptiveRival, TighterTolerancesTakeMoreStepsAndErrLess) {
  auto const loose = a_cell("free_body", "quaternion", GetParam()).with_rtol(1e-5).measured().record;
  auto const tight = a_cell("free_body", "quaternion", GetParam()).with_rtol(1e-9).measured().record;
  EXPECT_GT(*tight.steps, *loose.steps);
  EXPECT_LT(*tight.attitude_error_max, 1e-2 * *loose.attitude_error_max);
}

// ---- Memory between advances ----------------------------------------------------------------------------------------

#ifdef POLHODE_HAS_SUNDIALS
TEST(Cvode, KeepsItsHistoryBetweenAdvances) {
  EXPECT_GT(test::slew_in_pieces<Cvode<false>>(true).evaluations,
            2 * test::slew_in_pieces<Cvode<false>>(false).evaluations);
  EXPECT_GT(test::slew_in_pieces<Cvode<true>>(true).evaluations,
            2 * test::slew_in_pieces<Cvode<true>>(false).evaluations);
}

TEST(Cvode, ARestartReadsTheStateAgain) {
  auto const problem = erase<double, FlatQuaternion>(FreeBody(Choice{}));
  auto stepper = Cvode<false>{}.bind(*problem, Adaptive{1e-10, 1e-12}, NormPolicy::none);
  auto x = problem->initial();
  ASSERT_EQ(stepper.advance(x, 0, 5), Status::ok);
  auto const there = x;
  std::int64_t const steps = stepper.work().steps;
  x = problem->initial();
  stepper.restart();
  ASSERT_EQ(stepper.advance(x, 0, 5), Status::ok);
  EXPECT_LT(distance<double>(x, there), 1e-12);
  EXPECT_EQ(stepper.work().steps, 2 * steps) << "the library's own counter started anew; ours must not";
}
#endif

TEST(Odeint, ARestartForgetsTheLastSlope) {
  auto const problem = erase<double, FlatQuaternion>(FreeBody(Choice{}));
  auto const end_of = [&](bool changed_before) {
    auto stepper = OdeintDopri5{}.bind(*problem, FixedStep{0.1}, NormPolicy::none);
    auto x = problem->initial();
    if (changed_before) stepper.advance(x, 0, 5);
    x = problem->initial();
    stepper.restart();
    EXPECT_EQ(stepper.advance(x, 0, 5), Status::ok);
    return x;
  };
  EXPECT_EQ(distance<double>(end_of(true), end_of(false)), 0);
}

TEST(Odeint, FixedStepsAgreeWithOurOwnToRoundOff) {
  for (auto const& [rival, own] : {std::pair{"odeint_rk4", "rk4"}, {"odeint_dopri5", "dopri5"}}) {
    auto const theirs = a_cell("free_body", "quaternion", rival).with_h(0.1).simulated().history.rows.back();
    auto const ours = a_cell("free_body", "quaternion", own).with_h(0.1).simulated().history.rows.back();
    for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(theirs[i], ours[i], 1e-13) << rival << ", " << i;
  }
}

TEST(Odeint, ShortensTheLastStepAsWeDo) {
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto x = field.initial(), y = x;
  auto theirs = OdeintRk4{}.bind(field, FixedStep{0.3}, NormPolicy::none);
  auto ours = Rk4{}.bind(field, FixedStep{0.3}, NormPolicy::none);
  EXPECT_EQ(theirs.advance(x, 0, 1), Status::ok);
  EXPECT_EQ(ours.advance(y, 0, 1), Status::ok);
  EXPECT_EQ(theirs.work().steps, 4);
  EXPECT_LT(distance<double>(x, y), 1e-15);
}

}  // namespace
}  // namespace polhode
