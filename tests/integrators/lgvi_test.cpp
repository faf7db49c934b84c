/// The variational integrator under torques: order, symmetry, what a potential leaves unchanged.
#include "integrators/lgvi.hpp"

#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "integrators/lie_group.hpp"
#include "problems/free_body.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using namespace test;

/// A weight on an arm: torque = arm x weight in body axes.
template <Scalar S>
struct Weight {
  using Scalar = S;
  static constexpr bool sampled = false, feels_rate = false;
  Vec3<S> arm{S(0.3), S(-0.2), S(0.9)};                           ///< [m]
  static Vec3<S> weight() { return {S(0.0), S(0.0), S(-20.0)}; }  ///< [N, inertial]
  Vec3<S> torque(S const&, Quat<S> const& q, Vec3<S> const&) const { return cross(arm, to_body(q, weight())); }
  S energy(Quat<S> const& q) const { return -dot(arm, to_body(q, weight())); }
};
template <class S, template <class> class A>
auto heavy_body() {
  return controlled_body<S, A, true>(BodyParameters{}, Weight<S>{});
}
Vec3<double> momentum(Vec3<double> const& w) {
  return {100 * w.x, 120 * w.y, 110 * w.z};
}

template <template <class> class A>
double order_on(auto const& problem) {
  auto const exact = by_gauss(problem, 0.0625, 1);
  auto const error = [&](double h) { return angle_apart<A<Quad>>(state_at(LieVariational2{}, problem, h, 1), exact); };
  return order_of(error(1. / 64), error(1. / 128));
}

TEST(Lgvi, HasOrder2UnderTorquesOfEveryKind) {
  EXPECT_NEAR(order_on<S3>(heavy_body<Quad, S3>()), 2, 0.05);
  EXPECT_NEAR(order_on<SO3>(heavy_body<Quad, SO3>()), 2, 0.05);
  EXPECT_NEAR(order_on<S3>(shaken_body<Quad, S3>()), 2, 0.05);
  EXPECT_NEAR(order_on<FlatQuaternion>(shaken_body<Quad, FlatQuaternion>()), 2, 0.05);
  BodyParameters tilted;
  tilted.inertia = {100, 120, 110, 5, -3, 4};
  EXPECT_NEAR(order_on<S3>(controlled_body<Quad, S3, false>(tilted, Weight<Quad>{})), 2, 0.05);
}

TEST(Lgvi, HasOrder2UnderSampledControl) {
  auto const after_6_s = [](auto const& method, double h) {
    auto problem = TetherCapture(Choice{}).field<Quad, S3, true>();
    return test::tether_after_6_s(method, problem, h);
  };
  auto const exact = after_6_s(Gauss<8>{}, 0.125);
  auto const error = [&](double h) { return angle_apart<S3<Quad>>(after_6_s(LieVariational2{}, h), exact); };
  EXPECT_NEAR(order_of(error(1. / 32), error(1. / 64)), 2, 0.05);
}

TEST(Lgvi, OfAFreeBodyIsDiscreteMoserVeselov) {
  auto const problem = FreeBody(Choice{}).field<double, S3, true>();
  EXPECT_EQ(
      distance<double>(state_at(LieVariational2{}, problem, 0.25, 50), state_at(MoserVeselov<2>{}, problem, 0.25, 50)),
      0);
}

TEST(Lgvi, IsSymmetricInTime) {
  EXPECT_LT(forth_and_back(LieVariational2{}, heavy_body<double, S3>(), 0.25, 200), 1e-12);
  EXPECT_LT(forth_and_back(LieVariational2{}, heavy_body<double, SO3>(), 0.25, 200), 1e-12);
  EXPECT_LT(forth_and_back(LieVariational2{}, shaken_body<double, S3>(), 0.25, 40), 1e-12);
}

/// Greatest changes under a weight over some seconds in steps of h [s]: of the energy, relative; of the vertical
/// angular momentum, relative to |L|.
struct Drifts {
  double energy = 0, vertical = 0;
};
Drifts drifts_of(auto const& method, double h, int seconds) {
  auto const problem = heavy_body<double, S3>();
  auto x = problem.initial();
  auto stepper = method.bind(problem, FixedStep{h}, NormPolicy::none);
  auto const energy = [&] { return dot(momentum(x.second), x.second) / 2 + problem.control.energy(x.first); };
  auto const vertical = [&] { return to_inertial(x.first, momentum(x.second)).z; };
  double const energy_0 = energy(), vertical_0 = vertical(), size = length(momentum(x.second));
  Drifts worst;
  for (int i = 0; i < seconds; ++i) {
    EXPECT_EQ(stepper.advance(x, i, i + 1), Status::ok);
    worst.energy = std::max(worst.energy, std::fabs(energy() / energy_0 - 1));
    worst.vertical = std::max(worst.vertical, std::fabs(vertical() - vertical_0) / size);
  }
  return worst;
}

TEST(Lgvi, KeepsTheVerticalMomentumUnderAWeight) {
  EXPECT_LT(drifts_of(LieVariational2{}, 0.25, 5000).vertical, 1e-13);
  EXPECT_GT(drifts_of(Rkmk2{}, 0.25, 500).vertical, 1e-4) << "the test can tell";
}

TEST(Lgvi, ItsEnergyErrorIsBoundedUnderAWeight) {
  double const early = drifts_of(LieVariational2{}, 0.25, 500).energy;
  EXPECT_LT(drifts_of(LieVariational2{}, 0.25, 5000).energy, 1.1 * early);
  EXPECT_NEAR(drifts_of(LieVariational2{}, 0.125, 500).energy / early, 0.25, 0.02);
  EXPECT_GT(drifts_of(Rkmk2{}, 0.25, 5000).energy, 5 * drifts_of(Rkmk2{}, 0.25, 500).energy) << "the test can tell";
}

TEST(Lgvi, FailsOpenlyWhereTheStepIsTooLong) {
  auto const problem = shaken_body<double, S3>();
  auto x = problem.initial();
  Status const status = LieVariational2{}.bind(problem, FixedStep{60}, NormPolicy::none).advance(x, 0, 120);
  EXPECT_TRUE(status == Status::nonlinear_fail || status == Status::diverged);
}

TEST(Lgvi, AllocatesNothing) {
  auto const problem = shaken_body<double, SO3>();
  auto x = problem.initial();
  auto stepper = LieVariational2{}.bind(problem, FixedStep{0.1}, NormPolicy::none);
  auto const before = bench::allocations_of_this_thread();
  Status const status = stepper.advance(x, 0, 10);
  EXPECT_EQ(bench::allocations_of_this_thread(), before);
  EXPECT_EQ(status, Status::ok);
  EXPECT_LT(*stepper.work().iterations, 20 * stepper.work().steps);
}

}  // namespace
}  // namespace polhode
