/// The satellite under the gravity gradient: torque, Jacobi's integral, equilibria, libration, order, two references.
#include "problems/gravity_gradient.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "integrators/commutator_free.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/dual.hpp"
#include "problems/formulations.hpp"
#include "tests/problems/swarm_runs.hpp"
#include "tests/support/quad_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::in;
using test::Random;
using Real3 = Vec3<double>;
using Numbers = std::map<std::string, std::vector<double>>;

constexpr double n = 1.1e-3;  // [rad/s], the default
constexpr double orbit = 2 * 3.14159265358979323846 / n;
std::vector<double> const full_inertia{100, 120, 80, 5, -7, 3};

static_assert(Definition<GravityGradient>);

GravityGradient chosen(Numbers const& set = {}) {
  return GravityGradient(Choice{.words = {}, .set = set});
}
template <class S = double, template <class> class A = FlatQuaternion, bool fast = true>
auto field_of(GravityGradient const& problem) {
  return problem.field<S, A, fast>();
}
static_assert(std::is_trivially_copyable_v<decltype(field_of(chosen()))>, "or a step cannot keep it in registers");

/// A state of any attitude, its rates about as fast as the orbit.
Pair<Quat<double>, Real3> some_state(Random& random) {
  return {random.attitude(), random.vector(2 * n)};
}

// ---- The field ------------------------------------------------------------------------------------------------------

TEST(GravityGradient, TheFieldByItsFormula) {
  Random random(1);
  GravityGradient const problem = chosen({{"inertia", full_inertia}});
  Mat3<double> const J{{100, 5, -7}, {5, 120, 3}, {-7, 3, 80}};
  for (int i = 0; i < 50; ++i) {
    auto const x = some_state(random);
    auto const v = field_of<double, FlatQuaternion, false>(problem)(0.0, x);
    Real3 const nadir = to_body(x.first, Real3{0, 0, 1}), orbital = to_body(x.first, Real3{0, -n, 0});
    Real3 const torque = 3 * n * n * cross(nadir, J * nadir);
    EXPECT_LT(distance<double>(v.first, x.second - orbital), 1e-18);
    EXPECT_LT(distance<double>(J * v.second, cross(J * x.second, x.second) + torque), 1e-17);
  }
}

TEST(GravityGradient, BothFormsOfTheInertiaAgree) {
  Random random(2);
  GravityGradient const problem = chosen();
  auto const fast = field_of(problem);
  auto const full = field_of<double, FlatQuaternion, false>(problem);
  for (int i = 0; i < 50; ++i) {
    auto const x = some_state(random);
    EXPECT_LT(distance<double>(fast(0.0, x).second, full(0.0, x).second), 1e-20);
    EXPECT_NEAR(fast.jacobi(x), full.jacobi(x), 1e-18);
  }
}

/// The attitudes that put body axes along orbital axes: a quarter turn of some of 24.
TEST(GravityGradient, PrincipalAxesAlongTheOrbitAreEquilibria) {
  double const half = std::sqrt(0.5);
  Quat<double> const attitudes[] = {{0, 0, 0, 1},         {1, 0, 0, 0},           {0, 1, 0, 0},
                                    {0, 0, 1, 0},         {half, 0, 0, half},     {0, 0, half, half},
                                    {0.5, 0.5, 0.5, 0.5}, {0.5, -0.5, 0.5, 0.5},  {0, half, 0, half},
                                    {half, half, 0, 0},   {-0.5, 0.5, 0.5, -0.5}, {0, half, half, 0}};
  auto const field = field_of(chosen());
  for (Quat<double> const& q : attitudes) {
    auto const v = field(0.0, {q, to_body(q, Real3{0, -n, 0})});
    EXPECT_LT(largest<double>(v.first), 1e-18);
    EXPECT_LT(largest<double>(v.second), 1e-21);
  }
}

/// d/dt of Jacobi's integral along the field, by a dual number, against the rate at which its terms change.
template <bool fast>
void expect_jacobi_invariant(GravityGradient const& problem) {
  using D = Dual<1>;
  Random random(3);
  D s(0.0);
  s.slope[0] = 1;
  auto const field = field_of<D, FlatQuaternion, fast>(problem);
  for (int i = 0; i < 100; ++i) {
    auto const at = some_state(random);
    Point<RigidBody<FlatQuaternion<D>>> x{in<D>(at.first), in<D>(at.second)};
    auto const v = field(0.0, x);
    add(x, s, RigidBody<FlatQuaternion<D>>::rate(x, v));
    D const jacobi = field.jacobi(x);
    EXPECT_NEAR(jacobi.slope[0] / (n * n * n * 100), 0, 1e-13);
    EXPECT_EQ(jacobi.value, (field_of<double, FlatQuaternion, fast>(problem).jacobi(at)));
  }
}
TEST(GravityGradient, JacobisIntegralIsInvariant) {
  expect_jacobi_invariant<true>(chosen());
  expect_jacobi_invariant<false>(chosen({{"inertia", full_inertia}}));
}

TEST(GravityGradient, EveryFormulationHasTheSameField) {
  Random random(4);
  auto const expected = field_of(chosen());
  for (int i = 0; i < 50; ++i) {
    auto const x = some_state(random);
    auto const wanted = expected(0.0, x);
    [&]<class... F>(Types<F...>) {
      auto const check = [&]<class A>(A, auto const& field) {
        Pair<typename A::Point, Real3> const here{A::from_attitude(x.first), x.second};
        EXPECT_LT(distance<double>(field(0.0, here).first, wanted.first), 1e-16) << A::name;
        EXPECT_LT(distance<double>(field(0.0, here).second, wanted.second), 1e-18) << A::name;
        EXPECT_NEAR(field.jacobi(here), expected.jacobi(x), 1e-16) << A::name;
      };
      (check(typename F::template On<double>{}, field_of<double, F::template On>(chosen())), ...);
    }(Formulations{});
  }
}

// ---- Libration ------------------------------------------------------------------------------------------------------

/// Eigenfrequencies [rad/s] of the field at the identity and rest in orbital axes, by dual numbers in MRPs, ascending.
std::vector<double> frequencies(Numbers const& set) {
  using D = Dual<6>;
  using M = RigidBody<Mrp<D>>;
  Point<M> x{{0.0, 0.0, 0.0}, {0.0, -n, 0.0}};
  std::size_t k = 0;
  Point<M>::each([&](D& a) { a.slope[k++] = 1; }, x);
  auto const rate = M::rate(x, field_of<D, Mrp, false>(chosen(set))(0.0, x));
  Eigen::Matrix<double, 6, 6> jacobian;
  Eigen::Index row = 0;
  Chart<M>::each(
      [&](D const& a) {
        for (Eigen::Index column = 0; column < 6; ++column) jacobian(row, column) = a.slope[std::size_t(column)];
        ++row;
      },
      rate);
  std::vector<double> found;
  for (auto const& value : jacobian.eigenvalues()) {
    EXPECT_NEAR(value.real(), 0, 1e-9 * n);
    if (value.imag() > 0) found.push_back(value.imag());
  }
  std::sort(found.begin(), found.end());
  return found;
}

// Hughes, ch. 9: pitch alone, n sqrt(3 (J1 - J3) / J2); roll and yaw together, omega^4 - (1 + 3 k1 + k1 k3) n^2 omega^2
// + 4 k1 k3 n^4 = 0 with k1 = (J2 - J3) / J1, k3 = (J2 - J1) / J3.
TEST(GravityGradient, LibratesAtTheKnownFrequencies) {
  for (Real3 const& J : {Real3{100, 120, 80}, Real3{10, 12, 3}, Real3{500, 501, 499}}) {
    double const k1 = (J.y - J.z) / J.x, k3 = (J.y - J.x) / J.z, b = 1 + 3 * k1 + k1 * k3;
    double const root = std::sqrt(b * b - 16 * k1 * k3);
    std::vector<double> expected{n * std::sqrt(3 * (J.x - J.z) / J.y), n * std::sqrt((b - root) / 2),
                                 n * std::sqrt((b + root) / 2)};
    std::sort(expected.begin(), expected.end());
    std::vector<double> const found = frequencies({{"inertia", {J.x, J.y, J.z}}});
    ASSERT_EQ(found.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i] / expected[i], 1, 1e-9) << i;
  }
}

TEST(GravityGradient, ASmallPitchSwingsAtItsFrequency) {
  double const swing = 1e-4, quarter = 3.14159265358979323846 / 2 / (n * std::sqrt(3 * 20 / 120.0));
  auto const problem = chosen({{"q0", {0, std::sin(swing / 2), 0, std::cos(swing / 2)}}, {"omega0", {0, -n, 0}}});
  auto const field = field_of(problem);
  auto x = field.initial();
  auto stepper = Rk4{}.bind(field, FixedStep{quarter / 300}, NormPolicy::none);
  ASSERT_EQ(stepper.advance(x, 0.0, quarter), Status::ok);
  EXPECT_NEAR(2 * std::asin(x.first.y) / swing, 0, 1e-8);
  EXPECT_LT(field.nadir_angle(x), 1e-12);
  ASSERT_EQ(stepper.advance(x, quarter, 2 * quarter), Status::ok);
  EXPECT_NEAR(field.nadir_angle(x) / swing, 1, 1e-8);
}

// ---- Runs -----------------------------------------------------------------------------------------------------------

TEST(GravityGradient, TwoMethodsInQuadruplePrecisionAgree) {
  GravityGradient const problem = chosen();
  auto const gauss = test::by_gauss(field_of<Quad, S3>(problem), 20, orbit);
  auto const x = test::by_taylor(field_of<test::Series>(problem), orbit);
  EXPECT_LT(double(angle_between(gauss.first, {x[0], x[1], x[2], x[3]})), 1e-29);
  EXPECT_LT(double(distance<Quad>(gauss.second, {x[4], x[5], x[6]})), 1e-32);
  auto const field = field_of<Quad, S3>(problem);
  EXPECT_LT(std::fabs(double(field.jacobi(gauss) - field.jacobi(field.initial()))), 1e-35);
}

/// Error [rad] of the attitude after a quarter of an orbit in steps of h [s].
template <template <class> class A, class Method>
double error(Method const& method, double h) {
  static Quat<Quad> const reference = test::by_gauss(field_of<Quad, S3>(chosen()), 20, 1440).first;
  auto const field = field_of<Quad, A>(chosen());
  auto x = field.initial();
  EXPECT_EQ(method.bind(field, FixedStep{h}, NormPolicy::none).advance(x, 0, 1440), Status::ok);
  return double(angle_between(A<Quad>::attitude(x.first), reference));
}
TEST(GravityGradient, MethodsOfOrder4HaveIt) {
  auto const order = [](auto error) { return std::log2(error(20.0) / error(10.0)); };
  EXPECT_NEAR(order([](double h) { return error<FlatQuaternion>(Rk4{}, h); }), 4, 0.15);
  EXPECT_NEAR(order([](double h) { return error<FlatRotation>(Rk4{}, h); }), 4, 0.15);
  EXPECT_NEAR(order([](double h) { return error<Mrp>(Rk4{}, h); }), 4, 0.15);
  EXPECT_NEAR(order([](double h) { return error<S3>(CommutatorFree4{}, h); }), 4, 0.15);
  EXPECT_NEAR(order([](double h) { return error<SO3>(CommutatorFree4{}, h); }), 4, 0.15);
  EXPECT_NEAR(order([](double h) { return error<S3>(Rkmk4{}, h); }), 4, 0.15);
}

TEST(GravityGradient, LibratesForSixOrbits) {
  GravityGradient const problem = chosen();
  EXPECT_EQ(problem.horizon, 34300) << "34272 s and a little";
  auto const field = field_of(problem);
  auto stepper = Rk4{}.bind(field, FixedStep{10}, NormPolicy::none);
  auto x = field.initial();
  History run{.times = {}, .columns = {"nadir_angle", "jacobi"}, .rows = {}};
  for (double t = 0; t < problem.horizon; t += 50) {
    std::vector<double> row(problem.columns().size());
    field.show(x, row);
    run.times.push_back(t);
    run.rows.push_back(row);
    ASSERT_EQ(stepper.advance(x, t, t + 50), Status::ok);
  }
  std::vector<double> const angle = run.column("nadir_angle");
  EXPECT_NEAR(angle.front(), 2 * std::asin(std::hypot(0.05, 0.1)), 1e-15);
  EXPECT_LT(*std::max_element(angle.begin(), angle.end()), 0.35) << "the body's z never leaves the nadir";
  auto const claim = test::claims_of(problem, run).at("jacobi_drift");
  EXPECT_LT(*claim.value, 1e-8);
  EXPECT_TRUE(*claim.holds);
}

TEST(GravityGradient, TheClaimSeesADrift) {
  History const run{.times = {0, 1, 2}, .columns = {"jacobi"}, .rows = {{-2}, {-2.1}, {-1.9}}};
  auto const claim = test::claims_of(chosen(), run).at("jacobi_drift");
  EXPECT_NEAR(*claim.value, 0.05, 1e-15);
  EXPECT_FALSE(*claim.holds);
}

TEST(GravityGradient, Parameters) {
  EXPECT_EQ(chosen({{"orbit_rate", {2e-3}}}).horizon, 18900);
  EXPECT_NE(test::complaint<GravityGradient>(Choice{.words = {}, .set = {{"orbit_rate", {0}}}}), "");
  EXPECT_NE(test::complaint<GravityGradient>(Choice{.words = {}, .set = {{"inertia", {1, 2, 4}}}}), "");
  EXPECT_TRUE(chosen().principal());
  EXPECT_FALSE(chosen({{"inertia", full_inertia}}).principal());
  EXPECT_FALSE(chosen().torque_free());
}

}  // namespace
}  // namespace polhode
