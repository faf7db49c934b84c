/// Fixed steps: how an interval is divided, what is remembered between calls, Gauss to round-off and its foils, what
/// the methods keep of a free body.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "integrators/catalog.hpp"
#include "problems/catalog.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;

template <template <class> class A>
auto free_body() {
  return FreeBody(Choice{}).field<double, A, true>();
}
template <class X>
bool same_bits(X const& a, X const& b) {
  return distance<double>(a, b) == 0;
}
template <class Method, class P>
auto bound(P const& problem, double h) {
  return Method{}.bind(problem, FixedStep{h}, NormPolicy::none);
}

// ---- Dividing an interval -------------------------------------------------------------------------------------------

TEST(FixedSteps, TheLastIsShortenedIfTheStepDoesNotDivide) {
  auto const field = free_body<FlatQuaternion>();
  auto x = field.initial(), y = x;
  auto whole = bound<Rk4>(field, 0.3), part = bound<Rk4>(field, 0.3), rest = bound<Rk4>(field, 0.1);
  EXPECT_EQ(whole.advance(x, 0, 1), Status::ok);
  EXPECT_EQ(whole.work().steps, 4);
  EXPECT_EQ(part.advance(y, 0, 0.9), Status::ok);
  EXPECT_EQ(part.work().steps, 3);
  EXPECT_EQ(rest.advance(y, 0.9, 1), Status::ok);
  EXPECT_EQ(rest.work().steps, 1);
  EXPECT_LT(distance<double>(x, y), 1e-15);
}

TEST(FixedSteps, AStepLongerThanTheIntervalIsTheInterval) {
  auto const field = free_body<S3>();
  auto x = field.initial(), y = x;
  auto longer = bound<CommutatorFree4>(field, 7), exact = bound<CommutatorFree4>(field, 0.5);
  longer.advance(x, 0, 0.5);
  exact.advance(y, 0, 0.5);
  EXPECT_EQ(longer.work().steps, 1);
  EXPECT_TRUE(same_bits(x, y));
}

template <class Method, class P>
void expect_one_long_advance_equals_many_short(P const& problem, double h) {
  auto x = problem.initial(), y = x;
  auto once = bound<Method>(problem, h), often = bound<Method>(problem, h);
  EXPECT_EQ(once.advance(x, 0, 500 * h), Status::ok);
  for (int i = 0; i < 500; ++i) EXPECT_EQ(often.advance(y, i * h, (i + 1) * h), Status::ok);
  EXPECT_TRUE(same_bits(x, y)) << Method::info.name;
  EXPECT_EQ(once.work().steps, 500) << Method::info.name;
  EXPECT_EQ(often.work().steps, 500) << Method::info.name;
  EXPECT_EQ(once.work().iterations, often.work().iterations) << Method::info.name;
}

TEST(FixedSteps, OneLongAdvanceEqualsManyShortOnesToTheLastBit) {
  auto const slew = PdSlew(Choice{}).field<double, FlatQuaternion, true>();
  auto const slew_on_group = PdSlew(Choice{}).field<double, S3, true>();
  for (double h : {0.1, 0.125}) {
    expect_one_long_advance_equals_many_short<Rk4>(slew, h);
    expect_one_long_advance_equals_many_short<Dopri5>(slew, h);
    expect_one_long_advance_equals_many_short<GaussEntry<2>>(slew, h);
    expect_one_long_advance_equals_many_short<Gauss2Tol6>(slew, h);
    expect_one_long_advance_equals_many_short<Rkmk4>(slew_on_group, h);
    expect_one_long_advance_equals_many_short<CommutatorFree4>(slew_on_group, h);
    expect_one_long_advance_equals_many_short<GaussEntry<2>>(slew_on_group, h);
  }
}

TEST(FixedSteps, RestartForgetsEverything) {
  auto const field = free_body<FlatQuaternion>();
  auto x = field.initial(), kept = x;
  auto restarted = bound<GaussEntry<2>>(field, 0.1), going_on = bound<GaussEntry<2>>(field, 0.1);
  restarted.advance(x, 0, 5);
  going_on.advance(kept, 0, 5);
  auto fresh_x = x;
  restarted.restart();
  auto fresh = bound<GaussEntry<2>>(field, 0.1);
  restarted.advance(x, 5, 10);
  fresh.advance(fresh_x, 5, 10);
  going_on.advance(kept, 5, 10);
  EXPECT_TRUE(same_bits(x, fresh_x));
  EXPECT_FALSE(same_bits(x, kept)) << "what rounding took at 5 s must be carried over when nothing happened";
  EXPECT_LT(distance<double>(x, kept), 1e-14);
}

/// x' = x^2 leaves every bound at 1 s.
struct Escape {
  using Space = Euclidean3<double>;
  Vec3<double> operator()(double, Vec3<double> const& x) const { return {x.x * x.x, 0, 0}; }
  Vec3<double> initial() const { return {1, 0, 0}; }
};

TEST(FixedSteps, AStateThatIsNotFiniteHasDiverged) {
  Escape const problem;
  Vec3<double> x = problem.initial();
  auto stepper = bound<Rk4>(problem, 0.1);
  EXPECT_EQ(stepper.advance(x, 0, 5), Status::diverged);
  EXPECT_FALSE(all_finite(x));
}

// ---- Gauss ----------------------------------------------------------------------------------------------------------

/// Greatest drifts of norm and energy over 10^4 steps of 0.5 s.
template <int s>
void expect_round_off_only() {
  auto const field = free_body<FlatQuaternion>();
  auto x = field.initial();
  auto stepper = bound<GaussEntry<s>>(field, 0.5);
  auto const energy = [&] {
    Vec3<Quad> const w = test::in<Quad>(x.second);
    return (100 * w.x * w.x + 120 * w.y * w.y + 110 * w.z * w.z) / 2;
  };
  Quad const start = energy();
  double norm_drift = 0, energy_drift = 0;
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(stepper.advance(x, 0.5 * i, 0.5 * (i + 1)), Status::ok);
    norm_drift = std::max(norm_drift, double(S3<Quad>::defect(test::in<Quad>(x.first))));
    energy_drift = std::max(energy_drift, double(fabsq(energy() / start - 1)));
  }
  EXPECT_LT(norm_drift, 1e-14) << s << " stages";
  EXPECT_LT(energy_drift, 2e-14) << s << " stages";
}

TEST(Gauss, KeepsNormAndEnergyToRoundOffOverTenThousandSteps) {
  expect_round_off_only<2>();
  expect_round_off_only<3>();
  expect_round_off_only<4>();
}

/// Goes 100 steps forth and back; returns how far from the start it ends.
template <class Method, class P>
double forth_and_back(P const& problem, double h) {
  auto const start = problem.initial();
  auto x = start;
  EXPECT_EQ(bound<Method>(problem, h).advance(x, 0, 100 * h), Status::ok);
  EXPECT_GT(distance<double>(x, start), 0.1);
  EXPECT_EQ(bound<Method>(problem, -h).advance(x, 100 * h, 0), Status::ok);
  return distance<double>(x, start);
}

TEST(Gauss, IsSymmetricInTimeOnFlatCoordinates) {
  auto const field = free_body<FlatQuaternion>();
  EXPECT_LT(forth_and_back<GaussEntry<1>>(field, 0.5), 1e-13);
  EXPECT_LT(forth_and_back<GaussEntry<2>>(field, 0.5), 1e-13);
  EXPECT_LT(forth_and_back<GaussEntry<4>>(field, 0.5), 1e-13);
  EXPECT_GT(forth_and_back<Rk4>(field, 0.5), 1e-9) << "an explicit method is not: the test can tell";
}

// The chart is centred where the step begins; the midpoint rule does not see that, more stages do.
TEST(Gauss, OnAGroupOnlyTheMidpointRuleIsSymmetric) {
  auto const field = free_body<S3>();
  EXPECT_LT(forth_and_back<GaussEntry<1>>(field, 0.5), 1e-13);
  EXPECT_GT(forth_and_back<GaussEntry<2>>(field, 0.5), 1e-11);
  EXPECT_LT(forth_and_back<GaussEntry<2>>(field, 0.5), 1e-8);
}

/// Two stages, k_1 = k_2 = f(y), `sweeps` Jacobi sweeps, written out on plain numbers.
std::array<double, 7> gauss2_by_hand(std::array<double, 7> const& y, double h, int sweeps) {
  auto const f = [](std::array<double, 7> const& v) {
    auto const [x, yy, z, w, p, q, r] = v;
    return std::array<double, 7>{(w * p + yy * r - z * q) / 2,
                                 (w * q + z * p - x * r) / 2,
                                 (w * r + x * q - yy * p) / 2,
                                 -(x * p + yy * q + z * r) / 2,
                                 10. / 100 * q * r,
                                 10. / 120 * r * p,
                                 -20. / 110 * p * q};
  };
  double const root = std::sqrt(3.) / 6;
  auto k1 = f(y), k2 = k1;
  auto const stage = [&](double a1, double a2) {
    std::array<double, 7> u = y;
    for (std::size_t i = 0; i < 7; ++i) u[i] += h * (a1 * k1[i] + a2 * k2[i]);
    return f(u);
  };
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    auto const new1 = stage(0.25, 0.25 - root), new2 = stage(0.25 + root, 0.25);
    k1 = new1;
    k2 = new2;
  }
  std::array<double, 7> next = y;
  for (std::size_t i = 0; i < 7; ++i) next[i] += h / 2 * (k1[i] + k2[i]);
  return next;
}

template <class Method>
void expect_by_hand(int sweeps) {
  auto const field = free_body<FlatQuaternion>();
  auto x = field.initial();
  std::array<double, 7> before{}, after{};
  store(x, before.data());
  auto stepper = bound<Method>(field, 0.5);
  EXPECT_EQ(stepper.advance(x, 0, 0.5), Status::ok);
  store(x, after.data());
  auto const expected = gauss2_by_hand(before, 0.5, sweeps);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(after[i], expected[i], 4e-16) << Method::info.name << ", " << i;
  EXPECT_EQ(stepper.work().iterations, sweeps) << Method::info.name;
}

TEST(UnconvergedGauss, IsTheFormulaByHand) {
  expect_by_hand<Gauss2Sweeps1>(1);
  expect_by_hand<Gauss2Sweeps2>(2);
}

TEST(UnconvergedGauss, ConvergesToGaussWithManySweeps) {
  auto const field = free_body<FlatQuaternion>();
  auto x = field.initial();
  std::array<double, 7> before{}, after{};
  store(x, before.data());
  bound<GaussEntry<2>>(field, 0.5).advance(x, 0, 0.5);
  store(x, after.data());
  auto const expected = gauss2_by_hand(before, 0.5, 50);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(after[i], expected[i], 4e-16) << i;
}

// ---- The angular momentum in space ----------------------------------------------------------------------------------

/// Greatest change of the angular momentum in space, relative, over 50 s of the torque-free target.
double momentum_drift(std::string const& variant, double h) {
  auto const run = a_cell("tether_capture", "quaternion", "gauss2").of_variant(variant).with_h(h).simulated(0.5);
  EXPECT_EQ(run.status, results::Status::ok);
  auto const momentum = [](std::vector<double> const& row) {
    Quat<double> const q = normalised(Quat<double>{row[0], row[1], row[2], row[3]});
    return to_inertial(q, Vec3<double>{100 * row[4], 120 * row[5], 110 * row[6]});
  };
  Vec3<double> const start = momentum(run.history.rows.front());
  double worst = 0;
  for (auto const& row : run.history.rows) worst = std::max(worst, length(momentum(row) - start) / length(start));
  return worst;
}

TEST(AngularMomentum, DecidesTheSignOfThePapersEquation) {
  EXPECT_LT(momentum_drift("free", 0.05), 1e-9);
  EXPECT_GT(momentum_drift("free,as_printed", 0.05), 0.2);
}

TEST(AngularMomentum, Gauss2KeepsItsLengthAndLosesItsDirectionAtOrderFour) {
  std::vector<double> direction;
  for (double h : {0.5, 0.25, 0.125}) {
    auto const record = a_cell("free_body", "quaternion", "gauss2").with_h(h).measured().record;
    EXPECT_LT(*record.momentum_drift_max, 1e-12);
    EXPECT_LT(*record.energy_drift_max, 1e-12);
    direction.push_back(*record.momentum_direction_max);
  }
  EXPECT_GT(direction.back(), 1e-10) << "an error above round-off, or there is no order to see";
  EXPECT_NEAR(std::log2(direction[0] / direction[1]), 4, 0.1);
  EXPECT_NEAR(std::log2(direction[1] / direction[2]), 4, 0.1);
}

}  // namespace
}  // namespace polhode
