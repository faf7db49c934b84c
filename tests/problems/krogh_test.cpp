/// Numbers that others have printed for rates: Krogh's problem, and the free body of Hairer, Lubich & Wanner.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/runge_kutta.hpp"
#include "problems/dual.hpp"
#include "problems/free_body.hpp"
#include "problems/krogh_b5.hpp"
#include "tests/problems/swarm_runs.hpp"
#include "tests/support/quad_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::by_gauss;
using test::by_taylor;
using test::in;
using Real3 = Vec3<double>;
using Numbers = std::map<std::string, std::vector<double>>;

static_assert(Definition<KroghB5>);
static_assert(std::is_trivially_copyable_v<KroghField<double>>, "or a step cannot keep it in registers");

KroghB5 chosen(Numbers const& set = {}) {
  return KroghB5(Choice{.words = {}, .set = set});
}
template <class S = double>
auto field_of(KroghB5 const& problem) {
  return problem.field<S, FlatQuaternion, true>();
}
Real3 const published{-0.93965707987292035, -0.34211777540007493, 0.74141265961999525};  // y(20)
Vec3<Quad> first_three(std::vector<Quad> const& x) {
  return {x[0], x[1], x[2]};
}
void expect_near(Vec3<Quad> const& a, Real3 const& b, double tolerance, std::string const& by) {
  EXPECT_NEAR(double(a.x), b.x, tolerance) << by;
  EXPECT_NEAR(double(a.y), b.y, tolerance) << by;
  EXPECT_NEAR(double(a.z), b.z, tolerance) << by;
}

// ---- Published numbers ----------------------------------------------------------------------------------------------

// The printed numbers are doubles. They are met to the last bit with m = 51/100, which no double is;
TEST(Krogh, MeetsThePublishedNumbersByThreeMethods) {
  Quad const m = Quad(51) / 100;
  elliptic::Sncndn<Quad> const y = elliptic::Jacobi<Quad>(m, 1 - m)(20);
  Vec3<Quad> const closed{y.sn, y.cn, y.dn};
  Vec3<Quad> const gauss = by_gauss(KroghField<Quad>{m, {0, 1, 1}}, 0.05, 20);
  Vec3<Quad> const taylor = first_three(by_taylor(KroghField<test::Series>{m, {0.0, 1.0, 1.0}}, 20));
  expect_near(closed, published, 0, "the closed form");
  expect_near(gauss, published, 0, "Gauss");
  expect_near(taylor, published, 0, "Taylor");
  EXPECT_LT(double(distance<Quad>(closed, gauss)), 1e-31);
  EXPECT_LT(double(distance<Quad>(closed, taylor)), 1e-31);
}
// with m = 0.51, 9e-18 off, to a unit in the last digit.
TEST(Krogh, SoDoesTheProblem) {
  KroghB5 const problem = chosen();
  Vec3<Quad> const closed = *problem.closed_form(20);
  expect_near(closed, published, 1.2e-16, "the closed form");
  EXPECT_LT(double(distance<Quad>(closed, by_gauss(field_of<Quad>(problem), 0.05, 20))), 1e-31);
  auto const taylor = by_taylor(field_of<test::Series>(problem), 20);
  EXPECT_LT(double(distance<Quad>(closed, first_three(taylor))), 1e-31);
}

/// The body of VII.5, example 5.4: angular momentum (.2, 1, .4) in body axes; the quaternion (.4, .2, .4, .8) is scalar
/// first there. In decimals, which doubles are not.
Real3 const hlw_momentum{0.2372809549886188, 0.9526912271375783, 0.4858777357883199};
template <class S>
auto hlw_body() {
  auto const decimal = [](int hundredths) { return Quad(hundredths) / 100; };
  Vec3<Quad> const J{decimal(50), decimal(85), 1}, omega{decimal(20) / J.x, 1 / J.y, decimal(40) / J.z};
  Quat<Quad> const q{decimal(20), decimal(40), decimal(80), decimal(40)};
  return ControlledBody<S, FlatQuaternion, PrincipalInertia<Quad>, NoTorque<S>>{
      PrincipalInertia<Quad>(J), {}, {in<S>(q), in<S>(omega)}};
}
Vec3<Quad> momentum_of(auto const& body, Vec3<Quad> const& omega) {
  auto const& inverse = body.inertia.inverse;
  return {omega.x / inverse.x, omega.y / inverse.y, omega.z / inverse.z};
}

TEST(HairerLubichWanner, TheFreeBodyMeetsThePublishedMomentumByTwoMethods) {
  auto const gauss = by_gauss(hlw_body<Quad>(), 0.05, 30);
  auto const x = by_taylor(hlw_body<test::Series>(), 30);
  Vec3<Quad> const rate{x[4], x[5], x[6]};
  expect_near(momentum_of(hlw_body<Quad>(), gauss.second), hlw_momentum, 1e-16, "Gauss");
  expect_near(momentum_of(hlw_body<Quad>(), rate), hlw_momentum, 1e-16, "Taylor");
  EXPECT_LT(double(angle_between(gauss.first, {x[0], x[1], x[2], x[3]})), 1e-29);
  EXPECT_LT(double(distance<Quad>(gauss.second, rate)), 1e-29);
}

// Data rounded to doubles move the last digit.
TEST(HairerLubichWanner, SoDoesTheProblemWithItsParameters) {
  FreeBody const problem(Choice{
      .words = {},
      .set = {{"inertia", {0.5, 0.85, 1}}, {"q0", {0.2, 0.4, 0.8, 0.4}}, {"omega0", {0.2 / 0.5, 1 / 0.85, 0.4}}}});
  auto const field = problem.field<Quad, S3, true>();
  expect_near(momentum_of(field, by_gauss(field, 0.1, 30).second), hlw_momentum, 1e-15, "Gauss");
}

// ---- The problem ----------------------------------------------------------------------------------------------------

TEST(Krogh, KeepsItsTwoInvariants) {
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    double const m = random.uniform(0, 1);
    Real3 const y = random.vector(2);
    auto const rate = field_of(chosen({{"m", {m}}}))(0.0, y);
    EXPECT_NEAR(y.x * rate.x + y.y * rate.y, 0, 1e-14);
    EXPECT_NEAR(m * y.x * rate.x + y.z * rate.z, 0, 1e-14);
  }
}

TEST(Krogh, TheClosedFormSolvesItForEveryM) {
  for (double m : {0.0, 1e-9, 0.2, 0.9, 0.999999}) {
    KroghB5 const problem = chosen({{"m", {m}}});
    Vec3<Quad> const gauss = by_gauss(field_of<Quad>(problem), 0.05, 7);
    EXPECT_LT(double(distance<Quad>(*problem.closed_form(7), gauss)), 1e-30) << "m = " << m;
  }
  EXPECT_LT(double(distance<Quad>(*chosen().closed_form(0), {0, 1, 1})), 1e-33);
  EXPECT_FALSE(chosen({{"y0", {0, 1, 2}}}).closed_form(7));
}

TEST(Krogh, DualNumbersGiveTheJacobian) {
  using D = Dual<3>;
  double const m = 0.51;
  Vec3<D> y{0.3, -0.7, 1.1};
  y.x.slope[0] = y.y.slope[1] = y.z.slope[2] = 1;
  Vec3<D> const rate = field_of<D>(chosen())(0.0, y);
  EXPECT_EQ(rate.x.slope, (std::array{0.0, 1.1, -0.7}));
  EXPECT_EQ(rate.y.slope, (std::array{-1.1, 0.0, -0.3}));
  EXPECT_NEAR(rate.z.slope[0], m * 0.7, 1e-16);
  EXPECT_NEAR(rate.z.slope[1], -m * 0.3, 1e-16);
}

TEST(Krogh, RungeKuttaHasOrder4) {
  KroghB5 const problem = chosen();
  auto const field = field_of(problem);
  auto const error = [&](double h) {
    Real3 y = field.initial();
    EXPECT_EQ(Rk4{}.bind(field, FixedStep{h}, NormPolicy::none).advance(y, 0.0, 20.0), Status::ok);
    return double(distance<Quad>(in<Quad>(y), *problem.closed_form(20)));
  };
  EXPECT_NEAR(std::log2(error(0.05) / error(0.025)), 4, 0.15);
}

// ---- Choices and claims ---------------------------------------------------------------------------------------------

TEST(Krogh, RefusesWhatCannotBe) {
  auto const complaint = [](Numbers const& set) { return test::complaint<KroghB5>(Choice{.words = {}, .set = set}); };
  EXPECT_EQ(complaint({{"m", {0}}}), "");
  EXPECT_EQ(complaint({{"m", {1}}}), "parameter m: must be less than 1");
  EXPECT_EQ(complaint({{"m", {-0.1}}}), "parameter m: must not be negative");
  EXPECT_NE(complaint({{"y0", {1, 2}}}), "");
  EXPECT_EQ(chosen().refusal("quaternion"), "");
  EXPECT_NE(chosen().refusal("s3"), "");
}

TEST(Krogh, TheClaimIsThePublishedState) {
  History run{.times = {0, 20}, .columns = {"y1", "y2", "y3"}, .rows = {{0, 1, 1}, {}}};
  Vec3<Quad> const y = *chosen().closed_form(20);
  run.rows[1] = {double(y.x), double(y.y), double(y.z)};
  auto claim = test::claims_of(chosen(), run).at("y_20");
  EXPECT_LT(*claim.value, 3e-16);
  EXPECT_TRUE(*claim.holds);
  run.rows[1][2] += 2e-12;
  claim = test::claims_of(chosen(), run).at("y_20");
  EXPECT_NEAR(*claim.value, 2e-12, 1e-15);
  EXPECT_FALSE(*claim.holds);
  EXPECT_TRUE(chosen({{"m", {0.5}}}).claims(run).empty());
  run.times[1] = 19;
  EXPECT_TRUE(chosen().claims(run).empty());
}

}  // namespace
}  // namespace polhode
