/// Norm policies through the harness: who is refused and why, what the records say, what happens to refused cells.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "integrators/norm_policy.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;
using test::CellUnderTest;

CellUnderTest under(CellUnderTest it, std::string_view policy) {
  it.cell.policy = policy;
  return it;
}
CellUnderTest fixed(char const* formulation, char const* integrator) {
  return a_cell("pd_slew", formulation, integrator).with_h(0.1).until(5);
}
CellUnderTest adaptive(char const* formulation, char const* integrator) {
  return a_cell("pd_slew", formulation, integrator).with_rtol(1e-6).until(5);
}
std::string refusal_of(CellUnderTest const& it) {
  return bench::prepare(it.cell).refusal;
}

TEST(NormPolicyCells, EveryPolicyOfTheContractIsAWord) {
  std::vector<std::string> const expected{
      "none", "project", "project_multiplier", "project_symmetric", "baumgarte", "relaxation", "native"};
  EXPECT_EQ(bench::vocabulary().policies, expected);
}

TEST(NormPolicyCells, OwnMethodsOnFlatQuaternionsKnowThemAll) {
  for (char const* policy : {"baumgarte", "relaxation", "project_symmetric"})
    for (char const* method : {"rk4", "dopri5", "gauss2"})
      EXPECT_EQ(refusal_of(under(fixed("quaternion", method), policy)), "") << policy << ", " << method;
  for (char const* policy : {"baumgarte", "relaxation"})
    for (char const* method : {"dopri5", "dop853", "gauss2"})
      EXPECT_EQ(refusal_of(under(adaptive("quaternion", method), policy)), "") << policy << ", " << method;
  EXPECT_EQ(refusal_of(under(fixed("rotation", "rk4"), "baumgarte")), "");
  EXPECT_EQ(refusal_of(under(adaptive("quaternion", "dopri5_ode45"), "baumgarte")), "");
}

TEST(NormPolicyCells, ElsewhereTheyAreRefusedWithAReason) {
  struct Case {
    CellUnderTest cell;
    char const* policy;
    char const* says;
  };
  auto const free = a_cell("free_body", "quaternion", "exact").with_h(0.1).until(5);
  for (Case const& c :
       {Case{fixed("quaternion", "odeint_rk4"), "baumgarte", "library"},
        Case{fixed("quaternion", "odeint_rk4"), "relaxation", "library"},
        Case{adaptive("quaternion", "cvode_bdf"), "baumgarte", "library"},
        Case{fixed("s3", "cf4"), "baumgarte", "group"}, Case{fixed("so3", "cf4"), "relaxation", "group"},
        Case{fixed("mrp", "rk4"), "baumgarte", "no norm"},
        Case{fixed("rotation", "rk4"), "relaxation", "one body on flat quaternions"},
        Case{fixed("rotation", "rk4"), "project_symmetric", "one body on flat quaternions"},
        Case{adaptive("quaternion", "dopri5"), "project_symmetric", "equal steps"},
        Case{adaptive("quaternion", "dopri5_ode45"), "relaxation", "step control"},
        Case{free, "baumgarte", "closed form"}, Case{free, "relaxation", "closed form"}}) {
    std::string const why = refusal_of(under(c.cell, c.policy));
    EXPECT_NE(why.find(c.says), std::string::npos) << c.cell.cell.integrator << ", " << c.policy << ": " << why;
    EXPECT_GT(why.size(), 20u) << "a reason is a sentence";
  }
}

TEST(NormPolicyCells, RecordsTellWhatThePolicyDid) {
  // Where the body hardly turns, relaxation costs accuracy; this one spins.
  auto const spinning = a_cell("free_body", "quaternion", "rk4").with_h(0.25).until(20);
  auto const none = spinning.measured().record;
  EXPECT_FALSE(none.projections);
  for (char const* policy : {"project", "project_symmetric", "baumgarte", "relaxation"}) {
    auto const record = under(spinning, policy).measured().record;
    EXPECT_EQ(record.status, results::Status::ok) << policy << ": " << record.reason;
    EXPECT_EQ(record.projections, record.steps) << policy;
    EXPECT_GT(record.projection_work.value_or(0), 0) << policy;
    EXPECT_LT(*record.norm_drift_max, *none.norm_drift_max) << policy;
    EXPECT_GT(*record.norm_drift_raw_max, 1e-12) << policy << ": the drift before it does not vanish";
    EXPECT_LT(*record.attitude_error_max, 1.5 * *none.attitude_error_max) << policy;
  }
  auto const relaxed = under(spinning, "relaxation").measured().record;
  EXPECT_LT(*relaxed.norm_drift_max, 1e-14);
}

TEST(NormPolicyCells, AMeasuredRunEndsWhereATimedOneDoes) {
  for (char const* policy : {"project_symmetric", "baumgarte", "relaxation"})
    for (bool const steps_are_equal : {true, false}) {
      auto const cell =
          under(steps_are_equal ? fixed("quaternion", "dopri5") : adaptive("quaternion", "dopri5"), policy);
      auto const prepared = bench::prepare(cell.cell);
      if (!prepared.refusal.empty()) continue;
      auto const timed = prepared.problem->timed("quaternion", "dopri5", prepared.plan);
      ASSERT_TRUE(timed);
      ASSERT_EQ(timed->solve(), Status::ok);
      auto const state = timed->end_state();
      auto const shown = cell.simulated();
      ASSERT_EQ(shown.status, results::Status::ok) << shown.reason;
      auto const& last = shown.history.rows.back();
      for (std::size_t i = 0; i < state.size(); ++i) EXPECT_EQ(last[i], state[i]) << policy << ", component " << i;
    }
}

// Its method may not even have a function to call.
TEST(RefusedCells, AreRecordsAndDoNotRun) {
  for (auto const& cell : {under(fixed("s3", "cf4"), "relaxation"), fixed("quaternion", "cf4"), fixed("s3", "rk4")}) {
    auto const prepared = bench::prepare(cell.cell);
    ASSERT_FALSE(prepared.refusal.empty());
    auto const measured = cell.measured();
    EXPECT_EQ(measured.record.status, results::Status::refused);
    EXPECT_EQ(measured.record.reason, prepared.refusal);
    EXPECT_FALSE(measured.record.steps);
    EXPECT_THROW(bench::simulate(prepared, {}), std::logic_error);
  }
}

}  // namespace
}  // namespace polhode
