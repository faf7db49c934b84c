/// Five cooperative craft on SO(3): our reference values by several methods and by power series, every scalar and
/// formulation, the inertia, orders, drift, the switch of surfaces.
#include <gtest/gtest.h>

#include "integrators/commutator_free.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/runge_kutta.hpp"
#include "integrators/taylor.hpp"
#include "problems/dual.hpp"
#include "problems/so3_cooperative.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/problems/swarm_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::columns_of;
using test::expect_near;
using test::Numbers;
using test::Real3;
using test::run_swarm;
using test::Words;
using Rates = Many<Pair<Real3, Real3>, dynamic>;

constexpr test::Chooser<So3Cooperative> chosen;
constexpr double degree = BodyParameters::degree;

// ---- Our reference values -------------------------------------------------------------------------------------------

TEST(So3Reference, CommandAnglesAndAccelerationsAtTheStart) {
  auto const field = chosen.field<S3>({});
  auto const x = field.initial();
  auto const R = field.rotations(x);
  Quat<double> const q = quaternion(field.command(1, x, R).attitude);
  EXPECT_LE(distance<double>(q, {-.256698142475, .113224805874, .318093646205, .905595185074}), 1e-12);
  std::array<double, 5> const angles{38.315874817, 82.327348802, 83.536282945, 67.018838055, 83.135326504};
  for (std::size_t i = 0; i < 5; ++i) {
    auto const e = field.errors(i, x, R, field.command(i, x, R));
    EXPECT_NEAR(std::atan2(length(e.e_R), e.cosine()) / degree, angles[i], 5.1e-10);
    EXPECT_NEAR(length(field.law.virtual_control(CooperativeSurface::far, e).s1) / degree, angles[i], 5.1e-10);
  }
  expect_near(field.accelerations(x)[1], {-.522367404647, .131311849546, .726710937725}, 5.1e-13);
  auto const alone = chosen.field<S3>({}, {{"rho", {0}}});
  expect_near(alone.accelerations(x)[1], {-1.147841989375, -.146309161175, 1.296963627018}, 5.1e-13);
}

TEST(So3Reference, StateAt5Seconds) {
  auto const definition = chosen({});
  auto const expect_known = [&]<template <class> class A>(auto const& method, double h, std::string const& name) {
    auto const field = definition.field<double, A, true>();
    auto const x = run_swarm(field, method, h, 5).x;
    Quat<double> q = A<double>::attitude(x[0].first);
    if (q.w < 0) q = scaled(-1.0, q);
    EXPECT_LE(distance<double>(q, {-.002262582527, .080197751946, .050839259371, .995479066083}), 1e-12) << name;
    expect_near(x[0].second, {.007698252870, -.002886817323, .001506269899}, 1e-12, name);
    EXPECT_NEAR(columns_of(definition, field, x).at("q_a"), 1.9153595366, 1e-10) << name;
  };
  expect_known.operator()<S3>(Gauss<4>{}, 0.01, "gauss4 on s3");
  expect_known.operator()<SO3>(CommutatorFree4{}, 1e-3, "cf4 on so3");
  expect_known.operator()<FlatRotation>(Rk4{}, 1e-3, "rk4 on rotation");
}

/// The solution from the start to t by power series, on flat quaternions: components in storage order.
std::vector<Quad> by_series(Words const& words, Numbers const& set, double t_end, double tolerance) {
  auto const field = chosen.field<FlatQuaternion, Jet<Quad, 32>>(words, set);
  std::vector<Quad> state(35);
  store(chosen.field<FlatQuaternion, Quad>(words, set).initial(), state.data());
  Quad t(0.0);
  while (t < Quad(t_end)) {
    auto const segment = expand<Quad, 32>(field, state, t, Quad(Quad(t_end) - t), tolerance);
    EXPECT_GT(double(segment.h), 1e-3);
    if (!(segment.h > Quad(1e-3))) break;
    for (std::size_t i = 0; i < state.size(); ++i) state[i] = segment.component[i].at(segment.h);
    t += segment.h;
  }
  return state;
}

TEST(So3Reference, PowerSeriesAgreeWithGauss) {
  struct Kind {
    Words words;
    Numbers set;
  };
  for (Kind const& kind :
       {Kind{{}, {}}, Kind{{"near"}, {}}, Kind{{"method2"}, {{"delta", {0.01}}}}, Kind{{"method3"}, {}}}) {
    auto const field = chosen.field<FlatQuaternion>(kind.words, kind.set);
    std::array<double, 35> exact;
    store(run_swarm(field, Gauss<4>{}, 5e-3, 0.1).x, exact.data());
    std::vector<Quad> const series = by_series(kind.words, kind.set, 0.1, 1e-17);
    for (std::size_t i = 0; i < 35; ++i) EXPECT_NEAR(double(series[i]), exact[i], 1e-14);
  }
}

// To half a unit of the last digit of the references.
TEST(So3Reference, PowerSeriesTo5Seconds) {
  std::vector<Quad> const state = by_series({}, {}, 5, 1e-16);
  std::array<double, 7> const known{-.002262582527, .080197751946,  .050839259371, .995479066083,
                                    .007698252870,  -.002886817323, .001506269899};
  for (std::size_t i = 0; i < known.size(); ++i) EXPECT_NEAR(double(state[i]), known[i], 5.1e-13);
}

// ---- One problem in every scalar and formulation --------------------------------------------------------------------

TEST(So3Field, IsOneForEveryScalar) {
  for (Words const& words : {Words{}, Words{"ex2"}, Words{"near"}, Words{"method2"}, Words{"method3"}}) {
    auto const rates = chosen.field<FlatQuaternion>(words);
    auto const quads = chosen.field<FlatQuaternion, Quad>(words);
    auto const duals = chosen.field<FlatQuaternion, Dual<1>>(words);
    auto const series = chosen.field<FlatQuaternion, Jet<Quad, 32>>(words);
    auto const a = rates.accelerations(rates.initial());
    auto const b = quads.accelerations(quads.initial());
    auto const c = duals.accelerations(duals.initial());
    auto const d = series.accelerations(series.initial());
    for (std::size_t i = 0; i < 5; ++i) {
      expect_near(test::in<double>(b[i]), a[i], 1e-12);
      expect_near({c[i].x.value, c[i].y.value, c[i].z.value}, a[i], 1e-13);
      expect_near({double(d[i].x[0]), double(d[i].y[0]), double(d[i].z[0])}, test::in<double>(b[i]), 1e-30);
    }
  }
}

TEST(So3Field, IsTheSameInEveryFormulationAndForBothQuaternions) {
  test::Random random(9);
  for (Words const& words : {Words{}, Words{"switching"}, Words{"method2", "set_p"}, Words{"method3"}})
    for (int trial = 0; trial < 10; ++trial) {
      std::array<Quat<double>, 5> q;
      std::array<Real3, 5> omega;
      for (std::size_t i = 0; i < 5; ++i) {
        q[i] = random.attitude();
        omega[i] = random.vector(0.5);
      }
      auto const velocities = [&]<template <class> class A>(double sign) {
        auto const field = chosen.field<A>(words);
        auto x = field.initial();
        for (std::size_t i = 0; i < 5; ++i) x[int(i)] = {A<double>::from_attitude(scaled(sign, q[i])), omega[i]};
        Rates v(5);
        field(0, x, v);
        return v;
      };
      auto const plain = velocities.operator()<FlatQuaternion>(1);
      double const tolerance = 1e-11;
      EXPECT_LE(distance<double>(velocities.operator()<FlatQuaternion>(-1), plain), tolerance);
      EXPECT_LE(distance<double>(velocities.operator()<S3>(1), plain), tolerance);
      EXPECT_LE(distance<double>(velocities.operator()<SO3>(1), plain), tolerance);
      EXPECT_LE(distance<double>(velocities.operator()<FlatRotation>(1), plain), tolerance);
      EXPECT_LE(distance<double>(velocities.operator()<Mrp>(1), plain), tolerance);
      EXPECT_LE(distance<double>(velocities.operator()<MrpShadow>(1), plain), tolerance);
      for (int i = 0; i < 5; ++i) expect_near(plain[i].first, omega[std::size_t(i)], 0);
    }
}

TEST(So3Field, AllocatesNothing) {
  test::expect_no_allocations<5, 21>(chosen.field<S3>({"switching"}));
}

/// J Omega' = M - Omega x J Omega under the torques that the law commands for the same J.
struct Plant {
  using Law = CooperativeSwarm<double, S3<double>>;
  using Space = Law::Space;
  Law law;
  std::vector<FullInertia<double>> body;

  explicit Plant(Law const& of) : law(of) {
    for (auto const& J : law.inertia) body.emplace_back(J);
  }
  void operator()(double, Point<Space> const& x, Velocity<Space>& v) const {
    auto const M = law.torques(x);
    for (int i = 0; i < 5; ++i) {
      auto const at = std::size_t(i);
      v[i] = {x[i].second, body[at].acceleration(x[i].second, M[at])};
    }
  }
  Point<Space> initial() const { return law.initial(); }
  int state_events() const { return 0; }
  void event_values(double, Point<Space> const&, std::span<double>) const {}
  void take_sides(double, Point<Space> const&) {}
  void cross(int) {}
};

TEST(So3Field, InertiaCancelsFromTheMotionAndNotFromTheTorque) {
  std::vector<double> other(30, 0.0);
  for (std::size_t i = 0; i < 5; ++i) {
    double const size = 3 + 10 * double(i);
    std::array<double, 6> const J{size, 1.1 * size, 0.9 * size, 0.1 * size, 0, -0.05 * size};
    std::copy(J.begin(), J.end(), other.begin() + std::ptrdiff_t(6 * i));
  }
  Numbers const changed{{"inertia", other}};
  auto const field = chosen.field<S3>({"ex2"});
  auto const exact = run_swarm(field, CommutatorFree4{}, 0.02, 5).x;
  for (Plant const& plant : {Plant(field), Plant(chosen.field<S3>({"ex2"}, changed))}) {
    auto const x = run_swarm(plant, CommutatorFree4{}, 0.02, 5).x;
    for (int i = 0; i < 5; ++i) {
      EXPECT_LE(angle_between(x[i].first, exact[i].first), 1e-13);
      expect_near(x[i].second, exact[i].second, 1e-13);
    }
  }
  auto const ours = columns_of(chosen({"ex2"}), field, exact);
  auto const theirs = columns_of(chosen({"ex2"}), chosen.field<S3>({"ex2"}, changed), exact);
  EXPECT_EQ(ours.at("q_a"), theirs.at("q_a"));
  EXPECT_GT(std::fabs(ours.at("b1.mx") - theirs.at("b1.mx")), 1e-3);
  auto const M = field.torques(exact);
  EXPECT_EQ(ours.at("b5.mz"), M[4].z);
  Real3 const omega = exact[4].second, change = field.accelerations(exact)[4];
  Mat3<double> const J{{21, .8, .6}, {.8, 18, 1}, {.6, 1, 16}};
  expect_near(M[4], J * change + cross(omega, J * omega), 1e-14);
}

// ---- Orders and drift -----------------------------------------------------------------------------------------------

/// The greatest error in angle or rate at 5 s against gauss4.
template <template <class> class A, class Method>
double error_at_5(Words const& words, Numbers const& set, Method const& method, double h) {
  static std::map<std::pair<Words, Numbers>, Point<RigidBodies<S3<double>>>> exact;
  auto& known = exact[{words, set}];
  if (known.count() == 0) known = run_swarm(chosen.field<S3>(words, set), Gauss<4>{}, 0.00625, 5).x;
  auto const x = run_swarm(chosen.field<A>(words, set), method, h, 5).x;
  double most = 0;
  for (int i = 0; i < 5; ++i)
    most = std::max({most, angle_between(A<double>::attitude(x[i].first), known[i].first),
                     distance<double>(x[i].second, known[i].second)});
  return most;
}
/// Orders from .05 to .025 and from there to .0125 s.
template <template <class> class A, class Method>
std::array<double, 2> orders(Words const& words, Numbers const& set, Method const& method) {
  double const coarse = error_at_5<A>(words, set, method, 0.05), middle = error_at_5<A>(words, set, method, 0.025),
               fine = error_at_5<A>(words, set, method, 0.0125);
  return {std::log2(coarse / middle), std::log2(middle / fine)};
}

TEST(So3Order, IsFourOnTheSmoothField) {
  for (std::array<double, 2> const& order :
       {orders<S3>({}, {}, Rkmk4{}), orders<SO3>({}, {}, Rkmk4{}), orders<S3>({}, {}, CommutatorFree4{}),
        orders<SO3>({}, {}, CommutatorFree4{}), orders<FlatRotation>({}, {}, Rk4{})})
    for (double value : order) EXPECT_NEAR(value, 4, 0.1);
}

TEST(So3Order, IsLostWithThePlainRoot) {
  double const none = error_at_5<S3>({}, {{"delta", {0}}}, CommutatorFree4{}, 0.0125);
  EXPECT_GT(none, 1e-4);
  EXPECT_LT(error_at_5<S3>({}, {}, CommutatorFree4{}, 0.0125), 1e-9);
  auto const order = orders<S3>({}, {{"delta", {0.01}}}, CommutatorFree4{});
  EXPECT_GT(std::max(std::fabs(order[0] - 4), std::fabs(order[1] - 4)), 1) << "steps do not see the smoothing";
}

TEST(So3Order, SwitchingKeepsItWhereEventsAreLocated) {
  Words const switching{"switching"};
  for (double value : orders<S3>(switching, {}, CommutatorFree4{})) EXPECT_NEAR(value, 4, 0.1);
  for (double value : orders<FlatRotation>(switching, {}, Rk4{})) EXPECT_NEAR(value, 4, 0.1);

  auto const exact = run_swarm(chosen.field<S3>(switching), Gauss<4>{}, 0.00625, 5).x;
  double worst_order = 4, last = 0;
  for (double h : {0.1, 0.05, 0.025, 0.0125, 0.00625}) {
    auto const field = chosen.field<S3>({"switching", "unlocated"});
    auto stepper = CommutatorFree4{}.bind(field, FixedStep{h}, NormPolicy::none);
    auto x = field.initial();
    ASSERT_EQ(stepper.advance(x, 0, 5), Status::ok);
    double const error = distance<double>(x, exact);
    EXPECT_GT(error, 1e-5) << h;
    if (last > 0) worst_order = std::min(worst_order, std::log2(last / error));
    last = error;
  }
  EXPECT_LT(worst_order, 0) << "a smaller step with a greater error";
}

TEST(So3Switching, EveryCraftOnceAtTheSameTimesByTwoMethods) {
  auto const events = [](auto const& field, auto const& method, double h) {
    return run_swarm(field, method, h, 20).events;
  };
  auto const cf4 = events(chosen.field<S3>({"switching"}), CommutatorFree4{}, 0.005);
  auto const gauss = events(chosen.field<FlatQuaternion>({"switching"}), Gauss<3>{}, 0.02);
  std::vector<double> const known{1.0537066, 1.5761398, 1.6317325, 1.6479190, 1.7078978};
  ASSERT_EQ(cf4.size(), 5u);
  ASSERT_EQ(gauss.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(cf4[k], gauss[k], 1e-9);
    EXPECT_NEAR(cf4[k], known[k], 1e-7);
  }
}

TEST(So3Switching, HeldSidesStayUntilTheyCross) {
  auto field = chosen.field<SO3>({"switching"});
  auto const far = chosen.field<SO3>({"far"}), near = chosen.field<SO3>({"near"});
  auto x = field.initial();
  field.take_sides(0, x);
  for (int i = 0; i < 5; ++i) x[i].first = matrix(exp_quaternion(Real3{0.03 * i, -0.01 * i * i, 0.01}));
  auto const expect_same = [&](auto const& got, auto const& wanted) {
    for (std::size_t i = 0; i < 5; ++i) expect_near(got[i], wanted[i], 1e-15);
  };
  expect_same(field.accelerations(x), far.accelerations(x));
  std::array<double, 5> g{};
  field.event_values(0, x, g);
  for (double value : g) EXPECT_GT(value, 0) << "all within 20 deg";
  for (int k = 0; k < 5; ++k) field.cross(k);
  expect_same(field.accelerations(x), near.accelerations(x));
  field.holds_sides = false;
  expect_same(field.accelerations(x), near.accelerations(x));
}

TEST(So3Drift, OfNineNumbersFallsAsH4AndLieGroupsHaveNone) {
  auto const drift = []<template <class> class A>(auto const& method, double h) {
    auto const field = chosen.field<A>({});
    double most = 0;
    run_swarm(field, method, h, 20, field.initial(), [&](double, auto const& x) {
      for (int i = 0; i < 5; ++i)
        most = std::max(most, double(OrthogonalMatrix<double>::defect(field.rotations(x)[std::size_t(i)])));
    });
    return most;
  };
  double const coarse = drift.operator()<FlatRotation>(Rk4{}, 0.1),
               middle = drift.operator()<FlatRotation>(Rk4{}, 0.05);
  double const fine = drift.operator()<FlatRotation>(Rk4{}, 0.025);
  EXPECT_NEAR(coarse, 7.0e-6, 0.05e-6);
  EXPECT_NEAR(std::log2(coarse / middle), 4, 0.1);
  EXPECT_NEAR(std::log2(middle / fine), 4, 0.1);
  EXPECT_LT(drift.operator()<SO3>(Rkmk4{}, 0.1), 1e-12);
  EXPECT_LT(drift.operator()<SO3>(CommutatorFree4{}, 0.1), 1e-12);
  EXPECT_LT(drift.operator()<S3>(CommutatorFree4{}, 0.1), 1e-12);
}

}  // namespace
}  // namespace polhode
