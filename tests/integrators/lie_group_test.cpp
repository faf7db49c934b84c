/// Explicit methods on groups: their order conditions to 33 digits, their order where nothing is degenerate, what a
/// wrong coefficient does there.
#include "integrators/lie_group.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/crouch_grossman.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "problems/erased.hpp"
#include "problems/tether_capture.hpp"
#include "tests/integrators/exponential_conditions.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using namespace test;

constexpr double rounding = 1e-32;

// ---- Coefficients ---------------------------------------------------------------------------------------------------

TEST(Forests, AreCountedByCatalansNumbers) {
  EXPECT_EQ(forests(1).size(), 1u);
  EXPECT_EQ(forests(2).size(), 2u);
  EXPECT_EQ(forests(3).size(), 5u);
  EXPECT_EQ(forests(4).size(), 14u);
}

/// The tableau's step has this order and no higher; its c are the sums of its rows.
template <class T>
void expect_order_of_tableau(int order) {
  Scheme const scheme = scheme_of<T>();
  EXPECT_LT(greatest_defect(scheme, T::stages, order), rounding);
  EXPECT_GT(greatest_defect(scheme, T::stages, order + 1), 1e-3);
  for (std::size_t i = 0; i < T::stages; ++i)
    EXPECT_LT(double(fabsq(T::c[i] - weight(scheme, i, Forest{{Forest{}}}))), rounding) << i;
}

TEST(ProductsOfExponentials, MeetEveryConditionOfTheirOrder) {
  expect_order_of_tableau<Cf3Tableau>(3);
  expect_order_of_tableau<Cf4Tableau>(4);
  expect_order_of_tableau<Cg3Tableau>(3);
  expect_order_of_tableau<Cg4Tableau>(4);
}

TEST(ProductsOfExponentials, TheOrderInWhichTheyActMatters) {
  Scheme scheme = scheme_of<Cf4Tableau>();
  std::swap(scheme[4][0], scheme[4][1]);
  EXPECT_GT(greatest_defect(scheme, 4, 4), 1e-3);
  EXPECT_LT(greatest_defect(scheme, 4, 2), rounding) << "classical conditions alone would not see it so soon";
}

/// a_21, a_31, a_32, ..., b_1, ... as a scheme.
Scheme crouch_grossman(std::vector<Quad> const& coefficients) {
  Scheme scheme{{}};
  auto next = coefficients.begin();
  for (std::size_t row : {1, 2, 3, 4, 5}) {
    Factors factors;
    for (std::size_t j = 0; j < row; ++j) {
      factors.emplace_back(row);
      factors.back()[j] = *next++;
    }
    scheme.push_back(factors);
  }
  return scheme;
}
std::vector<Quad> defects_to_order_4(std::vector<Quad> const& coefficients) {
  std::vector<Quad> all;
  for (int order = 1; order <= 4; ++order)
    for (Quad const& d : defects(crouch_grossman(coefficients), 5, order)) all.push_back(d);
  return all;
}

// Newton with the shortest step: residuals in quadruple precision, their derivative and its pseudo-inverse in double.
// Along the solutions, of which there is a plane, that finds the nearest to 1e-30; across, the residual decides.
TEST(CrouchGrossman4, IsTheSolutionNearestToThePrintedDigits) {
  constexpr Decimal digits[]{0.8177227988124852_q, 0.3199876375476427_q,  0.0659864263556022_q, 0.9214417194464946_q,
                             0.4997857776773573_q, -1.0969984448371582_q, 0.3552358559023322_q, 0.2390958372307326_q,
                             1.3918565724203246_q, -1.1092979392113465_q, 0.1370831520630755_q, -0.0183698531564020_q,
                             0.7397813985370780_q, -0.1907142565505889_q, 0.3322195591068374_q};
  std::vector<Quad> printed;
  for (Decimal const& digit : digits) printed.push_back(digit.value);
  std::vector<Quad> z = printed;
  for (int sweep = 0; sweep < 4; ++sweep) {
    std::vector<Quad> const residual = defects_to_order_4(z);
    Eigen::MatrixXd slope(residual.size(), z.size());
    Eigen::VectorXd right(residual.size());
    for (Eigen::Index k = 0; k < slope.cols(); ++k) {
      Quad const step = 1e-12;
      std::vector<Quad> moved = z;
      moved[std::size_t(k)] += step;
      std::vector<Quad> const there = defects_to_order_4(moved);
      for (Eigen::Index i = 0; i < slope.rows(); ++i) {
        auto const at = std::size_t(i);
        slope(i, k) = double((there[at] - residual[at]) / step);
        right(i) = double(residual[at]);
      }
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse;
    inverse.setThreshold(1e-8);
    inverse.compute(slope);
    EXPECT_EQ(inverse.rank(), 13) << "1 + 1 + 3 + 8 conditions of order 4";
    Eigen::VectorXd const change = inverse.solve(right);
    for (std::size_t k = 0; k < z.size(); ++k) z[k] -= Quad(change(Eigen::Index(k)));
  }
  std::size_t k = 0;
  auto const expect_next = [&](Decimal const& coefficient) {
    EXPECT_LT(double(fabsq(coefficient.value - z[k])), 1e-30) << "coefficient " << k;
    EXPECT_LT(double(fabsq(coefficient.value - printed[k])), 1e-16) << "coefficient " << k;
    ++k;
  };
  for (std::size_t i = 1; i < 5; ++i)
    for (std::size_t j = 0; j < i; ++j) expect_next(Cg4Tableau::a[i][j]);
  for (Decimal const& b : Cg4Tableau::b) expect_next(b);
}

// ---- Order ----------------------------------------------------------------------------------------------------------

template <template <class> class A, class Method>
void expect_order_on_the_shaken_body(Method const& method) {
  static auto const problem = erase_type(shaken_body<Quad, A>());
  static auto const exact = by_gauss(*problem, 0.0625, 1);
  auto const error = [&](double h) { return angle_apart<A<Quad>>(state_at(method, *problem, h, 1), exact); };
  EXPECT_NEAR(order_of(error(1. / 64), error(1. / 128)), Method::info.order, 0.1)
      << Method::info.name << " on " << A<Quad>::name;
}

template <template <class> class A, class Method>
void expect_order_on_the_tether(Method const& method) {
  static auto const problem = erase_type(TetherCapture(Choice{}).field<Quad, A, true>());
  static auto const exact = test::tether_after_6_s(Gauss<8>{}, *problem, 0.125);
  auto const error = [&](double h) { return angle_apart<A<Quad>>(test::tether_after_6_s(method, *problem, h), exact); };
  EXPECT_NEAR(order_of(error(1. / 16), error(1. / 32)), Method::info.order, 0.1)
      << Method::info.name << " on " << A<Quad>::name;
}

TEST(LieGroupMethods, HaveTheirOrderWhereNothingIsDegenerate) {
  auto const on_both = [](auto const& method) {
    expect_order_on_the_shaken_body<S3>(method);
    expect_order_on_the_shaken_body<SO3>(method);
    expect_order_on_the_tether<S3>(method);
    expect_order_on_the_tether<SO3>(method);
  };
  on_both(Rkmk2{});
  on_both(Rkmk3{});
  on_both(CommutatorFree3{});
  on_both(CommutatorFree4{});
  on_both(CrouchGrossman3{});
  on_both(CrouchGrossman4{});
}

// ---- A wrong coefficient --------------------------------------------------------------------------------------------

using OneBody = RigidBody<S3<Quad>>;
using Field = Erased<OneBody>;

/// A step of a method whose coefficients are known when it runs; slow and obvious.
/// munthe_kaas: each stage has one exponential, of slopes in the chart; otherwise products of exponentials of slopes
struct RunTimeMethod {
  std::vector<Quad> c;
  Scheme scheme;
  bool munthe_kaas = false;

  Point<OneBody> step(Field const& p, Quad const& t, Quad const& h, Point<OneBody> const& x) const {
    std::vector<Chart<OneBody>> k;
    Point<OneBody> y = x;
    for (std::size_t i = 0; i < scheme.size(); ++i) {
      y = x;
      Chart<OneBody> u = OneBody::centre(x);
      for (Factor const& factor : scheme[i]) {
        u = OneBody::centre(y);
        for (std::size_t j = 0; j < factor.size(); ++j) add(u, Quad(h * factor[j]), k[j]);
        y = OneBody::retract(y, u);
      }
      if (i == c.size()) break;
      auto const v = p(t + c[i] * h, y);
      k.push_back(munthe_kaas ? OneBody::chart_rate(x, u, v) : OneBody::rate(y, v));
    }
    return y;
  }
  Point<OneBody> state_at(Field const& p, double h, double t_end) const {
    auto x = p.initial();
    for (int i = 0; i < std::lround(t_end / h); ++i) x = step(p, i * h, h, x);
    return x;
  }
};
template <class T>
RunTimeMethod run_time_products() {
  return {{std::begin(T::c), std::end(T::c)}, scheme_of<T>()};
}
template <class T>
RunTimeMethod run_time_munthe_kaas() {
  RunTimeMethod method{{}, {{}}, true};
  for (std::size_t i = 0; i < T::stages; ++i) {
    method.c.push_back(T::c[i].template as<Quad>());
    Factor row;
    for (std::size_t j = 0; j < T::stages; ++j)
      row.push_back((i + 1 < T::stages ? T::a[i + 1][j] : T::b[j]).template as<Quad>());
    if (i + 1 < T::stages) row.resize(i + 1);
    method.scheme.push_back({row});
  }
  return method;
}

/// The plain method is the library's; with any one coefficient wrong by .1 its order is lost. `written` says how many
/// coefficients there are.
template <class Method>
void expect_every_coefficient_to_matter(RunTimeMethod const& plain, int written) {
  auto const erased = erase_type(shaken_body<Quad, S3>());
  Field const& problem = *erased;
  auto const exact = by_gauss(problem, 0.0625, 0.5);
  auto const order = [&](RunTimeMethod const& method) {
    auto const error = [&](double h) { return angle_apart<S3<Quad>>(method.state_at(problem, h, 0.5), exact); };
    return order_of(error(1. / 32), error(1. / 64));
  };
  EXPECT_LT(double(distance<Quad>(plain.state_at(problem, 0.125, 0.5), state_at(Method{}, problem, 0.125, 0.5))),
            1e-31);
  EXPECT_NEAR(order(plain), Method::info.order, 0.1);

  int wrong = 0;
  auto const expect_lost = [&](RunTimeMethod const& method) {
    ++wrong;
    EXPECT_LT(order(method), Method::info.order - 0.5) << Method::info.name << ", mutation " << wrong;
  };
  for (std::size_t i = 0; i < plain.scheme.size(); ++i)
    for (std::size_t e = 0; e < plain.scheme[i].size(); ++e)
      for (std::size_t j = 0; j < plain.scheme[i][e].size(); ++j) {
        if (plain.scheme[i][e][j] == 0) continue;
        RunTimeMethod mutant = plain;
        mutant.scheme[i][e][j] += 0.1;
        expect_lost(mutant);
      }
  for (std::size_t i = 1; i < plain.c.size(); ++i) {
    RunTimeMethod mutant = plain;
    mutant.c[i] += 0.1;
    expect_lost(mutant);
  }
  EXPECT_EQ(wrong, written);
}

TEST(LieGroupMethods, AnyWrongCoefficientIsSeen) {
  expect_every_coefficient_to_matter<Rkmk3>(run_time_munthe_kaas<Kutta3>(), 3 + 3 + 2);
  expect_every_coefficient_to_matter<CommutatorFree3>(run_time_products<Cf3Tableau>(), 2 + 3 + 2);
  expect_every_coefficient_to_matter<CommutatorFree4>(run_time_products<Cf4Tableau>(), 5 + 8 + 3);
  expect_every_coefficient_to_matter<CrouchGrossman3>(run_time_products<Cg3Tableau>(), 3 + 3 + 2);
  expect_every_coefficient_to_matter<CrouchGrossman4>(run_time_products<Cg4Tableau>(), 10 + 5 + 4);
}

}  // namespace
}  // namespace polhode
