/// The heavy top: its published rate, its invariants, and that the body and the constrained system are one motion.
#include "problems/heavy_top.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "integrators/commutator_free.hpp"
#include "integrators/taylor.hpp"
#include "problems/dual.hpp"
#include "problems/formulations.hpp"
#include "tests/support/pinned_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::heavy_top;
using test::in;
using test::pinned_top;

// ---- The published rate ---------------------------------------------------------------------------------------------

/// Printed with ten decimals; its last two are not the solution's.
constexpr double printed = -106.1638041430;
/// What all methods here agree on.
Quad const certified = strtoflt128("-106.1638041431244612238437", nullptr);

using Series = Jet<Quad, 32>;

/// The state at t_end [s] by power series, components in storage order.
template <class P>
std::vector<Quad> end_by_series(P const& problem, Quad const& t_end) {
  auto const start = problem.initial();
  std::vector<Series> components(std::size_t(size_of(start)));
  store(start, components.data());
  std::vector<Quad> x;
  for (Series const& component : components) x.push_back(component[0]);
  for (Quad t = 0; t < t_end;) {
    auto const segment = expand<Quad, 32>(problem, x, t, Quad(t_end - t), 1e-33);
    EXPECT_GT(double(segment.h), 0);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = segment.component[i].at(segment.h);
    t += segment.h;
  }
  return x;
}
/// From quaternion and body rate.
Quad inertial_rate_y(std::vector<Quad> const& x) {
  return (matrix(Quat<Quad>{x[0], x[1], x[2], x[3]}) * Vec3<Quad>{x[4], x[5], x[6]}).y;
}

TEST(HeavyTop, TheBodyTurnsAsPublishedByTwoMethods) {
  auto const x = end_by_series(heavy_top("bruels").field<Series, FlatQuaternion, true>(), 2);
  EXPECT_NEAR(double(inertial_rate_y(x) - certified), 0, 1e-21);

  auto const problem = heavy_top("bruels").field<Quad, S3, true>();
  auto stepper = GaussEntry<4>{}.bind(problem, FixedStep{5e-4}, NormPolicy::none);
  auto y = problem.initial();
  ASSERT_EQ(stepper.advance(y, 0, 2), Status::ok);
  EXPECT_NEAR(double((matrix(y.first) * y.second).y - certified), 0, 1e-12);

  EXPECT_NEAR(double(certified), printed, 1.3e-10);
}

TEST(HeavyTop, TheConstrainedSystemIsTheSameMotion) {
  auto const body = end_by_series(heavy_top("bruels").field<Series, FlatQuaternion, true>(), 0.5);
  auto const system = end_by_series(pinned_top<Series, FlatQuaternion>(), 0.5);
  for (std::size_t i = 0; i < body.size(); ++i) EXPECT_NEAR(double(body[i] - system[i]), 0, 1e-24) << i;

  Mat3<Quad> const R = matrix(Quat<Quad>{body[0], body[1], body[2], body[3]});
  Vec3<Quad> const r{0, 1, 0}, omega{body[4], body[5], body[6]};
  Vec3<Quad> const x = R * r, v = R * cross(omega, r);
  EXPECT_NEAR(double(distance<Quad>(x, {system[7], system[8], system[9]})), 0, 1e-24);
  EXPECT_NEAR(double(distance<Quad>(v, {system[10], system[11], system[12]})), 0, 1e-24);
}

TEST(HeavyTop, TheConstrainedSystemTurnsAsPublished) {
  auto const problem = pinned_top<Quad, S3>();
  auto stepper = GaussEntry<4>{}.bind(problem, FixedStep{1e-3}, NormPolicy::none);
  auto x = problem.initial();
  ASSERT_EQ(stepper.advance(x, 0, 2), Status::ok);
  EXPECT_NEAR(double((matrix(x.first.first) * x.first.second).y - certified), 0, 5e-11);
}

// ---- Invariants and laws --------------------------------------------------------------------------------------------

TEST(HeavyTop, PotentialHasTheBookTorqueAndEnergy) {
  auto const problem = heavy_top("potential").field<double, S3, true>();
  EXPECT_NEAR(distance<double>(problem.start.first, {0.2, 0.4, 0.8, 0.4}), 0, 1e-15);
  Vec3<double> const momentum{0.5 * problem.start.second.x, 0.85 * problem.start.second.y, problem.start.second.z};
  EXPECT_NEAR(distance<double>(momentum, {0.2, 1, 0.4}), 0, 1e-15);

  test::Random random(1);
  Vec3<double> const e3{0, 0, 1};
  for (int trial = 0; trial < 20; ++trial) {
    Quat<double> const q = random.attitude();
    Vec3<double> const omega = random.vector(2), g = to_body(q, e3);
    EXPECT_NEAR(distance<double>(problem.control.torque(0, q, omega), cross(g, e3)), 0, 1e-15);
    double shown[3];
    problem.show({q, omega}, shown);
    double const kinetic = (0.5 * omega.x * omega.x + 0.85 * omega.y * omega.y + omega.z * omega.z) / 2;
    EXPECT_NEAR(shown[0], kinetic + g.z, 1e-14);
  }
}

TEST(HeavyTop, EnergyAndVerticalMomentumAreInvariants) {
  using D = Dual<1>;
  test::Random random(2);
  auto const energy_slope = [&](auto const& problem, Quat<double> const& q, Vec3<double> const& omega) {
    Pair<Quat<D>, Vec3<D>> x{in<D>(q), in<D>(omega)};
    auto const rate = RigidBody<FlatQuaternion<D>>::rate(x, problem(D(0.0), x));
    D s(0.0);
    s.slope[0] = 1;
    add(x, s, rate);
    Vec3<D> const momentum = problem.control.inertia * x.second;
    D const energy =
        0.5 * dot(x.second, momentum) - dot(matrix(x.first) * problem.control.moment, problem.control.gravity);
    return std::max(std::fabs(energy.slope[0]), std::fabs((matrix(x.first) * momentum).z.slope[0]));
  };
  for (int trial = 0; trial < 20; ++trial) {
    Quat<double> const q = random.attitude();
    Vec3<double> const omega = random.vector(3);
    EXPECT_NEAR(energy_slope(heavy_top("bruels").field<D, FlatQuaternion, true>(), q, omega), 0, 1e-12);
    EXPECT_NEAR(energy_slope(heavy_top("potential").field<D, FlatQuaternion, true>(), q, omega), 0, 1e-14);
    auto const skew = heavy_top("bruels", {{"arm", {0.3, -0.7, 0.4}}});
    EXPECT_NEAR(energy_slope(skew.field<D, FlatQuaternion, false>(), q, omega), 0, 1e-12);
  }
}

TEST(HeavyTop, PotentialKeepsItsInvariantsOnTheWay) {
  auto const problem = heavy_top("potential").field<double, S3, true>();
  double start[3], shown[3];
  problem.show(problem.initial(), start);
  auto stepper = GaussEntry<4>{}.bind(problem, FixedStep{0.01}, NormPolicy::none);
  auto x = problem.initial();
  ASSERT_EQ(stepper.advance(x, 0, heavy_top("potential").horizon), Status::ok);
  problem.show(x, shown);
  EXPECT_NEAR(shown[0], start[0], 1e-13);
  EXPECT_NEAR(shown[1], start[1], 1e-13);
}

TEST(HeavyTop, InertiaAboutThePivot) {
  EXPECT_EQ(heavy_top("bruels").body().inertia, (std::vector<double>{15.234375, 0.46875, 15.234375}));
  EXPECT_EQ(heavy_top("potential").body().inertia, (std::vector<double>{0.5, 0.85, 1}));

  Vec3<double> const r{0.3, -0.7, 0.4};
  auto const skew = heavy_top("bruels", {{"arm", {r.x, r.y, r.z}}, {"mass", {2}}});
  EXPECT_FALSE(skew.principal());
  Mat3<double> const J = skew.body().matrix<double>();
  test::Random random(3);
  Vec3<double> const w = random.vector(1), centre{0.234375 * w.x, 0.46875 * w.y, 0.234375 * w.z};
  Vec3<double> const expected = centre + 2 * cross(r, cross(w, r));  // the angular momentum about the pivot
  EXPECT_NEAR(distance<double>(J * w, expected), 0, 1e-15);
}

// ---- The constrained body -------------------------------------------------------------------------------------------

/// A body without symmetry.
template <class S>
PinnedBody<S> skew_body() {
  using R = Real<S>;
  Mat3<R> const J{{R(1.2), R(.1), R(-.2)}, {R(.1), R(.9), R(.05)}, {R(-.2), R(.05), R(1.5)}};
  return {R(2), J, {R(.3), R(-.7), R(.4)}, {R(.5), R(-1), R(-9)}};
}

/// Moves R, x, omega, v for a moment s under lambda: the constraint's derivatives must be those of the formulas.
TEST(PinnedBody, ItsFormulasAreDerivativesOfTheConstraint) {
  using D = Dual<1>;
  D s(0.0);
  s.slope[0] = 1;
  test::Random random(4);
  PinnedBody<double> const body = skew_body<double>();
  PinnedBody<D> const dual = skew_body<D>();
  auto const slope = [](Vec3<D> const& v) { return Vec3<double>{v.x.slope[0], v.y.slope[0], v.z.slope[0]}; };
  for (int trial = 0; trial < 20; ++trial) {
    Mat3<double> R = matrix(random.attitude());
    if (trial % 2 == 1) R.e1 = 1.01 * R.e1 + 0.01 * R.e2;  // nobody holds the orthogonality of nine numbers
    Vec3<double> const x = random.vector(1), v = random.vector(1), omega = random.vector(2);
    Vec3<double> const lambda = random.vector(5);
    auto const a = body.accelerations(R, omega, lambda);
    Mat3<D> turned = in<D>(R);
    add(turned, s, FlatRotation<D>::rate(in<D>(R), in<D>(omega)));
    Vec3<D> const moved = in<D>(x) + s * in<D>(v), faster = in<D>(v) + s * in<D>(a.second);
    Vec3<D> const spun = in<D>(omega) + s * in<D>(a.first);
    EXPECT_NEAR(distance<double>(slope(dual.constraint(turned, moved)), body.constraint_rate(R, omega, v)), 0, 1e-14);
    Vec3<double> const second = slope(dual.constraint_rate(turned, spun, faster));
    EXPECT_NEAR(distance<double>(second, body.constraint_acceleration(R, omega, a)), 0, 1e-13);

    auto const held = body.accelerations(R, omega, body.multiplier(R, omega));
    EXPECT_NEAR(length(body.constraint_acceleration(R, omega, held)), 0, 1e-13);
  }
}

TEST(PinnedBody, ForcesDoNoWorkAlongTheConstraint) {
  test::Random random(5);
  PinnedBody<double> const body = skew_body<double>();
  for (int trial = 0; trial < 20; ++trial) {
    Mat3<double> const R = matrix(random.attitude());
    Vec3<double> const omega = random.vector(2), mu = random.vector(1), v = R * cross(omega, body.arm());
    auto const change = body.impulse(R, mu);
    double const work = dot(omega, body.inertia().J * change.first) + body.mass() * dot(v, change.second);
    EXPECT_NEAR(work, 0, 1e-14);
    Vec3<double> const rate = random.vector(1);
    auto const against = body.impulse(R, body.impulse_against(R, R, rate));
    EXPECT_NEAR(distance<double>(body.constraint_rate(R, against.first, against.second), -1.0 * rate), 0, 1e-14);
  }
}

template <class A, class From, class To>
void expect_equal_rates(From const& quaternion_field, To const& field, Quat<double> const& q, Vec3<double> const& w) {
  auto const pose = [&](auto attitude) {
    Mat3<double> const R = matrix(q);
    Vec3<double> const r{0, 1, 0};
    using Position = Pair<Vec3<double>, Vec3<double>>;
    using Body = Pair<decltype(attitude), Vec3<double>>;
    return Pair<Body, Position>{{attitude, w}, {R * r, R * cross(w, r)}};
  };
  auto const got = field(0, pose(A::from_attitude(q))), expected = quaternion_field(0, pose(q));
  EXPECT_NEAR(distance<double>(got, expected), 0, 1e-12) << A::name;
}

TEST(PinnedField, IsTheSameInEveryFormulationAndThatOfTheBody) {
  test::Random random(6);
  auto const reduced = heavy_top("bruels").field<double, S3, true>();
  auto const flat = pinned_top<double, FlatQuaternion>();
  for (int trial = 0; trial < 10; ++trial) {
    Quat<double> const q = random.attitude();
    Vec3<double> const w = random.vector(5), r{0, 1, 0};
    expect_equal_rates<S3<double>>(flat, pinned_top<double, S3>(), q, w);
    expect_equal_rates<SO3<double>>(flat, pinned_top<double, SO3>(), q, w);
    expect_equal_rates<FlatRotation<double>>(flat, pinned_top<double, FlatRotation>(), q, w);
    auto const rate = flat(0, {{q, w}, {matrix(q) * r, matrix(q) * cross(w, r)}});
    EXPECT_NEAR(distance<double>(rate.first.second, reduced(0, {q, w}).second), 0, 1e-12);
  }
}

TEST(PinnedField, DriftsFromItsConstraintWithoutStabilisation) {
  auto const problem = pinned_top<double, S3>();
  std::vector<double> defects;
  ASSERT_EQ(test::run_pinned(
                problem, CommutatorFree4{}, 5e-4, 2,
                [&](double, auto const& x, auto const&) { defects.push_back(test::defects_of(problem, x).position); }),
            Status::ok);
  EXPECT_GT(defects[999], 1e-6);
  EXPECT_GT(defects.back(), 2 * defects[999]);
}

// ---- The definition -------------------------------------------------------------------------------------------------

TEST(HeavyTopDefinition, SaysWhatItIs) {
  static_assert(Definition<HeavyTop>);
  EXPECT_TRUE(heavy_top("bruels").plain());
  EXPECT_FALSE(heavy_top("dae").plain());
  EXPECT_TRUE(heavy_top("dae").constrained());
  EXPECT_FALSE(heavy_top("bruels").torque_free());
  EXPECT_TRUE(heavy_top("bruels", {{"gravity", {0}}}).torque_free());
  for (char const* word : {"quaternion", "s3", "so3", "rotation"}) EXPECT_EQ(heavy_top("dae").refusal(word), "");
  for (char const* word : {"mrp", "mrp_shadow", "euler"}) {
    EXPECT_THAT(heavy_top("dae").refusal(word), testing::HasSubstr("quaternions and matrices"));
    EXPECT_EQ(heavy_top("bruels").refusal(word), "");
  }
  EXPECT_THROW(heavy_top("bruels", {{"mass", {0}}}), ParameterError);
}

TEST(HeavyTopDefinition, TheChoiceDecidesTheField) {
  with_field<double, S3>(heavy_top("dae"), [](auto const& field) {
    if constexpr (!ConstrainedProblem<std::decay_t<decltype(field)>>) ADD_FAILURE();
  });
  with_field<double, S3>(heavy_top("bruels"), [](auto const& field) {
    if constexpr (ConstrainedProblem<std::decay_t<decltype(field)>>) ADD_FAILURE();
  });
}

TEST(HeavyTopDefinition, ClaimsWhatItShowsAtTwoSeconds) {
  HeavyTop const top = heavy_top("bruels");
  History history;
  for (Column const& column : top.columns()) history.columns.push_back(column.name);
  history.times = {0, 2, 4};
  history.rows = {{0, 0, 0}, {0, 0, printed + 5e-7}, {0, 0, 1}};
  auto const claims = top.claims(history);
  ASSERT_EQ(claims.size(), 1u);
  EXPECT_EQ(claims[0].published, printed);
  EXPECT_EQ(claims[0].holds, true);
  history.rows[1][2] = printed + 2e-6;
  EXPECT_EQ(top.claims(history)[0].holds, false);
  history.times[1] = 2.1;
  EXPECT_TRUE(top.claims(history).empty());
  EXPECT_TRUE(heavy_top("potential").claims(history).empty());
  EXPECT_EQ(heavy_top("dae").columns().size(), 5u);
}

}  // namespace
}  // namespace polhode
