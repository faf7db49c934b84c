/// Nothing is allocated once a method is bound: every own method on every formulation of every problem, fully typed.
#include <gtest/gtest.h>

#include <algorithm>
#include <new>
#include <optional>

#include "bench/process/allocations.hpp"
#include "tests/support/runs.hpp"

namespace polhode {
namespace {

using bench::allocations_of_this_thread;

TEST(Allocations, AreCounted) {
  auto const before = allocations_of_this_thread();
  ::operator delete(::operator new(8));  // called by name: a compiler may not leave it out
  ::operator delete[](::operator new[](8));
  EXPECT_EQ(allocations_of_this_thread() - before, 2);
}

#ifdef POLHODE_RACES
/// Allocations of one timed solve, which must go well; null if the cell is refused or not raced.
std::optional<std::int64_t> allocations_of(results::Cell const& cell) {
  auto const prepared = bench::prepare(cell);
  if (!prepared.refusal.empty()) return {};
  auto const solve = prepared.problem->timed(cell.formulation, cell.integrator, prepared.plan);
  if (!solve) return {};
  auto const before = allocations_of_this_thread();
  Status const status = solve->solve();
  auto const allocations = allocations_of_this_thread() - before;
  EXPECT_EQ(status, Status::ok) << cell.problem << ", " << cell.formulation << ", " << cell.integrator;
  return allocations;
}

TEST(Allocations, NoneInAnyAdvance) {
  int checked = 0;
  for (bench::ProblemWord const& problem : bench::vocabulary().problems)
    for (std::string const& formulation : problem.formulations)
      for (bench::IntegratorWord const& method : bench::vocabulary().integrators) {
        if (method.rival) continue;
        for (bool fixed : {true, false}) {
          if (fixed ? !method.fixed : !method.adaptive) continue;
          auto cell = test::a_cell(problem.name, formulation, method.name)
                          .of_variant(test::calm_variant(problem.name))
                          .until(std::min(2.0, 500 * problem.step));
          cell = fixed ? cell.with_h(problem.step) : cell.with_rtol(1e-8);
          auto const allocations = allocations_of(cell.cell);
          if (!allocations) continue;
          EXPECT_EQ(*allocations, 0) << problem.name << ", " << formulation << ", " << method.name;
          ++checked;
        }
      }
  EXPECT_GE(checked, 75);  // 3 problems; 10 fixed-step methods and an adaptive one on flat space, 10 on two groups
}

/// A slew of a small body under gains for a large one: the fixed point of Gauss diverges, and Newton's iteration makes
/// matrices.
TEST(Allocations, NoneWhereGaussTurnsToNewton) {
  int checked = 0, by_newton = 0;
  for (bench::IntegratorWord const& method : bench::vocabulary().integrators) {
    if (method.family != "gauss" || !method.fixed) continue;
    for (char const* formulation : {"quaternion", "s3", "so3", "rotation", "mrp"})
      for (bool fixed : {true, false}) {
        if (!fixed && !method.adaptive) continue;
        auto const stiff = test::a_cell("pd_slew", formulation, method.name).set("inertia", {0.5, 0.85, 1}).until(20);
        auto const cell = fixed ? stiff.with_h(0.25) : stiff.with_rtol(1e-6);
        if (!bench::prepare(cell.cell).refusal.empty()) continue;
        auto const record = cell.measured().record;
        if (record.status != results::Status::ok) continue;  // on a group some steps have no solution
        auto const allocations = allocations_of(cell.cell);
        if (!allocations) continue;
        EXPECT_EQ(*allocations, 0) << formulation << ", " << method.name << (fixed ? ", fixed" : ", adaptive");
        ++checked;
        by_newton += record.jacobians.value_or(0) > 0;
      }
  }
  EXPECT_GE(checked, 30);
  EXPECT_GE(by_newton, 8) << "no Newton, nothing seen";
}
#endif

}  // namespace
}  // namespace polhode
