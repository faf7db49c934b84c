/// Two groups of rigid bodies: the field by hand, V' by dual numbers, formulations, our reference values by three
/// methods, the spectrum and its warnings, the shadow point, theorem 2's counterexample, claims, choices.
#include <gtest/gtest.h>

#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/dual.hpp"
#include "problems/group_consensus.hpp"
#include "problems/laplacian.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/problems/swarm_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::columns_of;
using test::expect_near;
using test::history_of;
using test::in;
using test::Numbers;
using test::Random;
using test::run_swarm;
using test::Words;
using Rates = Many<Pair<Vec3<double>, Vec3<double>>, dynamic>;

constexpr test::Chooser<GroupConsensus> chosen;

// ---- The field ------------------------------------------------------------------------------------------------------

TEST(ConsensusField, TorqueOfBody3ByHand) {
  // Body 3 hears 1 and 2 with weight 1, and nobody of the other group. J = 1: omega' = u.
  Vec3<double> const s1{-1.29, -1.75, 0.02}, s2{-0.23, 1.57, -2.25}, s3{0.42, -2.37, -0.22};
  Vec3<double> const w1{-1.42, 2.58, 4.61}, w2{-0.82, 3.26, 0.94}, w3{2.48, 3.58, 2.09};
  Vec3<double> const apart = 2.0 * s3 - s1 - s2, slip = 2.0 * w3 - w1 - w2;
  double const z = dot(s3, s3);
  Vec3<double> const transposed =  // G^T v with 2 G = (1 - z) / 2 + hat(s) + s s^T
      0.5 * (0.5 * (1 - z) * apart - cross(s3, apart) + dot(s3, apart) * s3);
  auto const field = chosen.field<Mrp>({"ic1"});
  auto const x = field.initial();
  Rates v(5);
  field(0, x, v);
  expect_near(x[2].first, s3, 1e-15);
  expect_near(v[2].first, w3, 0);
  expect_near(v[2].second, -1.0 * (transposed + slip), 1e-14);
  // Body 4 hears 5, 1 (+) and 2 (-): omega part alone, all sigma = 0.
  Rates u(5);
  auto const rates_alone = chosen.field<Mrp>({"ic2"});
  rates_alone(0, rates_alone.initial(), u);
  Vec3<double> const w4{-2.42, 1.58, 1.61};
  expect_near(u[3].second, -1.0 * ((w4 - Vec3<double>{0, 0, 0}) + (w4 - w1) - (w4 - w2)), 1e-15);
}

/// V' = -omega^T (L x 1) omega, with any inertia.
TEST(ConsensusField, DerivativeOfVByDualNumbers) {
  using D = Dual<1>;
  Random random(5);
  Numbers const unequal{{"inertia", {1, 1.5, 2.2}}};
  auto const field = chosen.field<Mrp>({"ic1"}, unequal);
  auto const dual = chosen.field<Mrp, D>({"ic1"}, unequal);
  Eigen::MatrixXd const L = laplacian(field.graph);
  D s(0.0);
  s.slope[0] = 1;
  for (int trial = 0; trial < 20; ++trial) {
    auto x = field.initial();
    auto moved = dual.initial();
    for (int i = 0; i < 5; ++i) x[i] = {random.vector(1.5), random.vector(2)};
    Rates v(5);
    field(0, x, v);
    double expected = 0;
    for (int i = 0; i < 5; ++i) {
      Pair<Vec3<D>, Vec3<D>> at{in<D>(x[i].first), in<D>(x[i].second)};
      add(at.first, s, in<D>(mrp_rate(x[i].first, x[i].second)));
      add(at.second, s, in<D>(v[i].second));
      moved[i] = at;
      for (int j = 0; j < 5; ++j) expected -= L(i, j) * dot(x[i].second, x[j].second);
    }
    D const V = dual.lyapunov(moved);
    EXPECT_NEAR(V.slope[0], expected, 1e-12 * (1 + V.value)) << "trial " << trial;
  }
}

/// The velocities of the field on A at given attitudes and rates.
template <template <class> class A>
Rates velocities(Words const& words, std::vector<Quat<double>> const& q, std::vector<Vec3<double>> const& omega) {
  auto const field = chosen.field<A>(words);
  auto x = field.initial();
  for (std::size_t i = 0; i < 5; ++i) x[int(i)] = {A<double>::from_attitude(q[i]), omega[i]};
  Rates v(5);
  field(0, x, v);
  return v;
}

TEST(ConsensusField, IsTheSameInEveryFormulation) {
  Random random(9);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Quat<double>> q;
    std::vector<Vec3<double>> omega;
    for (int i = 0; i < 5; ++i) {
      q.push_back(random.attitude());
      omega.push_back(random.vector(1));
      if (q.back().w < -0.8) q.back() = scaled(-1.0, q.back());  // sigma of moderate size
    }
    auto const outer = velocities<Mrp>({}, q, omega);
    EXPECT_LE(distance<double>(velocities<FlatQuaternion>({}, q, omega), outer), 1e-12);
    EXPECT_LE(distance<double>(velocities<S3>({}, q, omega), outer), 1e-12);
    Words const shadow{"shadow"};
    auto const inner = velocities<Mrp>(shadow, q, omega);
    EXPECT_LE(distance<double>(velocities<FlatQuaternion>(shadow, q, omega), inner), 1e-12);
    EXPECT_LE(distance<double>(velocities<S3>(shadow, q, omega), inner), 1e-12);
    EXPECT_LE(distance<double>(velocities<MrpShadow>(shadow, q, omega), inner), 1e-12);
    EXPECT_LE(distance<double>(velocities<SO3>(shadow, q, omega), inner), 1e-12);
    EXPECT_LE(distance<double>(velocities<FlatRotation>(shadow, q, omega), inner), 1e-12);
  }
}

TEST(ConsensusField, AllocatesNothing) {
  test::expect_no_allocations<5, 9>(chosen.field<S3>({"shadow"}));
}

// ---- Our reference values, each by three methods --------------------------------------------------------------------

struct Outcome {
  std::string method;
  Vec3<double> sigma, omega;  ///< of body 1
  std::map<std::string, double> columns;
};
template <template <class> class A, class Method>
Outcome outcome(std::string const& name, Words const& words, Method const& method, double h, double t_end) {
  auto const definition = chosen(words);
  auto const field = definition.template field<double, A, true>();
  auto const run = run_swarm(field, method, h, t_end);
  EXPECT_EQ(run.status, Status::ok) << name;
  return {name, field.sigma(0, run.x), run.x[0].second, columns_of(definition, field, run.x)};
}
std::vector<Outcome> by_three_methods(Words const& words, double t_end, double fine) {
  return {outcome<FlatQuaternion>("gauss4", words, Gauss<4>{}, 0.01, t_end),
          outcome<S3>("cf4", words, CommutatorFree4{}, fine, t_end), outcome<Mrp>("rk4", words, Rk4{}, fine, t_end)};
}
Vec3<double> mean(Outcome const& run, std::string const& group) {
  return {run.columns.at(group + "_x"), run.columns.at(group + "_y"), run.columns.at(group + "_z")};
}

TEST(ConsensusReference, StatesAt10Seconds) {
  for (Outcome const& got : by_three_methods({"ic2"}, 10, 5e-4)) {
    expect_near(got.sigma, {.8792886109236, -1.4867235353350, -1.1478570248682}, 3e-11, got.method);
    expect_near(got.omega, {-.1693530106283, .1648283684021, -.3711024971813}, 3e-11, got.method);
    EXPECT_NEAR(got.columns.at("lyapunov"), 1.8201182486458, 3e-11) << got.method;
  }
  for (Outcome const& got : by_three_methods({"ic3"}, 10, 5e-4)) {
    expect_near(got.sigma, {-.1028689601026, .8404094463919, .8848133487660}, 3e-12, got.method);
    expect_near(got.omega, {-.4923623436263, -1.8206369704822, -.4236296837149}, 3e-12, got.method);
    EXPECT_NEAR(got.columns.at("lyapunov"), 4.9698803293382, 3e-12) << got.method;
  }
}

TEST(ConsensusReference, SteadyRates) {
  struct Steady {
    std::string start;
    Vec3<double> g1, g2;
    double period;  ///< of sigma in the first group: 4 pi / |omega| [s]
  };
  std::vector<Steady> const known{
      {"ic1", {-1.5784404859, .8512325884, .9953917774}, {.580860674, 1.341159174, .642318881}, 6.127},
      {"ic2", {-.1422234525, -.1677911468, -.3633335561}, {.1063375202, -.0736400681, -.0071140852}, 29.587},
      {"ic3", {-.3468926571, -1.1733596554, .1813551911}, {.2088465613, -.1342724176, .6512550909}, 10.159}};
  for (Steady const& steady : known)
    for (Outcome const& got : by_three_methods({steady.start}, 200, 2e-3)) {
      // Order 4 over 200 s of a motion that forgets slowly: rk4 on ic1 errs by 4e-8 at this step, 16 times less at
      // half.
      double const tolerance = got.method == "gauss4" ? 2e-10 : 5e-8;
      expect_near(mean(got, "g1"), steady.g1, tolerance, steady.start + " g1, " + got.method);
      expect_near(mean(got, "g2"), steady.g2, std::max(tolerance, 5e-10), steady.start + " g2, " + got.method);
      EXPECT_NEAR(4 * 3.14159265358979323846 / length(mean(got, "g1")), steady.period, 5e-4) << steady.start;
    }
}

TEST(ConsensusReference, BodiesReachTheMeanOfTheirGroupBy400SecondsNotBy200) {
  // By body, the greatest component of omega_i - group mean.
  auto const off = [](double t_end) {
    auto const field = chosen.field<FlatQuaternion>({"ic1"});
    auto const x = run_swarm(field, Gauss<4>{}, 0.02, t_end).x;
    auto const mean = field.group_rates(x);
    std::vector<double> by_body;
    for (std::size_t i = 0; i < 5; ++i)
      by_body.push_back(distance<double>(x[int(i)].second, mean[std::size_t(consensus_group[i])]));
    return by_body;
  };
  EXPECT_NEAR(off(200)[0], 1.6e-7, 5e-9) << "body 1";
  for (double value : off(200)) EXPECT_LT(value, 2e-7);
  for (double value : off(400)) EXPECT_LT(value, 1e-14);
}

TEST(ConsensusReference, WhatRk4MissesAt100Seconds) {
  auto const exact = outcome<FlatQuaternion>("gauss4", {"ic1"}, Gauss<4>{}, 0.02, 100);
  auto const error = [&](double h) {
    auto const got = outcome<Mrp>("rk4", {"ic1"}, Rk4{}, h, 100);
    return std::max(distance<double>(mean(got, "g1"), mean(exact, "g1")),
                    distance<double>(mean(got, "g2"), mean(exact, "g2")));
  };
  EXPECT_NEAR(error(0.1), 0.12, 0.03);
  EXPECT_NEAR(error(0.02), 8e-4, 2e-4);
  EXPECT_NEAR(error(0.01), 4.5e-5, 1e-5);
}

TEST(ConsensusReference, LateSigmaSwingsBetweenAPointAndItsShadow) {
  auto const field = chosen.field<S3>({"ic3"});
  std::array<double, 5> least, most{};
  least.fill(1e300);
  run_swarm(field, CommutatorFree4{}, 0.01, 200, field.initial(), [&](double t, auto const& x) {
    if (t < 170) return;
    for (std::size_t i = 0; i < 5; ++i) {
      double const size = length(field.sigma(int(i), x));
      least[i] = std::min(least[i], size);
      most[i] = std::max(most[i], size);
    }
  });
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(least[i] * most[i], 1, 1e-4) << i;
    EXPECT_GT(most[i], 1) << "crosses |sigma| = 1";
  }
}

// ---- The shadow point -----------------------------------------------------------------------------------------------

TEST(ConsensusShadow, FormulationsAgreeAcrossEvents) {
  Words const shadow{"ic1", "shadow"};
  auto const exact = run_swarm(chosen.field<FlatQuaternion>(shadow), Gauss<4>{}, 0.01, 5);
  ASSERT_GE(exact.events.size(), 5u);
  auto const expect_same = [&](auto const& run, std::string const& name) {
    ASSERT_EQ(run.events.size(), exact.events.size()) << name;
    for (std::size_t k = 0; k < run.events.size(); ++k) EXPECT_NEAR(run.events[k], exact.events[k], 1e-8) << name;
    for (int i = 0; i < 5; ++i) expect_near(run.x[i].second, exact.x[i].second, 1e-7, name);
  };
  expect_same(run_swarm(chosen.field<S3>(shadow), CommutatorFree4{}, 2e-3, 5), "s3");
  expect_same(run_swarm(chosen.field<MrpShadow>(shadow), Rk4{}, 2e-3, 5), "mrp_shadow");
  expect_same(run_swarm(chosen.field<Mrp>(shadow), Rk4{}, 2e-3, 5), "mrp");
}

TEST(ConsensusShadow, MakesVJumpUpAndKeepsTheGroupsApart) {
  auto const rise = [](Words const& words) {
    auto const definition = chosen(words);
    auto const field = definition.field<double, S3, true>();
    return test::claims_of(definition, history_of(field, definition.columns(), CommutatorFree4{}, 0.01, 100));
  };
  auto const with = rise({"ic1", "shadow"}), without = rise({"ic1"});
  EXPECT_EQ(without.at("lyapunov_rise").holds, true) << *without.at("lyapunov_rise").value;
  EXPECT_EQ(with.at("lyapunov_rise").holds, false);
  EXPECT_GT(*with.at("lyapunov_rise").value, 1);
  EXPECT_EQ(with.at("together").holds, false);
}

}  // namespace
}  // namespace polhode
