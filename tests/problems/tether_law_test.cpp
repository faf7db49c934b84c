/// The tether's control law by hand: angle, tension, thrusters, switching, effort; variants; claims on made-up
/// histories.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "problems/tether_capture.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::expect_near;
constexpr double degree = BodyParameters::degree;
using Law = TetherController<double>;

Choice chosen(std::set<std::string> const& words) {
  Choice choice;
  choice.words = words;
  return choice;
}

/// What the controller shows, by name.
struct Shown {
  double alpha, tension;
  Vec3<double> torque;
  double effort;
};
Shown shown(Law const& law, Quat<double> const& q) {
  std::array<double, 6> out{};
  law.show(q, {0, 0, 0}, out);
  return {out[0], out[1], {out[2], out[3], out[4]}, out[5]};
}
/// The arm is turned by `angle` from the tether, about the body's y axis.
Quat<double> turned(double angle) {
  return {0, std::sin(angle / 2), 0, std::cos(angle / 2)};
}
Vec3<double> const at_rest{0, 0, 0};

// ---- The first sample, computed here from the paper's equations -----------------------------------------------------

/// The paper's eq. (4), A(q) maps orbital to body axes; eqs. (17)-(25) on the printed initial data.
struct FirstSample {
  double q1 = 0.227, q2 = 0.383, q3 = 0.227, q4 = 0.866, omega = 10 * degree;
  double alpha = 0;
  Vec3<double> arm_cross_tether{};  ///< d~ x r~

  FirstSample() {
    double const norm = std::sqrt(q1 * q1 + q2 * q2 + q3 * q3 + q4 * q4);
    q1 /= norm, q2 /= norm, q3 /= norm, q4 /= norm;
    // r~ = A (-1, 0, 0)^T: minus the first column of A.
    double const rx = -(q1 * q1 - q2 * q2 - q3 * q3 + q4 * q4);
    double const ry = -2 * (q1 * q2 - q3 * q4);
    double const rz = -2 * (q1 * q3 + q2 * q4);
    alpha = std::acos(-rx);  // d~ = (-1, 0, 0)
    arm_cross_tether = {0, rz, -ry};
  }
};

Vec3<double> first_torque(std::set<std::string> const& words, std::map<std::string, std::vector<double>> const& set) {
  auto field = TetherCapture(Choice{.words = words, .set = set}).field<double, FlatQuaternion, true>();
  field.sample(0, field.initial());
  return field.held;
}

TEST(TetherLaw, AngleAtTheStart) {
  FirstSample const paper;
  auto const start = TetherCapture(Choice{}).field<double, S3, true>().initial();
  double const alpha = shown(Law(TetherLaw{}), start.first).alpha;
  EXPECT_NEAR(alpha / degree, 52.883, 5e-4);
  EXPECT_NEAR(alpha, paper.alpha, 1e-15);
}

TEST(TetherLaw, FirstTorqueOfCase1) {
  FirstSample const p;
  // Tension 40 alpha = 36.9 N is above its limit of 30 N; each thruster is at its limit of 5 N m, against the rate.
  EXPECT_GT(40 * p.alpha, 30);
  Vec3<double> const tether = (2 * 30.0) * p.arm_cross_tether;
  Vec3<double> const towards = (8 * p.alpha / std::sin(p.alpha)) * p.arm_cross_tether;
  EXPECT_LT(towards.x - 80 * p.omega, -5);
  EXPECT_LT(towards.y - 80 * p.omega, -5);
  EXPECT_LT(towards.z - 80 * p.omega, -5);
  expect_near(first_torque({"case1"}, {}), tether - Vec3<double>{5, 5, 5}, 1e-13);
}

TEST(TetherLaw, FirstTorqueOfCase1WithoutLimits) {
  FirstSample const p;
  Vec3<double> const tether = (2 * 40 * p.alpha) * p.arm_cross_tether;
  Vec3<double> const towards = (8 * p.alpha / std::sin(p.alpha)) * p.arm_cross_tether;
  Vec3<double> const damping = (80 * p.omega) * Vec3<double>{1, 1, 1};
  expect_near(first_torque({"case1"}, {{"f_max", {100}}, {"u_max", {100}}}), tether + towards - damping, 1e-13);
  expect_near(first_torque({"case2"}, {{"f_max", {100}}, {"u_max", {100}}}), tether, 1e-13);
  expect_near(first_torque({"case3"}, {{"f_max", {100}}, {"u_max", {100}}}), towards - damping, 1e-13);
}

// ---- Each part of the law -------------------------------------------------------------------------------------------

TEST(TetherLaw, SwitchesAtFiveDegrees) {
  TetherCapture definition(chosen({"case2"}));
  for (Parameter const& parameter : definition.parameters())
    if (parameter.name() == "switch_angle") {
      ASSERT_EQ(parameter.values().size(), 1u);
      EXPECT_NEAR(parameter.values()[0], 5 * degree, 1e-16);
    }
  TetherLaw const law{.actuators = TetherCase::switched, .switch_angle = 5 * degree};
  Vec3<double> const omega{0.01, 0, 0};

  Law above(law), below(law);
  double const far = 5.001 * degree, near = 4.999 * degree;
  Vec3<double> const by_tether = above.torque(0, turned(far), omega);
  EXPECT_NEAR(shown(above, turned(far)).tension, 40 * far, 1e-13);
  EXPECT_EQ(by_tether.x, 0) << "a thruster would damp it";
  EXPECT_NEAR(std::fabs(by_tether.y), 2 * 40 * far * std::sin(far), 1e-13);

  Vec3<double> const by_thrusters = below.torque(0, turned(near), omega);
  EXPECT_EQ(shown(below, turned(near)).tension, 0);
  EXPECT_NEAR(by_thrusters.x, -80 * 0.01, 1e-13);
  EXPECT_NEAR(std::fabs(by_thrusters.y), 8 * near, 1e-13);
}

TEST(TetherLaw, TheTorqueTurnsTheArmTowardsTheTether) {
  for (TetherCase actuators : {TetherCase::both, TetherCase::thrusters, TetherCase::switched}) {
    Law law(TetherLaw{.actuators = actuators});
    // A positive turn about y has put the arm off; the torque must turn back.
    EXPECT_LT(law.torque(0, turned(0.5), at_rest).y, 0);
  }
}

TEST(TetherLaw, TensionIsNeverNegativeNorAboveItsLimit) {
  Law law(TetherLaw{.actuators = TetherCase::switched});
  law.torque(0, turned(0.1), at_rest);
  EXPECT_NEAR(shown(law, turned(0.1)).tension, 4, 1e-12) << "40 alpha; no rate is known yet";
  law.torque(0.1, turned(0.105), at_rest);
  EXPECT_NEAR(shown(law, turned(0.105)).tension, 40 * 0.105 + 120 * 0.005 / 0.1, 1e-11) << "and 120 per rad/s";
  expect_near(law.torque(0.2, turned(0.05), at_rest), {0, 0, 0}, 0);
  EXPECT_EQ(shown(law, turned(0.05)).tension, 0) << "40 * .05 - 120 * .55 is below zero: a tether does not push";
  law.torque(0.3, turned(0.9), at_rest);
  EXPECT_EQ(shown(law, turned(0.9)).tension, 30);
}

TEST(TetherLaw, ThrustersAreLimitedAxisByAxis) {
  Law law(TetherLaw{.actuators = TetherCase::thrusters});
  Quat<double> const aligned{0, 0, 0, 1};  // no direction to turn in: damping alone
  expect_near(law.torque(0, aligned, {0.01, 0.2, -0.3}), {-0.8, -5, 5}, 1e-15);
  expect_near(law.torque(0, aligned, at_rest), {0, 0, 0}, 0);
}

TEST(TetherLaw, NothingWorksInTheFreeCase) {
  Law law(TetherLaw{.actuators = TetherCase::none});
  expect_near(law.torque(0, turned(1), {1, 2, 3}), {0, 0, 0}, 0);
}

TEST(TetherLaw, EffortIsTheExactSumOverHeldSamples) {
  test::Random random(1);
  Law law(TetherLaw{.actuators = TetherCase::both, .sample_period = 0.25});
  double effort = 0;
  Vec3<double> thrust{0, 0, 0};
  for (int i = 0; i < 20; ++i) {
    Quat<double> const q = turned(random.uniform(0, 3));
    Vec3<double> const held = law.torque(0.25 * i, q, random.vector(0.1));
    effort += 0.25 * dot(thrust, thrust);  // what was held until now
    EXPECT_NEAR(shown(law, q).effort, effort, 1e-12);
    expect_near(shown(law, q).torque, held, 0);
    double const tension = shown(law, q).tension, sine = 2 * q.y * q.w;
    thrust = held - Vec3<double>{0, -2 * tension * sine, 0};
  }
  EXPECT_GT(effort, 1);
}

// ---- Variants -------------------------------------------------------------------------------------------------------

std::map<std::string, std::vector<double>> parameters_of(std::set<std::string> const& words) {
  TetherCapture definition(chosen(words));
  std::map<std::string, std::vector<double>> values;
  for (Parameter const& parameter : definition.parameters()) values[parameter.name()] = parameter.values();
  return values;
}

TEST(TetherVariants, GainSets) {
  auto const g1 = parameters_of({"case1", "g1"}), g2 = parameters_of({"case1", "g2"});
  auto const gains = [](auto const& p) {
    return std::array{p.at("k_pe")[0], p.at("k_de")[0], p.at("k_pu")[0], p.at("k_du")[0], p.at("f_max")[0]};
  };
  EXPECT_EQ(gains(g1), (std::array<double, 5>{40, 120, 8, 80, 30}));
  EXPECT_EQ(gains(g2), (std::array<double, 5>{0.6, 4, 5, 60, 20}));
  for (char const* same : {"u_max", "switch_angle", "sample_period", "inertia", "q0", "omega0"})
    EXPECT_EQ(g1.at(same), g2.at(same)) << same;
  EXPECT_EQ(g1.at("u_max")[0], 5);
  EXPECT_EQ(g1.at("sample_period")[0], 0.1);
}

TEST(TetherVariants, FreeIsContinuousAndTorqueFree) {
  TetherCapture const free(chosen({"free"})), driven(Choice{});
  EXPECT_TRUE(free.torque_free());
  EXPECT_EQ(free.sample_period, 0);
  EXPECT_FALSE(driven.torque_free());
  EXPECT_EQ(driven.sample_period, 0.1);
  EXPECT_EQ(driven.horizon, 50);
}

TEST(TetherVariants, RawQ0KeepsThePrintedNorm) {
  auto const norm_defect = [](std::set<std::string> const& words) {
    auto const x = TetherCapture(chosen(words)).field<double, FlatQuaternion, true>().initial();
    return dot(x.first, x.first) - 1;
  };
  EXPECT_NEAR(norm_defect({"raw_q0"}), -2.97e-4, 5e-7);
  EXPECT_NEAR(norm_defect({}), 0, 4.5e-16);
}

TEST(TetherVariants, AsPrintedTurnsTheCoriolisTermAround) {
  auto const acceleration = [](std::set<std::string> const& words) {
    auto const field = TetherCapture(chosen(words)).field<double, S3, true>();
    return field(0, field.initial()).second;
  };
  double const w2 = 100 * degree * degree;
  expect_near(acceleration({"free"}), w2 * Vec3<double>{10. / 100, 10. / 120, -20. / 110}, 1e-17);
  expect_near(acceleration({"free", "as_printed"}), w2 * Vec3<double>{-10. / 100, -10. / 120, 20. / 110}, 1e-17);
}

TEST(TetherVariants, CoupledSamplesAtEveryStep) {
  Choice choice = chosen({"coupled"});
  choice.step = 0.02;
  EXPECT_EQ(TetherCapture(choice).sample_period, 0.02);
  choice.step = 0;
  try {
    TetherCapture const refused(choice);
    FAIL() << "adaptive steps have no size to couple to";
  } catch (ParameterError const& error) {
    EXPECT_STREQ(error.what(), "variant coupled ties the sample period to the step: needs fixed steps");
  }
}

// ---- Claims ---------------------------------------------------------------------------------------------------------

TEST(TetherClaims, FirstZeroIsInterpolated) {
  using history::first_zero;
  EXPECT_NEAR(*first_zero({0, 1, 2, 3}, {4, 3, -1, -2}), 1.75, 1e-15);
  EXPECT_EQ(*first_zero({0, 1, 2}, {4, 0, 4}), 1);
  EXPECT_FALSE(first_zero({0, 1, 2}, {4, 3, 2}));
  EXPECT_FALSE(first_zero({0, 1, 2}, {-4, 3, 2})) << "a rise through zero is another event";
}

TEST(TetherClaims, MaximaAreCountedAboveTheirSurroundings) {
  using history::maxima;
  EXPECT_EQ(maxima({5, 4, 3, 2}, 0.1), 0);
  EXPECT_EQ(maxima({1, 2, 3, 4}, 0.1), 0) << "the end is no interior maximum";
  EXPECT_EQ(maxima({1, 2, 3, 2, 1}, 0.1), 1);
  EXPECT_EQ(maxima({1, 3, 1, 4, 1, 3, 1}, 0.1), 3);
  EXPECT_EQ(maxima({1, 3, 2.95, 3, 2.95, 1}, 0.1), 1) << "ripples below the threshold";
  EXPECT_EQ(maxima({10, 5, 8, 5, 7, 5}, 0.1), 2) << "waves below the start are waves";
}

/// A row a second, the last one at 50 s.
History history_of(std::vector<double> const& alpha_degrees, std::vector<double> const& omega_y = {}) {
  History history;
  history.columns = {"wy", "alpha", "energy_c"};
  for (std::size_t i = 0; i < alpha_degrees.size(); ++i) {
    history.times.push_back(i + 1 < alpha_degrees.size() ? double(i) : 50);
    history.rows.push_back({omega_y.empty() ? 1.0 : omega_y[i], alpha_degrees[i] * degree, 10.0 * double(i)});
  }
  return history;
}
std::map<std::string, ClaimResult> claims_of(std::string const& variant, History const& history) {
  std::map<std::string, ClaimResult> claims;
  for (ClaimResult const& claim : TetherCapture(chosen({variant})).claims(history)) claims[claim.name] = claim;
  return claims;
}

TEST(TetherClaims, Case3) {
  std::vector<double> const omega_y{1, 1, 1, -1, -1};
  auto good = claims_of("case3", history_of({52, 77.42, 40, 1.2, 0.9}, omega_y));
  EXPECT_NEAR(*good.at("alpha_max").value, 77.42 * degree, 1e-15);
  EXPECT_NEAR(*good.at("alpha_max").published, 77.5 * degree, 1e-15);
  EXPECT_EQ(good.at("alpha_max").holds, true);
  EXPECT_EQ(*good.at("omega_y_zero").value, 2.5);
  EXPECT_EQ(good.at("omega_y_zero").holds, false) << "5 s within 1 s";
  EXPECT_EQ(good.at("alpha_end").holds, true);
  EXPECT_EQ(good.at("alpha_maxima").holds, true);
  EXPECT_EQ(*good.at("alpha_maxima").value, 1);
  EXPECT_EQ(*good.at("energy_c").value, 40);
  EXPECT_FALSE(good.at("energy_c").holds.has_value()) << "nothing is printed to hold it against";

  auto const bad = claims_of("case3", history_of({52, 77.39, 40, 60, 1.1}));
  EXPECT_EQ(bad.at("alpha_max").holds, false);
  EXPECT_FALSE(bad.at("omega_y_zero").value) << "it never crosses";
  EXPECT_EQ(bad.at("omega_y_zero").holds, false);
  EXPECT_EQ(bad.at("alpha_end").holds, false);
  EXPECT_EQ(bad.at("alpha_maxima").holds, false) << "two rises";

  History until_4 = history_of({52, 60, 70});
  until_4.times = {0, 2, 4};
  EXPECT_FALSE(claims_of("case3", until_4).contains("omega_y_zero")) << "it is printed for 5 s";
}

TEST(TetherClaims, Case2IsWaveLikeAndCase1IsNot) {
  History const waves = history_of({52, 60, 40, 55, 20, 30, 0.5}), one_rise = history_of({52, 55, 30, 10, 0.5});
  EXPECT_EQ(claims_of("case2", waves).at("alpha_maxima").holds, true);
  EXPECT_EQ(claims_of("case2", one_rise).at("alpha_maxima").holds, false);
  EXPECT_EQ(claims_of("case1", waves).at("alpha_maxima").holds, false);
  EXPECT_EQ(claims_of("case1", one_rise).at("alpha_maxima").holds, true);
  EXPECT_FALSE(claims_of("case1", one_rise).at("alpha_max").published) << "the paper prints no number";
  EXPECT_FALSE(claims_of("case1", one_rise).at("alpha_max").holds.has_value());
}

TEST(TetherClaims, WhatIsSaidOf50SecondsIsNotHeldAgainstFewer) {
  History shorter = history_of({52, 55, 30, 10});
  shorter.times.back() = 10;
  EXPECT_FALSE(claims_of("case1", shorter).contains("alpha_end"));
  EXPECT_TRUE(claims_of("case1", shorter).contains("alpha_max"));
}

TEST(TetherClaims, EveryClaimIsAnnouncedAndTheFreeBodyHasNone) {
  std::set<std::string> announced;
  for (ClaimInfo const& claim : TetherCapture::info().claims) announced.insert(claim.name);
  History const history = history_of({52, 55, 30, 10, 0.5});
  std::set<std::string> evaluated;
  for (char const* variant : {"case1", "case2", "case3"})
    for (auto const& [name, claim] : claims_of(variant, history)) evaluated.insert(name);
  EXPECT_EQ(evaluated, announced);
  EXPECT_TRUE(claims_of("free", history).empty());
  EXPECT_TRUE(claims_of("case1", history_of({})).empty()) << "nothing was seen";
}

TEST(TetherClaims, AnUnknownColumnIsAnError) {
  EXPECT_THROW(history_of({1}).column("beta"), std::out_of_range);
}

}  // namespace
}  // namespace polhode
