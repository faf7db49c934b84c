/// Runs of the dead-zone problem: reference values, bounds after t_f, formulations, order, stability; claims.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "integrators/commutator_free.hpp"
#include "integrators/gauss.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/dead_zone.hpp"
#include "tests/problems/chosen_problem.hpp"

namespace polhode {
namespace {

using test::expect_near;
using test::Numbers;
using test::Real3;
using test::Words;

constexpr test::Chooser<DeadZone> chosen;

// ---- Driving --------------------------------------------------------------------------------------------------------

/// Advances to t_end in steps of h, landing on t_f; look(t, x) every `stride` steps and on both sides of t_f.
template <class Method, class Field, class Look>
auto run(Method method, Field field, double h, double t_end, int stride, Look look) {
  auto stepper = method.bind(field, FixedStep{h}, NormPolicy::none);
  auto x = field.initial();
  look(field, 0.0, x);
  auto const to = [&](double from, double until) {
    auto const pieces = int(std::lround((until - from) / (h * stride)));
    for (int i = 1; i <= pieces; ++i) {
      double const step = (until - from) / pieces;
      EXPECT_EQ(stepper.advance(x, from + (i - 1) * step, from + i * step), Status::ok);
      look(field, from + i * step, x);
    }
  };
  double const t_f = field.time_events().at(0);
  to(0, std::min(t_f, t_end));
  if (t_end > t_f) {
    field.enter_phase(t_f);
    stepper.restart();
    look(field, t_f, x);
    to(t_f, t_end);
  }
  return x;
}
template <class Method, class Field>
auto state_at(Method method, Field const& field, double h, double t_end) {
  return run(method, field, h, t_end, int(std::lround(0.5 / h)), [](auto&&...) {});
}
/// The columns of a run, as the harness would collect them.
template <class Method, class Field>
History history_of(Method method, Field const& field, double h, double t_end, int stride) {
  History history;
  for (Column const& column : chosen({}).columns()) history.columns.push_back(column.name);
  run(method, field, h, t_end, stride, [&](Field const& now, double t, auto const& x) {
    std::vector<double> row(history.columns.size());
    now.show(t, x, row);
    history.times.push_back(t);
    history.rows.push_back(std::move(row));
  });
  return history;
}
std::map<std::string, ClaimResult> claims_of(DeadZone const& problem, History const& history) {
  std::map<std::string, ClaimResult> claims;
  for (ClaimResult const& claim : problem.claims(history)) claims[claim.name] = claim;
  return claims;
}

/// The documented states at time t: N2, cubic, t_f = 50 s, p = 0.
struct Documented {
  Real3 sigma, omega;
};
template <class Field, class X>
void expect_state(Field const& field, double t, X const& x, Documented const& expected, double tolerance) {
  expect_near(field.sigma(t, x), expected.sigma, tolerance, "sigma");
  expect_near(x.second, expected.omega, tolerance, "omega");
}

// Printed to 13 decimals; either method's own error is below half a unit there.
TEST(DeadZoneReference, SmoothByTwoMethods) {
  Documented const expected{{0.5081534459900, 0.01383502456497, 0.2393699387606},
                            {0.0583598836249, -0.0782008474008, 0.1032905096102}};
  auto const flat = chosen.field<FlatQuaternion>({"smooth"});
  expect_state(flat, 10, state_at(Gauss<3>{}, flat, 0.0025, 10), expected, 1e-13);
  auto const group = chosen.field<SO3>({"smooth"});
  expect_state(group, 10, state_at(CommutatorFree4{}, group, 1e-4, 10), expected, 1e-13);
}

TEST(DeadZoneReference, PrintedBySmallSteps) {
  Documented const at_10{{0.5081534905428, 0.01383498156808, 0.2393699520588},
                         {0.0583598773922, -0.0782007231258, 0.1032904989848}};
  Documented const at_25{{0.5442436243194, -0.1796142629439, 0.1857596746911},
                         {-0.0639998755994, 0.00892660718593, -0.01137493383306}};
  auto const field = chosen.field<FlatQuaternion>({"printed"});
  expect_state(field, 10, state_at(Rk4{}, field, 5e-4, 10), at_10, 1e-10);
  expect_state(field, 25, state_at(Rk4{}, field, 5e-4, 25), at_25, 1e-10);
}

TEST(DeadZoneReference, PeaksOfTheCommand) {
  auto const claims = claims_of(chosen({}), history_of(Rk4{}, chosen.field<FlatQuaternion>({}), 2.5e-3, 60, 1));
  EXPECT_NEAR(*claims.at("v_x_peak").value, 16.66, 0.005);
  EXPECT_NEAR(*claims.at("v_y_peak").value, 31.38, 0.005);
  EXPECT_NEAR(*claims.at("v_z_peak").value, 17.86, 0.005);
  EXPECT_NEAR(*claims.at("sigma_rest").value, 5.4e-8, 0.05e-8);
}

TEST(DeadZoneBounds, HoldForEveryInertiaAndTime) {
  for (char const* kind : {"printed", "continuous", "smooth"})
    for (double t_f : {50.0, 80.0})
      for (double p : {-0.2, 0.0, 0.2}) {
        SCOPED_TRACE(std::string(kind) + ", t_f " + std::to_string(t_f) + ", p " + std::to_string(p));
        Numbers const set{{"t_f", {t_f}}, {"inertia_error", {p}}};
        DeadZone const problem = chosen({kind}, set);
        EXPECT_EQ(problem.horizon, t_f + 50);
        auto const claims =
            claims_of(problem, history_of(Rk4{}, chosen.field<FlatQuaternion>({kind}, set), 5e-3, problem.horizon, 4));
        EXPECT_EQ(claims.at("sigma_rest").holds, true) << *claims.at("sigma_rest").value;
        EXPECT_EQ(claims.at("layer").holds, true) << *claims.at("layer").value;
        EXPECT_NEAR(*claims.at("sigma_max").value, t_f == 50 ? 0.68674 : 1.19824, 1e-5);
      }
}

// t_f = 80 s turns the body by 200 degrees: descriptions that lose the quaternion's sign see it jump on the way.
TEST(DeadZoneFormulations, AreOneProblem) {
  for (double t : {35.0, 82.0}) {
    auto const at = [&]<template <class> class A>() {
      auto const x = state_at(Gauss<3>{}, chosen.field<A>({"smooth"}, {{"t_f", {80}}}), 2.5e-3, t);
      return Pair<Quat<double>, Real3>{A<double>::attitude(x.first), x.second};
    };
    auto const quaternion = at.template operator()<FlatQuaternion>();
    for (auto const& other : {at.template operator()<S3>(), at.template operator()<SO3>(),
                              at.template operator()<FlatRotation>(), at.template operator()<Mrp>()}) {
      EXPECT_LT(angle_between(quaternion.first, other.first), 1e-12);
      expect_near(quaternion.second, other.second, 1e-12);
    }
  }
}

TEST(DeadZoneOrder, Rk4HasOrderFourOnSmooth) {
  auto const field = chosen.field<FlatQuaternion>({"smooth", "n4"});
  auto const exact = state_at(Gauss<4>{}, field, 2.5e-3, 10);
  auto const error = [&](double h) { return distance<double>(state_at(Rk4{}, field, h, 10), exact); };
  double const coarse = error(4e-3), middle = error(2e-3), fine = error(1e-3);
  EXPECT_GT(fine, 1e-12) << "above round-off, or there is no order to see";
  EXPECT_NEAR(std::log2(coarse / middle), 4, 0.1);
  EXPECT_NEAR(std::log2(middle / fine), 4, 0.1);
}

/// s / beta of RK4 at every tenth of a second up to 10 s, where h k / beta = reach.
std::vector<Real3> layer_of_rk4(char const* kind, char const* gains, double reach) {
  DeadZone problem = chosen({kind, gains});
  double beta = 0;
  for (Parameter const& parameter : problem.parameters())
    if (parameter.name() == "beta") beta = parameter.values()[0];
  auto const field = problem.field<double, FlatQuaternion, true>();
  auto stepper = Rk4{}.bind(field, FixedStep{reach * beta / 5e-3}, NormPolicy::none);
  auto x = field.initial();
  std::vector<Real3> layer;
  for (int i = 1; i <= 100 && stepper.advance(x, 0.1 * (i - 1), 0.1 * i) == Status::ok; ++i)
    layer.push_back((1 / beta) * field.signals(0.1 * i, x).sliding);
  return layer;
}
/// How far s / beta is from that of small steps; infinite if the run did not end.
double error_in_layer(char const* kind, char const* gains, double reach) {
  auto const layer = layer_of_rk4(kind, gains, reach), resolved = layer_of_rk4(kind, gains, 0.5);
  if (layer.size() != resolved.size()) return INFINITY;
  double most = 0;
  for (std::size_t i = 0; i < layer.size(); ++i) most = std::max(most, distance<double>(layer[i], resolved[i]));
  return most;
}

// RK4's interval of stability ends at 2.785 (Hairer & Wanner II, IV.2). On n1 only k / beta reaches it, and s goes
// astray within its layer; on n2 c reaches it, too, and the run is lost.
TEST(DeadZoneStability, ThePolesLimitTheStepOfRk4) {
  EXPECT_LT(error_in_layer("smooth", "n1", 2.7), 2e-3);
  EXPECT_GT(error_in_layer("smooth", "n1", 2.8), 0.05);
  EXPECT_LT(error_in_layer("smooth", "n1", 2.8), 1);
  EXPECT_LT(error_in_layer("smooth", "n2", 2.5), 2);
  EXPECT_GT(error_in_layer("smooth", "n2", 10.0 / 3), 100);
}

// The slope of D reaches 1.48 m, so the fast pole reaches 1.48 k / beta: 2.785 / 1.48 = 1.88.
TEST(DeadZoneStability, TheDeadZoneLimitsItEarlier) {
  EXPECT_LT(error_in_layer("continuous", "n1", 1.75), 1e-3);
  EXPECT_LT(error_in_layer("smooth", "n1", 2.0), 1e-3);
  EXPECT_GT(error_in_layer("continuous", "n1", 2.0), 1e-2);
}

// ---- Claims ---------------------------------------------------------------------------------------------------------

History made_up(std::vector<double> const& times, double rest, double layer) {
  History history;
  for (Column const& column : chosen({}).columns()) history.columns.push_back(column.name);
  for (double t : times)
    history.rows.push_back({-1, 2, -3, 0, -layer * 5e-5, 0, t < 50 ? 0.6 : 0, t < 50 ? -0.8 : -rest, 0});
  history.times = times;
  return history;
}

TEST(DeadZoneClaims, ByHand) {
  auto const good = claims_of(chosen({}), made_up({0, 25, 50, 100}, 0.9e-6, 0.9));
  EXPECT_EQ(good.at("sigma_rest").holds, true);
  EXPECT_EQ(good.at("sigma_rest").value, 0.9e-6);
  EXPECT_EQ(good.at("layer").holds, true);
  EXPECT_NEAR(*good.at("layer").value, 0.9, 1e-15);
  EXPECT_NEAR(*good.at("sigma_max").value, 1, 1e-15);
  EXPECT_EQ(good.at("v_z_peak").value, 3);
  auto const bad = claims_of(chosen({}), made_up({0, 50}, 1.1e-6, 1.1));
  EXPECT_EQ(bad.at("sigma_rest").holds, false);
  EXPECT_EQ(bad.at("layer").holds, false);
  EXPECT_FALSE(claims_of(chosen({}), made_up({0, 25}, 0, 0)).contains("sigma_rest")) << "the run ends before t_f";

  std::set<std::string> announced, evaluated;
  for (ClaimInfo const& claim : DeadZone::info().claims) announced.insert(claim.name);
  for (auto const& [name, claim] : good) evaluated.insert(name);
  EXPECT_EQ(evaluated, announced);
}

}  // namespace
}  // namespace polhode
