/// The closed form as an integrator: errors of no more than the data's own, on any free body, for any time; arcs,
/// formulations, products of inertia, what it keeps.
#include "integrators/exact.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "problems/mrp.hpp"
#include "tests/integrators/free_body_runs.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using test::drift_over;
using test::FreeCase;
using test::in;
using test::Random;

constexpr double eps = 0x1p-52;

// ---- Accuracy -------------------------------------------------------------------------------------------------------

/// Round-off by time t [s]: eps times the radians of the fastest turn, and one more.
double round_off(FreeCase const& c, double t) {
  return eps * (1 + c.momentum() * std::fabs(t) / c.least_moment());
}
/// How far one unit in the last place of any datum moves the attitude by time t, in units of round_off; at least 1.
double conditioning(FreeCase const& c, double t) {
  auto const exact = c.exact<Quad>().at(t).first;
  double worst = 1;
  for (std::size_t datum = 0; datum < 6; ++datum) {
    FreeCase moved = c;
    std::array<double*, 6> const data{&moved.inertia[0], &moved.inertia[1], &moved.inertia[2],
                                      &moved.omega0.x,   &moved.omega0.y,   &moved.omega0.z};
    *data[datum] = std::nextafter(*data[datum], 2 * *data[datum]);
    worst = std::max(worst, double(angle_between(moved.exact<Quad>().at(t).first, exact)) / round_off(c, t));
  }
  return worst;
}

// Every case is a line of the log; none is left out.
TEST(ExactIntegrator, ErrsByRoundOffOnAnyBodyForAThousandSeconds) {
  unsigned const seed = 3;
  Random random(seed);
  std::string const path = testing::TempDir() + "exact_integrator_cases.csv";
  std::ofstream log(path);
  log << "case,kind,I_1,I_2,I_3,omega_1,omega_2,omega_3,t,error,round_off,kappa\n";
  log.precision(17);
  double worst = 0, worst_without_kappa = 0;
  for (int n = 0; n < 1000; ++n) {
    FreeCase const c = random_case(random, n);
    auto const field = c.field<double, S3>();
    auto const exact = c.exact<Quad>();
    auto stepper = Exact{}.bind(field, FixedStep{0.1}, NormPolicy::none);
    auto x = field.initial();
    double t = 0;
    for (double next : {1., 30., 333., 1000., -1000.}) {
      ASSERT_EQ(stepper.advance(x, t, next), Status::ok);
      t = next;
      double const error = double(angle_between(in<Quad>(x.first), exact.at(t).first));
      double const units = error / round_off(c, t);
      double const kappa = std::fabs(t) == 1000 ? conditioning(c, t) : 1;
      log << n << ',' << c.kind << ',' << c.inertia[0] << ',' << c.inertia[1] << ',' << c.inertia[2] << ','
          << c.omega0.x << ',' << c.omega0.y << ',' << c.omega0.z << ',' << t << ',' << error << ',' << round_off(c, t)
          << ',' << kappa << '\n';
      EXPECT_LE(units, 8 * kappa) << "seed " << seed << ", case " << n << ", " << c.kind << ", t = " << t;
      worst = std::max(worst, units / kappa);
      worst_without_kappa = std::max(worst_without_kappa, units);
    }
  }
  RecordProperty("log", path);
  RecordProperty("worst_in_units", std::to_string(worst));
  RecordProperty("worst_without_kappa", std::to_string(worst_without_kappa));
}

// By a method that knows no elliptic functions.
TEST(ExactIntegrator, AgreesWithGaussInQuadruplePrecision) {
  Random random(4);
  for (int n = 0; n < 10; ++n) {
    FreeCase const c = random_case(random, n);
    auto const field = c.field<Quad, FlatQuaternion>();
    auto const gauss = test::by_gauss(field, n == 8 ? 0.02 : 0.1, 5);
    auto const x = test::state_at(Exact{}, field, 5, 5);
    EXPECT_LT(double(distance<Quad>(x.first, gauss.first)), 1e-28) << c.kind;
    EXPECT_LT(double(distance<Quad>(x.second, gauss.second)), 1e-28) << c.kind;
  }
}

TEST(ExactIntegrator, KnowsProductsOfInertia) {
  FreeCase const c = test::turned_axes();
  auto const field = c.field_of_matrix<Quad, FlatQuaternion>();
  auto const gauss = test::by_gauss(field, 0.1, 10);
  auto const x = test::state_at(Exact{}, field, 10, 10);
  EXPECT_LT(double(distance<Quad>(x.first, gauss.first)), 1e-28);
  EXPECT_LT(double(distance<Quad>(x.second, gauss.second)), 1e-28);
}

TEST(ExactIntegrator, IsOneInEveryFormulation) {
  FreeCase const c;
  auto const expected = c.exact<double>().at(100).first;
  EXPECT_LT(angle_between(test::state_at(Exact{}, c.field<double, FlatQuaternion>(), 0.1, 100).first, expected), 1e-13);
  EXPECT_LT(angle_between(test::state_at(Exact{}, c.field<double, S3>(), 0.1, 100).first, expected), 1e-13);
  auto const so3 = test::state_at(Exact{}, c.field<double, SO3>(), 0.1, 100);
  EXPECT_LT(angle_between(SO3<double>::attitude(so3.first), expected), 1e-13);
  auto const flat = test::state_at(Exact{}, c.field<double, FlatRotation>(), 0.1, 100);
  EXPECT_LT(angle_between(SO3<double>::attitude(flat.first), expected), 1e-13);
}

// ---- Arcs -----------------------------------------------------------------------------------------------------------

TEST(ExactIntegrator, StartsEveryAdvanceFromTheBeginningOfTheArc) {
  auto const field = FreeCase{}.field<double, FlatQuaternion>();
  auto stepper = Exact{}.bind(field, FixedStep{0.1}, NormPolicy::none);
  auto x = field.initial();
  for (int i = 0; i < 100000; ++i) stepper.advance(x, 0.1 * i, 0.1 * (i + 1));
  auto const at_once = test::state_at(Exact{}, field, 0.1, 0.1 * 100000);
  EXPECT_EQ(distance<double>(x, at_once), 0);
  EXPECT_EQ(stepper.work().steps, 100000);
}

TEST(ExactIntegrator, RestartsFromAStateThatWasChanged) {
  FreeCase const c;
  FreeCase other;
  other.omega0 = {-0.4, 0.1, 0.2};
  auto const field = c.field<double, FlatQuaternion>();
  auto stepper = Exact{}.bind(field, FixedStep{0.1}, NormPolicy::none);
  auto x = field.initial();
  stepper.advance(x, 0, 7);
  x = other.field<double, FlatQuaternion>().initial();
  stepper.restart();
  stepper.advance(x, 7, 9);
  EXPECT_LT(distance<double>(x.first, other.exact<double>().at(2).first), 1e-14);
}

TEST(ExactIntegrator, ReturnsToTheStart) {
  EXPECT_LT(test::forth_and_back(Exact{}, FreeCase{}.field<double, FlatQuaternion>(), 0.1, 10000), 1e-12);
  EXPECT_LT(test::forth_and_back(Exact{}, FreeCase{}.field<Quad, FlatQuaternion>(), 0.1, 1000), 1e-30);
}

TEST(ExactIntegrator, LeavesRestAtRest) {
  FreeCase still;
  still.omega0 = {0, 0, 0};
  auto const field = still.field<double, S3>();
  auto const x = test::state_at(Exact{}, field, 0.1, 1e6);
  EXPECT_LT(distance<double>(x.first, field.initial().first), 2 * eps);
  EXPECT_EQ(length(x.second), 0);
}

// ---- What is kept ---------------------------------------------------------------------------------------------------

TEST(ExactIntegrator, KeepsEveryInvariantForAMillionSeconds) {
  Random random(5);
  for (int n = 0; n < 20; ++n) {
    FreeCase const c = random_case(random, n);
    EXPECT_LT(drift_over(c.field<double, FlatQuaternion>(), Exact{}, 0.1, 100, 1e4).worst(), 32 * eps) << c.kind;
    EXPECT_LT(drift_over(c.field<double, FlatRotation>(), Exact{}, 0.1, 100, 1e4).worst(), 64 * eps) << c.kind;
  }
}

// ---- Who may use it -------------------------------------------------------------------------------------------------

TEST(ExactIntegrator, WantsARigidBodyOfQuaternionsOrMatrices) {
  EXPECT_EQ(Exact::info.needs, Needs::free_body);
  EXPECT_TRUE((RunsFixed<Exact, decltype(FreeCase{}.field<double, S3>())>));
  EXPECT_TRUE((RunsFixed<Exact, decltype(FreeCase{}.field_of_matrix<double, SO3>())>));
  EXPECT_FALSE((RunsFixed<Exact, decltype(FreeCase{}.field<double, Mrp>())>));
  EXPECT_FALSE((RunsAdaptive<Exact, decltype(FreeCase{}.field<double, S3>())>));
}

}  // namespace
}  // namespace polhode
