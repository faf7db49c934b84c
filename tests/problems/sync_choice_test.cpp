/// Spacecraft that synchronise: claims, choices that cannot be, held sides, swarms of any number.
#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "integrators/lie_group.hpp"
#include "problems/quaternion_sync.hpp"
#include "tests/problems/swarm_runs.hpp"

namespace polhode {
namespace {

using test::columns_of;
using test::history_of;
using Words = std::set<std::string>;
using Numbers = std::map<std::string, std::vector<double>>;

Choice chosen(Words const& words, Numbers const& set = {}) {
  return Choice{.words = words, .set = set};
}
template <template <class> class A>
auto field_of(Words const& words, Numbers const& set = {}) {
  return QuaternionSync(chosen(words, set)).field<double, A, true>();
}

// ---- Claims ---------------------------------------------------------------------------------------------------------

std::map<std::string, ClaimResult> claims(Words const& words) {
  QuaternionSync const definition(chosen(words));
  auto const field = definition.field<double, FlatQuaternion, true>();
  History history = history_of(field, definition.columns(), Gauss<3>{}, 0.1, 20);
  if (words.contains("protocol13")) history.events = {.2116516346, .4855026743, 1.0050253857 + 2e-9};
  return test::claims_of(definition, history);
}

TEST(SyncClaims, OfThePapersData) {
  for (std::string const protocol : {"protocol7", "protocol13"}) {
    auto const all = claims({protocol});
    for (char const* name :
         {"lyapunov_rise", "lyapunov_start", "lyapunov_end", "together", "disagreement_end", "scalar_consensus"})
      EXPECT_EQ(all.at(name).holds, true) << protocol << ": " << name << " " << *all.at(name).value;
    EXPECT_EQ(all.contains("lemma_1"), protocol == "protocol7") << "some scalar parts start negative";
    EXPECT_FALSE(all.contains("trap"));
  }
  EXPECT_EQ(claims({"protocol7"}).at("lemma_1").holds, true);
  EXPECT_NEAR(*claims({"protocol7"}).at("together").value, 11.58, 0.005);
  EXPECT_NEAR(*claims({"protocol13"}).at("together").value, 12.43, 0.005);
}

TEST(SyncClaims, CrossingsHoldWithin1e9Seconds) {
  auto const all = claims({"protocol13"});
  EXPECT_EQ(all.at("crossing_1").holds, true);
  EXPECT_EQ(all.at("crossing_3").holds, false) << "2e-9 s late";
  EXPECT_FALSE(claims({}).contains("crossing_1")) << "protocol 7 has no events";
}

TEST(SyncClaims, RawDataContradictTheFiguresAndTheTrapHolds) {
  auto const raw = claims({"raw"});
  EXPECT_EQ(raw.at("scalar_consensus").holds, false);
  EXPECT_EQ(raw.at("together").holds, false);
  EXPECT_FALSE(raw.at("lyapunov_end").holds.has_value()) << "our number is that of the normalised data";
  EXPECT_EQ(claims({"trap"}).at("trap").holds, true);
}

TEST(SyncClaims, MadeUpHistories) {
  History history{.times = {0, 10, 20},
                  .columns = {"disagreement", "scalar_spread", "scalar_min", "lyapunov"},
                  .rows = {{1, .5, .1, 1.278598}, {.02, .01, .3, .3}, {0, .002, .2, .4}}};
  auto const all = test::claims_of(QuaternionSync(chosen({})), history);
  EXPECT_NEAR(*all.at("together").value, 15, 1e-12);
  EXPECT_EQ(all.at("together").holds, false);
  EXPECT_NEAR(*all.at("lemma_1").value, .1, 1e-15);
  EXPECT_EQ(all.at("lemma_1").holds, false);
  EXPECT_NEAR(*all.at("lyapunov_rise").value, .1, 1e-15);
  EXPECT_EQ(all.at("lyapunov_rise").holds, false);
  EXPECT_EQ(all.at("lyapunov_start").holds, true);
  EXPECT_EQ(all.at("lyapunov_end").holds, false);
  EXPECT_EQ(all.at("scalar_consensus").holds, false);
  history.times.pop_back();
  history.rows.pop_back();
  EXPECT_FALSE(test::claims_of(QuaternionSync(chosen({})), history).contains("lyapunov_end")) << "20 s not reached";
  EXPECT_TRUE(QuaternionSync(chosen({})).claims(History{}).empty());
}

TEST(SyncClaims, EveryClaimIsAnnounced) {
  std::set<std::string> announced, evaluated;
  for (ClaimInfo const& claim : QuaternionSync::info().claims) announced.insert(claim.name);
  for (Words const& words : {Words{}, Words{"protocol13"}, Words{"trap"}})
    for (auto const& [name, claim] : claims(words)) evaluated.insert(name);
  EXPECT_EQ(evaluated, announced);
}

// ---- Choices --------------------------------------------------------------------------------------------------------

TEST(SyncChoice, WhatCannotBeIsRefusedByName) {
  auto const complaint = [](Numbers const& set, Words const& words = {}) {
    return test::complaint<QuaternionSync>(chosen(words, set));
  };
  for (double n : {2.5, 1.0, 2e6})
    EXPECT_EQ(complaint({{"n", {n}}}), "parameter n: must be a whole number from 2 to 1e6") << n;
  EXPECT_EQ(complaint({{"seed", {.5}}}), "parameter seed: must be a whole number from 0 to 2^53");
  for (char const* word : {"raw", "recomputed", "trap"})
    EXPECT_EQ(complaint({{"n", {6}}}, {word}), "parameter n: variants recomputed, raw and trap are about 5 craft");
  EXPECT_EQ(complaint({{"graph", {1, 6, 1}}}), "parameter graph: node 6 does not exist: there are 5");
  EXPECT_EQ(complaint({{"graph", {1, 2, -1}}}),
            "parameter graph: weights must be greater than 0: node 1 hears node 2 with -1");
  EXPECT_EQ(complaint({{"graph", {1, 2, 1, 2, 1, 1}}}),
            "parameter graph: must be strongly connected: node 1 does not hear node 3, not even through others");
  EXPECT_EQ(complaint({{"graph", {1, 2, 1, 2, 3, 1, 3, 1, 1}}, {"n", {3}}}), "");
}

TEST(SyncChoice, FormulationsAndSwitching) {
  QuaternionSync const seven(chosen({"protocol7"})), thirteen(chosen({"protocol13", "unlocated"})),
      raw(chosen({"raw"}));
  for (char const* good : {"quaternion", "s3", "mrp"}) EXPECT_EQ(thirteen.refusal(good), "");
  for (char const* bad : {"so3", "rotation", "mrp_shadow", "euler321"})
    EXPECT_EQ(thirteen.refusal(bad), "the law sees the sign of the quaternion, which this formulation has not");
  EXPECT_EQ(raw.refusal("quaternion"), "");
  EXPECT_EQ(raw.refusal("mrp"), "three numbers cannot keep the norm of raw quaternions");
  EXPECT_FALSE(seven.switches());
  EXPECT_TRUE(thirteen.switches());
  EXPECT_TRUE(seven.locate_events);
  EXPECT_FALSE(thirteen.locate_events);
  EXPECT_EQ((field_of<S3>({"protocol7"}).state_events()), 0);
  EXPECT_EQ((field_of<S3>({"protocol13"}).state_events()), 5);
  static_assert(SwitchingProblem<decltype(field_of<S3>({}))>);
}

TEST(SyncChoice, HeldSidesStayUntilTheyCross) {
  auto field = field_of<FlatQuaternion>({"protocol13"});
  auto x = field.initial();
  Many<Vec3<double>, dynamic> held(5), anew(5);
  field.take_sides(0, x);
  for (int i = 0; i < 5; ++i) x[i].w = -x[i].w;
  field(0, x, held);
  field.holds_sides = false;
  field(0, x, anew);
  EXPECT_EQ(distance<double>(held, anew), 0) << "all signs turned over: no product of two has changed";
  x[1].w = -x[1].w;
  field(0, x, anew);
  EXPECT_GT(distance<double>(held, anew), 0.1) << "looks at the state anew";
  field.holds_sides = true;
  Many<Vec3<double>, dynamic> crossed(5);
  field(0, x, crossed);
  EXPECT_EQ(distance<double>(held, crossed), 0) << "holds";
  field.cross(1);
  field(0, x, crossed);
  EXPECT_EQ(distance<double>(anew, crossed), 0);
}

// ---- Large swarms ---------------------------------------------------------------------------------------------------

TEST(SyncSwarm, IsItsSeed) {
  auto const at = [](double seed) { return field_of<FlatQuaternion>({"protocol7"}, {{"n", {50}}, {"seed", {seed}}}); };
  EXPECT_EQ(distance<double>(at(1).initial(), at(1).initial()), 0);
  EXPECT_EQ(at(1).graph.heard, at(1).graph.heard);
  EXPECT_GT(distance<double>(at(1).initial(), at(2).initial()), 0.1);
  EXPECT_NE(at(1).graph.heard, at(2).graph.heard);
  for (int i = 0; i < 50; ++i) {
    EXPECT_NEAR(dot(at(1).initial()[i], at(1).initial()[i]), 1, 5e-16);
    EXPECT_GE(at(1).initial()[i].w, 0) << "(7) works on the upper half";
  }
}

TEST(SyncSwarm, FiftyCraftAgreeInTheEndAndTheLawsHold) {
  Numbers const fifty{{"n", {50}}};
  for (char const* protocol : {"protocol7", "protocol13"}) {
    QuaternionSync const definition(chosen({protocol}, fifty));
    auto const field = definition.field<double, S3, true>();
    auto const claims = test::claims_of(definition, history_of(field, definition.columns(), Rkmk4{}, 0.1, 60));
    EXPECT_EQ(claims.at("lyapunov_rise").holds, true) << protocol << " " << *claims.at("lyapunov_rise").value;
    EXPECT_EQ(claims.at("scalar_consensus").holds, true) << protocol;
    EXPECT_FALSE(claims.at("disagreement_end").holds.has_value());
  }
}

TEST(SyncSwarm, TheBoundOnDisagreementIsOne) {
  QuaternionSync const definition(chosen({}, {{"n", {300}}}));
  auto const field = definition.field<double, FlatQuaternion, true>();
  auto const x = field.initial();
  double exact = 0;
  for (int i = 0; i < 300; ++i)
    for (int j = 0; j < i; ++j) {
      Quat<double> d = x[i];
      add(d, -1.0, x[j]);
      exact = std::max(exact, std::sqrt(dot(d, d)));
    }
  double const bound = columns_of(definition, field, x).at("disagreement");
  EXPECT_GE(bound, exact);
  EXPECT_LE(bound, 2 * exact);
}

TEST(SyncSwarm, AHundredThousandCraftAllocateNothingAndShowNoV) {
  QuaternionSync const definition(chosen({"protocol13"}, {{"n", {100000}}}));
  EXPECT_EQ(definition.columns().size(), 3u);
  auto field = definition.field<double, S3, true>();
  auto const x = field.initial();
  ASSERT_EQ(x.count(), 100000);
  Many<Vec3<double>, dynamic> v(x.count());
  std::vector<double> g(std::size_t(field.state_events())), shown(3);
  auto const before = bench::allocations_of_this_thread();
  field(0, x, v);
  field.take_sides(0, x);
  field.event_values(0, x, std::span(g));
  field.cross(77);
  field(0, x, v);
  field.show(x, shown);
  EXPECT_EQ(bench::allocations_of_this_thread() - before, 0);
  EXPECT_GT(largest<double>(v), 0.1);
  EXPECT_TRUE(all_finite(v));
  EXPECT_LT(shown[2], -0.9) << "some of so many start near -1";
}

}  // namespace
}  // namespace polhode
