/// Spacecraft that synchronise: the field by hand, V' by dual numbers, our reference values by three methods in
/// different formulations, events, orders, raw data and the trap.
#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/quaternion_sync.hpp"

#include <gtest/gtest.h>

#include "problems/dual.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/problems/swarm_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::columns_of;
using test::expect_near;
using test::Random;
using test::run_swarm;
using Words = std::set<std::string>;

Choice chosen(Words const& words) {
  return Choice{.words = words, .set = {}};
}
template <template <class> class A>
auto field_of(Words const& words) {
  return QuaternionSync(chosen(words)).field<double, A, true>();
}
/// One entry for every method: quaternion by Gauss, s3 by a commutator-free method, mrp by Kutta's.
struct Outcome {
  std::string method;
  std::vector<Quat<double>> attitudes;
  std::map<std::string, double> columns;
  std::vector<double> events;
};
template <template <class> class A, class Method>
Outcome outcome(std::string const& name, Words const& words, Method const& method, double h, double t_end) {
  QuaternionSync const definition(chosen(words));
  auto const field = definition.field<double, A, true>();
  auto const run = run_swarm(field, method, h, t_end);
  EXPECT_EQ(run.status, Status::ok) << name;
  Outcome result{
      .method = name, .attitudes = {}, .columns = columns_of(definition, field, run.x), .events = run.events};
  for (int i = 0; i < run.x.count(); ++i) result.attitudes.push_back(A<double>::attitude(run.x[i]));
  return result;
}
std::vector<Outcome> by_three_methods(Words const& words, double t_end) {
  return {outcome<FlatQuaternion>("gauss4", words, Gauss<4>{}, 0.1, t_end),
          outcome<S3>("cf4", words, CommutatorFree4{}, 0.01, t_end), outcome<Mrp>("rk4", words, Rk4{}, 0.005, t_end)};
}

// ---- The field ------------------------------------------------------------------------------------------------------

TEST(SyncField, RatesByHandFromThePrintedData) {
  // Craft 1 hears 2 and 5; craft 3 hears 4. Raw: as printed.
  auto const rates = [](Words const& words) {
    auto const field = field_of<FlatQuaternion>(words);
    auto const x = field.initial();
    Many<Vec3<double>, dynamic> v(5);
    field(0, x, v);
    return std::vector<Vec3<double>>{v[0], v[2]};
  };
  auto const seven = rates({"protocol7", "raw"});
  expect_near(seven[0], {-.2480 - .5211 - 2 * .2934, .3059 + .0775 + 2 * .1556, -.8761 + .8416 - 2 * .7695}, 1e-15);
  expect_near(seven[1], {.7631 + .2558, -.3068 + .7306, .3815 - .5565}, 1e-15);
  // Under (13) the scalar parts of 1, 3 and 5 are negative: 1 sees 2 turned over and 5 not; 3 sees 4 turned over.
  auto const thirteen = rates({"protocol13", "raw"});
  expect_near(thirteen[0], {.2480 - .5211 - 2 * .2934, -.3059 + .0775 + 2 * .1556, .8761 + .8416 - 2 * .7695}, 1e-15);
  expect_near(thirteen[1], {-.7631 + .2558, .3068 + .7306, -.3815 - .5565}, 1e-15);
}

TEST(SyncField, VariantsOfTheInitialData) {
  double const square = .2934 * .2934 + .1556 * .1556 + .7695 * .7695;
  auto const first = [](Words const& words) { return field_of<FlatQuaternion>(words).initial()[0]; };
  Quat<double> const raw = first({"raw"}), normal = first({}), recomputed = first({"recomputed"});
  EXPECT_NEAR(dot(raw, raw) - 1, .1711, 5e-5);
  EXPECT_NEAR(dot(normal, normal), 1, 5e-16);
  EXPECT_NEAR(normal.x / normal.w, .2934 / .6846, 1e-15);
  EXPECT_EQ(recomputed.x, .2934);
  EXPECT_NEAR(recomputed.w, std::sqrt(1 - square), 1e-15);
  EXPECT_NEAR(first({"protocol13", "recomputed"}).w, -std::sqrt(1 - square), 1e-15);
  auto const on_s3 = field_of<S3>({"raw"}).initial();
  EXPECT_NEAR(dot(on_s3[0], on_s3[0]) - 1, .1711, 5e-5);
  std::vector<double> const defects{.1711, -.0292, -.0128, -.0097, -.0053};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(dot(on_s3[i], on_s3[i]) - 1, defects[std::size_t(i)], 5e-5) << i;
}

/// V' = sum p_i q_i.omega_i = -1/2 sum p_i a_ij |r_i - r_j|^2, r_i the vector part times s_i; s_i = 1 under (7).
TEST(SyncField, DerivativeOfVByDualNumbers) {
  using D = Dual<1>;
  Random random(11);
  std::vector<double> const p{.2, .1, .1, .4, .2};
  for (bool signs : {false, true}) {
    QuaternionSync const definition(chosen({signs ? "protocol13" : "protocol7"}));
    auto const field = definition.field<double, FlatQuaternion, true>();
    Graph const& graph = field.graph;
    for (int trial = 0; trial < 20; ++trial) {
      auto x = field.initial();
      for (int i = 0; i < 5; ++i) x[i] = random.attitude();
      Many<Vec3<double>, dynamic> v(5);
      field(0, x, v);
      double expected = 0;
      D V(0.0), s(0.0);
      s.slope[0] = 1;
      for (int i = 0; i < 5; ++i) {
        double const side = signs && x[i].w < 0 ? -1 : 1;
        graph.each_heard(i, [&](int j, double a) {
          double const other = signs && x[j].w < 0 ? -1 : 1;
          Vec3<double> const d = side * vec(x[i]) - other * vec(x[j]);
          expected -= 0.5 * p[std::size_t(i)] * a * dot(d, d);
        });
        Quat<D> moved = test::in<D>(x[i]);
        add(moved, s, test::in<D>(quaternion_rate(x[i], v[i])));
        V += p[std::size_t(i)] * (D(2.0) - 2.0 * moved.w);
      }
      EXPECT_NEAR(V.slope[0], expected, 1e-14) << signs << ", trial " << trial;
      EXPECT_NEAR(columns_of(definition, field, x).at("lyapunov"), V.value, 1e-14);
    }
  }
}

TEST(SyncField, ColumnsByHand) {
  QuaternionSync const definition(chosen({"protocol7"}));
  auto const field = definition.field<double, FlatQuaternion, true>();
  auto x = field.initial();
  for (int i = 0; i < 5; ++i) x[i] = {0, 0, 0, 1};
  x[1] = {1, 0, 0, 0};
  x[3] = {0, .6, 0, -.8};
  auto const columns = columns_of(definition, field, x);
  EXPECT_NEAR(columns.at("disagreement"), std::sqrt(.36 + 1.8 * 1.8), 1e-15);
  EXPECT_NEAR(columns.at("scalar_spread"), 1.8, 1e-15);
  EXPECT_NEAR(columns.at("scalar_min"), -.8, 1e-15);
  EXPECT_NEAR(columns.at("lyapunov"), .1 * 2 + .4 * 3.6, 1e-15);
}

/// Euler's method adds omega h q / 2, which is orthogonal to q: |q|^2 grows by exactly 1 + h^2 |omega|^2 / 4.
TEST(SyncField, ExplicitEulerStretchesTheNormByAKnownFactor) {
  auto const field = field_of<FlatQuaternion>({"protocol7"});
  auto const x = field.initial();
  Many<Vec3<double>, dynamic> v(5);
  field(0, x, v);
  auto const end = run_swarm(field, Explicit<Euler1>{}, 0.1, 0.1).x;
  double most = 0;
  for (int i = 0; i < 5; ++i) {
    double const grown = 1 + 0.01 * dot(v[i], v[i]) / 4;
    EXPECT_NEAR(dot(end[i], end[i]), grown, 1e-15) << i;
    most = std::max(most, grown - 1);
  }
  EXPECT_NEAR(Attitudes<FlatQuaternion<double>>::defect(end), most, 1e-15);
  EXPECT_GT(most, 1e-3);
}

// ---- Our reference values, each by three methods --------------------------------------------------------------------

struct Reference {
  std::string protocol;
  Quat<double> limit;
  double V_start, V_end, disagreement;
  std::vector<double> events;
};
std::vector<Reference> const references{
    {"protocol7", {.157567986615, -.143355710576, .451767621741, .866329894316}, 1.278598, .267340, 2.609e-4, {}},
    {"protocol13",
     {.12842986872, -.149543284727, .463805311646, .863728665556},
     1.972655,
     .272543,
     3.810e-4,
     {.2116516346, .4855026743, 1.0050253857}}};

TEST(SyncReference, LimitsAndEvents) {
  for (Reference const& known : references)
    for (Outcome const& got : by_three_methods({known.protocol}, 60)) {
      for (Quat<double> const& q : got.attitudes)
        EXPECT_LE(distance<double>(q, known.limit), 3e-11) << known.protocol << ", " << got.method;
      ASSERT_EQ(got.events.size(), known.events.size()) << got.method;
      for (std::size_t k = 0; k < known.events.size(); ++k)
        EXPECT_NEAR(got.events[k], known.events[k], 1e-10) << got.method;
    }
}

TEST(SyncReference, ValuesAt20Seconds) {
  for (Reference const& known : references)
    for (Outcome const& got : by_three_methods({known.protocol}, 20)) {
      EXPECT_NEAR(got.columns.at("disagreement"), known.disagreement, 5e-8) << known.protocol << ", " << got.method;
      EXPECT_NEAR(got.columns.at("lyapunov"), known.V_end, 5e-7) << known.protocol << ", " << got.method;
    }
}

TEST(SyncReference, CrossingsAreUpwardsByCraft5Then3Then1) {
  auto const field = field_of<FlatQuaternion>({"protocol13"});
  auto const signs_at = [&](double t) {
    auto const x = run_swarm(field, Gauss<3>{}, t / 16, t).x;
    std::vector<bool> up;
    for (int i = 0; i < 5; ++i) up.push_back(x[i].w > 0);
    return up;
  };
  EXPECT_EQ(signs_at(0.2), (std::vector<bool>{false, true, false, true, false}));
  EXPECT_EQ(signs_at(0.3), (std::vector<bool>{false, true, false, true, true}));
  EXPECT_EQ(signs_at(0.6), (std::vector<bool>{false, true, true, true, true}));
  EXPECT_EQ(signs_at(1.1), (std::vector<bool>{true, true, true, true, true}));
}

/// Fixed steps, nothing located: what RK4 makes of the jumps.
template <class Problem>
auto unlocated_end(Problem const& problem, double h) {
  auto x = problem.initial();
  auto stepper = Rk4{}.bind(problem, FixedStep{h}, NormPolicy::none);
  EXPECT_EQ(stepper.advance(x, 0, 20), Status::ok);
  return x;
}
double error_at_20(Words const& words, double h, bool located) {
  auto const field = field_of<FlatQuaternion>(words);
  auto const exact = run_swarm(field, Gauss<4>{}, 0.05, 20).x;
  auto const x = located ? run_swarm(field, Rk4{}, h, 20).x : unlocated_end(field, h);
  return distance<double>(x, exact);
}

TEST(SyncOrder, Rk4KeepsItsOrderOnlyWhereEventsAreLocated) {
  // From h = .025 on: where steps are cut at events is a matter of chance, which coarser steps feel.
  auto const order = [](Words const& words, bool located) {
    return std::log2(error_at_20(words, 0.025, located) / error_at_20(words, 0.00625, located)) / 2;
  };
  EXPECT_NEAR(order({"protocol7"}, false), 4, 0.2);
  EXPECT_NEAR(order({"protocol13"}, true), 4, 0.2);
  EXPECT_NEAR(error_at_20({"protocol13"}, 0.1, false), 2.2e-3, 1e-4);
  EXPECT_NEAR(error_at_20({"protocol13"}, 0.0125, false), 6e-4, 5e-5);
}

// ---- Raw data, the trap ---------------------------------------------------------------------------------------------

TEST(SyncRaw, VectorsAgreeButScalarsStayApart) {
  for (auto const& run : {outcome<FlatQuaternion>("gauss4", {"raw"}, Gauss<4>{}, 0.1, 60),
                          outcome<S3>("cf4", {"raw"}, CommutatorFree4{}, 0.01, 60)}) {
    for (Quat<double> const& q : run.attitudes)
      EXPECT_LE(distance<double>(vec(q), vec(run.attitudes[0])), 1e-9) << run.method;
    EXPECT_NEAR(run.columns.at("scalar_spread"), 0.111, 5e-4) << run.method;
    EXPECT_NEAR(run.columns.at("disagreement"), 0.111, 5e-4) << run.method;
  }
}

TEST(SyncTrap, Protocol7RestsWithAttitudesApart) {
  for (Outcome const& got : by_three_methods({"protocol7", "trap"}, 20)) {
    EXPECT_NEAR(got.columns.at("disagreement"), std::sqrt(2), 1e-12) << got.method;
    EXPECT_NEAR(double(angle_between(got.attitudes[0], got.attitudes[2])), 3.14159265358979323846, 1e-12)
        << "sqrt(2) on the sphere of quaternions, from q and from -q alike";
  }
}

TEST(SyncTrap, IsASaddle) {
  auto const field = field_of<FlatQuaternion>({"protocol7", "trap"});
  auto x = field.initial();
  x[0] = x[0] * exp_quaternion(Vec3<double>{0, 1e-6, 0});
  double left = 0;
  run_swarm(field, Gauss<3>{}, 0.2, 120, x, [&](double t, auto const& at) {
    if (left == 0 && field.disagreement(at) < 1) left = t;
  });
  EXPECT_GT(left, 40);
  EXPECT_LT(left, 60);
}

TEST(SyncTrap, Protocol13LeavesItAndTwoCraftCrossTogether) {
  for (Outcome const& got : by_three_methods({"protocol13", "trap"}, 60)) {
    for (Quat<double> const& q : got.attitudes)
      EXPECT_LE(distance<double>(q, Quat<double>{.3, -.4, .5, std::sqrt(.5)}), 1e-10) << got.method;
    ASSERT_EQ(got.events.size(), 2u) << got.method;
    EXPECT_NEAR(got.events[0], .998828926193, 1e-10) << got.method;
    EXPECT_EQ(got.events[0], got.events[1]) << got.method;
  }
}

}  // namespace
}  // namespace polhode
