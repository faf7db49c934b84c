/// Nothing is allocated once a method is bound: every own method on every formulation of every problem, fully typed.
#include <gtest/gtest.h>

#include <algorithm>
#include <new>

#include "bench/allocations.hpp"
#include "tests/runs.hpp"

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
          auto const prepared = bench::prepare(cell.cell);
          if (!prepared.refusal.empty()) continue;
          auto const solve = prepared.problem->timed(formulation, method.name, prepared.plan);
          if (!solve) continue;  // a formulation that is not raced
          auto const before = allocations_of_this_thread();
          Status const status = solve->solve();
          auto const allocations = allocations_of_this_thread() - before;
          EXPECT_EQ(allocations, 0) << problem.name << ", " << formulation << ", " << method.name;
          EXPECT_EQ(status, Status::ok) << problem.name << ", " << formulation << ", " << method.name;
          ++checked;
        }
      }
  EXPECT_GE(checked, 75);  // 3 problems; 10 fixed-step methods and an adaptive one on flat space, 10 on two groups
}
#endif

}  // namespace
}  // namespace polhode
