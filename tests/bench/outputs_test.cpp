/// Outputs of adaptive runs: methods with dense output look back into their steps for them, the others end steps there.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;
using test::CellUnderTest;

CellUnderTest slew_by(std::string_view method, double rtol) {
  return a_cell("pd_slew", "quaternion", method).with_rtol(rtol).until(20);
}
/// The greatest difference of the components of q at the same rows of two histories.
double difference(History const& a, History const& b) {
  EXPECT_EQ(a.times, b.times);
  double worst = 0;
  for (std::size_t row = 0; row < std::min(a.rows.size(), b.rows.size()); ++row)
    for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, std::fabs(a.rows[row][i] - b.rows[row][i]));
  return worst;
}

class Dense : public testing::TestWithParam<char const*> {};
INSTANTIATE_TEST_SUITE_P(Outputs, Dense, testing::Values("dopri5", "dop853", "verner65", "verner76", "verner98"),
                         [](auto const& method) { return std::string(method.param); });

TEST_P(Dense, DoNotEndStepsAndAreAsAccurateAsThem) {
  double const rtol = 1e-8, every = 0.1;
  auto const few = slew_by(GetParam(), rtol).simulated(20), many = slew_by(GetParam(), rtol).simulated(every);
  ASSERT_EQ(many.status, results::Status::ok) << many.reason;
  EXPECT_EQ(many.outcome.work.steps, few.outcome.work.steps);
  EXPECT_EQ(many.history.rows.back(), few.history.rows.back()) << "looking does not change the run";
  ASSERT_EQ(many.history.rows.size(), 201u);
  EXPECT_LT(many.outcome.work.steps, 201) << "some steps hold several outputs";
  double const error = difference(many.history, slew_by("dop853", 1e-13).simulated(every).history);
  EXPECT_LT(error, 30 * rtol);
  EXPECT_GT(error, 1e-13) << "errors to be seen";
}

TEST_P(Dense, AreOnTheSphereWhereTheStepsAreProjected) {
  CellUnderTest cell = slew_by(GetParam(), 1e-6).projected();
  auto const run = cell.simulated(0.1);
  ASSERT_EQ(run.status, results::Status::ok) << run.reason;
  for (std::vector<double> const& row : run.history.rows) {
    double norm = 0;
    for (std::size_t i = 0; i < 4; ++i) norm += row[i] * row[i];
    EXPECT_LE(std::fabs(norm - 1), 6.7e-16);
  }
}

TEST(Outputs, EndTheStepsOfMethodsWithoutDenseOutput) {
  auto const run = slew_by("gauss4", 1e-8).simulated(0.1);
  ASSERT_EQ(run.status, results::Status::ok) << run.reason;
  EXPECT_GE(run.outcome.work.steps, 200);
}

// Samples stay stops: between them the command is held, and no step may look across.
TEST(Outputs, OfASampledLoopComeBetweenItsSamples) {
  auto const cell = a_cell("tether_capture", "quaternion", "dop853").of_variant("case1").with_rtol(1e-10).until(5);
  auto const run = cell.simulated(0.025);
  auto const fine = a_cell("tether_capture", "quaternion", "rk4").of_variant("case1").with_h(0.0005).until(5);
  ASSERT_EQ(run.status, results::Status::ok) << run.reason;
  EXPECT_LT(difference(run.history, fine.simulated(0.025).history), 1e-9);
}

}  // namespace
}  // namespace polhode
