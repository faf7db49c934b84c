/// Two groups of rigid bodies: spectra and their warnings, theorem 2's counterexample, claims, choices that cannot be.
#include <gtest/gtest.h>

#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/group_consensus.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/problems/swarm_runs.hpp"

namespace polhode {
namespace {

using test::history_of;
using test::Numbers;
using test::run_swarm;
using test::Words;

constexpr test::Chooser<GroupConsensus> chosen;
/// The paper's graph with weights +-c between the groups: eigenvalues 0, 0, (5 -+ sqrt(1 + 16 c^2)) / 2, 3.
std::vector<double> coupled_by(double c) {
  return {1, 2, 1, 1, 3, 1, 2, 3, 1, 4, 5, 1, 1, 4, c, 2, 5, c, 1, 5, -c, 2, 4, -c};
}
/// Path 1-2-3 and pair 4-5, their ends coupled.
std::vector<double> const path{1, 2, 1, 2, 3, 1, 4, 5, 1, 1, 4, 1, 1, 5, -1, 3, 4, -1, 3, 5, 1};

// ---- The spectrum ---------------------------------------------------------------------------------------------------

TEST(ConsensusSpectrum, OfThePapersGraph) {
  std::vector<double> const wanted{0, 0, (5 - std::sqrt(17)) / 2, 3, (5 + std::sqrt(17)) / 2};
  auto const problem = chosen({});
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(problem.spectrum()[k], wanted[k], 1e-14) << k;
  EXPECT_EQ(problem.warning(), "");
  auto const claims = test::claims_of(problem, History{});
  EXPECT_EQ(claims.at("zero_eigenvalues").holds, true);
  EXPECT_EQ(claims.at("least_eigenvalue").holds, true);
  EXPECT_EQ(*claims.at("greatest_eigenvalue").published, 4);
  EXPECT_EQ(claims.at("greatest_eigenvalue").holds, false) << "4.5616: the paper's own matrix";
}

TEST(ConsensusSpectrum, WarnsOfWhatItCannotRefuse) {
  EXPECT_EQ(chosen({}, {{"graph", coupled_by(0.5)}}).warning(), "");
  EXPECT_EQ(chosen({}, {{"graph", coupled_by(2)}}).warning(),
            "graph: the Laplacian has a negative eigenvalue, -1.53113: the groups are driven apart");
  EXPECT_EQ(chosen({}, {{"graph", coupled_by(std::sqrt(1.5))}}).warning(),
            "graph: the Laplacian has 3 eigenvalues 0, not 2: a group need not come together");
}

TEST(ConsensusSpectrum, Theorem1IsFalseAndItsLoopDiverges) {
  auto const problem = chosen({"ic3"}, {{"graph", path}});
  EXPECT_NEAR(problem.spectrum().front(), (3 - std::sqrt(17)) / 2, 1e-14);
  EXPECT_EQ(test::claims_of(problem, History{}).at("least_eigenvalue").holds, false);
  EXPECT_NE(problem.warning(), "");
  auto const field = problem.field<double, S3, true>();
  auto const run = run_swarm(field, CommutatorFree4{}, 1e-3, 20);
  double fastest = 0;
  for (int i = 0; i < 5; ++i) fastest = std::max(fastest, length(run.x[i].second));
  EXPECT_GT(fastest, 100) << "from rest";
}

// ---- Theorem 2's counterexample -------------------------------------------------------------------------------------

TEST(ConsensusTheorem2, SigmaEscapesAt2PiOverOmega) {
  double const T = 2 * 3.14159265358979323846 / 0.3;
  auto const problem = chosen({"theorem2"});
  auto const field = problem.field<double, Mrp, true>();
  auto const before = run_swarm(field, Rk4{}, 0.01, 20.9);
  EXPECT_EQ(before.status, Status::ok);
  for (int i = 0; i < 5; ++i) {
    double const size = std::tan(0.3 * 20.9 / 4);
    EXPECT_NEAR(length(before.x[i].first) / size, 1, 1e-4) << "tan(|omega| t / 4)";
    EXPECT_EQ(distance<double>(before.x[i].second, field.initial()[i].second), 0) << "no torque";
  }
  for (double h : {0.1, 0.01}) EXPECT_EQ(run_swarm(field, Rk4{}, h, 25).status, Status::diverged) << h;

  auto const claims = test::claims_of(problem, history_of(field, problem.columns(), Rk4{}, 0.01, 25));
  EXPECT_NEAR(*claims.at("escape").value, T, 0.05);
  EXPECT_FALSE(claims.contains("together"));
}

TEST(ConsensusTheorem2, QuaternionsPassThrough) {
  auto const problem = chosen({"theorem2"});
  auto const field = problem.field<double, S3, true>();
  auto const run = run_swarm(field, CommutatorFree4{}, 0.05, 100);
  ASSERT_EQ(run.status, Status::ok);
  Quat<double> const exact = exp_quaternion(Vec3<double>{10, 20, 20});
  for (int i = 0; i < 5; ++i) EXPECT_LE(double(angle_between(run.x[i].first, exact)), 1e-12);
  auto const claims = test::claims_of(problem, history_of(field, problem.columns(), CommutatorFree4{}, 0.05, 50));
  EXPECT_EQ(claims.at("escape").holds, true) << *claims.at("escape").value;
}

// ---- Claims ---------------------------------------------------------------------------------------------------------

std::map<std::string, ClaimResult> claims(Words const& words) {
  auto const problem = chosen(words);
  auto const field = problem.field<double, FlatQuaternion, true>();
  return test::claims_of(problem, history_of(field, problem.columns(), Gauss<3>{}, 0.02, 100));
}
std::vector<char const*> const rates{"g1_x", "g1_y", "g1_z", "g2_x", "g2_y", "g2_z"};

TEST(ConsensusClaims, PrintedRatesOfIc2AndIc3HoldAndThoseOfIc1DoNot) {
  for (char const* start : {"ic1", "ic2", "ic3"}) {
    auto const all = claims({start});
    for (char const* name : {"lyapunov_rise", "lyapunov_start", "together"})
      EXPECT_EQ(all.at(name).holds, true) << start << ": " << name << " " << *all.at(name).value;
    double worst = 0;
    for (char const* name : rates) {
      double const off = std::fabs(*all.at(name).value - *all.at(name).published);
      EXPECT_EQ(all.at(name).holds, off <= 0.01) << start << ": " << name;
      worst = std::max(worst, off);
    }
    if (std::string(start) == "ic1")
      EXPECT_NEAR(worst, 0.36, 0.01) << "an artefact of a loose tolerance";
    else
      EXPECT_LE(worst, 0.01) << start;
  }
}

TEST(ConsensusClaims, VerdictsAreOnlyAboutThePapersData) {
  auto const other = chosen({"ic2"}, {{"inertia", {2, 2, 2}}});
  auto const field = other.field<double, S3, true>();
  auto const all = test::claims_of(other, history_of(field, other.columns(), CommutatorFree4{}, 0.02, 100));
  for (char const* name : rates) {
    EXPECT_TRUE(all.at(name).value.has_value());
    EXPECT_FALSE(all.at(name).published.has_value());
    EXPECT_FALSE(all.at(name).holds.has_value());
  }
  EXPECT_EQ(all.at("lyapunov_rise").holds, true);
}

TEST(ConsensusClaims, EveryClaimIsAnnounced) {
  std::set<std::string> announced, evaluated;
  for (ClaimInfo const& claim : GroupConsensus::info().claims) announced.insert(claim.name);
  for (Words const& words : {Words{"ic2"}, Words{"theorem2"}})
    for (auto const& [name, claim] : claims(words)) evaluated.insert(name);
  EXPECT_EQ(evaluated, announced);
}

// ---- Choices --------------------------------------------------------------------------------------------------------

TEST(ConsensusChoice, WhatCannotBeIsRefusedByName) {
  auto const complaint = [](Numbers const& set) {
    return test::complaint<GroupConsensus>(Choice{.words = {}, .set = set});
  };
  EXPECT_EQ(complaint({{"graph", {1, 6, 1}}}), "parameter graph: node 6 does not exist: there are 5");
  EXPECT_EQ(complaint({{"graph", {1, 2, 1, 2, 3, 1}}}),
            "parameter graph: must be connected: no links lead from node 4 to node 1");
  EXPECT_EQ(complaint({{"graph", {1, 2, 1, 2, 3, 1, 4, 5, 1, 3, 4, 1}}}),
            "parameter graph: must be in-degree balanced: what node 3 hears from group 2 must sum to 0, not 1");
  EXPECT_EQ(complaint({{"inertia", {1, 1, 1, 0, 0, 0}}}),
            "parameter inertia: takes 3 number(s), the principal moments of every body, not 6");
  EXPECT_EQ(complaint({{"sigma0", {1, 2, 3}}}), "parameter sigma0: takes 15 number(s), not 3");
  EXPECT_EQ(complaint({{"graph", coupled_by(2)}}), "") << "a warning, no refusal";
}

TEST(ConsensusChoice, LargeSigmaIsKept) {
  std::vector<double> sigma0(15, 0);
  sigma0[0] = 20;
  sigma0[4] = -7;
  auto const field = chosen({}, {{"sigma0", sigma0}}).field<double, FlatQuaternion, true>();
  auto const x = field.initial();
  EXPECT_LT(x[0].first.w, 0);
  EXPECT_NEAR(field.sigma(0, x).x, 20, 1e-12);
  EXPECT_NEAR(field.sigma(1, x).y, -7, 1e-13);
}

TEST(ConsensusChoice, FormulationsByVariant) {
  auto const plain = chosen({}), shadow = chosen({"shadow"}), unlocated = chosen({"shadow", "unlocated"});
  for (char const* any : {"quaternion", "s3", "mrp"}) {
    EXPECT_EQ(plain.refusal(any), "") << any;
    EXPECT_EQ(shadow.refusal(any), "") << any;
  }
  EXPECT_EQ(shadow.refusal("mrp_shadow"), "");
  for (char const* signless : {"mrp_shadow", "so3", "rotation"}) {
    EXPECT_EQ(plain.refusal(signless), "the law sees the sign of the quaternion, which this formulation has not");
    EXPECT_EQ(unlocated.refusal(signless), "") << signless;
  }
  for (char const* matrix : {"so3", "rotation"})
    EXPECT_EQ(shadow.refusal(matrix),
              "the law jumps where a scalar part changes its sign, which a matrix has not: add the variant unlocated");
  EXPECT_FALSE(plain.switches());
  EXPECT_TRUE(shadow.switches());
  EXPECT_FALSE(unlocated.locate_events);
  EXPECT_EQ((plain.field<double, S3, true>().state_events()), 0);
  EXPECT_EQ((shadow.field<double, S3, true>().state_events()), 5);
  EXPECT_EQ((shadow.field<double, SO3, true>().state_events()), 0);
  static_assert(SwitchingProblem<decltype(plain.field<double, S3, true>())>);
}

TEST(ConsensusChoice, HeldSidesStayUntilTheyCross) {
  auto field = chosen({"ic3", "shadow"}).field<double, S3, true>();
  auto x = field.initial();
  x[1].first = {0.6, 0, 0, 0.8};
  field.take_sides(0, x);
  double const inside = 0.6 / 1.8;
  EXPECT_NEAR(field.sigma(1, x).x, inside, 1e-15);
  x[1].first = {0.8, 0, 0, -0.6};
  EXPECT_NEAR(field.sigma(1, x).x, 2, 1e-15) << "held: beyond 180 deg without a jump";
  field.cross(1);
  EXPECT_NEAR(field.sigma(1, x).x, -0.5, 1e-15);
}

}  // namespace
}  // namespace polhode
