/// One list of the catalogue (POLHODE_METHODS: OwnMethods or Rivals), compiled on every space for erased problems.
#include <tuple>

#include "bench/methods.hpp"

namespace polhode::bench {
namespace {

template <Space M, class Method>
Outcome solve(Erased<M>& problem, Plan const& plan, Watch<M>& watch) {
  return with_stepper(Method{}, problem, plan, [&](auto stepper) {
    Point<M> x = problem.initial();
    Outcome outcome;
    outcome.status = run_from_stop_to_stop(problem, stepper, x, plan.stops, plan.h(), watch);
    outcome.work = stepper.work();
    outcome.projections = stepper.projections();
    outcome.evaluations = problem.evaluations();
    return outcome;
  });
}

template <Space M, class Method>
MethodOn<M> method_on() {
  using Flat = Erased<RigidBody<FlatQuaternion<double>>>;
  using Group = Erased<RigidBody<S3<double>>>;
  MethodOn<M> entry{.info = &Method::info,
                    .fixed = RunsFixed<Method, Flat> || RunsFixed<Method, Group>,
                    .adaptive = RunsAdaptive<Method, Flat> || RunsAdaptive<Method, Group>,
                    .refusal = refusal<M>(Method::info.needs)};
  if (!Method::info.not_built.empty()) {
    entry.refusal = Method::info.not_built;
    entry.fixed = entry.adaptive = true;  // asked in either way, it is refused with this reason
  }
  if constexpr (refusal<M>(Method::info.needs).empty() && Method::info.not_built.empty()) {
    static_assert(IntegratorFor<Method, Erased<M>>, "a method that is not refused must bind");
    entry.solve = solve<M, Method>;
  }
  return entry;
}

template <Space M, class... Method>
std::vector<MethodOn<M>> list(Types<Method...>) {
  return {method_on<M, Method>()...};
}

}  // namespace

template <Space M, class Methods>
std::vector<MethodOn<M>> methods_on() {
  return list<M>(Methods{});
}

namespace {

// Their addresses, kept, make every formulation of the catalogue an instance in this unit.
template <class... F>
auto instances(Types<F...>) {
  return std::tuple{&methods_on<RigidBody<typename F::template On<double>>, POLHODE_METHODS>...};
}
[[gnu::used]] auto const kept = instances(Formulations{});

}  // namespace
}  // namespace polhode::bench
