/// State events: found where they are, together if they come together, and with the order that they give back.
#include <gtest/gtest.h>

#include "bench/cell/recorder.hpp"
#include "integrators/runge_kutta.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;
using test::CellUnderTest;

// ---- The search -----------------------------------------------------------------------------------------------------

TEST(ZeroBetween, EndsJustBeyondTheZero) {
  int calls = 0;
  double const zero = zero_between(0.0, 2.0, 1.0, std::cos(2.0), 1e-15, [&](double t) {
    ++calls;
    return std::cos(t);
  });
  EXPECT_NEAR(zero, std::acos(0.0), 2e-15);
  EXPECT_LE(calls, 20);
}

TEST(ZeroBetween, DoesNotStallOnACornerOrAFlatPlace) {
  for (double const corner : {1e-9, 0.3, 1 - 1e-9}) {
    auto const bent = [&](double t) { return t < corner ? corner - t : 1e6 * (corner - t); };
    EXPECT_NEAR(zero_between(0.0, 1.0, bent(0), bent(1), 1e-14, bent), corner, 1e-14);
    auto const flat = [&](double t) { return -std::pow(t - corner, 9); };
    EXPECT_NEAR(zero_between(0.0, 1.0, flat(0), flat(1), 1e-14, flat), corner, 1e-12);
  }
}

TEST(ZeroBetween, KnowsQuadruplePrecision) {
  auto const f = [](Quad t) { return Quad(2 - t * t); };
  Quad const zero = zero_between(Quad(1), Quad(2), f(1), f(2), Quad(1e-33), f);
  EXPECT_LT(double(abs_of(Quad(zero * zero - 2))), 1e-32);
}

// ---- A problem that anybody can solve -------------------------------------------------------------------------------

/// Three points on lines, x' = -1 while x is on the side where it began and -2 beyond zero; two of them meet zero
/// together.
struct Drops {
  using Space = Euclidean3<double>;
  bool holds = false;
  Vec3<double> beyond{0, 0, 0};

  Vec3<double> initial() const { return {0.5, 0.5, 0.8}; }
  Vec3<double> operator()(double, Vec3<double> const& x) const {
    auto const rate = [&](double at, double side) { return (holds ? side != 0 : at < 0) ? -2.0 : -1.0; };
    return {rate(x.x, beyond.x), rate(x.y, beyond.y), rate(x.z, beyond.z)};
  }
  int state_events() const { return 3; }
  void event_values(double, Vec3<double> const& x, std::span<double> g) const { store(x, g.data()); }
  void take_sides(double, Vec3<double> const& x) {
    holds = true;
    beyond = {x.x < 0 ? 1.0 : 0.0, x.y < 0 ? 1.0 : 0.0, x.z < 0 ? 1.0 : 0.0};
  }
  void cross(int k) {
    double& side = k == 0 ? beyond.x : k == 1 ? beyond.y : beyond.z;
    side = 1 - side;
  }
};

/// Where three seconds end: 3 - t_0 seconds at -2.
Vec3<double> run(bool locate, bench::Located& located, double h) {
  Drops drops;
  auto const problem = erase_type(drops);
  auto stepper = Rk4{}.bind(*problem, FixedStep{h}, NormPolicy::none);
  Vec3<double> x = drops.initial();
  bench::RunLoop loop(*problem, stepper, h, locate);
  bench::Schedule schedule;
  schedule.t_end = 3;
  EXPECT_EQ(loop.go(x, bench::stops_of(schedule), bench::NoWatch{}), Status::ok);
  located = loop.located();
  return x;
}

TEST(StateEvents, AreFoundTogetherIfTheyComeTogether) {
  bench::Located located;
  Vec3<double> const x = run(true, located, 0.37);
  ASSERT_EQ(located.events, 3);
  EXPECT_NEAR(located.times[0], 0.5, 1e-14);
  EXPECT_EQ(located.times[1], located.times[0]);
  EXPECT_NEAR(located.times[2], 0.8, 1e-14);
  EXPECT_GT(located.trials, 0);
  EXPECT_LE(located.trials, 30) << "the functions are straight";
  EXPECT_NEAR(x.x, -5, 1e-13);
  EXPECT_NEAR(x.z, -4.4, 1e-13);
}

TEST(StateEvents, AreMissedIfNobodyLooks) {
  bench::Located located;
  Vec3<double> const x = run(false, located, 0.37);
  EXPECT_EQ(located.events, 0);
  EXPECT_GT(std::fabs(x.x + 5), 1e-3);
}

TEST(StateEvents, OnTheBorderOfAStepAreFoundOnce) {
  bench::Located located;
  Vec3<double> const x = run(true, located, 0.1);  // 0.5 and 0.8 are borders
  EXPECT_EQ(located.events, 3);
  EXPECT_NEAR(x.x, -5, 1e-13);
  EXPECT_NEAR(x.z, -4.4, 1e-13);
}

// ---- The dead zone: kinks of the actuators --------------------------------------------------------------------------

TEST(DeadZoneEvents, GiveRk4ItsOrderBackSoonAfterAKink) {  // later the loop has forgotten
  auto const error_of = [](std::string const& variant, double h) {
    return *a_cell("dead_zone", "mrp", "rk4")
                .of_variant(variant)
                .with_h(h)
                .until(5.4)
                .measured()
                .record.attitude_error_end;
  };
  double const ratio = error_of("continuous,n4", 0.008) / error_of("continuous,n4", 0.001);
  EXPECT_NEAR(std::log(ratio) / std::log(8), 4, 0.3);
  EXPECT_GT(error_of("continuous,n4,unlocated", 0.001), 10 * error_of("continuous,n4", 0.001));
}

TEST(DeadZoneEvents, AMethodThatStallsInTheGapsSaysSoAndKeepsItsCounts) {
  auto const record =
      a_cell("dead_zone", "mrp", "cvode_bdf").of_variant("printed").with_rtol(1e-9).until(20).measured().record;
  EXPECT_TRUE(record.status == results::Status::stalled || record.status == results::Status::max_steps)
      << record.reason;
  EXPECT_GT(*record.steps, 10'000);
  EXPECT_LT(*record.steps, 20'000'000);
  EXPECT_FALSE(record.reference_bar) << "the closed loop slides: there are no digits to certify";
  EXPECT_EQ(record.events_located, 0);
}

/// After how many steps of length dt a run until 100 s is called stalled; at most a million are taken.
std::int64_t steps_until_stalled(std::optional<double> h, double dt) {
  bench::Pace pace(100, h);
  std::int64_t steps = 0;
  try {
    while (steps < 1'000'000 && double(steps) * dt < 100) pace.check(double(++steps) * dt);
  } catch (bench::Stalled const&) {
    return steps;
  }
  return -1;
}

// On the continuous actuators, with h k / beta past a method's limit, v chatters: equal steps of 0.05 s end on one
// event after the other, and would for hours.
TEST(Pace, ARunThatWouldTakeHoursIsStalledAfter65536Steps) {
  EXPECT_EQ(steps_until_stalled(0.05, 1e-6), 65536);
  EXPECT_EQ(steps_until_stalled(std::nullopt, 1e-6), 65536);
  EXPECT_EQ(steps_until_stalled(0.05, 0.05), -1);
  EXPECT_EQ(steps_until_stalled(std::nullopt, 1e-5), -1) << "1e7 steps are long, and no more";
  EXPECT_EQ(steps_until_stalled(1e-7, 1e-7), -1) << "these are the steps that were asked for";
}

// ---- Ends of charts -------------------------------------------------------------------------------------------------

TEST(Charts, ThatEndEndTheRunAsDiverged) {
  auto const theorem2 = [](char const* formulation, char const* method) {
    auto const cell = a_cell("group_consensus", formulation, method).of_variant("theorem2").until(30);
    return (std::string_view(method) == "rk4" ? cell.with_h(0.02) : cell.with_rtol(1e-9)).measured().record;
  };
  for (char const* method : {"rk4", "dopri5", "odeint_dopri5", "cvode_adams"}) {
    auto const record = theorem2("mrp", method);
    EXPECT_EQ(record.status, results::Status::diverged) << method << ": " << record.reason;
    EXPECT_FALSE(record.attitude_error_max) << "no number of a failed run is shown";
    EXPECT_EQ(theorem2("quaternion", method).status, results::Status::ok) << method;
  }
}

TEST(Charts, OfEulerAnglesEndAt90DegreesOfPitch) {
  auto const cell = a_cell("free_body", "euler", "rk4")
                        .set("inertia", {1, 1, 1})
                        .set("q0", {0, 0, 0, 1})
                        .set("omega0", {0, 0.1, 0})
                        .with_h(0.1);
  EXPECT_EQ(cell.until(15).measured().record.status, results::Status::ok);
  EXPECT_EQ(cell.until(16).measured().record.status, results::Status::diverged);
}

// ---- Synchronisation: the paper's network ---------------------------------------------------------------------------

/// Scalar parts of craft 5, 3 and 1 reach zero [s].
constexpr std::array crossings{.2116516346, .4855026743, 1.0050253857};

void expect_crossings(CellUnderTest const& cell) {
  auto const run = cell.of_variant("protocol13").until(2).simulated(2);
  ASSERT_EQ(run.status, results::Status::ok) << cell.cell.integrator << ": " << run.reason;
  ASSERT_EQ(run.history.events.size(), crossings.size()) << cell.cell.integrator;
  for (std::size_t k = 0; k < crossings.size(); ++k)
    EXPECT_NEAR(run.history.events[k], crossings[k], 1e-9) << cell.cell.integrator << " as " << cell.cell.formulation;
}

TEST(SyncEvents, AreWithin1e9SecondsByEveryKindOfMethod) {
  expect_crossings(a_cell("quaternion_sync", "quaternion", "gauss4").with_h(0.02));
  expect_crossings(a_cell("quaternion_sync", "s3", "cf4").with_h(0.005));
  expect_crossings(a_cell("quaternion_sync", "mrp", "rk4").with_h(0.005));
  expect_crossings(a_cell("quaternion_sync", "quaternion", "dopri5").with_rtol(1e-11));
  expect_crossings(a_cell("quaternion_sync", "quaternion", "odeint_rkf78").with_h(0.05));
  expect_crossings(a_cell("quaternion_sync", "quaternion", "odeint_dopri5").with_rtol(1e-11));
  expect_crossings(a_cell("quaternion_sync", "quaternion", "cvode_adams").with_rtol(1e-12));
  expect_crossings(a_cell("quaternion_sync", "quaternion", "cvode_bdf").with_rtol(1e-13));
}

TEST(SyncEvents, OfTheReferenceAreThePublishedOnes) {
  auto const prepared =
      bench::prepare(a_cell("quaternion_sync", "s3", "cf4").of_variant("protocol13").with_h(0.1).until(2).cell);
  auto const times = bench::Reference::solve(*prepared.problem, prepared.schedule).event_times();
  ASSERT_EQ(times.size(), crossings.size());
  for (std::size_t k = 0; k < crossings.size(); ++k) EXPECT_NEAR(times[k], crossings[k], 5.1e-11);
}

TEST(SyncEvents, OfTheTrapComeTogether) {
  auto const run = a_cell("quaternion_sync", "quaternion", "gauss4")
                       .of_variant("protocol13,trap")
                       .with_h(0.02)
                       .until(2)
                       .simulated(2);
  ASSERT_EQ(run.history.events.size(), 2u);
  EXPECT_EQ(run.history.events[0], run.history.events[1]);
  EXPECT_NEAR(run.history.events[0], .998828926193, 1e-11);
}

/// The error of the attitudes at 20 s.
double error_of(std::string const& variant, double h) {
  return *a_cell("quaternion_sync", "quaternion", "rk4")
              .of_variant(variant)
              .with_h(h)
              .measured()
              .record.attitude_error_max;
}

TEST(SyncEvents, LocatedTheyGiveRk4ItsOrderBack) {
  double const ratio = error_of("protocol13", 0.025) / error_of("protocol13", 0.003125);
  EXPECT_NEAR(std::log(ratio) / std::log(8), 4, 0.25);
  double const lost = error_of("protocol13,unlocated", 0.025) / error_of("protocol13,unlocated", 0.003125);
  EXPECT_LT(std::log(lost) / std::log(8), 2);
}

TEST(SyncEvents, ARecordSaysWhetherTheyWereLocated) {
  auto const record_of = [](std::string const& variant, std::string const& method) {
    auto const cell = a_cell("quaternion_sync", "quaternion", method).of_variant(variant).until(2);
    return (method == "cvode_adams" ? cell.with_rtol(1e-9) : cell.with_h(0.05)).measured().record;
  };
  EXPECT_EQ(record_of("protocol13", "rk4").events_located, 3);
  EXPECT_EQ(record_of("protocol13", "cvode_adams").events_located, 3);
  EXPECT_EQ(record_of("protocol13", "odeint_abm8").events_located, 0) << "its history does not bear a shorter step";
  EXPECT_EQ(record_of("protocol13,unlocated", "rk4").events_located, 0);
  EXPECT_FALSE(record_of("protocol7", "rk4").events_located) << "there are none";
}

}  // namespace
}  // namespace polhode
