/// Adaptive methods against the tolerance that they are given. Walks the catalogue: a new one is tested by being
/// listed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/conformance/slopes.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using bench::IntegratorWord;
using bench::vocabulary;
using test::a_cell;
using test::CellUnderTest;

/// A run at one tolerance.
struct TolerancePoint {
  double rtol, error;  ///< relative tolerance; greatest attitude error [rad]
  std::int64_t steps;
};

/// Runs from rtol 1e-4 to 1e-10, atol as the command line has it, while they take at most `most_steps`: a method of
/// order 2 would take a million.
std::vector<TolerancePoint> sweep(CellUnderTest const& cell, std::int64_t most_steps = 30'000) {
  std::vector<TolerancePoint> points;
  for (double const rtol : {1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    auto const record = cell.with_rtol(rtol).measured().record;
    EXPECT_EQ(record.status, results::Status::ok) << cell.cell.integrator << ", rtol " << rtol << ": " << record.reason;
    if (record.status != results::Status::ok) break;
    points.push_back({rtol, *record.attitude_error_max, *record.steps});
    if (3 * *record.steps > most_steps) break;
  }
  return points;
}

/// d log(error) / d log(rtol) of the points where the tolerance decides about the steps: at least twenty a smooth arc.
/// With fewer the arc's ends decide, or a longest step (dopri5_ode45: a tenth of the arc), and a tenfold tolerance is a
/// step or two. Null if those span less than three decades.
std::optional<double> slope_where_tolerance_decides(std::vector<TolerancePoint> const& points, int arcs) {
  std::vector<test::OrderPoint> decided;
  for (TolerancePoint const& point : points)
    if (point.steps >= 20 * arcs && point.error > 1e-13)
      decided.push_back({std::log(point.rtol), std::log(point.error)});
  if (decided.size() < 4) return {};
  return test::slope_of(decided);
}

/// A problem, and how many smooth arcs it has: from sample to sample.
struct ToleranceProblem {
  CellUnderTest cell;
  int arcs;
};
/// Long enough for methods of order 16 to take more steps than a handful.
std::vector<ToleranceProblem> problems_for(std::string_view formulation, std::string const& method) {
  return {{a_cell("pd_slew", formulation, method), 1},
          {a_cell("tether_capture", formulation, method).of_variant("case1").set("sample_period", {2}).until(6), 3},
          {a_cell("free_body", formulation, method).until(600), 1}};
}
/// Calls f(method, problem) for every adaptive method on every problem that it accepts.
template <class F>
void for_each_adaptive(F f) {
  for (IntegratorWord const& method : vocabulary().integrators)
    if (method.adaptive && method.not_built.empty() && test::is_walked("", method.name))
      for (std::string_view formulation : {"quaternion", "s3", "mrp"})
        for (ToleranceProblem const& problem : problems_for(formulation, method.name))
          if (bench::prepare(problem.cell.with_rtol(1e-6).cell).refusal.empty()) f(method, problem);
}
std::string text_of(CellUnderTest const& it) {
  return it.cell.integrator + " on " + it.cell.problem + " as " + it.cell.formulation;
}

TEST(Tolerance, ErrorsAreProportionalToIt) {
  std::map<std::string, int> judged;
  for_each_adaptive([&](IntegratorWord const& method, ToleranceProblem const& problem) {
    judged[method.name];
    auto const slope = slope_where_tolerance_decides(sweep(problem.cell), problem.arcs);
    if (!slope) return;
    ++judged[method.name];
    // See its pitfall: the pair that SUNDIALS 6.4 makes of Fehlberg's estimates an error of lower order than it has.
    double const within = method.name == "arkode_erk8" ? 0.5 : 0.3;
    EXPECT_NEAR(*slope, 1, within) << text_of(problem.cell);
  });
  EXPECT_GE(int(judged.size()), test::at_least(20));
  for (auto const& [name, times] : judged) EXPECT_GE(times, 1) << name << ": its steps are never its own";
}

/// A tolerance bounds the error of a step. Errors of steps add up, so a run may err by as many tolerances as it has
/// steps; multistep libraries make use of that, with hundreds of tolerances. Our own methods stay within ten.
TEST(Tolerance, BoundsTheErrorOfARun) {
  for_each_adaptive([](IntegratorWord const& method, ToleranceProblem const& problem) {
    CellUnderTest cell = problem.cell;
    if (cell.cell.problem == "free_body") cell = cell.until(50);
    for (TolerancePoint const& point : sweep(cell)) {
      EXPECT_LT(point.error, double(point.steps) * point.rtol) << text_of(cell);
      if (!method.rival) {
        EXPECT_LT(point.error, 10 * point.rtol) << text_of(cell);
      }
    }
  });
}

}  // namespace
}  // namespace polhode
