/// Many bodies: the laws of their space, what they cost, and that every formulation tells the same story.
#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "problems/space_laws.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using test::a_cell;
using test::CellUnderTest;
using test::Random;

// ---- The space ------------------------------------------------------------------------------------------------------

TEST(Power, OfThreeIsThreeOfItsFactorSideBySide) {
  using One = RigidBody<S3<double>>;
  auto const check = []<class M>(M) {
    Random random(3);
    Point<M> x(3), y(3);
    Chart<M> u(3), k(3);
    Velocity<M> v(3);
    for (int i = 0; i < 3; ++i) {
      x[i] = {random.attitude(), random.vector(2)};
      v[i] = {random.vector(2), random.vector(2)};
      u[i] = {random.vector(0.1), random.vector(0.1)};
    }
    Chart<M> const moved = u;
    displace<M>(
        x, [&](auto& z, auto const& at) { add(z, at(moved)); }, u, y);
    to_chart_rate<M>(x, u, v, k);
    for (int i = 0; i < 3; ++i) {
      Chart<One> expected = One::centre(x[i]);
      add(expected, moved[i]);
      EXPECT_EQ(distance<double>(u[i], expected), 0);
      EXPECT_EQ(distance<double>(y[i], One::retract(x[i], expected)), 0);
      EXPECT_EQ(distance<double>(k[i], One::chart_rate(x[i], expected, v[i])), 0);
    }
    to_rate<M>(x, v, k);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(distance<double>(k[i], One::rate(x[i], v[i])), 0);
    EXPECT_EQ(size_of(x), 21);
    EXPECT_EQ(size_of(u), 18);
  };
  check(RigidBodies<S3<double>, 3>{});
  check(RigidBodies<S3<double>>{});
}

TEST(Power, OnAFlatSpaceThePointIsTheCoordinate) {
  using M = Attitudes<FlatQuaternion<double>>;
  Random random(4);
  Point<M> x(2), y(2);
  Chart<M> step(2), unused(2);
  for (int i = 0; i < 2; ++i) {
    x[i] = random.attitude();
    step[i] = scaled(0.1, random.attitude());
  }
  displace<M>(
      x, [&](auto& z, auto const& at) { add(z, 2.0, at(step)); }, unused, y);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(y[i].y, x[i].y + 2 * step[i].y, 1e-16);
  displace<M>(
      x, [&](auto& z, auto const& at) { add(z, 2.0, at(step)); }, unused, x);  // onto itself
  for (int i = 0; i < 2; ++i) EXPECT_EQ(distance<double>(x[i], y[i]), 0);
}

TEST(Power, TheWorstDefectCounts) {
  using M = Attitudes<S3<double>>;
  Point<M> x(3);
  x[0] = {0, 0, 0, 1};
  x[1] = {0, 0, 0, 2};
  x[2] = {0, 0, 0, 0.5};
  EXPECT_EQ(M::defect(x), 3);
  EXPECT_EQ(M::project(x), 1);
  EXPECT_EQ(M::defect(x), 0);
}

// ---- Formulations ---------------------------------------------------------------------------------------------------

/// Each formulation by the tightest method that suits it, against the reference: the error [rad] at most `allowed`.
void expect_agreement(std::string const& problem, std::string const& variant, double t_end,
                      std::vector<std::string> const& formulations, double h, double allowed) {
  for (std::string const& formulation : formulations) {
    auto const record =
        a_cell(problem, formulation, "gauss4").of_variant(variant).until(t_end).with_h(h).measured().record;
    ASSERT_EQ(record.status, results::Status::ok) << formulation << ": " << record.reason;
    EXPECT_LT(*record.attitude_error_max, allowed) << problem << " " << variant << " as " << formulation;
  }
}

TEST(Formulations, OfTheSynchronisedNetworkAgree) {
  for (char const* variant : {"protocol7", "protocol13"})
    expect_agreement("quaternion_sync", variant, 20, {"quaternion", "s3", "mrp"}, 0.02, 2e-13);
}
TEST(Formulations, OfTheSwarmAgree) {
  for (char const* variant : {"ic1", "ic2", "ic3"})
    expect_agreement("group_consensus", variant, 1.5, {"quaternion", "s3", "mrp"}, 0.005, 1e-11);
  expect_agreement("group_consensus", "ic2,shadow", 1.5, {"quaternion", "s3", "mrp_shadow"}, 0.005, 1e-11);
}
TEST(Formulations, OfOneBodyAgree) {
  std::vector<std::string> const all{"quaternion", "s3", "so3", "rotation", "mrp", "mrp_shadow", "euler"};
  expect_agreement("dead_zone", "smooth,n4", 3, all, 0.004, 1e-12);
  expect_agreement("dead_zone", "continuous,n4", 5.5, all, 0.004, 1e-11);
  expect_agreement("pd_slew", "", 10, all, 0.01, 1e-12);
  expect_agreement("free_body", "", 10, all, 0.01, 1e-12);
  expect_agreement("tether_capture", "case1", 10, all, 0.02, 1e-12);
}

// ---- Cost -----------------------------------------------------------------------------------------------------------

#ifdef POLHODE_RACES
/// Bytes that a solve of n craft asks for, from the choice of the problem to its end.
std::int64_t bytes_for(int n, std::string const& formulation, std::string const& integrator) {
  auto const before = bench::allocated_bytes_of_this_thread();
  auto const prepared = bench::prepare(
      a_cell("quaternion_sync", formulation, integrator).set("n", {double(n)}).with_h(0.1).until(0.2).cell);
  auto const timed = prepared.problem->timed(formulation, integrator, prepared.plan);
  EXPECT_EQ(timed->solve(), Status::ok);
  return bench::allocated_bytes_of_this_thread() - before;
}

TEST(NetworkCost, MemoryIsLinearInTheCraft) {
  bytes_for(10, "quaternion", "rk4");  // the catalogue is made at its first use
  for (auto const& [formulation, integrator] :
       {std::pair{"quaternion", "rk4"}, {"s3", "cf4"}, {"quaternion", "gauss2"}, {"mrp", "dopri5"}}) {
    double const few = double(bytes_for(2000, formulation, integrator));
    double const many = double(bytes_for(20'000, formulation, integrator));
    EXPECT_NEAR(many / few, 10, 0.5) << integrator;
    EXPECT_LT(many / 20'000, 4000) << integrator << ": bytes a craft";
  }
}
#endif

TEST(NetworkCost, ALargeNetworkHasNoReferenceButDriftAndClaims) {
  auto const measured = a_cell("quaternion_sync", "quaternion", "rk4").set("n", {1000}).with_h(0.1).until(1).measured();
  EXPECT_EQ(measured.record.status, results::Status::ok);
  EXPECT_EQ(measured.record.reference, "");
  EXPECT_FALSE(measured.record.attitude_error_max);
  EXPECT_GT(*measured.record.norm_drift_max, 0);
  EXPECT_FALSE(measured.record.claims.empty());
}

}  // namespace
}  // namespace polhode
