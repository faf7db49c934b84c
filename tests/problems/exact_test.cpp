/// The closed form of the free body against Gauss in quadruple precision, published numbers, its invariants and itself;
/// Jacobi's functions against Boost.Math.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <boost/multiprecision/float128.hpp>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "integrators/gauss.hpp"
#include "problems/exact.hpp"
#include "problems/rigid_body.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::in;
using test::Random;

constexpr double eps = 0x1p-52;
constexpr double degree = BodyParameters::degree;

/// A body, its initial state and a time by which it has shown what it does.
struct Case {
  std::string name;
  Vec3<double> J;
  Vec3<double> omega0;
  double t_end;
  Quat<double> q0{0.227, 0.383, 0.227, 0.866};

  template <class S>
  ExactFreeBody<S> exact() const {
    return {in<S>(J), normalised(in<S>(q0)), in<S>(omega0)};
  }
  /// Radians of the fastest turn until t, and one more: what a rounding error of the data grows to.
  double turned(double t) const {
    Vec3<double> const L{J.x * omega0.x, J.y * omega0.y, J.z * omega0.z};
    return 1 + length(L) * std::fabs(t) / std::min({J.x, J.y, J.z});
  }
};
void PrintTo(Case const& c, std::ostream* out) {
  *out << c.name;
}

std::vector<Case> in_all_orders(Case const& c) {
  std::vector<Case> cases;
  std::array<double, 3> moments{c.J.x, c.J.y, c.J.z};
  std::sort(moments.begin(), moments.end());
  do {
    Case permuted = c;
    permuted.J = {moments[0], moments[1], moments[2]};
    permuted.name += "_" + std::to_string(cases.size());
    cases.push_back(permuted);
  } while (std::next_permutation(moments.begin(), moments.end()));
  return cases;
}

std::vector<Case> all_cases() {
  double const w = 10 * degree;
  std::vector<Case> cases = in_all_orders({"tether", {100, 120, 110}, {w, w, w}, 50});
  // The body of Hairer, Lubich & Wanner, VII.5, example 5.4; their data are scalar first.
  for (Case const& c : in_all_orders({"hlw", {0.5, 0.85, 1}, {0.2 / 0.5, 1 / 0.85, 0.4}, 15, {0.4, 0.2, 0.8, 0.4}}))
    cases.push_back(c);
  // J_z (J_z - J_y) omega_z^2 = J_x (J_y - J_x) omega_x^2 holds in doubles: on the separatrix.
  Vec3<double> const J{1, 2, 2.25};
  cases.push_back({"separatrix", J, {0.75, 0.5, 1}, 15});
  cases.push_back({"separatrix_reversed", J, {-0.75, 0.5, 1}, 15});
  cases.push_back({"separatrix_backwards", {2.25, 2, 1}, {-1, -0.5, -0.75}, 15});
  int number = 0;
  for (double distance : {1e-3, 1e-6, 1e-12})
    for (double side : {1., -1.})
      for (double start : {0.5, -3.})
        cases.push_back(
            {"near_separatrix_" + std::to_string(number++), J, {0.75 * (1 + side * distance), start, -1}, 10});
  cases.push_back({"oblate", {2, 3, 2}, {0.3, 0.7, -0.6}, 15});
  cases.push_back({"oblate_equatorial", {2, 3, 2}, {0.3, 0, -0.6}, 15});
  cases.push_back({"prolate", {3, 3, 2}, {0.3, 0.7, -0.6}, 15});
  cases.push_back({"prolate_equatorial", {2, 3, 3}, {0, 0.7, -0.6}, 15});
  cases.push_back({"almost_oblate", {2, 3, 2 + 1e-12}, {0.3, 0.7, -0.6}, 15});
  cases.push_back({"almost_prolate", {3, 3 - 1e-12, 2}, {0.3, -0.7, 0.6}, 15});
  cases.push_back({"sphere", {3, 3, 3}, {0.3, 0.7, -0.6}, 15});
  cases.push_back({"spin_x", {1, 2, 3}, {-0.9, 0, 0}, 15});
  cases.push_back({"spin_y", {1, 2, 3}, {0, 0.9, 0}, 15});
  cases.push_back({"spin_z", {1, 2, 3}, {0, 0, 0.9}, 15});
  cases.push_back({"spin_z_backwards", {1, 2, 3}, {0, 0, -0.9}, 15});
  cases.push_back({"wobble_x", {1, 2, 3}, {0.9, 1e-9, 1e-8}, 15});
  cases.push_back({"wobble_y", {1, 2, 3}, {1e-9, 0.9, 1e-8}, 15});
  cases.push_back({"wobble_z", {1, 2, 3}, {1e-9, 1e-10, 0.9}, 15});
  cases.push_back({"thin_rod", {0.05, 1, 1.01}, {1, 0.5, 0.3}, 15});
  cases.push_back({"rest", {1, 2, 3}, {0, 0, 0}, 15});
  return cases;
}

std::string name_of(testing::TestParamInfo<Case> const& info) {
  return info.param.name;
}
class FreeMotion : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(All, FreeMotion, testing::ValuesIn(all_cases()), name_of);

// ---- Against Gauss --------------------------------------------------------------------------------------------------

/// 8-stage Gauss on flat quaternions, forwards from (q0, omega0), at `stops` equidistant times up to t_end.
std::vector<ExactFreeBody<Quad>::State> by_gauss(Case const& c, int stops) {
  using Field = ControlledBody<Quad, FlatQuaternion, PrincipalInertia<Quad>, NoTorque<Quad>>;
  Field const field{PrincipalInertia<Quad>(in<Quad>(c.J)), {}, {normalised(in<Quad>(c.q0)), in<Quad>(c.omega0)}};
  double const h = 0.15 / std::max(0.3, length(c.omega0));  // 33 digits need steps of about 0.15 rad
  auto stepper = Gauss<8>{}.bind(field, FixedStep{h}, NormPolicy::none);
  auto x = field.initial();
  std::vector<ExactFreeBody<Quad>::State> states{x};
  for (int k = 0; k < stops; ++k) {
    EXPECT_EQ(stepper.advance(x, c.t_end * k / stops, c.t_end * (k + 1) / stops), Status::ok);
    states.push_back(x);
  }
  return states;
}

TEST_P(FreeMotion, AgreesWithGaussInQuadruplePrecision) {
  Case const& c = GetParam();
  int const stops = 3;
  auto const exact = c.exact<Quad>();
  auto const in_double = c.exact<double>();
  // Backwards: the reversed motion is the motion of the reversed rate.
  Case reversed = c;
  reversed.omega0 = -1.0 * c.omega0;
  for (double direction : {1., -1.}) {
    auto const gauss = by_gauss(direction > 0 ? c : reversed, stops);
    for (int k = 0; k <= stops; ++k) {
      double const t = direction * c.t_end * k / stops;
      auto const expected = gauss[std::size_t(k)];
      Vec3<Quad> const omega = Quad(direction) * expected.second;
      auto const state = exact.at(Quad(t));
      EXPECT_LT(double(angle_between(state.first, expected.first)), 1e-28) << "t = " << t;
      EXPECT_LT(double(length(state.second - omega)), 1e-28) << "t = " << t;
      auto const rounded = in_double.at(t);
      EXPECT_LT(double(angle_between(in<Quad>(rounded.first), expected.first)), 1e-13) << "t = " << t;
      EXPECT_LT(double(length(in<Quad>(rounded.second) - omega)), 1e-13) << "t = " << t;
    }
  }
}

// ---- Against published numbers --------------------------------------------------------------------------------------

// Hairer, Lubich & Wanner, VII.5, example 5.4: angular momentum in body axes.
TEST(ExactFreeBody, MeetsThePublishedMomentum) {
  Quad const one = 1, tenth = one / 10;
  Vec3<Quad> const J{5 * tenth, 17 * one / 20, one};
  ExactFreeBody<Quad> const body(J, {2 * tenth, 4 * tenth, 8 * tenth, 4 * tenth},
                                 {2 * tenth / J.x, one / J.y, 4 * tenth / J.z});
  Vec3<Quad> const omega = body.at(30).second;
  EXPECT_NEAR(double(J.x * omega.x), 0.2372809549886188, 1e-15);
  EXPECT_NEAR(double(J.y * omega.y), 0.9526912271375783, 1e-15);
  EXPECT_NEAR(double(J.z * omega.z), 0.4858777357883199, 1e-15);
}

// Krogh's problem, B5 of the test set DETEST: y = (sn, cn, dn)(t | 0.51).
TEST(Jacobi, SolvesKroghsProblem) {
  auto const y = elliptic::Jacobi<Quad>(Quad(51) / 100, Quad(49) / 100)(20);
  EXPECT_NEAR(double(y.sn), -0.93965707987292035, 2e-16);
  EXPECT_NEAR(double(y.cn), -0.34211777540007493, 2e-16);
  EXPECT_NEAR(double(y.dn), 0.74141265961999525, 2e-16);
  auto const rounded = elliptic::Jacobi<double>(0.51, 0.49)(20);
  EXPECT_NEAR(rounded.sn, -0.93965707987292035, 5e-15);
  EXPECT_NEAR(rounded.cn, -0.34211777540007493, 5e-15);
  EXPECT_NEAR(rounded.dn, 0.74141265961999525, 5e-15);
}

// ---- Jacobi's functions ---------------------------------------------------------------------------------------------

using Boost = boost::multiprecision::float128;

TEST(Jacobi, AgreesWithBoost) {
  for (double m1 : {1., 1 - 1e-14, 1 - 1e-6, 0.9, 0.5, 0.1, 1e-2, 1e-4, 1e-8}) {
    Quad const m = 1 - Quad(m1);
    Boost const modulus = sqrt(Boost(m));
    elliptic::Jacobi<Quad> const quad(m, m1);
    elliptic::Jacobi<double> const rounded(double(m), m1);
    Boost const K = boost::math::ellint_1(modulus);
    EXPECT_LT(std::fabs(double(quad.quarter_period() / K.backend().value() - 1)), m1 < 1e-2 ? 1e-25 : 1e-31) << m1;
    EXPECT_LT(std::fabs(rounded.quarter_period() / double(K) - 1), 1e-15) << m1;
    for (double u : {0., 1e-9, 0.3, 1., 1.6, 2.5, 3.7, 5., 9., -0.7, -4.}) {
      Boost cn, dn;
      Boost const sn = boost::math::jacobi_elliptic(modulus, Boost(u), &cn, &dn);
      auto const far = [&](auto const& value, Boost const& expected) {
        return std::fabs(double(Quad(value) - expected.backend().value()));
      };
      // Boost takes k alone, where m1 has lost digits, and stops its own ladder early.
      double const close = m1 < 1e-2 ? 1e-22 : 1e-29;
      auto const a = quad(Quad(u));
      EXPECT_LT(std::max({far(a.sn, sn), far(a.cn, cn), far(a.dn, dn)}), close) << "u = " << u << ", m1 = " << m1;
      auto const b = rounded(u);
      EXPECT_LT(std::max({far(b.sn, sn), far(b.cn, cn), far(b.dn, dn)}), 4e-15) << "u = " << u << ", m1 = " << m1;
    }
  }
}

TEST(Jacobi, IsHyperbolicAtTheEnd) {
  elliptic::Jacobi<double> const end(1, 0), nearly(1, 1e-30);
  for (double u : {-20., -3., -1e-5, 0., 0.5, 4., 25.}) {
    auto const a = end(u), b = nearly(u);
    EXPECT_NEAR(a.sn, std::tanh(u), 4 * eps);
    EXPECT_NEAR(a.cn, 1 / std::cosh(u), 4 * eps);
    EXPECT_NEAR(b.sn, a.sn, 1e-14) << "u = " << u;
    EXPECT_NEAR(b.cn, a.cn, 1e-14) << "u = " << u;
    EXPECT_NEAR(b.dn, a.dn, 1e-14) << "u = " << u;
  }
}

TEST(Jacobi, ArgumentIsTheInverse) {
  for (double m1 : {1., 0.7, 1e-3, 1e-20}) {
    elliptic::Jacobi<Quad> const jacobi(1 - Quad(m1), m1);
    for (int i = -10; i <= 10; ++i) {
      Quad const u = jacobi.quarter_period() * i / 10;
      auto const j = jacobi(u);
      Quad const dn = sqrt(m1 + jacobi(u).cn * j.cn * (1 - Quad(m1)));  // small ones from their small parts
      EXPECT_LT(std::fabs(double(elliptic::argument_of(j.sn, abs_of(j.cn), dn) - u)), 1e-31 / std::sqrt(m1)) << i;
    }
  }
}

// ---- Invariants -----------------------------------------------------------------------------------------------------

TEST_P(FreeMotion, KeepsEnergyAndMomentumInSpaceForAMillionSeconds) {
  Case const& c = GetParam();
  auto const body = c.exact<double>();
  auto const momentum = [&](Vec3<double> const& w) { return Vec3<double>{c.J.x * w.x, c.J.y * w.y, c.J.z * w.z}; };
  Quat<double> const q0 = normalised(c.q0);
  Vec3<double> const L0 = to_inertial(q0, momentum(c.omega0));
  double const size = length(L0), energy0 = dot(momentum(c.omega0), c.omega0);
  for (double t = -1e6; t < 1.01e6; t += 12345.678) {
    auto const [q, omega] = body.at(t);
    Vec3<double> const L = to_inertial(q, momentum(omega));
    EXPECT_NEAR(dot(q, q), 1, 16 * eps) << "t = " << t;
    EXPECT_NEAR(dot(momentum(omega), omega), energy0, 32 * eps * energy0) << "t = " << t;
    EXPECT_NEAR(length(L), size, 16 * eps * size) << "t = " << t;
    EXPECT_LE(length(L - L0), 32 * eps * size) << "t = " << t;
  }
}

TEST_P(FreeMotion, StartsWhereItWasPut) {
  Case const& c = GetParam();
  auto const state = c.exact<double>().at(0);
  EXPECT_LE(distance<double>(state.first, normalised(c.q0)), 8 * eps);
  EXPECT_LE(distance<double>(state.second, c.omega0), 8 * eps * (c.turned(1) - 1));
}

// ---- The flow -------------------------------------------------------------------------------------------------------

TEST_P(FreeMotion, RestartsOnItsOwnPath) {
  Case const& c = GetParam();
  auto const body = c.exact<Quad>();
  for (auto const& [first, second] : {std::pair(0.3, 0.5), std::pair(0.8, -0.6), std::pair(-0.4, 0.4)}) {
    Quad const t1 = first * c.t_end, t2 = second * c.t_end;
    auto const half_way = body.at(t1);
    auto const restarted = ExactFreeBody<Quad>(in<Quad>(c.J), half_way.first, half_way.second).at(t2);
    auto const expected = body.at(t1 + t2);
    EXPECT_LT(double(angle_between(restarted.first, expected.first)), 1e-28) << first << ", " << second;
    EXPECT_LT(double(length(restarted.second - expected.second)), 1e-28) << first << ", " << second;
  }
}

TEST(ExactFreeBody, KeepsTheNormOfTheAttitudeThatItWasGiven) {
  ExactFreeBody<double> const body({1, 2, 3}, {0.227, 0.383, 0.227, 0.866}, {0.1, 0.2, 0.3});
  Quat<double> const q = body.at(77).first;
  EXPECT_NEAR(dot(q, q), 1 - 2.97e-4, 1e-15);
}

TEST(ExactFreeBody, IsFiniteAtAnyTime) {
  for (Case const& c : all_cases()) {
    auto const body = c.exact<double>();
    for (double t : {1e12, -1e18, 1e30, 1e200}) {
      auto const [q, omega] = body.at(t);
      EXPECT_NEAR(dot(q, q), 1, 1e-14) << c.name << ", t = " << t;
      EXPECT_TRUE(all_finite(omega)) << c.name << ", t = " << t;
    }
  }
}

// ---- Rounding errors ------------------------------------------------------------------------------------------------

/// Errors in double against Quad, in units of eps (1 + |L| t / least moment).
double rounding_units(Case const& c, std::vector<double> const& times) {
  auto const exact = c.exact<Quad>();
  auto const rounded = c.exact<double>();
  double worst = 0;
  for (double t : times) {
    double const error = double(angle_between(in<Quad>(rounded.at(t).first), exact.at(t).first));
    worst = std::max(worst, error / (eps * c.turned(t)));
  }
  return worst;
}
/// How far one unit in the last place of a datum moves the attitude by time t, in the same units; at least 1.
double conditioning(Case const& c, double t) {
  auto const exact = c.exact<Quad>().at(t).first;
  double worst = 1;
  for (int datum = 0; datum < 6; ++datum) {
    Case moved = c;
    std::array<double*, 6> const data{&moved.J.x,      &moved.J.y,      &moved.J.z,
                                      &moved.omega0.x, &moved.omega0.y, &moved.omega0.z};
    double& value = *data[std::size_t(datum)];
    value = std::nextafter(value, 2 * value);
    double const apart = double(angle_between(moved.exact<Quad>().at(t).first, exact));
    worst = std::max(worst, apart / (eps * c.turned(t)));
  }
  return worst;
}

// The bound asks nothing of the conditioning (about 5 units at 1000 s): the data are taken as exact.
TEST(ExactFreeBody, IsExactToRoundOffForAnyBody) {
  unsigned const seed = 1;
  Random random(seed);
  double worst = 0, kappa = 1;
  for (int n = 0; n < 1000; ++n) {
    Vec3<double> const J{random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)};
    Case const c{"random", J, random.vector(1), 1000, random.attitude()};
    double const units = rounding_units(c, {-1000, 1, 30, 333, 1000});
    EXPECT_LT(units, 8) << "seed " << seed << ", body " << n;
    worst = std::max(worst, units);
    if (n % 10 == 0) kappa = std::max(kappa, conditioning(c, 1000));
  }
  RecordProperty("worst_error_in_units", std::to_string(worst));
  RecordProperty("worst_conditioning_in_units", std::to_string(kappa));
}

// Near the separatrix an error of the data is magnified a millionfold and more; the formulas do not magnify.
TEST(ExactFreeBody, LosesNothingNearTheSeparatrix) {
  unsigned const seed = 2;
  Random random(seed);
  for (int n = 0; n < 100; ++n) {
    double const distance = std::pow(10, random.uniform(-15, -1)) * (n % 2 == 0 ? 1 : -1);
    Case const c{"near", {1, 2, 2.25}, {0.75 * (1 + distance), random.uniform(-1, 1), 1}, 1000, random.attitude()};
    EXPECT_LT(rounding_units(c, {-1000, 1, 30, 333, 1000}), 8) << "seed " << seed << ", distance " << distance;
  }
}

}  // namespace
}  // namespace polhode
