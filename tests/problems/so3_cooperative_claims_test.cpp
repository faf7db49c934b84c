/// Five cooperative craft on SO(3): the times at which they have come together, the order of the methods, the jump of
/// Euler angles, claims, choices that cannot be.
#include <gtest/gtest.h>

#include "integrators/commutator_free.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/so3_cooperative.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/problems/swarm_runs.hpp"

namespace polhode {
namespace {

using test::claims_of;
using test::history_of;
using test::Numbers;
using test::run_swarm;
using test::Words;
using Claims = std::map<std::string, ClaimResult>;

constexpr test::Chooser<So3Cooperative> chosen;
template <template <class> class A, class Method>
Claims claims(Words const& words, Numbers const& set, Method const& method, double h, double t_end = 20) {
  auto const definition = chosen(words, set);
  return claims_of(definition, history_of(definition.field<double, A, true>(), definition.columns(), method, h, t_end));
}
Numbers const rough{{"delta", {0.01}}};

// ---- Times ----------------------------------------------------------------------------------------------------------

struct Known {
  Words words;
  Numbers set;
  double t1;         ///< [s]
  double published;  ///< [s]
};
std::vector<Known> const known_times{{{}, {}, 5.891, 4.89},
                                     {{}, {{"rho", {0}}}, 9.531, 4.89},
                                     {{}, rough, 5.596, 4.89},
                                     // 5.54954; 5.5493 .. 5.5496 by steps that run over the switch
                                     {{"switching"}, rough, 5.549, 4.89}};

TEST(So3Times, AreOursByTwoMethodsAndNotThePublished) {
  for (Known const& known : known_times)
    for (Claims const& all : {claims<S3>(known.words, known.set, Gauss<2>{}, 0.01),
                              claims<FlatQuaternion>(known.words, known.set, Rk4{}, 0.01)}) {
      ClaimResult const &t1 = all.at("t1"), &ours = all.at("t1_ours");
      EXPECT_NEAR(*t1.value, known.t1, 5.5e-4) << known.t1;
      EXPECT_EQ(*t1.published, known.published);
      EXPECT_EQ(t1.holds, false) << "tables lost: 13% and more off";
      EXPECT_EQ(*ours.value, *t1.value);
      EXPECT_EQ(ours.holds, true);
    }
}

/// The published order is one of gains: `set_p` shows it, equal linearisations do not.
TEST(So3Times, OrderOfTheMethodsIsAMatterOfGains) {
  auto const t1 = [](std::string const& method, std::string const& gains) {
    Claims const coarse = claims<S3>({method, gains}, rough, CommutatorFree4{}, 0.02);
    Claims const fine = claims<FlatQuaternion>({method, gains}, rough, Rk4{}, 0.01);
    EXPECT_NEAR(*coarse.at("t1").value, *fine.at("t1").value, 1e-4) << method;
    EXPECT_EQ(coarse.at("t1").holds, false);
    if (coarse.contains("t1_ours")) {
      EXPECT_EQ(coarse.at("t1_ours").holds, true) << method;
    }
    return *fine.at("t1").value;
  };
  EXPECT_NEAR(t1("method1", "set_p"), 5.60, 0.005);
  EXPECT_NEAR(t1("method2", "set_p"), 5.87, 0.005);
  EXPECT_NEAR(t1("method3", "set_p"), 8.67, 0.005);
  double const one = t1("method1", "set_e");
  EXPECT_NEAR(t1("method2", "set_e") / one, 1, 0.005);
  EXPECT_NEAR(t1("method3", "set_e") / one, 1, 0.005);
}

TEST(So3Claims, VerdictsOnThePublishedTimeAreWithin5Percent) {
  auto const definition = chosen({"method3", "set_p"});
  // q_a falls from 2 at 0 s to at_8 and at_10, and rests there or at `end`.
  auto const made_up = [&](double at_8, double at_10, double end) {
    History history;
    for (Column const& column : definition.columns()) history.columns.push_back(column.name);
    history.times = {0, 8, 10, 20};
    for (double value : {2.0, at_8, at_10, end}) history.rows.emplace_back(history.columns.size(), value);
    return history;
  };
  auto const verdict = [&](History const& history) { return claims_of(definition, history).at("t1"); };
  EXPECT_NEAR(*verdict(made_up(2, 0.5, 0)).value, 28.0 / 3, 1e-12);
  EXPECT_EQ(verdict(made_up(2, 0.5, 0)).published, 9.29);
  EXPECT_EQ(verdict(made_up(2, 0.5, 0)).holds, true);
  EXPECT_EQ(verdict(made_up(1.5, 0, 0)).holds, false) << "8.667 s";
  EXPECT_FALSE(verdict(made_up(2, 0.5, 3)).value.has_value()) << "never";
  EXPECT_EQ(verdict(made_up(2, 0.5, 3)).holds, false);
  History history = made_up(2, 0.5, 0);
  EXPECT_FALSE(claims_of(definition, history).contains("t1_ours")) << "another delta";
  history.times.back() = 19;
  EXPECT_TRUE(claims_of(definition, history).empty()) << "20 s not reached";
  EXPECT_TRUE(definition.claims(History{}).empty());
}

TEST(So3Claims, SpreadAt5Seconds) {
  Claims const fine = claims<S3>({}, {}, CommutatorFree4{}, 0.01, 5);
  EXPECT_NEAR(*fine.at("q_a_5s").value, 1.9153595366, 1e-8);
  EXPECT_EQ(fine.at("q_a_5s").holds, true);
  Claims const between = claims<S3>({}, {}, CommutatorFree4{}, 0.0048, 6);
  EXPECT_NEAR(*between.at("q_a_5s").value, 1.9153595366, 1e-5) << "linear between rows";
  EXPECT_FALSE((claims<S3>({}, {}, CommutatorFree4{}, 0.03, 6).contains("q_a_5s"))) << "rows too far apart";
  EXPECT_FALSE((claims<S3>({}, rough, CommutatorFree4{}, 0.01, 6).contains("q_a_5s"))) << "another delta";
  EXPECT_EQ((claims<FlatRotation>({}, {}, Rk4{}, 0.2, 5).at("q_a_5s").holds), false) << "steps too large";
}

// ---- Large angles ---------------------------------------------------------------------------------------------------

TEST(So3LargeAngles, EulerAnglesJumpWhereTheMatrixDoesNot) {
  for (Numbers const& set : {Numbers{}, rough})
    for (double h : {0.001, 0.005}) {
      Claims const all = claims<S3>({"ex2"}, set, CommutatorFree4{}, h, 0.7);
      EXPECT_GT(*all.at("euler_jump").value, 90) << h;
      EXPECT_EQ(all.at("euler_jump").holds, true);
      EXPECT_LT(*all.at("r23_jump").value, 0.01) << h;
      EXPECT_EQ(all.at("r23_jump").holds, true);
    }
  EXPECT_FALSE((claims<S3>({"ex2"}, {}, CommutatorFree4{}, 0.01, 0.7).contains("euler_jump"))) << "coarse rows";
  EXPECT_FALSE((claims<S3>({"ex2"}, {}, CommutatorFree4{}, 0.005, 0.5).contains("euler_jump"))) << "ends too early";
  EXPECT_FALSE((claims<S3>({}, {}, CommutatorFree4{}, 0.005, 0.7).contains("euler_jump"))) << "ex1";
}

TEST(So3LargeAngles, Craft2PassesTheSingularity) {
  auto const definition = chosen({"ex2"});
  auto const field = definition.field<double, SO3, true>();
  double least = 0, at = 0;
  run_swarm(field, Rkmk4{}, 0.001, 1, field.initial(), [&](double t, auto const& x) {
    double const yaw = test::columns_of(definition, field, x).at("b2.yaw");
    if (yaw >= least) return;
    least = yaw;
    at = t;
  });
  EXPECT_NEAR(least, -89.95, 0.005);
  EXPECT_NEAR(at, 0.448, 0.0015);
}

TEST(So3LargeAngles, ColumnsAtTheStartAreTheGivenAngles) {
  auto const definition = chosen({"ex2"});
  auto const field = definition.field<double, FlatRotation, true>();
  auto const row = test::columns_of(definition, field, field.initial());
  EXPECT_NEAR(row.at("b2.pitch"), 5, 1e-12);
  EXPECT_NEAR(row.at("b2.yaw"), -80, 1e-12);
  EXPECT_NEAR(row.at("b2.roll"), 38, 1e-12);
  EXPECT_EQ(row.at("b2.r23"), field.initial()[1].first.e3.y);
  // Pitch, yaw, roll less those of craft 1, wrapped.
  double const squares = 145. * 145 + 110 * 110 + 158 * 158 + 27 * 27 + 60 * 60 + 66 * 66 + 110 * 110 + 20 * 20 +
                         150 * 150 + 90 * 90 + 80 * 80 + 122 * 122;
  EXPECT_NEAR(row.at("q_a"), std::sqrt(squares / 5), 1e-11);
  double turned = 0;
  for (int i = 1; i < 5; ++i) {
    auto const apart = angle_between(quaternion(field.initial()[0].first), quaternion(field.initial()[i].first));
    turned += std::pow(apart / BodyParameters::degree, 2);
  }
  EXPECT_NEAR(row.at("q_geo"), std::sqrt(turned / 5), 1e-11);
}

TEST(So3Claims, EveryClaimIsAnnounced) {
  std::set<std::string> announced, evaluated;
  for (ClaimInfo const& claim : So3Cooperative::info().claims) announced.insert(claim.name);
  for (Claims const& some :
       {claims<S3>({}, {}, CommutatorFree4{}, 0.05), claims<S3>({"ex2"}, {}, CommutatorFree4{}, 0.005, 0.7)})
    for (auto const& [name, claim] : some) evaluated.insert(name);
  EXPECT_EQ(evaluated, announced);
}

TEST(So3Claims, VerdictsAreOnlyAboutOurData) {
  std::vector<double> angles(15, 5.0);
  angles[0] = 40;
  Claims const all = claims<S3>({}, {{"angles0", angles}}, CommutatorFree4{}, 0.05);
  EXPECT_TRUE(all.at("t1").value.has_value());
  EXPECT_FALSE(all.at("t1").published.has_value());
  EXPECT_FALSE(all.at("t1").holds.has_value());
  EXPECT_FALSE(all.contains("t1_ours"));
  Claims const large = claims<S3>({"ex2"}, {}, CommutatorFree4{}, 0.05);
  EXPECT_FALSE(large.at("t1").holds.has_value());
  Claims const stronger = claims<S3>({}, {{"k1", {1.5}}}, CommutatorFree4{}, 0.05);
  EXPECT_FALSE(stronger.contains("t1_ours"));
  std::vector<double> heavy(30, 0.0);
  for (std::size_t k = 0; k < 30; ++k) heavy[k] = k % 6 < 3 ? 100 : 1;
  EXPECT_EQ((claims<S3>({}, {{"inertia", heavy}}, CommutatorFree4{}, 0.01).at("t1_ours").holds), true) << "J cancels";
}

// ---- Choices --------------------------------------------------------------------------------------------------------

std::string complaint(Numbers const& set, Words const& words = {}) {
  return test::complaint<So3Cooperative>(Choice{.words = words, .set = set});
}

TEST(So3Choice, WhatCannotBeIsRefusedByName) {
  EXPECT_EQ(complaint({{"rho", {0.95}}}),
            "parameter rho: must be within [0, .9]: near 1 the common rate is free, and the accelerations have no "
            "solution (I - W is singular)");
  EXPECT_EQ(complaint({{"rho", {0.9}}}), "");
  EXPECT_EQ(complaint({{"rho", {-0.1}}}), "parameter rho: must not be negative");
  EXPECT_EQ(complaint({{"delta", {-0.1}}}), "parameter delta: must not be negative");
  for (char const* method : {"method2", "method3"})
    for (char const* surface : {"near", "switching"})
      EXPECT_EQ(complaint({}, {method, surface}),
                "variant " + std::string(surface) +
                    ": is about the surfaces of method1; method2 and method3 have one each, so leave it out");
  EXPECT_EQ(complaint({}, {"method2", "far"}), "");
  std::vector<double> inertia(30, 0.0);
  for (std::size_t k = 0; k < 30; ++k) inertia[k] = k % 6 < 3 ? 10 : 0;
  EXPECT_EQ(complaint({{"inertia", inertia}}), "");
  inertia[6] = 25;
  EXPECT_EQ(complaint({{"inertia", inertia}}),
            "parameter inertia of craft 2: breaks the triangle inequality: no principal moment may exceed the sum of "
            "the other two");
  EXPECT_EQ(complaint({{"inertia", {1, 1, 1}}}), "parameter inertia: takes 30 number(s), not 3");
  EXPECT_EQ(complaint({{"angles0", {1, 2, 3}}}), "parameter angles0: takes 15 number(s), not 3");
}

TEST(So3Choice, GraphsAreCheckedAndNormalised) {
  std::vector<double> const ring{1, 2, 3, 2, 3, 1, 3, 4, 1, 4, 5, .1, 5, 1, 7};
  EXPECT_EQ(complaint({{"graph", ring}}), "");
  EXPECT_EQ(complaint({{"graph", {1, 2, 1, 2, 1, 1}}}),
            "parameter graph: must be strongly connected: node 1 does not hear node 3, not even through others");
  EXPECT_EQ(complaint({{"graph", {1, 2, -1}}}),
            "parameter graph: weights must be greater than 0: node 1 hears node 2 with -1");
  auto const weights = [](Numbers const& set) { return chosen({}, set).field<double, S3, true>().graph.weight; };
  for (double a : weights({{"graph", ring}})) EXPECT_EQ(a, 1);
  std::vector<double> const known{1, .75, .25, 1, .21 / .61, .40 / .61, 1};
  std::vector<double> const printed = weights({});
  for (std::size_t k = 0; k < known.size(); ++k) EXPECT_NEAR(printed[k], known[k], 1e-15);

  // Craft 3 and 1 head against each other, and craft 2 hears both alike.
  std::vector<double> graph = ring, angles(15, 0.0);
  graph.insert(graph.end(), {2, 1, 1});
  angles[0] = 180;
  EXPECT_EQ(complaint({{"graph", graph}, {"angles0", angles}}),
            "parameter graph: what node 2 hears cancels at the start: it has no command");
}

TEST(So3Choice, WhatADefinitionSays) {
  static_assert(Definition<So3Cooperative>);
  auto const plain = chosen({}), switching = chosen({"switching"}), unlocated = chosen({"switching", "unlocated"});
  EXPECT_FALSE(plain.switches());
  EXPECT_TRUE(switching.switches());
  EXPECT_TRUE(switching.locate_events);
  EXPECT_FALSE(unlocated.locate_events);
  EXPECT_EQ((plain.field<double, S3, true>().state_events()), 0);
  EXPECT_EQ((switching.field<double, S3, true>().state_events()), 5);
  static_assert(SwitchingProblem<decltype(plain.field<double, S3, true>())>);
  EXPECT_EQ(plain.no_reference(), "");
  EXPECT_EQ(switching.no_reference(), "");
  EXPECT_EQ(chosen({}, {{"delta", {0}}}).no_reference(),
            "with delta = 0 the law's slope is infinite where a component of s1 passes 0");
  EXPECT_EQ(plain.columns().size(), 21u);
  EXPECT_EQ(plain.columns()[0].name, "q_a");
  EXPECT_EQ(plain.columns()[16].name, "b5.mz");
}

TEST(So3Choice, GainsByMethodAndSet) {
  auto const values = [](Words const& words, Numbers const& set = {}) {
    auto const law = chosen(words, set).field<double, S3, true>().law;
    return std::vector<double>{law.k1, law.k2, law.p1, law.p2, double(law.crosses)};
  };
  using Values = std::vector<double>;
  for (char const* method : {"method1", "method2", "method3"})
    EXPECT_EQ(values({method}), (Values{1.15, .15, .03, .03, 1}));
  EXPECT_EQ(values({"method1", "set_p"}), (Values{1.15, .15, .03, .03, 1}));
  EXPECT_EQ(values({"method2", "set_p"}), (Values{1, 1, 0, .1, 0}));
  EXPECT_EQ(values({"method3", "set_p"}), (Values{.35, .35, .1, .1, 0}));
  EXPECT_EQ(values({"method3", "set_p"}, {{"p1", {.2}}}), (Values{.35, .35, .2, .1, 0}));
}

}  // namespace
}  // namespace polhode
