/// Explicit pairs of high order: their orders in quadruple precision, their errors against the tolerance in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "tests/integrators/high_order_pairs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

template <class E>
class HighOrder : public testing::Test {};
TYPED_TEST_SUITE(HighOrder, test::HighOrderPairs);

/// Stiffer and faster than by default: there the pairs are asymptotic long before round-off. On the default slew
/// Verner's 6(5), whose leading terms are small, falls by order 7 and more down to 1e-23.
template <Scalar S>
auto brisk_slew() {
  Choice choice;
  choice.set["k_p"] = {100};
  choice.set["omega0"] = {-0.6, -0.9, 0.3};
  return PdSlew(choice).field<S, FlatQuaternion, true>();
}
/// It at 4 s in 33 digits.
auto const& end_of_slew() {
  static auto const end = test::by_gauss(brisk_slew<Quad>(), 1.0 / 64, 4);
  return end;
}

TEST(BriskSlew, TwoMethodsAgree) {
  auto const series = test::by_taylor(brisk_slew<test::Series>(), 4);
  std::array<Quad, 7> gauss;
  store(end_of_slew(), gauss.data());
  for (std::size_t i = 0; i < 7; ++i) EXPECT_LT(double(fabsq(gauss[i] - series[i])), 1e-31);
}

TYPED_TEST(HighOrder, FallsAsItsOrderSaysInQuadruplePrecision) {
  using Method = typename TypeParam::Method;
  auto const field = brisk_slew<Quad>();
  int const finest = Method::info.order == 6 ? 10 : Method::info.order == 8 ? 6 : 8;
  std::vector<double> errors;
  for (int k = finest - 2; k <= finest; ++k) {
    auto x = field.initial();
    ASSERT_EQ(Method{}.bind(field, FixedStep{std::ldexp(1, -k)}, NormPolicy::none).advance(x, 0, 4), Status::ok);
    errors.push_back(double(distance<Quad>(x, end_of_slew())));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[2]) / 2, Method::info.order, 0.1);
  EXPECT_GT(errors[2], 1e-31) << "round-off: no order to see";
}

TYPED_TEST(HighOrder, ErrorIsProportionalToTheTolerance) {
  using Method = typename TypeParam::Method;
  auto const field = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  static auto const exact = test::by_gauss(FreeBody(Choice{}).field<Quad, FlatQuaternion, true>(), 0.25, 50);
  std::vector<double> ratios;
  for (int digits = 4; digits <= 12; ++digits) {
    double const rtol = std::pow(10, -digits);
    auto x = field.initial();
    auto stepper = Method{}.bind(field, Adaptive{rtol, rtol / 100}, NormPolicy::none);
    ASSERT_EQ(stepper.advance(x, 0, 50), Status::ok);
    std::array<double, 7> got;
    std::array<Quad, 7> wanted;
    store(x, got.data());
    store(exact, wanted.data());
    double error = 0;
    for (std::size_t i = 0; i < 7; ++i) error = std::max(error, double(fabsq(got[i] - wanted[i])));
    ratios.push_back(error / rtol);
  }
  auto const [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  EXPECT_LT(*most / *least, 100);
  EXPECT_LT(*most, 10);
}

}  // namespace
}  // namespace polhode
