#pragma once
/// Symmetry in time, measured in quadruple precision: so many steps forth, and as many back. Walks the catalogue's
/// lists: a new method is tested by being listed, whether it claims the symmetry or not.
#include <gtest/gtest.h>

#include <optional>

#include "problems/coning.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/pinned_runs.hpp"
#include "tests/support/splitting_runs.hpp"

namespace polhode::test {

/// What 32 steps leave of a return by round-off, and what the least asymmetric methods, of order 16, leave at least.
inline constexpr double round_off_of_return = 1e-29, least_asymmetry = 1e-27;

/// How far from the start a run ends that turns round after n steps of h [s]; null if a step fails. Steps back are
/// steps of -h: a method is symmetric if they undo those of h.
template <class Method, Problem P>
std::optional<double> miss_of_return(P const& problem, double h, int n) {
  auto const start = problem.initial();
  auto x = start;
  Quad const turn = Quad(n) * Quad(h);
  if (Method{}.bind(problem, FixedStep{h}, NormPolicy::none).advance(x, 0, turn) != Status::ok) return {};
  EXPECT_GT(double(distance<Quad>(x, start)), 0.01) << "nothing moves";
  if (Method{}.bind(problem, FixedStep{-h}, NormPolicy::none).advance(x, turn, 0) != Status::ok) return {};
  return double(distance<Quad>(x, start));
}

/// The space of the problems for methods that need this.
template <Needs needs, class A>
struct SymmetrySpace {
  static constexpr bool constrained = needs == Needs::constraint || needs == Needs::constraint_on_group;
  using Moving = std::conditional_t<constrained, MovingBody<A>, RigidBody<A>>;
  using type = std::conditional_t<needs == Needs::prescribed_rates, Attitudes<A>, Moving>;
};
/// A problem on it: a top under a weight that swings in time, if the method accepts a torque.
template <Needs needs, template <class> class A>
auto symmetry_problem() {
  if constexpr (SymmetrySpace<needs, A<Quad>>::constrained)
    return erase_type(pinned_top<Quad, A>());
  else if constexpr (needs == Needs::prescribed_rates)
    return erase<Quad, A>(Coning(Choice{}));
  else if constexpr (needs == Needs::free_body)
    return erase_type(controlled_body<Quad, A, true>(top(), NoTorque<Quad>{}));
  else
    return erase_type(top_under<Quad, A>({.shaken = true}));
}

/// Whether a method claims to be symmetric on M. What runs everywhere claims it for flat coordinates: on a group its
/// charts are centred where steps begin, which only the midpoint rule does not feel.
template <class Method, Space M>
constexpr bool claims_symmetry() {
  constexpr auto const& info = Method::info;
  return (info.preserves & is_symmetric) && (M::flat || info.needs != Needs::none || info.order == 2);
}
inline void expect_return(std::optional<double> miss, bool symmetric, std::string_view method,
                          std::string_view formulation) {
  ASSERT_TRUE(miss) << method << " as " << formulation << ": a step fails";
  if (symmetric) {
    EXPECT_LT(*miss, round_off_of_return) << method << " as " << formulation << " claims to be symmetric";
  } else {
    EXPECT_GT(*miss, least_asymmetry) << method << " as " << formulation << " is symmetric: a claim is missing";
  }
}
/// One method on one formulation. Under a torque that feels the rate splittings lose the symmetry, as their pitfall
/// says.
template <class Method, class Formulation>
void expect_symmetry_as_claimed() {
  constexpr auto const& info = Method::info;
  auto const problem = symmetry_problem<info.needs, Formulation::template On>();
  using P = typename std::decay_t<decltype(problem)>::element_type;
  constexpr bool constrained = SymmetrySpace<info.needs, typename Formulation::template On<Quad>>::constrained;
  constexpr bool symmetric = claims_symmetry<Method, typename P::Space>();
  expect_return(miss_of_return<Method>(*problem, constrained ? 0x1p-9 : 0x1p-3, 16), symmetric, info.name,
                Formulation::name);
  if constexpr (symmetric &&
                (info.needs == Needs::none || info.needs == Needs::group || info.needs == Needs::rigid_body)) {
    auto const shaken = erase_type(shaken_body<Quad, Formulation::template On>());
    expect_return(miss_of_return<Method>(*shaken, 0.5, 16), info.family != Family::splitting, info.name,
                  Formulation::name);
  }
}

/// Every method of a list with fixed steps on every formulation that it suits; how many that were.
template <class... Method>
int expect_symmetry_as_claimed(Types<Method...>) {
  int checked = 0;
  auto const one = [&]<class M, class F>(M, F) {
    using Space = typename SymmetrySpace<M::info.needs, typename F::template On<Quad>>::type;
    // As for orders: high orders are not compiled for angles.
    constexpr bool calm = M::info.order <= 5 || !std::same_as<F, Formulation<EulerAngles>>;
    if constexpr (calm && refusal<Space>(M::info.needs).empty() && RunsFixed<M, Erased<Space>>) {
      expect_symmetry_as_claimed<M, F>();
      ++checked;
    }
  };
  auto const all = [&]<class M, class... F>(M method, Types<F...>) { (one(method, F{}), ...); };
  (all(Method{}, Formulations{}), ...);
  return checked;
}

}  // namespace polhode::test
