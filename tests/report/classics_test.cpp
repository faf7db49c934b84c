// The report's sections on the classics and on the constrained top, from made-up records.
#include <cmath>

#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;

/// A run held against a number: value and print, met or not.
Record against(Record r, std::string const& claim, double value, std::optional<double> printed, bool met) {
  r.claims[claim] = {value, printed, met ? "reproduced" : "not reproduced"};
  return r;
}

Contents printed_numbers() {
  constexpr double printed = -106.1638041430;
  Contents c;
  auto const top = [&](char const* integrator, double h, double apart) {
    Record r = run_of("heavy_top", "bruels", {integrator, 4, 1e3, 4, 0}, h, 2);
    c.records.push_back(against(r, "omega_y_2s", printed + apart, printed, apart <= 1e-6));
  };
  top("gauss4", 0.001, 3e-11);
  top("gauss2", 0.001, 2e-3);
  top("odeint_rkf78", 0.0001, -4e-9);
  Record krogh = run_of("krogh_b5", "", {"gauss4", 8, 1e-9, 24, 0}, 0.05, 20);
  krogh.attitude_error_end.reset();
  krogh.attitude_error_max.reset();
  c.records.push_back(against(krogh, "y_20", 4e-15, std::nullopt, true));
  krogh.of.h = 0.1;
  krogh.cell += "/other";
  krogh.status = results::Status::diverged;
  c.records.push_back(against(krogh, "y_20", 0, std::nullopt, true));
  return c;
}

TEST(ReportClassics, TheSectionComesWithItsRunsAlone) {
  Folder const folder;
  Contents c;
  c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 12, 2e-15}, 0.1));
  c.records.push_back(made("pd_slew", "plain", {"gauss2", 4, 5e-6, 12, 2e-15}, 0.1));
  std::string const text = markdown_of(c, folder.path);
  EXPECT_FALSE(contains(text, "Classics"));
  EXPECT_FALSE(contains(text, "held by a constraint"));
  Folder const other{folder.path / "other"};
  EXPECT_TRUE(contains(markdown_of(printed_numbers(), other.path), "## 9. Classics"));
  expect_sound(other.path);
}

TEST(ReportClassics, PrintedNumbersAreHeldAgainstTheNearestRuns) {
  Folder const folder;
  std::string const text = markdown_of(printed_numbers(), folder.path);
  EXPECT_TRUE(contains(text, "| own | gauss4 (quaternion), h = 0.001 s | 3e-11 | 12 of 13 | 1 of 2 |"));
  EXPECT_TRUE(contains(text, "| rival | odeint_rkf78 (quaternion), h = 0.0001 s | 4e-9 | 10 of 13 | 1 of 1 |"));
  // The run that failed agrees with nothing.
  EXPECT_TRUE(contains(text, "| own | gauss4 (quaternion), h = 0.05 s | 4e-15 | 14 of 17 | 1 of 1 |"));
  EXPECT_TRUE(contains(text, "Sources: Bruels &amp; Cardona (2010), J. Comput. Nonlinear Dynam. 5, 031002; Hull,"));
}

TEST(ReportClassics, WhichMethodForWhichProblem) {
  Folder const folder;
  Contents c;
  for (double const h : {0.0125, 0.025, 0.05, 0.1}) {
    for (Method const& m :
         {Method{"gauss4", 8, 1e-2, 24, 0}, Method{"rk4", 4, 1e-2, 4, 0}, Method{"odeint_rkf78", 8, 1e-1, 13, 0}}) {
      Record r = run_of("pd_slew", "gyrostat", m, h, 60);
      r.cpu_time_s.reset();
      c.records.push_back(r);
    }
  }
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "Cheapest to 1e-9 rad: odeint_rkf78 on pd_slew gyrostat."));
  EXPECT_TRUE(contains(text,
                       "| pd_slew gyrostat | 1e-6 | rk4 (quaternion) | h = 0.05 s | 2000 | odeint_rkf78 (quaternion) "
                       "| h = 0.1 s | ≤ 6500 | 3.25 |"));
  EXPECT_TRUE(contains(text, "| integrator | formulation | pd_slew gyrostat |"));
  EXPECT_TRUE(contains(text, "| rk4 | quaternion | 4.00 |"));
}

TEST(ReportClassics, TheLargestStepThatKeepsJacobisIntegral) {
  Folder const folder;
  Contents c;
  for (double const h : {10.0, 20.0, 50.0, 100.0}) {
    for (auto const& [integrator, drift] :
         {std::pair("gauss4", 5e-19 * std::pow(h, 6)), std::pair("rk4", 1e-7 * h), std::pair("lie_euler", 1e-4 * h)}) {
      Record r = run_of("gravity_gradient", "", {integrator, 4, 1e-9, 4, 0}, h, 34300);
      c.records.push_back(against(r, "jacobi_drift", drift, std::nullopt, drift <= 1e-6));
    }
  }
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text,
                       "keeps it within 1e-6 for 34300 s, in whatever coordinates: 100 s: gauss4; 10 s: rk4; none "
                       "here: lie_euler."));
  EXPECT_TRUE(contains(slurp(folder.path / "figures" / "classics-gravity-gradient.csv"), "rk4"));
}

/// A run of the constrained top with defects that are powers of the step.
Record pinned(char const* integrator, char const* formulation, double h, double position, double velocity,
              double acceleration, double multiplier) {
  Record r = run_of("heavy_top", "dae", {integrator, 2, 1e3, 4, 0}, h, 2);
  r.of.formulation = formulation;
  r.cell += formulation;
  r.position_defect_max = position;
  r.velocity_defect_max = velocity;
  r.acceleration_defect_max = acceleration;
  r.multiplier_error_max = multiplier;
  return r;
}

Contents constrained() {
  Contents c;
  for (double const h : {0.000125, 0.00025, 0.0005, 0.001}) {
    for (char const* formulation : {"so3", "s3"})
      c.records.push_back(pinned("rattle", formulation, h, 2e-16, 3e-14, 1e6 * h, 1e4 * h * h));
    c.records.push_back(
        pinned("rk4", "quaternion", h, 1e8 * std::pow(h, 4), 1e11 * std::pow(h, 4), 1e-11, 1e3 * h * h));
    Record refused = pinned("rattle", "quaternion", h, 0, 0, 0, 0);
    refused.status = results::Status::refused;
    c.records.push_back(refused);
  }
  for (double const rtol : {1e-4, 1e-6})
    c.records.push_back(adaptive(pinned("ida", "quaternion", 0.1, rtol / 10, rtol, 0.1, rtol), rtol));
  c.records.back().status = results::Status::max_steps;
  return c;
}

TEST(ReportConstrained, WhoHoldsWhichLevel) {
  Folder const folder;
  std::string const text = markdown_of(constrained(), folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "## 9. A top held by a constraint"));
  EXPECT_TRUE(contains(text,
                       "Positions, |Phi| in m: held to round-off, within 2e-16, by rattle; at the finest step or "
                       "tolerance ida 1e-5 at rtol = 0.0001, rk4 2.4e-8 at h = 0.000125 s (order 4.00)."));
  EXPECT_TRUE(contains(text, "Velocities, |dPhi/dt| in m/s: held to round-off, within 3e-14, by rattle; at"));
  // The form of index 1 has no multiplier, and says nothing about the second derivative.
  EXPECT_TRUE(
      contains(text,
               "Accelerations, |d2Phi/dt2| in m/s^2: held to round-off by none; at the finest step or tolerance "
               "rattle 120 at h = 0.000125 s (order 1.00), ida 0.1 at rtol = 0.0001."));
  EXPECT_TRUE(contains(text, "The multiplier, relative error: held to round-off by none; at"));
}

TEST(ReportConstrained, AConstraintThatIsHeldIsNoAccuracy) {
  Folder const folder;
  Contents c = constrained();
  Record better = pinned("half_explicit4", "s3", 0.000125, 3e-16, 2e-15, 1e-11, 2e-10);
  better.attitude_error_end = 3e-10;
  c.records.push_back(better);
  EXPECT_TRUE(contains(markdown_of(c, folder.path),
                       "at h = 0.000125 s the attitude errors of methods that hold Phi at round-off reach from 3e-10 "
                       "rad (half_explicit4) to 1.6e-5 rad (rattle)."));
}

TEST(ReportConstrained, OneRowForEachMethodAndStep) {
  Folder const folder;
  std::string const text = markdown_of(constrained(), folder.path);
  EXPECT_TRUE(contains(text, "| rattle | constraint | s3 | h = 0.001 s | ok | 200000 | 0.001 | 2e-16 | 3e-14 |"));
  EXPECT_FALSE(contains(text, "| rattle | constraint | so3 |"));
  EXPECT_TRUE(contains(text, "| rk4 | index 1 | quaternion | h = 0.001 s | ok |"));
  EXPECT_TRUE(contains(text, "| ida | constraint | quaternion | rtol = 1e-6 | max_steps | 2000 | – | – |"));
}

TEST(ReportConstrained, OrdersOfEveryLevel) {
  Folder const folder;
  std::string const text = markdown_of(constrained(), folder.path);
  EXPECT_TRUE(contains(text, "| rattle | s3 | 2.00 | – | – | 1.00 | 2.00 |"));
  EXPECT_TRUE(contains(text, "| rattle | so3 | 2.00 | – | – | 1.00 | 2.00 |"));
  EXPECT_TRUE(contains(text, "| rk4 | quaternion | 2.00 | 4.00 | 4.00 | – | 2.00 |"));
}

TEST(ReportConstrained, TheDriftOfAHistoryIsDrawn) {
  Folder const folder;
  Contents c = constrained();
  EXPECT_FALSE(contains(markdown_of(c, folder.path), "Figure constrained-drift"));
  c.series.push_back({c.records[2].cell, "history", {"t", "position_defect"}, {"s", "m"}, {{1, 1e-8}, {2, 4e-8}}});
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "Figure constrained-drift"));
  EXPECT_TRUE(contains(slurp(folder.path / "figures" / "constrained-drift.csv"), ",2,4e-08"));
}

}  // namespace
}  // namespace polhode::report
