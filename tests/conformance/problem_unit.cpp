/// A problem that a binary adds (POLHODE_PROBLEM, from POLHODE_PROBLEM_HEADER) against the laws of the spaces that it
/// lives on and against its own certified reference, in every formulation.
#include <gtest/gtest.h>

#include <algorithm>

#include "bench/solve/problems.hpp"
#include "problems/space_laws.hpp"
#include "tests/support/runs.hpp"

#include POLHODE_PROBLEM_HEADER

namespace polhode {
namespace {

using D = POLHODE_PROBLEM;

/// The space of the problem's field in a formulation, as a template on the scalar.
template <class Formulation>
struct Fields {
  template <class S>
  using Field = decltype(std::declval<D const&>().template field<S, Formulation::template On, true>());
  template <class S>
  using Space = typename Field<S>::Space;
};
/// The laws at the problem's start, for its own velocity there and an offset along it.
template <class Formulation>
void expect_laws() {
  using S = Dual<1>;
  using M = typename Fields<Formulation>::template Space<S>;
  if constexpr (SmallSpace<M>) {  // of many bodies each lives on a space of this library
    auto const field = D(Choice{}).template field<S, Formulation::template On, true>();
    Point<M> const x = field.initial();
    Velocity<M> const v = field(S(0.0), x);
    double largest = 1;
    Chart<M>::each([&](S const& component) { largest = std::max(largest, std::fabs(component.value)); }, M::rate(x, v));
    Chart<M> offset = M::rate(x, v);
    add(offset, 0.1 / largest - 1, M::rate(x, v));
    EXPECT_LT(check_space_laws<Fields<Formulation>::template Space>(x, offset, v), 1e-13 * largest)
        << Formulation::name;
  }
}

TEST(AddedProblem, LivesOnSpacesThatKeepTheLaws) {
  []<class... F>(Types<F...>) { (expect_laws<F>(), ...); }(bench::FormulationsOf<D>{});
}

TEST(AddedProblem, IsTheSameInEveryFormulation) {
  bench::ProblemWord const& problem = bench::vocabulary().problem(D::info().name);
  for (std::string const& formulation : problem.formulations) {
    auto const cell = test::a_cell(problem.name, formulation, "gauss4").with_h(problem.step / 4);
    auto const prepared = bench::prepare(cell.cell);
    if (!prepared.refusal.empty() || !prepared.problem->no_reference().empty()) continue;
    auto const record = cell.until(20 * problem.step).measured().record;
    ASSERT_EQ(record.status, results::Status::ok) << formulation << ": " << record.reason;
    EXPECT_LT(record.attitude_error_max.value_or(0), 1e-6) << formulation;
    EXPECT_LT(record.rate_error_max.value_or(0), 1e-6) << formulation;
  }
}

}  // namespace
}  // namespace polhode
