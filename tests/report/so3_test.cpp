// The report's section on five craft on SO(3), from made-up records.
#include <cmath>

#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;

constexpr double printed_t1[] = {4.89, 5.15, 9.29};

/// A run of gauss4 that tells t1 and leaves a history of all columns that figures ask for.
void add_timed(Contents& c, std::string const& variant, std::map<std::string, double> const& set, double t1,
               int method) {
  Record r = run_of("so3_cooperative", variant, {"gauss4", 8, 1e-7, 24, 2e-16}, 0.01, 20);
  r.of.formulation = "s3";
  for (auto const& [name, value] : set) {
    r.of.set[name] = {value};
    r.cell += fmt::format("/{} {}", name, value);
  }
  double const printed = printed_t1[method - 1];
  r.claims["t1"] = {t1, printed, std::fabs(t1 - printed) <= 0.05 * printed ? "reproduced" : "not reproduced"};
  Series s{r.cell, "history", {"t", "q_a", "q_geo"}, {"s", "deg", "deg"}, {}};
  for (int craft = 1; craft <= 5; ++craft) {
    for (char const axis : {'x', 'y', 'z'}) {
      s.columns.push_back(fmt::format("b{}.m{}", craft, axis));
      s.units.emplace_back("N m");
    }
  }
  for (int i = 0; i <= 40; ++i) {
    double const t = 0.5 * i, apart = 60 * std::exp(-t);
    std::vector<double> row{t, apart, apart / 2};
    row.resize(s.columns.size(), t < 8 ? 20 : 0.1);
    s.rows.push_back(std::move(row));
  }
  c.records.push_back(std::move(r));
  c.series.push_back(std::move(s));
}

/// Three methods with either set of gains: one gives 5.6 s to all, the other the times told.
Contents contest(std::vector<double> const& set_p) {
  Contents c;
  for (int k = 1; k <= 3; ++k) {
    std::string const method = fmt::format("ex1,method{},far,", k);
    add_timed(c, method + "set_e", {{"delta", 0.01}}, 5.6 + 0.002 * k, k);
    add_timed(c, method + "set_p", {{"delta", 0.01}}, set_p[std::size_t(k - 1)], k);
  }
  return c;
}

TEST(ReportSo3, TheSectionComesWithItsRunsAlone) {
  Folder const folder;
  Contents c;
  c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 12, 2e-15}, 0.1));
  EXPECT_FALSE(contains(markdown_of(c, folder.path), "so3_cooperative"));
  Folder const other{folder.path / "other"};
  std::string const text = markdown_of(contest({5.596, 5.867, 8.671}), other.path);
  expect_sound(other.path);
  EXPECT_TRUE(contains(text, "## 9. Five craft come to one attitude on SO(3)"));
  EXPECT_TRUE(contains(text, "doi 10.3873/j.issn.1000-1328.2018.06.009"));
  EXPECT_TRUE(contains(text, "| feed-forward rho | .8 of the command's rate | chosen |"));
  EXPECT_TRUE(contains(text, "| strong connection | 1-5-2-3-4-1 | deduced |"));
  EXPECT_TRUE(contains(text, "## 11. Measured orders"));
}

TEST(ReportSo3, TheOrderOfTheMethodsIsAMatterOfGains) {
  Folder const folder;
  std::string const text = markdown_of(contest({5.596, 5.867, 8.671}), folder.path);
  EXPECT_TRUE(contains(text,
                       "The order of the methods by t1 is a matter of gains: with set_e (delta = 0.01) they lie "
                       "within 0.071% of each other; with set_p (delta = 0.01) 1 &lt; 2 &lt; 3, as printed."));
  EXPECT_TRUE(contains(text, "| case | claim | the paper | published | unit | set_e, delta = 0.01 |"));
  EXPECT_TRUE(contains(text, "| 4.89 | s | 5.602: no | 5.596: no |"));
  EXPECT_TRUE(contains(slurp(folder.path / "figures" / "so3-methods.csv"), "printed t1,4.89,1"));
}

TEST(ReportSo3, AnotherOrderIsNotTakenForThePrintedOne) {
  Folder const folder;
  EXPECT_TRUE(contains(markdown_of(contest({5.9, 5.6, 8.7}), folder.path),
                       "No gains here give the printed order of the times t1: with set_e (delta = 0.01) they lie "
                       "within 0.071% of each other; with set_p (delta = 0.01) 2 &lt; 1 &lt; 3, not as printed."));
}

TEST(ReportSo3, WhatTheCommandDoesToTheTime) {
  Folder const folder;
  Contents c;
  add_timed(c, "ex1,method1,far,set_e", {}, 5.891, 1);
  add_timed(c, "ex1,method1,far,set_e", {{"rho", 0}}, 9.531, 1);
  add_timed(c, "ex1,method1,switching,set_e", {{"delta", 0.01}}, 5.549, 1);
  c.records.front().claims["t1_ours"] = {5.8912, std::nullopt, "reproduced"};
  c.records.front().claims["q_a_5s"] = {1.91535953, std::nullopt, "reproduced"};
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "No two methods were run with one set of gains"));
  EXPECT_TRUE(contains(text, "| far | 0.1 | 0.8 | gauss4 (s3), h = 0.01 s | 5.891: yes | 1.915: yes |"));
  EXPECT_TRUE(contains(text, "| switching | 0.01 | 0.8 | gauss4 (s3), h = 0.01 s | 5.549 | – |"));
  EXPECT_TRUE(contains(text, "the craft are together at 5.891 s, without it at 9.531 s"));
}

TEST(ReportSo3, TorquesComeToRest) {
  Folder const folder;
  EXPECT_TRUE(contains(markdown_of(contest({5.596, 5.867, 8.671}), folder.path),
                       "The greatest torque is 20 N m; from 7.5 s on all are below 1% of it."));
}

TEST(ReportSo3, EulerAnglesJumpAndTheMatrixDoesNot) {
  Folder const folder;
  Contents c;
  Record r = run_of("so3_cooperative", "ex2,method1,far,set_e", {"gauss4", 8, 1e-7, 24, 2e-16}, 0.0025, 1,
                    {{"euler_jump", 173.4}, {"r23_jump", 0.0034}});
  Series s{r.cell, "history", {"t", "b2.r23", "b2.pitch", "b2.yaw", "b2.roll"}, {"s", "", "deg", "deg", "deg"}, {}};
  for (int i = 0; i <= 400; ++i) {
    double const t = 0.0025 * i;
    bool const after = t > 0.4489;
    s.rows.push_back({t, 0.6 + 0.1 * t, after ? 175.0 : 5.0, -90 + 40 * std::fabs(t - 0.4489), after ? -150.0 : 40.0});
  }
  c.records.push_back(r);
  c.series.push_back(s);
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text,
                       "At 0.449 s (the paper: about .5 s) craft 2's yaw is -89.96 deg. Within 5 ms pitch and roll "
                       "both turn by 173.4 deg, while R_23 moves by 0.0034: the angles jump, the attitude does not."));
  std::string const csv = slurp(folder.path / "figures" / "so3-jump.csv");
  EXPECT_TRUE(contains(csv, "0.3,"));
  EXPECT_FALSE(contains(csv, ",0.2975,"));
}

/// Fixed steps with errors of order 4, and a drift of order 4 where nobody keeps R orthogonal.
Contents orders() {
  Contents c;
  for (double const h : {0.0125, 0.025, 0.05, 0.1}) {
    for (auto const& [formulation, integrator, drift] :
         {std::tuple("rotation", "rk4", 7e-2 * std::pow(h, 4)), std::tuple("rotation", "odeint_rk4", 1e-3),
          std::tuple("so3", "cf4", 4e-15), std::tuple("so3", "rkmk4", 9e-15)}) {
      Record r = run_of("so3_cooperative", "ex1,method1,far,set_e", {integrator, 4, 0.02, 4, drift}, h, 20);
      r.of.formulation = formulation;
      r.cell += formulation;
      c.records.push_back(r);
    }
    for (bool const located : {true, false}) {
      Record r =
          run_of("so3_cooperative", located ? "ex1,method1,switching,set_e" : "ex1,method1,switching,set_e,unlocated",
                 {"cf4", located ? 4.0 : 1.0, 0.02, 4, 4e-15}, h, 20);
      r.of.formulation = "so3";
      r.events_located = located ? 5 : 0;
      c.records.push_back(r);
    }
  }
  return c;
}

TEST(ReportSo3, OrdersByDescription) {
  Folder const folder;
  std::string const text = markdown_of(orders(), folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "Measured orders: on R^9 (rotation) rk4 4.00; on SO(3) (so3) cf4 4.00, rkmk4 4.00."));
  EXPECT_TRUE(contains(slurp(folder.path / "figures" / "so3-order.gp"), "set title 'SO(3) (so3)'"));
}

TEST(ReportSo3, NineNumbersDriftAndRotationsDoNot) {
  Folder const folder;
  std::string const text = markdown_of(orders(), folder.path);
  EXPECT_TRUE(contains(text,
                       "|R^T R - 1| drifts: rk4 (rotation) 7e-6 at h = 0.1 s, falling as h^4.00; odeint_rk4 (rotation) "
                       "0.001 at h = 0.1 s."));
  EXPECT_TRUE(contains(text, "It stays at round-off, at most 9e-15, at every step here: cf4 (so3) and rkmk4 (so3)."));
}

TEST(ReportSo3, SurfacesThatAreLocatedKeepTheOrder) {
  Folder const folder;
  std::string const text = markdown_of(orders(), folder.path);
  EXPECT_TRUE(contains(text, "with steps that end there cf4 4.00; with steps across cf4 1.00."));
  EXPECT_TRUE(contains(text, "| ex1,method1,switching,set_e | cf4 | so3 | 5 | 4.00 |"));
}

}  // namespace
}  // namespace polhode::report
