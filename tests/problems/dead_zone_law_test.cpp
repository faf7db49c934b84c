/// The dead-zone problem by hand: parameters of attitude, path, law, actuators, events, choices.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "problems/dead_zone.hpp"
#include "problems/dual.hpp"
#include "problems/jet.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::expect_near;
using test::Numbers;
using test::Real3;
using test::Words;

constexpr test::Chooser<DeadZone> chosen;
static_assert(Definition<DeadZone>);
static_assert(std::is_trivially_copyable_v<DeadZoneBody<double, S3<double>>>, "or a step cannot keep it in registers");

Real3 const at_rest{0, 0, 0}, sigma_0{-0.128, 0.515, 0.128}, omega_0{0.1, -0.3, 0.2};

// ---- Modified Rodrigues parameters ----------------------------------------------------------------------------------

TEST(DeadZoneMrp, BelongsToTheAttitudeNotToTheQuaternion) {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    Real3 const sigma = random.uniform(0.1, 1.5) * random.direction(), near = sigma + random.vector(0.05);
    Quat<double> const q = quaternion_of_mrp(sigma);
    EXPECT_NEAR(dot(q, q), 1, 1e-15);
    expect_near(mrp_near(q, near), sigma, 1e-14, "also where |sigma| > 1");
    expect_near(mrp_near(scaled(-1.0, q), near), sigma, 1e-14, "-q");
    expect_near(mrp_near(quaternion(matrix(q)), near), sigma, 1e-14, "through the matrix");
  }
}

TEST(DeadZoneMrp, KinematicsAreThoseOfTheQuaternion) {
  test::Random random(2);
  for (int i = 0; i < 100; ++i) {
    Real3 const sigma = random.uniform(0.1, 1.5) * random.direction(), omega = random.vector(1);
    Quat<double> const q = quaternion_of_mrp(sigma), rate = quaternion_rate(q, omega);
    auto const moving = [](double value, double slope) {
      return Dual<1>::of(value, [&](std::size_t) { return slope; });
    };
    Vec3<Dual<1>> const moved =
        mrp_near(Quat<Dual<1>>{moving(q.x, rate.x), moving(q.y, rate.y), moving(q.z, rate.z), moving(q.w, rate.w)},
                 test::in<Dual<1>>(sigma));
    Real3 const sigma_rate = mrp_rate(sigma, omega);
    expect_near({moved.x.slope[0], moved.y.slope[0], moved.z.slope[0]}, sigma_rate, 1e-14);
    expect_near(mrp_rate_inverse(sigma, sigma_rate), omega, 1e-14);
    Vec3<Dual<1>> const turned = mrp_rate(
        Vec3<Dual<1>>{moving(sigma.x, sigma_rate.x), moving(sigma.y, sigma_rate.y), moving(sigma.z, sigma_rate.z)},
        test::in<Dual<1>>(omega));
    expect_near({turned.x.slope[0], turned.y.slope[0], turned.z.slope[0]}, mrp_rate_change(sigma, sigma_rate, omega),
                1e-14);
  }
}

// ---- The path -------------------------------------------------------------------------------------------------------

template <class S>
DecayingPath<S> path_of(PathKind kind, double t_f) {
  return {kind, Real<S>(t_f), test::in<S>(sigma_0), test::in<S>(mrp_rate(sigma_0, omega_0))};
}

TEST(DeadZonePath, BeginsAsTheBodyDoes) {
  expect_near(mrp_rate(sigma_0, omega_0), {0.097318975, -0.069938275, 0.01948155}, 5e-10, "a1 as documented");
  for (PathKind kind : {PathKind::cubic, PathKind::quintic}) {
    auto const start = path_of<double>(kind, 50)(0);
    expect_near(start.at, sigma_0, 0);
    expect_near(start.rate, mrp_rate(sigma_0, omega_0), 0);
  }
  expect_near(path_of<double>(PathKind::quintic, 50)(0).acceleration, at_rest, 0);
}

TEST(DeadZonePath, EndsAtRestAndStaysThere) {
  for (PathKind kind : {PathKind::cubic, PathKind::quintic}) {
    auto path = path_of<double>(kind, 80);
    expect_near(path(80).at, at_rest, 1e-14);
    expect_near(path(80).rate, at_rest, 1e-15);
    path.arrived = true;
    for (double t : {80.0, 100.0}) {
      expect_near(path(t).at, at_rest, 0);
      expect_near(path(t).rate, at_rest, 0);
      expect_near(path(t).acceleration, at_rest, 0);
    }
  }
  expect_near(path_of<double>(PathKind::quintic, 80)(80).acceleration, at_rest, 1e-15);
}

TEST(DeadZonePath, RatesAreItsDerivatives) {
  for (PathKind kind : {PathKind::cubic, PathKind::quintic})
    for (double t : {0.0, 7.0, 33.0, 50.0}) {
      auto const at = path_of<Dual<1>>(kind, 50)(Dual<1>::of(t, [](std::size_t) { return 1.0; }));
      expect_near({at.at.x.slope[0], at.at.y.slope[0], at.at.z.slope[0]}, path_of<double>(kind, 50)(t).rate, 1e-15);
      expect_near({at.rate.x.slope[0], at.rate.y.slope[0], at.rate.z.slope[0]},
                  path_of<double>(kind, 50)(t).acceleration, 1e-16);
    }
}

// The cubic's lambda'' ends at 6 sigma_0 / t_f^2 + 2 sigma_0' / t_f and is 0 from then on: v falls by 4 M^-1 J of it.
TEST(DeadZonePath, OnTheCubicTheCommandJumpsAtTheEnd) {
  auto const fall = [](Words const& words) {
    auto field = chosen.field<S3>(words);
    S3<double>::Point const identity{0, 0, 0, 1};
    Real3 const before = field.signals(50, {identity, at_rest}).v;
    field.enter_phase(50);
    return before - field.signals(50, {identity, at_rest}).v;
  };
  expect_near(fall({"cubic"}), {14.29, -3.43, 1.34}, 0.005);
  expect_near(fall({"quintic"}), at_rest, 1e-10);
}

// ---- The law --------------------------------------------------------------------------------------------------------

TEST(DeadZoneLaw, ByHand) {
  Mat3<double> const J{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
  SlidingLaw<double> const law({.c = 10, .beta = 0.5, .k = 0.1}, J, {0.95, 1, 1.05});
  PathPoint<double> const rest{at_rest, at_rest, at_rest};
  expect_near(law(rest, at_rest, at_rest).v, at_rest, 0);

  // At sigma = 0, G = 1/4: s = .4/4, v = 2 * 4 (-10 * .1 - .1 * .2) / .95.
  auto const spin = law(rest, at_rest, {0.4, 0, 0});
  expect_near(spin.sliding, {0.1, 0, 0}, 1e-16);
  expect_near(spin.v, {8 * -1.02 / 0.95, 0, 0}, 1e-14);
  // Two axes: omega x J omega = (0, 0, omega_x omega_y); s_y = 1 is past the layer.
  expect_near(law(rest, at_rest, {0.4, 4, 0}).v, {8 * -1.02 / 0.95, 12 * (-10 - 0.1), 1.6 / 1.05}, 1e-13);
  // An offset alone: G^-1 of sigma = (.5, 0, 0) along x is 4 / 1.25; s = 5 is past the layer.
  expect_near(law(rest, {0.5, 0, 0}, at_rest).v, {2 * 4 / 1.25 * -0.1 / 0.95, 0, 0}, 1e-15);
  // The path's own motion is fed forward: eta' = -.2, c (lambda' - sigma') and lambda''.
  auto const fed = law({at_rest, {0, 0.2, 0}, {0, 0, 0.3}}, at_rest, at_rest);
  expect_near(fed.sliding, {0, -0.2, 0}, 0);
  expect_near(fed.v, {0, 12 * (2 + 0.1 * 0.4), 16 * 0.3 / 1.05}, 1e-14);
}

// On `smooth` with the inertia known, the closed loop is s' = -k sat(s / beta) + G J^-1 tau_d, whatever the state.
TEST(DeadZoneLaw, MakesTheSlidingVariableDecay) {
  test::Random random(3);
  auto const field = chosen.field<FlatQuaternion>({"smooth", "n1"});
  auto const moving = chosen.field<FlatQuaternion, Dual<1>>({"smooth", "n1"});
  int saturated = 0, within = 0;
  for (int i = 0; i < 200; ++i) {
    double const t = random.uniform(0, 50);
    auto const path = field.path(t);
    Real3 const sigma = path.at + random.vector(i % 2 ? 1e-7 : 0.05);
    Real3 const omega = mrp_rate_inverse(sigma, path.rate - (sigma - path.at) + random.vector(1e-6));
    Pair<Quat<double>, Real3> const x{quaternion_of_mrp(sigma), omega};
    auto const velocity = RigidBody<FlatQuaternion<double>>::rate(x, field(t, x));

    std::array<double, 7> value{}, slope{};
    store(x, value.data());
    store(velocity, slope.data());
    std::array<Dual<1>, 7> seeded;
    for (std::size_t k = 0; k < 7; ++k) seeded[k] = Dual<1>::of(value[k], [&](std::size_t) { return slope[k]; });
    Pair<Quat<Dual<1>>, Vec3<Dual<1>>> y;
    load(y, seeded.data());
    auto const s = moving.signals(Dual<1>::of(t, [](std::size_t) { return 1.0; }), y).sliding;

    Real3 const disturbance = mrp_rate(sigma, field.inertia.acceleration(at_rest, dead_zone_disturbance(t)));
    auto const wanted = [&](double si) {
      (std::fabs(si) > 5e-7 ? saturated : within) += 1;
      return -5e-3 * clamp(si / 5e-7, -1.0, 1.0);
    };
    expect_near({s.x.slope[0], s.y.slope[0], s.z.slope[0]},
                Real3{wanted(s.x.value), wanted(s.y.value), wanted(s.z.value)} + disturbance, 2e-12);
  }
  EXPECT_GT(saturated, 50);
  EXPECT_GT(within, 50);
}

// ---- The actuators --------------------------------------------------------------------------------------------------

Real3 torque_of(DeadZoneKind kind, Real3 const& v) {
  DeadZoneActuator<double> const actuators(kind);
  return actuators.torque(v, DeadZoneActuator<double>::sides_of(v));
}

TEST(DeadZoneActuators, AsPrinted) {
  auto const D = [](double x, double y, double z) { return torque_of(DeadZoneKind::printed, {x, y, z}); };
  expect_near(D(0, 0, 0), at_rest, 0);
  expect_near(D(0.499, 0.599, 0.399), at_rest, 0, "the gap ends at b_r");
  expect_near(D(-0.599, -0.399, -0.499), at_rest, 0, "and at b_l");
  expect_near(D(0.5, 0.6, 0.4), {0.1 * std::cos(0.5), 0.2 * std::sin(1.2), 0.2 * std::sin(1.0)}, 1e-16, "jumps");
  expect_near(D(-0.6, -0.4, -0.5), {0.2 * std::sin(-1.2), 0.15 * std::cos(-1.0), 0.1 * std::sin(-1.5)}, 1e-16);
  expect_near(D(2.5, 2.6, 2.4), {1.9 + 0.1 * std::cos(2.5), 2 + 0.2 * std::sin(5.2), 2.1 + 0.2 * std::sin(6.0)}, 1e-15);
  expect_near(D(-2.6, -2.4, -2.5),
              {-1.9 + 0.2 * std::sin(-5.2), -2 + 0.15 * std::cos(-6.0), -2.1 + 0.1 * std::sin(-7.5)}, 1e-15);
}

TEST(DeadZoneActuators, ContinuousTakesTheJumpsAway) {
  auto const D = [](double x, double y, double z) { return torque_of(DeadZoneKind::continuous, {x, y, z}); };
  expect_near(D(0.5, 0.6, 0.4), at_rest, 0);
  expect_near(D(-0.6, -0.4, -0.5), at_rest, 0);
  expect_near(D(2.5, 2.6, 2.4) - D(0.5, 0.6, 0.4),
              torque_of(DeadZoneKind::printed, {2.5, 2.6, 2.4}) - torque_of(DeadZoneKind::printed, {0.5, 0.6, 0.4}),
              1e-15);
  expect_near(D(-2.6, -2.4, -2.5),
              {-1.9 + 0.2 * (std::sin(-5.2) - std::sin(-1.2)), -2 + 0.15 * (std::cos(-6.0) - std::cos(-1.0)),
               -2.1 + 0.1 * (std::sin(-7.5) - std::sin(-1.5))},
              1e-15);
}

TEST(DeadZoneActuators, SmoothIsADiagonalMatrix) {
  expect_near(torque_of(DeadZoneKind::smooth, {0.1, -3, 2}), {0.095, -3, 2.1}, 1e-15);
}

TEST(DeadZoneActuators, HeldSidesDecideInsteadOfTheCommand) {
  DeadZoneActuator<double> const actuators(DeadZoneKind::continuous);
  DeadZoneSides const sides = DeadZoneActuator<double>::sides_of({1, -1, 0});
  Real3 const late{0.45, -0.35, 0.45};  // each a little past a breakpoint
  expect_near(
      actuators.torque(late, sides),
      {0.95 * -0.05 + 0.1 * (std::cos(0.45) - std::cos(0.5)), 0.05 + 0.15 * (std::cos(-0.875) - std::cos(-1.0)), 0},
      1e-16);
}

TEST(DeadZoneField, IsEulersEquationWithTheTrueInertia) {
  double const p = 0.25;
  auto const field = chosen.field<S3>({"printed"}, {{"inertia_error", {p}}});
  auto const x = field.initial();
  double const t = 3;
  Mat3<double> const J = chosen({}, {{"inertia_error", {p}}}).body().matrix<double>();
  expect_near(J.e1, {1.25 * 950, 1.25 * 11, 1.25 * 5}, 1e-12);
  expect_near(J.e3, {1.25 * 5, 1.25 * 36, 1.25 * 360}, 1e-12);
  Real3 const tau{0.1 * std::sin(0.3), 0.2 * std::sin(0.3 + 3.14159265358979323846 / 2), 0.3 * std::sin(0.6)};
  Real3 const torque = torque_of(DeadZoneKind::printed, field.signals(t, x).v) + tau;
  Real3 const omega = x.second, rate = field(t, x).second;
  expect_near(J * rate + cross(omega, J * omega), torque, 1e-12);
  expect_near(field(t, x).first, omega, 0);
  expect_near(omega, omega_0, 0);
  expect_near(field.sigma(0, x), sigma_0, 1e-16);
}

TEST(DeadZoneField, IsOneForEveryScalar) {
  for (char const* kind : {"printed", "continuous", "smooth"}) {
    auto const field = chosen.field<FlatQuaternion>({kind});
    auto const in_quad = chosen.field<FlatQuaternion, Quad>({kind});
    auto const in_series = chosen.field<FlatQuaternion, Jet<double, 4>>({kind});
    auto const x = field.initial();
    Pair<Quat<Quad>, Vec3<Quad>> const x_quad{test::in<Quad>(x.first), test::in<Quad>(x.second)};
    Pair<Quat<Jet<double, 4>>, Vec3<Jet<double, 4>>> const x_series{test::in<Jet<double, 4>>(x.first),
                                                                    test::in<Jet<double, 4>>(x.second)};
    double const t = 0.75;
    Real3 const rate = field(t, x).second;
    Vec3<Quad> const quad = in_quad(Quad(t), x_quad).second;
    auto const series = in_series(t, x_series).second;
    EXPECT_GT(length(rate), 1e-3);
    expect_near({double(quad.x), double(quad.y), double(quad.z)}, rate, 1e-12, kind);
    expect_near({series.x[0], series.y[0], series.z[0]}, rate, 1e-14, kind);
  }
}

// ---- Events ---------------------------------------------------------------------------------------------------------

TEST(DeadZoneEvents, KinksAreThoseOfTheContinuousActuators) {
  EXPECT_EQ(chosen.field<S3>({"continuous"}).state_events(), 6);
  EXPECT_EQ(chosen.field<S3>({"printed"}).state_events(), 0) << "it slides: events would never end";
  EXPECT_EQ(chosen.field<S3>({"smooth"}).state_events(), 0);
  EXPECT_TRUE(chosen({"printed"}).switches());
  EXPECT_TRUE(chosen({"continuous"}).switches());
  EXPECT_FALSE(chosen({"smooth"}).switches());
  EXPECT_TRUE(chosen({"continuous"}).locate_events);
  EXPECT_FALSE(chosen({"continuous", "unlocated"}).locate_events);
  EXPECT_NE(chosen({"printed"}).no_reference(), "");
  EXPECT_EQ(chosen({"continuous"}).no_reference(), "");
  EXPECT_EQ(chosen({"smooth"}).no_reference(), "");
  EXPECT_EQ(chosen.field<S3>({}, {{"t_f", {80}}}).time_events(), std::vector<double>{80});
}

TEST(DeadZoneEvents, ValuesAreDistancesFromTheBreakpoints) {
  auto const field = chosen.field<S3>({"continuous"});
  auto const x = field.initial();
  Real3 const v = field.signals(2, x).v;
  std::array<double, 6> g{};
  field.event_values(2, x, g);
  expect_near({g[0], g[1], g[2]}, v - Real3{0.5, 0.6, 0.4}, 0);
  expect_near({g[3], g[4], g[5]}, v - Real3{-0.6, -0.4, -0.5}, 0);
}

TEST(DeadZoneEvents, SidesAreHeldFromWhenTheyAreTakenUntilTheyAreCrossed) {
  auto const free = chosen.field<S3>({"continuous"});
  auto held = free;
  auto const x = free.initial();
  Real3 const v = free.signals(0, x).v;
  ASSERT_GT(v.z, 0.4);
  held.take_sides(0, x);
  expect_near(held(0, x).second, free(0, x).second, 0);

  // The same attitude, the rate changed so that v_z lies left of the gap.
  auto other = x;
  other.second.z += 1e-3;
  ASSERT_LT(free.signals(0, other).v.z, -0.5);
  EXPECT_GT(distance<double>(held(0, other).second, free(0, other).second), 1e-6) << "still on the right";
  auto const torque = [&](auto const& field) {  // of the actuators about z
    return field.actuators.torque(field.signals(0, other).v, field.sides).z;
  };
  held.cross(2);
  EXPECT_EQ(torque(held), 0) << "in the gap";
  held.cross(5);
  expect_near(held(0, other).second, free(0, other).second, 0);

  auto printed = chosen.field<S3>({"printed"});
  printed.take_sides(0, x);
  EXPECT_FALSE(printed.holds_sides) << "nothing would ever change them";
}

TEST(DeadZoneEvents, TheFieldWaitsForItsPhase) {
  auto field = chosen.field<S3>({"smooth"});
  S3<double>::Point const identity{0, 0, 0, 1};
  Real3 const before = field(50, {identity, at_rest}).second;
  field.enter_phase(0);
  expect_near(field(50, {identity, at_rest}).second, before, 0);
  field.enter_phase(50 - 1e-9);  // merged with an output time
  EXPECT_GT(distance<double>(field(50, {identity, at_rest}).second, before), 1e-3);
}

// ---- Choices --------------------------------------------------------------------------------------------------------

TEST(DeadZoneChoices, GainSetsAndParameters) {
  auto const gains = [](Words const& words) {
    DeadZone problem = chosen(words);
    std::map<std::string, std::vector<double>> values;
    for (Parameter const& parameter : problem.parameters()) values[parameter.name()] = parameter.values();
    return std::array{values.at("c")[0], values.at("beta")[0], values.at("k_gain")[0]};
  };
  EXPECT_EQ(gains({}), (std::array{100.0, 5e-5, 5e-3}));
  EXPECT_EQ(gains({"n1"}), (std::array{1.0, 5e-7, 5e-3}));
  EXPECT_EQ(gains({"n3"}), (std::array{10.0, 5e-6, 5e-3}));
  EXPECT_EQ(gains({"n4"}), (std::array{31.6, 1.58e-4, 5e-3}));
  EXPECT_THROW(chosen({}, {{"inertia_error", {-1}}}), ParameterError);
  EXPECT_THROW(chosen({}, {{"t_f", {0}}}), ParameterError);
  auto const start = chosen.field<SO3>({}, {{"sigma0", {0, 0, 2}}}).initial();
  expect_near(start.first.e1, {std::cos(4 * std::atan(2.0)), std::sin(4 * std::atan(2.0)), 0}, 1e-15, "4 atan |sigma|");
}

}  // namespace
}  // namespace polhode
