/// Every own method's order, measured in quadruple precision against certified references; rivals' in double. Walks the
/// catalogues: a new method is tested by being listed.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/catalog.hpp"
#include "problems/catalog.hpp"
#include "tests/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;

struct Point2 {
  double log_h, log_error;
};

/// Least squares.
double slope_of(std::vector<Point2> const& points) {
  double const n = double(points.size());
  double h = 0, e = 0, hh = 0, he = 0;
  for (Point2 const& p : points) {
    h += p.log_h / n;
    e += p.log_error / n;
  }
  for (Point2 const& p : points) {
    hh += (p.log_h - h) * (p.log_h - h);
    he += (p.log_h - h) * (p.log_error - e);
  }
  return he / hh;
}

/// An order problem over 4 s: non-principal rates, a torque that depends on the attitude, steps that divide exactly.
struct OrderProblem {
  test::CellUnderTest cell;
  bench::PreparedCell prepared;
  bench::QuadState end;

  explicit OrderProblem(test::CellUnderTest const& c)
      : cell(c.until(4)),
        prepared(bench::prepare(cell.with_h(0.5).cell)),
        end(bench::Reference::solve(*prepared.problem, prepared.schedule).at(4)) {}
};
OrderProblem const& slew() {
  static OrderProblem const problem(a_cell("pd_slew", "s3", "cf4"));
  return problem;
}
/// Sampled every 2 s, so that there is room for steps.
OrderProblem const& tether() {
  static OrderProblem const problem(
      a_cell("tether_capture", "s3", "cf4").of_variant("case1").set("sample_period", {2}));
  return problem;
}

/// Stiffer and faster than by default, with the scalar part above .7 throughout: there a method of order 5 shows its
/// order before double precision ends. On the default slew its errors fall by order 6 until round-off.
OrderProblem const& brisk_slew() {
  static OrderProblem const problem(a_cell("pd_slew", "s3", "cf4").set("k_p", {100}).set("omega0", {-0.6, -0.9, 0.3}));
  return problem;
}

/// The finest of five steps, as a power of two [s]: where a method of this order is asymptotic, and its error in
/// quadruple precision is far above round-off.
int finest_exponent(int order) {
  return order == 1 ? -11 : order <= 5 ? -9 : order == 6 ? -6 : -5;
}

template <class Method, template <class> class A, Definition D>
void expect_order(D const& definition, OrderProblem const& problem, std::string_view formulation) {
  auto const& info = Method::info;
  std::vector<Point2> points;
  for (int k = finest_exponent(info.order) + 4; k >= finest_exponent(info.order); --k) {
    double const h = std::ldexp(1, k);
    auto const field = erase<Quad, A>(definition);
    auto stepper = Method{}.bind(*field, FixedStep{h}, NormPolicy::none);
    auto x = field->initial();
    ASSERT_EQ(bench::RunLoop(*field, stepper, h, true).go(x, problem.prepared.plan.stops, bench::NoWatch{}),
              Status::ok);
    double const error = double(angle_between(A<Quad>::attitude(x.first), problem.end.at(0).q));
    ASSERT_GT(error, 1e-27) << "round-off: no order to see";
    points.push_back({std::log(h), std::log(error)});
  }
  EXPECT_NEAR(slope_of(points), info.order, 0.1)
      << info.name << " on " << problem.cell.cell.problem << " as " << formulation;
}

/// Calls f(method, formulation) for each own method with an order and each formulation that it suits.
template <class F, class... Method>
void for_each_method(F f, Types<Method...>) {
  auto const on_formulation = [&]<class Formulation>(Formulation formulation) {
    auto const one = [&]<class M>(M method) {
      using Space = RigidBody<typename Formulation::template On<Quad>>;
      if constexpr (refusal<Space>(M::info.needs).empty() && M::info.order > 0) f(method, formulation);
    };
    (one(Method{}), ...);
  };
  [&]<class... Formulation>(Types<Formulation...>) { (on_formulation(Formulation{}), ...); }(Formulations{});
}

TEST(Order, OfEveryOwnMethodOnTheSlew) {
  int checked = 0;
  for_each_method(
      [&]<class Method, class F>(Method, F) {
        expect_order<Method, F::template On>(PdSlew(Choice{}), slew(), F::name);
        ++checked;
      },
      OwnMethods{});
  EXPECT_GE(checked, 20);
}

TEST(Order, OfEveryOwnMethodOnTheTether) {
  Choice choice;
  choice.set["sample_period"] = {2};
  int checked = 0;
  for_each_method(
      [&]<class Method, class F>(Method, F) {
        expect_order<Method, F::template On>(TetherCapture(choice), tether(), F::name);
        ++checked;
      },
      OwnMethods{});
  EXPECT_GE(checked, 20);
}

TEST(Order, OfEveryRivalWithFixedSteps) {
  int checked = 0;
  for (bench::IntegratorWord const& word : bench::vocabulary().integrators) {
    if (!word.rival || !word.fixed || !word.order || !word.not_built.empty()) continue;
    std::vector<Point2> points;
    for (double steps_a_second : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0, 128.0}) {
      double const h = 1 / steps_a_second;
      auto cell = brisk_slew().cell;
      cell.cell.formulation = "quaternion";
      cell.cell.integrator = word.name;
      auto const run = cell.with_h(h).simulated();
      ASSERT_EQ(run.status, results::Status::ok);
      auto const& row = run.history.rows.back();
      double const error = double(angle_between(Quat<Quad>{row[0], row[1], row[2], row[3]}, brisk_slew().end.at(0).q));
      if (2e-13 < error && error < 1e-4)  // round-off is below 7e-15
        points.push_back({std::log(h), std::log(error)});
    }
    ASSERT_GE(points.size(), 3u) << word.name;
    if (points.size() > 3) points.erase(points.begin(), points.end() - 3);  // the finest are the most asymptotic
    // Between the leading term and round-off double precision leaves orders 7 and 8 less than a decade of steps.
    EXPECT_NEAR(slope_of(points), *word.order, *word.order < 7 ? 0.1 : 0.2) << word.name;
    ++checked;
  }
  EXPECT_GE(checked, 2);
}

}  // namespace
}  // namespace polhode
