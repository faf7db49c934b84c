/// What every method on groups owes: the constraint, many bodies like one, no allocations.
#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/crouch_grossman.hpp"
#include "integrators/lie_gauss.hpp"
#include "integrators/lie_group.hpp"
#include "problems/erased.hpp"
#include "tests/support/lie_group_runs.hpp"

namespace polhode {
namespace {

using namespace test;

template <class F>
void for_each_method(F f) {
  f(LieEuler{});
  f(Rkmk2{});
  f(Rkmk3{});
  f(Rkmk4{});
  f(CommutatorFree3{});
  f(CommutatorFree4{});
  f(CrouchGrossman3{});
  f(CrouchGrossman4{});
  f(LieGaussEntry<1>{});
  f(LieGaussEntry<2>{});
  f(LieGaussEntry<3>{});
}

/// Types are forgotten: a method is compiled once for each space.
template <template <class> class A>
void expect_constraint_kept(auto const& method) {
  static auto const problem = erase_type(shaken_body<double, A>());
  auto x = problem->initial();
  auto stepper = method.bind(*problem, FixedStep{0.1}, NormPolicy::none);
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(stepper.advance(x, 10 * i, 10 * (i + 1)), Status::ok);
    worst = std::max(worst, A<double>::defect(x.first));
  }
  EXPECT_EQ(stepper.work().steps, 10'000);
  EXPECT_LT(worst, 1e-13) << method.info.name << " on " << A<double>::name;
}

TEST(LieGroupMethods, KeepTheConstraintOverTenThousandSteps) {
  for_each_method([](auto const& method) {
    expect_constraint_kept<S3>(method);
    expect_constraint_kept<SO3>(method);
  });
}

/// Three bodies together and each alone; nothing is allocated on the way.
template <template <class> class A>
void expect_many_bodies_are_one_body_often(auto const& method) {
  using Copies = Swarm<decltype(shaken_body<double, A>())>;
  static Copies const copies{shaken_body<double, A>(), 3};
  static auto const swarm = erase_type(copies);
  static auto const one = erase_type(copies.body);

  auto together = swarm->initial();
  auto stepper = method.bind(*swarm, FixedStep{0.1}, NormPolicy::none);
  auto const before = bench::allocations_of_this_thread();
  Status const status = stepper.advance(together, 0, 2);
  EXPECT_EQ(bench::allocations_of_this_thread(), before) << method.info.name;
  EXPECT_EQ(status, Status::ok);
  for (int i = 0; i < 3; ++i) {
    auto alone = copies.start(i);
    EXPECT_EQ(method.bind(*one, FixedStep{0.1}, NormPolicy::none).advance(alone, 0, 2), Status::ok);
    EXPECT_LT(distance<double>(together[i], alone), 1e-14) << method.info.name << ", body " << i;
  }
}

TEST(LieGroupMethods, ManyBodiesAreOneBodyOftenAndNothingIsAllocated) {
  for_each_method([](auto const& method) { expect_many_bodies_are_one_body_often<S3>(method); });
  expect_many_bodies_are_one_body_often<SO3>(CrouchGrossman4{});
  expect_many_bodies_are_one_body_often<SO3>(LieGaussEntry<2>{});
}

}  // namespace
}  // namespace polhode
