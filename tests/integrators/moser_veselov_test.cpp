/// The discrete Moser-Veselov algorithm: order, coefficients, invariants, structure, refusals.
#include "integrators/moser_veselov.hpp"

#include <gtest/gtest.h>

#include "integrators/exact.hpp"
#include "problems/dual.hpp"
#include "problems/mrp.hpp"
#include "tests/integrators/free_body_runs.hpp"
#include "tests/support/lie_group_runs.hpp"

namespace polhode {
namespace {

using test::FreeCase;
using test::in;

constexpr double eps = 0x1p-52;

/// Calls f(method) for each order.
template <class F>
void for_each_order(F f) {
  f(MoserVeselov<2>{});
  f(MoserVeselov<4>{});
  f(MoserVeselov<6>{});
  f(MoserVeselov<8>{});
  f(MoserVeselov<10>{});
}

// ---- Order ----------------------------------------------------------------------------------------------------------

template <template <class> class A, class P>
void expect_orders(P const& problem) {
  auto const exact = test::state_at(Exact{}, problem, 4, 4);
  for_each_order([&](auto method) {
    auto const error = [&](double h) {
      return test::angle_apart<A<Quad>>(test::state_at(method, problem, h, 4), exact);
    };
    double last = error(0.5);
    for (double h : {0.25, 0.125, 0.0625}) {
      double const now = error(h);
      EXPECT_NEAR(test::order_of(last, now), method.info.order, 0.05) << method.info.name << ", h = " << h;
      last = now;
    }
    EXPECT_GT(last, 1e-29) << "round-off: no order to see";
  });
}
TEST(MoserVeselov, HasItsOrder) {
  expect_orders<FlatQuaternion>(FreeCase{}.field<Quad, FlatQuaternion>());
  expect_orders<SO3>(FreeCase{}.field<Quad, SO3>());
}
TEST(MoserVeselov, HasItsOrderWithProductsOfInertia) {
  expect_orders<S3>(test::turned_axes().field_of_matrix<Quad, S3>());
}

// ---- Numbers --------------------------------------------------------------------------------------------------------

// Hairer & Vilmart (2006): s_3, d_3, s_5, d_5, s_7, d_7 in their own symmetric functions, as in the authors' code.
TEST(MoserVeselov, HasThePublishedCoefficients) {
  using R = Quad;
  R const a = 0.6, b = 0.8, c = 1, h = 0.3;
  Vec3<R> const I{a, b, c}, L{0.2, 1, -0.4};
  R const C = dot(L, L) / 2, H = (L.x * L.x / a + L.y * L.y / b + L.z * L.z / c) / 2;
  R const det = a * b * c, S1 = a + b + c, S2 = a * a + b * b + c * c, S3 = a * a * a + b * b * b + c * c * c;
  R const X1 = 1 / a + 1 / b + 1 / c, X2 = 1 / (a * a) + 1 / (b * b) + 1 / (c * c);
  R const X3 = 1 / (a * a * a) + 1 / (b * b * b) + 1 / (c * c * c);
  R const XI = (a + b) / c + (b + c) / a + (c + a) / b;
  R const X12 = (a + b) / (c * c) + (b + c) / (a * a) + (c + a) / (b * b);
  R const X21 = (a * a + b * b) / c + (b * b + c * c) / a + (c * c + a * a) / b;
  R const s3 = S1 / (6 * det) * C - X1 / 3 * H;
  R const d3 = -C / (3 * det) + S1 / (6 * det) * H;
  R const s5 =
      (S2 / det - X1) / (30 * det) * C * C + (1 - XI) / (30 * det) * C * H + (3 * S1 / det + 2 * X2) / 60 * H * H;
  R const d5 =
      -S1 / (60 * det * det) * C * C + (X1 / det / 10 - S2 / (60 * det * det)) * C * H - (9 + XI) / (60 * det) * H * H;
  R const s7 = (4 * det + 17 * S3 - 15 * det * XI) / (2520 * det * det * det) * C * C * C +
               (9 * S1 + 10 * det * X2 - 6 * X21) / (420 * det * det) * C * C * H +
               ((6 * X12 - 100 * X1) * det + 53 * S2) / (2520 * det * det) * C * H * H +
               (15 - det * X3 - 2 * XI) / (630 * det) * H * H * H;
  R const d7 = (34 * det * X1 - 19 * S2) / (2520 * det * det * det) * C * C * C +
               (S3 + 2 * det * XI - 85 * det) / (1260 * det * det * det) * C * C * H +
               (47 * S1 + 13 * X21 - 38 * det * X2) / (2520 * det * det) * C * H * H +
               (9 * det * X1 + det * X12 - 11 * S2) / (1260 * det * det) * H * H * H;
  R const z = h * h;
  R const s[] = {z * s3, z * s3 + z * z * s5, z * s3 + z * z * s5 + z * z * z * s7};
  R const d[] = {z * d3, z * d3 + z * z * d5, z * d3 + z * z * d5 + z * z * z * d7};
  for (std::size_t k = 0; k < 3; ++k) {
    auto const J = modified_moments<R>(I, L, h, std::span(moment_orders).first(k + 1));
    Vec3<R> const expected{1 / ((1 + s[k]) / a + d[k]), 1 / ((1 + s[k]) / b + d[k]), 1 / ((1 + s[k]) / c + d[k])};
    EXPECT_LT(double(distance<R>(J, expected)), 1e-31) << "order " << 2 * k + 4;
  }
}

/// The angle between one step of h with these terms and the exact turn [rad].
double error_of_a_step(double h, std::span<MomentOrder const> terms) {
  Vec3<Quad> const I{60, 120, 90}, omega{0.3, -0.2, 0.25};
  Vec3<Quad> const L{I.x * omega.x, I.y * omega.y, I.z * omega.z};
  Vec3<Quad> c;
  std::int64_t sweeps = 0;
  EXPECT_TRUE(moser_veselov_turn(modified_moments<Quad>(I, L, Quad(h), terms), Quad(h / 2) * L, c, sweeps));
  auto const exact = ExactFreeBody<Quad>(I, {0, 0, 0, 1}, omega).at(h).first;
  return double(angle_between(Quat<Quad>{c.x, c.y, c.z, 1}, exact));
}
// Of every one of them, if it is wrong by one.
TEST(MoserVeselov, NeedsEveryInteger) {
  double const h = 0.5, right = error_of_a_step(h, moment_orders);
  int wrong = 0;
  for (std::size_t k = 0; k < 4; ++k)
    for (bool of_s : {true, false}) {
      std::vector<MomentTerm> terms(of_s ? moment_orders[k].s.begin() : moment_orders[k].d.begin(),
                                    of_s ? moment_orders[k].s.end() : moment_orders[k].d.end());
      for (MomentTerm& term : terms) {
        ++term.integer;
        std::vector<MomentOrder> orders(std::begin(moment_orders), std::end(moment_orders));
        (of_s ? orders[k].s : orders[k].d) = terms;
        EXPECT_GT(error_of_a_step(h, orders), 1.2 * right) << "k = " << k + 1;
        --term.integer;
        ++wrong;
      }
    }
  EXPECT_EQ(wrong, 79);
}

// Hairer, Lubich & Wanner, VII.5, example 5.4: angular momentum in body axes at 30 s.
TEST(MoserVeselov, MeetsThePublishedMomentum) {
  FreeCase const c{
      .kind = "hlw", .inertia = {0.5, 0.85, 1}, .omega0 = {0.4, 1 / 0.85, 0.4}, .q0 = {0.4, 0.2, 0.8, 0.4}};
  auto const omega = test::state_at(MoserVeselov<10>{}, c.field<double, FlatQuaternion>(), 0.05, 30).second;
  EXPECT_NEAR(0.5 * omega.x, 0.2372809549886188, 1e-14);
  EXPECT_NEAR(0.85 * omega.y, 0.9526912271375783, 1e-14);
  EXPECT_NEAR(omega.z, 0.4858777357883199, 1e-14);
}

// ---- Invariants -----------------------------------------------------------------------------------------------------

TEST(MoserVeselov, KeepsEveryInvariantExactlyAtAnyStep) {
  for_each_order([](auto method) {
    EXPECT_LT(test::drift_over(FreeCase{}.field<Quad, FlatQuaternion>(), method, 0.5, 10, 5).worst(), 1e-31)
        << method.info.name;
  });
}
TEST(MoserVeselov, KeepsEveryInvariantForTenThousandSteps) {
  FreeCase const c;
  for_each_order([&](auto method) {
    EXPECT_LT(test::drift_over(c.field<double, FlatQuaternion>(), method, 0.1, 10, 100).worst(), 8 * eps);
    EXPECT_LT(test::drift_over(c.field<double, S3>(), method, 0.1, 10, 100).worst(), 8 * eps);
    EXPECT_LT(test::drift_over(c.field<double, SO3>(), method, 0.1, 10, 100).worst(), 16 * eps);
    EXPECT_LT(test::drift_over(c.field<double, FlatRotation>(), method, 0.1, 10, 100).worst(), 16 * eps);
    EXPECT_LT(test::drift_over(test::turned_axes().field_of_matrix<double, S3>(), method, 0.1, 10, 100).worst(),
              16 * eps);
  });
}
// Round-off is a random walk, and a slow one: with plain sums it reaches 1e-13.
TEST(MoserVeselov, KeepsEveryInvariantForAMillionSteps) {
  FreeCase const tether{.kind = "tether", .inertia = {100, 120, 110}, .omega0 = {0.17453, 0.17453, 0.17453}};
  test::Drift const drift =
      test::drift_over(tether.field<double, FlatQuaternion>(), MoserVeselov<10>{}, 0.1, 100, 1000);
  EXPECT_LT(drift.norm, 16 * eps);
  EXPECT_LT(drift.energy, 16 * eps);
  EXPECT_LT(drift.momentum, 16 * eps);
  EXPECT_LT(drift.direction, 32 * eps);
}
// Every step errs alike here, which is the worst that can be: by a ten-thousandth of round-off.
TEST(MoserVeselov, KeepsTheNormOfASteadySpin) {
  FreeCase const spin{.kind = "spin", .inertia = {1, 2, 3}, .omega0 = {0, 0, 0.7}};
  EXPECT_LT(test::drift_over(spin.field<double, FlatQuaternion>(), MoserVeselov<4>{}, 0.1, 10, 1000).worst(), 1e-13);
}

// ---- Structure ------------------------------------------------------------------------------------------------------

TEST(MoserVeselov, ReturnsToTheStart) {
  for_each_order([](auto method) {
    EXPECT_LT(test::forth_and_back(method, FreeCase{}.field<double, FlatQuaternion>(), 0.1, 1000), 1e-13);
    EXPECT_LT(test::forth_and_back(method, FreeCase{}.field<Quad, FlatQuaternion>(), 0.5, 50), 1e-31);
  });
}

// The multipliers of RATTLE leave  F D - D F^T = h hat(L),  F the turn of the step, D = tr(I) / 2 - I.
TEST(MoserVeselov, OfOrderTwoIsRattle) {
  FreeCase const c;
  auto const field = c.field<Quad, FlatQuaternion>();
  auto const start = field.initial();
  Quad const h = 0.5;
  auto const F = matrix(conj(start.first) * test::state_at(MoserVeselov<2>{}, field, 0.5, 0.5).first);
  Vec3<Quad> const D{75, 15, 45}, L{60 * start.second.x, 120 * start.second.y, 90 * start.second.z};
  EXPECT_LT(std::fabs(double(F.e1.y * D.x - D.y * F.e2.x - h * L.z)), 1e-30);
  EXPECT_LT(std::fabs(double(F.e2.z * D.y - D.z * F.e3.y - h * L.x)), 1e-30);
  EXPECT_LT(std::fabs(double(F.e3.x * D.z - D.x * F.e1.z - h * L.y)), 1e-30);
}

// L -> L' is a Poisson map:  A hat(L) A^T = hat(L'),  A = dL'/dL.
TEST(MoserVeselov, IsAPoissonMap) {
  using D = Dual<3>;
  FreeCase const c;
  for_each_order([&](auto method) {
    auto const field = c.field<D, FlatQuaternion>();
    auto x = field.initial();
    Vec3<double> const I{60, 120, 90}, L = {I.x * c.omega0.x, I.y * c.omega0.y, I.z * c.omega0.z};
    x.second.x.slope[0] = 1 / I.x;
    x.second.y.slope[1] = 1 / I.y;
    x.second.z.slope[2] = 1 / I.z;
    using M = typename decltype(field)::Space;
    typename decltype(method)::template Method<double> const steps{PrincipalAxes<double>(field.inertia_matrix())};
    typename decltype(steps)::template Memory<M> memory;
    typename decltype(steps)::template Frame<M> frame;
    for (double t : {0., 1., 2.}) steps.step(field, D(t), 1.0, x, frame, memory);
    Vec3<D> const omega = x.second;
    auto const row = [](double moment, D const& w) {
      return Vec3<double>{moment * w.slope[0], moment * w.slope[1], moment * w.slope[2]};
    };
    Vec3<double> const a = row(I.x, omega.x), b = row(I.y, omega.y), d = row(I.z, omega.z);
    EXPECT_NEAR(dot(b, cross(L, d)), -I.x * omega.x.value, 1e-9) << method.info.name;
    EXPECT_NEAR(dot(d, cross(L, a)), -I.y * omega.y.value, 1e-9) << method.info.name;
    EXPECT_NEAR(dot(a, cross(L, b)), -I.z * omega.z.value, 1e-9) << method.info.name;
  });
}

// ---- As a stepper ---------------------------------------------------------------------------------------------------

TEST(MoserVeselov, TakesStepsOfAnyLength) {
  auto const field = FreeCase{}.field<Quad, FlatQuaternion>();
  auto stepper = MoserVeselov<10>{}.bind(field, FixedStep{0.1}, NormPolicy::none);
  auto x = field.initial();
  EXPECT_EQ(stepper.one_step(x, 0, 0.05), Status::ok);
  EXPECT_EQ(stepper.advance(x, 0.05, 0.98), Status::ok);
  EXPECT_LT(double(distance<Quad>(x, test::state_at(Exact{}, field, 1, 0.98))), 1e-21);
  EXPECT_GE(stepper.work().iterations.value_or(0), 2 * stepper.work().steps);
}
TEST(MoserVeselov, RestartsFromAStateThatWasChanged) {
  FreeCase other;
  other.omega0 = {-0.4, 0.1, 0.2};
  auto const field = FreeCase{}.field<double, FlatQuaternion>(), changed = other.field<double, FlatQuaternion>();
  auto stepper = MoserVeselov<8>{}.bind(field, FixedStep{0.1}, NormPolicy::none);
  auto x = field.initial();
  stepper.advance(x, 0, 1);
  x = changed.initial();
  stepper.restart();
  stepper.advance(x, 1, 3);
  EXPECT_LT(distance<double>(x, test::state_at(MoserVeselov<8>{}, changed, 0.1, 2)), 1e-15);
}
TEST(MoserVeselov, SaysWhenAStepIsTooLong) {
  auto const field = FreeCase{}.field<double, FlatQuaternion>();
  auto x = field.initial();
  EXPECT_NE((MoserVeselov<2>{}.bind(field, FixedStep{30}, NormPolicy::none).advance(x, 0, 300)), Status::ok);
}
TEST(MoserVeselov, WantsARigidBodyOfQuaternionsOrMatrices) {
  using Method = MoserVeselov<6>;
  EXPECT_EQ(Method::info.needs, Needs::free_body);
  EXPECT_EQ(Method::info.name, "dmv6");
  EXPECT_TRUE((RunsFixed<Method, decltype(FreeCase{}.field<double, FlatRotation>())>));
  EXPECT_FALSE((RunsFixed<Method, decltype(FreeCase{}.field<double, Mrp>())>));
}

}  // namespace
}  // namespace polhode
