/// Problems: fields by hand, inertia in any axes, parameter rules, the slew's control law, announced events.
#include "problems/problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "integrators/gauss.hpp"
#include "problems/catalog.hpp"
#include "tests/problems/chosen_problem.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::expect_near;
using test::in;
using test::Random;

// ---- The catalogue --------------------------------------------------------------------------------------------------

template <class D>
void check_pointing(D const& problem) {
  std::string const& where = D::info().pointing;
  auto const columns = problem.columns();
  bool const is_shown =
      std::ranges::any_of(columns, [&](Column const& c) { return c.name == where && c.unit == "rad"; });
  EXPECT_TRUE(where.empty() || where == angle_of_q || is_shown) << D::info().name << ": " << where;
}
TEST(Catalogue, WherePointingIsFoundExists) {
  [&]<class... D>(Types<D...>) { (check_pointing(D(Choice{})), ...); }(Problems{});
}

// ---- Euler's equation -----------------------------------------------------------------------------------------------

TEST(PrincipalInertia, ByHand) {
  Vec3<double> const J{2, 3, 4}, omega{1, 2, 3}, torque{4, 6, 8};
  PrincipalInertia<double> const body(J);
  expect_near(body.acceleration(omega), {-3, 2, -0.5}, 1e-15);  // (3-4)/2 * 2*3, (4-2)/3 * 3*1, (2-3)/4 * 1*2
  expect_near(body.acceleration(omega, torque), {-1, 4, 1.5}, 1e-15);
  PrincipalInertia<double> const printed(J, -1.0);
  expect_near(printed.acceleration(omega), {3, -2, 0.5}, 1e-15);
  expect_near(printed.acceleration(omega, torque), {5, 0, 2.5}, 1e-15);  // the torque keeps its sign
}

TEST(FullInertia, ByHand) {
  Mat3<double> const J{{2, 1, 0}, {1, 3, 0}, {0, 0, 4}};
  Vec3<double> const omega{1, 0, 1};
  FullInertia<double> const body(J);
  // J omega x omega = (2, 1, 4) x (1, 0, 1) = (1, 2, -1); the inverse is [[.6, -.2, 0], [-.2, .4, 0], [0, 0, .25]].
  expect_near(body.acceleration(omega), {0.2, 0.6, -0.25}, 1e-15);
  expect_near(body.acceleration(omega, Vec3<double>{5, 0, 4}), {3.2, -0.4, 0.75}, 1e-15);
  expect_near(FullInertia<double>(J, -1.0).acceleration(omega), {-0.2, -0.6, 0.25}, 1e-15);
}

TEST(FullInertia, OfADiagonalMatrixIsPrincipal) {
  Random random(1);
  Mat3<double> const J{{100, 0, 0}, {0, 120, 0}, {0, 0, 110}};
  for (int i = 0; i < 100; ++i) {
    Vec3<double> const omega = random.vector(1), torque = random.vector(50);
    expect_near(FullInertia<double>(J).acceleration(omega, torque),
                PrincipalInertia<double>({100, 120, 110}).acceleration(omega, torque), 1e-15);
  }
}

/// A torque fixed in the body.
struct ConstantTorque {
  using Scalar = Quad;
  static constexpr bool sampled = false;
  Vec3<Quad> value;
  Vec3<Quad> torque(Quad const&, Quat<Quad> const&, Vec3<Quad> const&) const { return value; }
};

template <class Problem>
Quat<Quad> attitude_after(Problem const& problem, double t_end) {
  auto x = problem.initial();
  auto stepper = Gauss<8>{}.bind(problem, FixedStep{0.25}, NormPolicy::none);
  EXPECT_EQ(stepper.advance(x, 0, t_end), Status::ok);
  return x.first;
}

TEST(FullInertia, ATurnOfTheBodyAxesIsTheSamePhysics) {
  Quat<Quad> const r = normalised(Quat<Quad>{0.3, -0.4, 0.5, 0.7});  // components in axes B become matrix(r) times them
  Mat3<Quad> const R = matrix(r), J{{100, 0, 0}, {0, 120, 0}, {0, 0, 110}};
  auto const turned = [&](Vec3<Quad> const& column) { return R * (J * transposed_times(R, column)); };
  Mat3<Quad> const J_turned{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})};

  Quat<Quad> const q = normalised(Quat<Quad>{0.227, 0.383, 0.227, 0.866});
  Vec3<Quad> const omega{0.17, -0.2, 0.3}, torque{3, 1, -2};
  using Body = ControlledBody<Quad, S3, PrincipalInertia<Quad>, ConstantTorque>;
  using Turned = ControlledBody<Quad, S3, FullInertia<Quad>, ConstantTorque>;
  Body const body{PrincipalInertia<Quad>({100, 120, 110}), {torque}, {q, omega}};
  Turned const other{FullInertia<Quad>(J_turned), {R * torque}, {q * conj(r), R * omega}};
  EXPECT_LT(double(angle_between(attitude_after(body, 5), attitude_after(other, 5) * r)), 1e-29);
}

TEST(FullInertia, SixNumbersAreXxYyZzXyXzYz) {
  BodyParameters body;
  body.inertia = {1, 2, 3, 0.4, 0.5, 0.6};
  Mat3<double> const J = body.matrix<double>();
  expect_near(J.e1, {1, 0.4, 0.5}, 0);
  expect_near(J.e2, {0.4, 2, 0.6}, 0);
  expect_near(J.e3, {0.5, 0.6, 3}, 0);
  EXPECT_FALSE(body.principal());
}

TEST(FreeBody, ProductsOfInertiaThatAreZeroChangeNothing) {
  auto const end = [](std::vector<double> const& inertia) {
    FreeBody const definition(Choice{.words = {}, .set = {{"inertia", inertia}}});
    auto const field = erase<Quad, S3>(definition);
    return attitude_after(*field, 5);
  };
  EXPECT_LT(double(angle_between(end({100, 120, 110}), end({100, 120, 110, 0, 0, 0}))), 1e-30);
}

TEST(FreeBody, AttitudeMovesByHalfTheProductWithTheRate) {
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto const x = field.initial();
  EXPECT_NEAR(dot(x.first, x.first), 1, 4.5e-16);
  EXPECT_NEAR(x.first.x / x.first.w, 0.227 / 0.866, 1e-15);
  double const rate = 3.14159265358979323846 / 18;
  expect_near(field(0, x).first, {rate, rate, rate}, 1e-16);
  expect_near(field(0, x).second, rate * rate * Vec3<double>{10. / 100, 10. / 120, -20. / 110}, 1e-17);
}

// ---- Parameters -----------------------------------------------------------------------------------------------------

std::string complaint(Parameter parameter, std::vector<double> const& values) {
  std::vector<double> const before = parameter.values();
  std::string const said = test::complaint_of<ParameterError>([&] { parameter.assign(values); });
  EXPECT_EQ(parameter.values(), said.empty() ? values : before) << "a refused value must not stick";
  return said;
}

TEST(Parameters, EveryRuleHasItsMessage) {
  double const inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  double number = 1;
  std::vector<double> three{1, 2, 3};
  Parameter const finite("k", "N", Rule::finite, number), vector("omega0", "rad/s", Rule::finite, three);
  EXPECT_EQ(complaint(finite, {-2}), "");
  EXPECT_EQ(complaint(finite, {nan}), "parameter k: every number must be finite");
  EXPECT_EQ(complaint(finite, {}), "parameter k: takes 1 number(s), not 0");
  EXPECT_EQ(complaint(finite, {1, 2}), "parameter k: takes 1 number(s), not 2");
  EXPECT_EQ(complaint(vector, {1, -inf, 3}), "parameter omega0: every number must be finite");
  EXPECT_EQ(complaint(vector, {1, 2}), "parameter omega0: takes 3 number(s), not 2");

  Parameter const positive("sample_period", "s", Rule::positive, number);
  EXPECT_EQ(complaint(positive, {1e-9}), "");
  EXPECT_EQ(complaint(positive, {0}), "parameter sample_period: must be greater than 0 s");
  EXPECT_EQ(complaint(positive, {-1}), "parameter sample_period: must be greater than 0 s");

  Parameter const non_negative("f_max", "N", Rule::non_negative, number);
  EXPECT_EQ(complaint(non_negative, {0}), "");
  EXPECT_EQ(complaint(non_negative, {-1e-9}), "parameter f_max: must not be negative");
}

TEST(Parameters, AQuaternionMustBeNearlyUnit) {
  std::vector<double> q{0, 0, 0, 1};
  Parameter const parameter("q0", "", Rule::unit_quaternion, q);
  EXPECT_EQ(complaint(parameter, {0.227, 0.383, 0.227, 0.866}), "");
  EXPECT_EQ(complaint(parameter, {0, 0, 0, std::sqrt(1.0199)}), "");
  EXPECT_EQ(complaint(parameter, {0, 0, 0, 2}),
            "parameter q0: |q|^2 must be within 2% of 1 (it is then normalised), not 4.000000");
  EXPECT_EQ(complaint(parameter, {0, 0, 0, std::sqrt(0.9799)}),
            "parameter q0: |q|^2 must be within 2% of 1 (it is then normalised), not 0.979900");
}

TEST(Parameters, AnInertiaMustBelongToABody) {
  std::vector<double> inertia{100, 120, 110};
  Parameter const parameter("inertia", "kg m^2", Rule::inertia, inertia);
  std::string const triangle =
      "parameter inertia: breaks the triangle inequality: no principal moment may exceed the sum of the other two";
  std::string const moments = "parameter inertia: principal moments of inertia must be greater than 0 kg m^2";
  EXPECT_EQ(complaint(parameter, {0.5, 0.85, 1}), "");
  EXPECT_EQ(complaint(parameter, {1, 1, 2}), "") << "a lamina lies on the border";
  EXPECT_EQ(complaint(parameter, {1, 1, 2.01}), triangle);
  EXPECT_EQ(complaint(parameter, {1, 1, 0}), moments);
  EXPECT_EQ(complaint(parameter, {1, -1, 1}), moments);
  EXPECT_EQ(complaint(parameter, {1, 2}), "parameter inertia: takes 3 or 6 number(s), not 2");
  EXPECT_EQ(complaint(parameter, {10, 10, 10, 1, 0, 0}), "") << "principal moments 9, 10, 11";
  EXPECT_EQ(complaint(parameter, {10, 10, 10, 6, 0, 0}), triangle) << "principal moments 4, 10, 16";

  // About n = (2, 1, 2) / 3 the moment `about`, across it 1.
  auto const turned = [](double about) {
    double const more = (about - 1) / 9;
    return std::vector<double>{1 + 4 * more, 1 + more, 1 + 4 * more, 2 * more, 4 * more, 2 * more};
  };
  EXPECT_EQ(complaint(parameter, turned(2)), "") << "a lamina in any axes";
  EXPECT_EQ(complaint(parameter, turned(2 + 1e-9)), triangle);
  EXPECT_EQ(complaint(parameter, turned(1e-9)), "") << "a rod";
  EXPECT_EQ(complaint(parameter, turned(-1e-9)), moments);
}

TEST(Parameters, ProblemsRefuseWhatTheirParametersRefuse) {
  EXPECT_THROW(PdSlew(Choice{.words = {}, .set = {{"k_p", {-1}}}}), ParameterError);
  EXPECT_THROW(TetherCapture(Choice{.words = {}, .set = {{"sample_period", {0}}}}), ParameterError);
  PdSlew changed(Choice{.words = {}, .set = {{"k_d", {7}}, {"omega0", {0, 0, 1}}}});
  std::map<std::string, std::vector<double>> values;
  for (Parameter const& parameter : changed.parameters()) values[parameter.name()] = parameter.values();
  EXPECT_EQ(values.at("k_d"), std::vector<double>{7});
  EXPECT_EQ(values.at("omega0"), (std::vector<double>{0, 0, 1}));
  EXPECT_EQ(values.at("k_p"), std::vector<double>{4}) << "the default";
}

// ---- The slew's control law -----------------------------------------------------------------------------------------

TEST(PdController, ByHand) {
  PdController<double> const law{4, 20};
  Quat<double> const q{0.1, -0.2, 0.3, 0.9};
  Vec3<double> const omega{0.01, 0.02, -0.03}, expected{-0.4 - 0.2, 0.8 - 0.4, -1.2 + 0.6};
  expect_near(law.torque(0, q, omega), expected, 1e-15);
  expect_near(law.torque(0, scaled(-1.0, q), omega), expected, 1e-15, "q and -q are one attitude");
  expect_near(law.torque(0, {1, 0, 0, 0}, {0, 0, 0}), {-4, 0, 0}, 0, "sgn 0 = 1");
}

TEST(PdSlew, SettlesAsDocumented) {
  auto const field = PdSlew(Choice{}).field<double, FlatQuaternion, true>();
  auto x = field.initial();
  auto stepper = Gauss<4>{}.bind(field, FixedStep{0.1}, NormPolicy::none);
  double least = 1;
  for (int i = 0; i < 600; ++i) {
    ASSERT_EQ(stepper.advance(x, 0.1 * i, 0.1 * (i + 1)), Status::ok);
    least = std::min(least, x.first.w);
  }
  EXPECT_GE(least, 0.61);  // the scalar part keeps its sign, so the law is smooth
  EXPECT_NEAR(angle_between(x.first, Quat<double>{0, 0, 0, 1}) * 180 / 3.14159265358979323846, 0.35, 0.005);
}

}  // namespace
}  // namespace polhode
