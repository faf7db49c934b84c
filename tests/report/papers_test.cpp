// The report's sections on papers, from made-up records: they appear with their runs, and say what those hold.
#include <cmath>

#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

namespace fs = std::filesystem;
using namespace samples;
using results::Status;

/// A history of one column, at 0 s and at the end.
Series history_with(Record const& r, std::string const& column, double first, double last) {
  return {r.cell, "history", {"t", column}, {"s", ""}, {{0, first}, {r.of.t_end, last}}};
}

Method const exact_4{"rk4", 4, 5e-3, 4, 1e-12};

Contents sync() {
  Contents c;
  auto const add = [&](std::string const& variant, std::map<std::string, double> const& claims, double apart) {
    c.records.push_back(run_of("quaternion_sync", variant, {"gauss4", 8, 1e-7, 24, 2e-16}, 0.02, 20, claims));
    c.series.push_back(history_with(c.records.back(), "disagreement", 1, apart));
  };
  add("protocol7,normalized", {{"scalar_consensus", 7e-5}, {"lemma_1", 0}}, 2e-4);
  add("protocol7,raw", {{"scalar_consensus", 0.25}}, 0.25);
  c.records.back().claims["scalar_consensus"].verdict = "not reproduced";
  add("protocol7,normalized,trap", {{"trap", 0}}, 1);  // quaternions 1 apart: 2 acos(1/2) = 120 deg
  add("protocol13,normalized,trap", {}, 3e-6);
  c.records.back().events_located = 2;
  for (double const h : {0.003125, 0.00625, 0.0125, 0.025, 0.05}) {
    for (bool const located : {true, false}) {
      Record r = run_of("quaternion_sync", located ? "protocol13,normalized" : "protocol13,normalized,unlocated",
                        exact_4, h, 20);
      r.events_located = located ? 3 : 0;
      if (!located) *r.attitude_error_end = h == 0.00625 ? 2e-3 : 4e-3;
      if (located && h == 0.05) *r.attitude_error_end *= 7;  // events cut these steps by chance: they are not fitted
      c.records.push_back(r);
    }
  }
  return c;
}

TEST(ReportPapers, SectionsAppearWithTheirRunsAlone) {
  Folder const folder;
  std::string const without = markdown_of(full(), folder.path);
  std::string const sections = without.substr(without.find("## 2. "));  // the answer says what it cannot say
  for (auto const* word : {"quaternion_sync", "group_consensus", "dead_zone"}) EXPECT_FALSE(contains(sections, word));
  EXPECT_TRUE(contains(without, "## 10. Measured orders"));
  EXPECT_TRUE(contains(without, "| gains | g1 strong tether, g2 weak tether | deduced |"));
  Folder const other{folder.path / "other"};
  std::string const with = markdown_of(sync(), other.path);
  expect_sound(other.path);
  EXPECT_TRUE(contains(with, "## 9. Spacecraft that synchronise"));
  EXPECT_TRUE(contains(with, "## 11. Measured orders"));
  EXPECT_TRUE(contains(with, "doi 10.16366/j.cnki.1000-2367.2022.06.001"));
  EXPECT_TRUE(contains(with, "| step and horizon | 0.1 s, 20 s | printed |"));
}

TEST(ReportPapers, ClaimsAreListedByCaseWithTheirVerdicts) {
  Folder const folder;
  std::string const text = markdown_of(sync(), folder.path);
  EXPECT_TRUE(contains(text, "| case | claim | the paper | published | unit | normalized | normalized trap | raw |"));
  EXPECT_TRUE(contains(text, "its greatest fall | – |  | 0: yes | – | – |"));
  EXPECT_TRUE(contains(text, "| – |  | 7e-5: yes | – | 0.25: no |"));
}

TEST(ReportPapers, RawQuaternionsNeverAgree) {
  Folder const folder;
  EXPECT_TRUE(contains(markdown_of(sync(), folder.path),
                       "their scalar parts differ by 0.25 under (7), for ever; normalised, by 7e-5 under (7)"));
}

TEST(ReportPapers, RefusalsForOneReasonShareARow) {
  Folder const folder;
  Contents c = sync();
  for (auto const* variant : {"protocol7,normalized", "protocol13,normalized"}) {
    for (auto const* integrator : {"cf4", "rkmk4"}) {
      Record r = run_of("quaternion_sync", variant, {integrator, 4, 1, 4, 0}, 0.1, 20);
      r.status = Status::refused;
      r.reason = "needs a rotation group";
      c.records.push_back(r);
    }
  }
  EXPECT_TRUE(contains(markdown_of(c, folder.path),
                       "| refused | needs a rotation group | quaternion_sync, 2 variants | cf4 (quaternion) and rkmk4 "
                       "(quaternion) | 4 | – |"));
}

TEST(ReportPapers, RunsThatStepAcrossEventsAreNotRanked) {
  Folder const folder;
  std::string const text = markdown_of(sync(), folder.path);
  EXPECT_TRUE(contains(text, "| quaternion_sync protocol13,normalized, 20 s | rk4 |"));
  EXPECT_FALSE(contains(text, "| quaternion_sync protocol13,normalized,unlocated, 20 s | rk4 |"));
  EXPECT_FALSE(contains(text, "### quaternion_sync protocol13,normalized,unlocated"));
}

TEST(ReportPapers, TheTrapIsAnAngle) {
  Folder const folder;
  EXPECT_TRUE(contains(markdown_of(sync(), folder.path),
                       "ends with quaternions 1 apart, attitudes that differ by 120 deg: an equilibrium, though an "
                       "unstable one. (13) ends 3e-6 apart after 2 located changes of sign."));
}

TEST(ReportPapers, TheOrderIsThatOfStepsWhichEventsDoNotRule) {
  Folder const folder;
  std::string const text = markdown_of(sync(), folder.path);
  EXPECT_TRUE(contains(text, "| protocol13,normalized | rk4 | quaternion | 3 | 4.00 |"));
  EXPECT_TRUE(contains(text, "| protocol13,normalized,unlocated | rk4 | quaternion | 0 | – | – | – |"));
  EXPECT_TRUE(contains(text,
                       "with events located rk4 4.00; not located none, the errors do not lie on a line. At h = "
                       "0.003125 s the largest error is 4.8e-13 rad with events located and 0.004 rad without."));
  EXPECT_TRUE(contains(slurp(folder.path / "figures" / "sync-order.gp"), "set title '(13), not located'"));
}

TEST(ReportPapers, NetworksShowTheirCost) {
  Folder const folder;
  Contents c = sync();
  Record r = run_of("quaternion_sync", "protocol7,normalized", exact_4, 0.1, 2);
  r.of.set["n"] = {1000};
  r.cell += "/n";
  r.steps = 20;
  r.evaluations = 90;
  r.norm_drift_max = 3e-7;
  c.records.push_back(r);
  r.cell += "/refused";
  r.of.integrator = "cf4";
  r.status = Status::refused;
  c.records.push_back(r);
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "| 1000 | quaternion | rk4 | h = 0.1 s | ok | 20 | 90 | 4.5 | 3e-7 |"));
  EXPECT_FALSE(contains(text, "| 1000 | quaternion | cf4 |"));
}

/// Runs of ic1: the limit from fixed steps, and an adaptive method whose first rate is `first` at a tolerance.
Contents swarm(std::vector<std::pair<double, double>> const& tries, double limit) {
  constexpr char const* names[] = {"g1_x", "g1_y", "g1_z", "g2_x", "g2_y", "g2_z"};
  constexpr double printed[] = {1.87, 1.03, .64, .75, 1.34, .55};
  Contents c;
  auto const with_rates = [&](Record r, double first) {
    for (int k = 0; k < 6; ++k) r.claims[names[k]] = {k == 0 ? first : printed[k], printed[k], "not reproduced"};
    r.claims["greatest_eigenvalue"] = {4.56, 4.0, "not reproduced"};
    r.claims["least_eigenvalue"] = {0.0, 0.0, "reproduced"};
    r.claims["zero_eigenvalues"] = {2.0, 2.0, "reproduced"};
    return r;
  };
  c.records.push_back(with_rates(run_of("group_consensus", "ic1", {"gauss4", 8, 1e-9, 24, 2e-16}, 0.01, 200), limit));
  for (auto const& [rtol, first] : tries) {
    c.records.push_back(
        with_rates(adaptive(run_of("group_consensus", "ic1", {"dopri5_ode45", 5, 1, 6, 1e-9}, 0.1, 200), rtol), first));
  }
  c.records.push_back(
      with_rates(adaptive(run_of("group_consensus", "ic1", {"cvode_adams", 5, 1, 6, 1e-9}, 0.1, 200), 1e-3), 2.13));
  return c;
}

TEST(ReportPapers, ThePrintedRateAppearsAtATolerance) {
  Folder const folder;
  std::string const text =
      markdown_of(swarm({{1e-2, 2.4}, {1e-3, 1.8725}, {1e-4, 1.6}, {1e-5, 1.503}}, 1.5), folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text,
                       "dopri5_ode45 at rtol = 1e-3, atol = 1e-6 gives 1.873, 1.030, 0.640 and 0.750, 1.340, 0.550 "
                       "rad/s, within 0.0025 of print. Of the other 4 adaptive runs the nearest is 0.26 rad/s off."));
  EXPECT_TRUE(contains(text, "other programs disagree on the first rate, 1.873: cvode_adams says 2.130."));
  EXPECT_TRUE(
      contains(text, "within 0.01 rad/s of the limit stay dopri5_ode45 from 1e-5 on; nowhere here: cvode_adams."));
  EXPECT_TRUE(contains(text, "| 1e-4 |"));
  std::string const csv = slurp(folder.path / "figures" / "consensus-tolerance.csv");
  EXPECT_TRUE(contains(csv, "gives the printed rates"));
  EXPECT_TRUE(contains(csv, "limit,1e-05,1.5") || contains(csv, "limit,1e-5,1.5")) << csv.substr(0, 400);
}

TEST(ReportPapers, APrintedRateThatNothingGivesIsNotExplained) {
  Folder const folder;
  std::string const text = markdown_of(swarm({{1e-2, 2.4}, {1e-3, 1.6}}, 1.5), folder.path);
  EXPECT_TRUE(contains(text,
                       "No tolerance here gives the printed rates; the nearest, 0.26 rad/s off, come from "
                       "cvode_adams at rtol = 1e-3"));
  EXPECT_FALSE(contains(text, "no property of the swarm"));
  Folder const other{folder.path / "other"};
  EXPECT_TRUE(contains(markdown_of(swarm({{1e-3, 1.87}}, 1.869), other.path), "there is nothing to explain"));
}

TEST(ReportPapers, TheSpectrumAndTheEscape) {
  Folder const folder;
  Contents c = swarm({{1e-3, 1.87}}, 1.5);
  c.records.push_back(run_of("group_consensus", "ic1,theorem2", exact_4, 0.02, 30, {{"escape", 20.94}}));
  Record r = run_of("group_consensus", "ic1,theorem2", {"gauss4", 8, 1e-7, 24, 2e-16}, 0.02, 30);
  r.of.formulation = "mrp";
  r.status = Status::diverged;
  r.reason = "sigma is infinite";
  c.records.push_back(r);
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(
      contains(text, "by twice the largest in-degree, 4. The paper's own matrix has 4.56, and breaks the bound."));
  EXPECT_TRUE(contains(text, "escapes at 20.94 s."));
  EXPECT_TRUE(contains(text, "with a status instead of a NaN: mrp. Runs that went on: quaternion."));
  EXPECT_TRUE(contains(text, "| mrp | gauss4 | h = 0.02 s | diverged |"));
}

Contents actuators() {
  Contents c;
  for (auto const* variant : {"printed,cubic,n2", "printed,quintic,n2"}) {
    bool const cubic = contains(variant, "cubic");
    Record r = run_of("dead_zone", variant, exact_4, 0.005, 100,
                      {{"sigma_rest", cubic ? 2e-6 : 5e-8}, {"layer", 0.5}, {"v_x_peak", 16.66}});
    r.events_located = 0;
    if (cubic) r.claims["sigma_rest"].verdict = "not reproduced";
    c.records.push_back(r);
    // v_x = t before 50 s, t - 14.5 after it on the cubic path
    Series s{r.cell, "history", {"t", "v_x", "v_y", "v_z"}, {"s", "N m", "N m", "N m"}, {}};
    for (double const t : {49.0, 49.5, 50.0, 50.5, 51.0}) s.rows.push_back({t, t > 50 && cubic ? t - 14.5 : t, 1, 2});
    c.series.push_back(s);
  }
  return c;
}

TEST(ReportPapers, BoundsAndTheJumpOfTheCommand) {
  Folder const folder;
  std::string const text = markdown_of(actuators(), folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text,
                       "At rest within 1e-6 from t_f on: 1 of 2 runs, the worst |sigma_i| being 2e-6. In the "
                       "boundary layer throughout: 2 of 2 runs."));
  EXPECT_TRUE(contains(text, "| 50 | printed | 0 | rk4 (quaternion), h = 0.005 s | ok | 2e-6: no | 0.5: yes |"));
  EXPECT_TRUE(contains(text, "| 50 | printed | \\-14.5 | 0 | 0 |"));
  EXPECT_TRUE(contains(text, "| 50 | printed quintic | 0 | 0 | 0 |"));
}

TEST(ReportPapers, StepControlOnPrintedAndSmoothActuators) {
  Folder const folder;
  Contents c;
  for (auto const* variant : {"printed,cubic,n2", "smooth,cubic,n2"}) {
    for (auto const* integrator : {"dopri5", "cvode_bdf"}) {
      Record r = adaptive(run_of("dead_zone", variant, {integrator, 5, 1, 6, 1e-9}, 0.1, 100), 1e-6);
      r.steps = contains(variant, "smooth") ? 1000 : 3200;
      if (contains(variant, "printed") && integrator == std::string("cvode_bdf")) {
        r.status = Status::stalled;
        r.reason = "stuck at t = 5.24 s";
      }
      c.records.push_back(r);
    }
  }
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "1 of 2 adaptive runs reach the end there, with 3.2 to 3.2 times the steps"));
  EXPECT_TRUE(contains(text, "| dopri5 | 1e-6 | ok | 3200 |"));
  EXPECT_TRUE(contains(text, "| cvode_bdf | 1e-6 | stalled | 3200 |"));
  EXPECT_TRUE(
      contains(text, "Not at the end: cvode_bdf (quaternion) at rtol = 1e-6, atol = 1e-6: stuck at t = 5.24 s."));
}

TEST(ReportPapers, KinksThatAreLocatedKeepTheOrder) {
  Folder const folder;
  Contents c;
  for (double const h : {0.0025, 0.005, 0.01, 0.02}) {
    for (bool const located : {true, false}) {
      Record r = run_of("dead_zone", located ? "continuous,cubic,n4" : "continuous,cubic,n4,unlocated",
                        {"rk4", located ? 4.0 : 2.0, 0.5, 4, 1e-12}, h, 5.5);
      r.events_located = located ? 9 : 0;
      c.records.push_back(r);
    }
  }
  // the same variant to another horizon has no twin there
  c.records.push_back(run_of("dead_zone", "continuous,cubic,n4", {"gauss3", 6, 0.5, 4, 1e-12}, 0.01, 100));
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "| continuous,cubic,n4 | rk4 | quaternion | 9 | 4.00 |"));
  EXPECT_TRUE(contains(text, "| continuous,cubic,n4,unlocated | rk4 | quaternion | 0 | 2.00 |"));
  EXPECT_FALSE(contains(text, "| continuous,cubic,n4 | gauss3 | quaternion |"));
}

}  // namespace
}  // namespace polhode::report
