/// The timed solves of one problem (POLHODE_PROBLEM, from POLHODE_PROBLEM_HEADER) by one list of methods
/// (POLHODE_METHODS, from POLHODE_METHODS_HEADER), fully typed: what a user who compiled this method against this
/// problem would run. Foils among the formulations are not raced: they are compiled for erased problems alone.
#include "bench/solve/problems.hpp"
#include "bench/solve/timed_solve.hpp"
#include "problems/dual_field.hpp"
#include POLHODE_PROBLEM_HEADER
#include POLHODE_METHODS_HEADER

namespace polhode::bench {
namespace {

using D = POLHODE_PROBLEM;
using Methods = POLHODE_METHODS;

template <class F, class Method>
std::unique_ptr<TimedSolve> timed_on(D const& definition, Plan const& plan) {
  using P = decltype(definition.template field<double, F::template On, true>());
  if constexpr (!refusal<typename P::Space>(Method::info.needs).empty() || !Method::info.not_built.empty()) {
    return nullptr;
  } else if constexpr (requires { requires Method::uses_jacobian; }) {
    using Duals = decltype(definition.template field<JacobianScalar, F::template On, true>());
    using Both = WithJacobian<P, Duals>;
    return timed_solve_of<Method, Both>(Both(definition.template field<double, F::template On, true>(),
                                             definition.template field<JacobianScalar, F::template On, true>()),
                                        plan);
  } else {
    return timed_solve_of<Method, P>(definition.template field<double, F::template On, true>(), plan);
  }
}

template <class F, class... Method>
std::unique_ptr<TimedSolve> find_method(D const& definition, std::string_view integrator, Plan const& plan,
                                        Types<Method...>) {
  std::unique_ptr<TimedSolve> found;
  ((Method::info.name == integrator && (found = timed_on<F, Method>(definition, plan), true)) || ...);
  return found;
}
template <class... F>
std::unique_ptr<TimedSolve> find(D const& definition, std::string_view formulation, std::string_view integrator,
                                 Plan const& plan, Types<F...>) {
  std::unique_ptr<TimedSolve> found;
  ((F::name == formulation && (found = find_method<F>(definition, integrator, plan, Methods{}), true)) || ...);
  return found;
}

}  // namespace

template <>
std::unique_ptr<TimedSolve> timed_solve<D, Methods>(D const& definition, std::string_view formulation,
                                                    std::string_view integrator, Plan const& plan) {
  return find(definition, formulation, integrator, plan, TimedFormulationsOf<D>{});
}

}  // namespace polhode::bench
