/// The order of methods for constrained systems in every component, in quadruple precision.
#include <gtest/gtest.h>

#include "integrators/generalized_alpha.hpp"
#include "tests/support/pinned_runs.hpp"

namespace polhode {
namespace {

using test::pinned_top;
using test::PinnedErrors;

// ---- The tableau ----------------------------------------------------------------------------------------------------

using Five = std::array<Quad, 5>;

struct HalfExplicitConditions : testing::Test {
  HalfExplicitTableau<Quad> table;
  Five c{}, b = table.a[4], ones{1, 1, 1, 1, 1};

  HalfExplicitConditions() {
    for (std::size_t i = 0; i < 4; ++i)
      for (Quad const& a : table.a[i]) c[i + 1] += a;
  }
  static Five times(Five const& x, Five const& y) {
    Five z;
    for (std::size_t i = 0; i < 5; ++i) z[i] = x[i] * y[i];
    return z;
  }
  /// The rows of the stages.
  Five A(Five const& x) const {
    Five y{};
    for (std::size_t i = 1; i < 5; ++i)
      for (std::size_t j = 0; j < i; ++j) y[i] += table.a[i - 1][j] * x[j];
    return y;
  }
  /// What the algebraic unknowns see: the inverse of rows 2 .. 6 on the stages 2 .. 5 and the end, x there, 1 at the
  /// end.
  Five W(Five const& x) const {
    Five y{};
    for (std::size_t i = 0; i < 5; ++i) {
      Quad rest = i < 4 ? x[i + 1] : Quad(1);
      for (std::size_t j = 0; j < i; ++j) rest -= table.a[i][j] * y[j];
      y[i] = rest / table.a[i][i];
    }
    return y;
  }
  /// b.x against its exact value.
  void expect(Five const& x, Quad const& exact) const {
    Quad sum = 0;
    for (std::size_t i = 0; i < 5; ++i) sum += b[i] * x[i];
    EXPECT_NEAR(double(sum - exact), 0, 1e-31);
  }
};

TEST_F(HalfExplicitConditions, OfRungeKuttaToOrder4) {
  Five const c2 = times(c, c);
  expect(ones, 1);
  expect(c, Quad(1) / 2);
  expect(c2, Quad(1) / 3);
  expect(A(c), Quad(1) / 6);
  expect(times(c, c2), Quad(1) / 4);
  expect(times(c, A(c)), Quad(1) / 8);
  expect(A(c2), Quad(1) / 12);
  expect(A(A(c)), Quad(1) / 24);
}
TEST_F(HalfExplicitConditions, OfTheMultiplierToOrder4) {
  Five const c2 = times(c, c), w = W(c2);
  expect(times(c, w), Quad(2) / 3);
  expect(times(w, w), Quad(4) / 3);
  expect(times(c, W(times(c, c2))), Quad(3) / 4);
  expect(times(c2, w), Quad(1) / 2);
  expect(times(c, times(w, w)), Quad(1));
  expect(times(w, W(times(c, c2))), Quad(3) / 2);
  expect(times(w, times(w, w)), Quad(2));
  expect(times(A(c), w), Quad(1) / 4);
  expect(A(times(c, w)), Quad(1) / 6);
  expect(A(times(w, w)), Quad(1) / 3);
}

// ---- Order ----------------------------------------------------------------------------------------------------------

constexpr double t_end = 0.125;

/// The state at t_end, in quadruple precision.
template <template <class> class A>
auto const& exact_end() {
  static auto const end = test::pinned_reference(pinned_top<Quad, A>(), t_end);
  return end;
}
template <class Method, template <class> class A>
PinnedErrors errors_at(double h) {
  auto const problem = pinned_top<Quad, A>();
  PinnedErrors errors{};
  EXPECT_EQ(test::run_pinned(problem, Method{}, h, t_end,
                             [&](double, auto const& x, auto const& stepper) {
                               errors = test::errors_of(problem, x, stepper.multiplier(), exact_end<A>());
                             }),
            Status::ok);
  return errors;
}
/// Slopes over two halvings from h = 2^-10 s.
template <class Method, template <class> class A>
void expect_order(double order) {
  PinnedErrors coarse = errors_at<Method, A>(0x1p-10);
  for (double h : {0x1p-11, 0x1p-12}) {
    PinnedErrors const fine = errors_at<Method, A>(h);
    for (std::size_t i = 0; i < fine.size(); ++i)
      EXPECT_NEAR(std::log2(coarse[i] / fine[i]), order, 0.1)
          << Method::info.name << ", " << test::pinned_names[i] << ", h = " << h;
    coarse = fine;
  }
  EXPECT_EQ(Method::info.order, order);
}

TEST(ConstrainedOrder, HalfExplicitIsOfOrder4InAllComponents) {
  expect_order<HalfExplicit4, S3>(4);
}
TEST(ConstrainedOrder, HalfExplicitOnFlatCoordinates) {
  expect_order<HalfExplicit4, FlatQuaternion>(4);
}
TEST(ConstrainedOrder, RattleIsOfOrder2InAllComponents) {
  expect_order<Rattle, S3>(2);
}
TEST(ConstrainedOrder, GeneralizedAlphaIsOfOrder2InAllComponents) {
  expect_order<GeneralizedAlpha, S3>(2);
}

/// The greatest multiplier error on the way, the start included [N].
double transient_error(double h) {
  static auto const problem = pinned_top<Quad, S3>();
  std::vector<Vec3<Quad>> exact;
  EXPECT_EQ(test::run_pinned(problem, HalfExplicit4{}, 0x1p-12, 0x1p-5,
                             [&](double, auto const&, auto const& stepper) { exact.push_back(stepper.multiplier()); }),
            Status::ok);
  double most = 0;
  EXPECT_EQ(test::run_pinned(problem, GeneralizedAlpha{}, h, 0x1p-5,
                             [&](double t, auto const&, auto const& stepper) {
                               Vec3<Quad> const right = exact.at(std::size_t(std::lround(t * 0x1p12)) - 1);
                               most = std::max(most, double(length(stepper.multiplier() - right)));
                             }),
            Status::ok);
  return most;
}
TEST(ConstrainedOrder, GeneralizedAlphaStartsWithoutATransientOfOrder1) {
  double const coarse = transient_error(0x1p-9), middle = transient_error(0x1p-10), fine = transient_error(0x1p-11);
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.2);
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.2);
}

/// Errors of lambda_-, lambda_+ and their mean at 2^-5 s [N].
std::array<double, 3> own_multipliers(double h) {
  auto const problem = pinned_top<Quad, S3>();
  using M = std::decay_t<decltype(problem)>::Space;
  Rattle::Memory<M> memory;
  Rattle::Frame<M> frame;
  auto x = problem.initial();
  for (long i = 0; i < std::lround(0x1p-5 / h); ++i) Rattle{}.step(problem, Quad(0), Quad(h), x, frame, memory);
  Vec3<Quad> const before = memory.before, exact = memory.multiplier;
  Rattle{}.step(problem, Quad(0), Quad(h), x, frame, memory);
  Vec3<Quad> const mean = Quad(0.5) * (before + memory.after);
  return {double(length(before - exact)), double(length(memory.after - exact)), double(length(mean - exact))};
}
TEST(ConstrainedOrder, RattlesOwnMultipliersAreOfOrder1AndTheirMeanOfOrder2) {
  auto const coarse = own_multipliers(0x1p-10), fine = own_multipliers(0x1p-11);
  EXPECT_NEAR(std::log2(coarse[0] / fine[0]), 1, 0.1);
  EXPECT_NEAR(std::log2(coarse[1] / fine[1]), 1, 0.1);
  EXPECT_NEAR(std::log2(coarse[2] / fine[2]), 2, 0.1);
}

}  // namespace
}  // namespace polhode
