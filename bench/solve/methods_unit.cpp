/// One list of the catalogue (POLHODE_METHODS, from POLHODE_METHODS_HEADER), compiled for erased problems on every
/// space of one kind (POLHODE_SPACES: OneBodySpaces, AttitudesSpaces, BodiesSpaces or PositionSpaces).
#include <tuple>

#include "bench/solve/methods.hpp"
#include "bench/solve/timed_solve.hpp"
#include POLHODE_METHODS_HEADER

namespace polhode::bench {
namespace {

/// Calls f(bound stepper) with the method driven as the plan says; with dense output, if its adaptive stepper has it.
template <class Method, Problem P, class F>
auto with_stepper(Method const& method, P const& problem, Plan const& plan, F f) {
  constexpr bool fixed = RunsFixed<Method, P>, adaptive = RunsAdaptive<Method, P>;
  if constexpr (fixed)
    if (!adaptive || std::holds_alternative<FixedStep>(plan.control))
      return f(method.bind(problem, std::get<FixedStep>(plan.control), plan.policy));
  if constexpr (adaptive) {
    Adaptive const& control = std::get<Adaptive>(plan.control);
    if constexpr (requires { method.bind_dense(problem, control, plan.policy); })
      return f(method.bind_dense(problem, control, plan.policy));
    else
      return f(method.bind(problem, control, plan.policy));
  }
}

template <Space M, class Method>
Outcome solve(Erased<M>& problem, Plan const& plan, Watch<M>& watch) {
  return with_stepper(Method{}, problem, plan, [&](auto stepper) {
    Point<M> x = problem.initial();
    Outcome outcome;
    RunLoop run(problem, stepper, plan.h(), plan.locate);
    try {
      outcome.status = run.go(x, plan.stops, watch);
    } catch (...) {
      outcome.ended = std::current_exception();
    }
    outcome.located = run.located();
    outcome.work = stepper.work();
    outcome.work.steps -= outcome.located.trials;
    outcome.work.rejected += outcome.located.trials;
    outcome.projections = stepper.projections();
    outcome.evaluations = problem.evaluations() + outcome.work.evaluations;
    if constexpr (requires { problem.series(); })
      if (SeriesTwin const* series = problem.series()) outcome.evaluations += series->evaluations();
    return outcome;
  });
}

// What an entry lacks is said in words, here, before anything of it is compiled that would stumble over it.

/// The facts of a method.
template <class I>
concept Described = requires {
  { I::info } -> std::same_as<MethodInfo const&>;
};
/// A method with a Frame and a Memory is driven by Fixed, which takes its steps.
template <class I, class P, class M = typename P::Space, class S = typename M::Scalar>
concept Stepping = requires(I const method, P const& p, S t, Real<S> h, Point<M> x, typename I::template Frame<M> frame,
                            typename I::template Memory<M> memory) {
  { method.step(p, t, h, x, frame, memory) } -> std::same_as<void>;
};
template <class I, class M>
concept Framed = requires {
  typename I::template Frame<M>;
  typename I::template Memory<M>;
};
template <Space M, class Method>
consteval void check_step() {
  if constexpr (Framed<Method, M> && refusal<M>(Method::info.needs).empty())
    static_assert(Stepping<Method, Erased<M>>,
                  "Stepping: a method with Frame and Memory needs  void step(p, t, h, x, frame, memory) const");
}
template <class... Method>
consteval bool check(Types<Method...>) {
  static_assert((Described<Method> && ...), "Described: a method needs  static constexpr MethodInfo info{...}");
  (check_step<RigidBody<FlatQuaternion<double>>, Method>(), ...);
  (check_step<RigidBody<S3<double>>, Method>(), ...);
  return true;
}
static_assert(check(POLHODE_METHODS{}));

/// Spaces such that every method runs on one of them.
using Probes = Types<RigidBody<FlatQuaternion<double>>, RigidBody<S3<double>>, MovingBody<FlatQuaternion<double>>,
                     MovingBody<S3<double>>, Attitudes<S3<double>>>;
template <class Method, class... M>
constexpr bool runs_fixed(Types<M...>) {
  return (RunsFixed<Method, Erased<M>> || ...);
}
template <class Method, class... M>
constexpr bool runs_adaptive(Types<M...>) {
  return (RunsAdaptive<Method, Erased<M>> || ...);
}

template <Space M, class Method>
MethodOn<M> method_on() {
  MethodOn<M> entry{.info = &Method::info,
                    .fixed = runs_fixed<Method>(Probes{}),
                    .adaptive = runs_adaptive<Method>(Probes{}),
                    .refusal = refusal<M>(Method::info.needs)};
  if (!Method::info.not_built.empty()) {
    entry.refusal = Method::info.not_built;
    entry.fixed = entry.adaptive = true;  // asked in either way, it is refused with this reason
  }
  if constexpr (refusal<M>(Method::info.needs).empty() && Method::info.not_built.empty()) {
    static_assert(IntegratorFor<Method, Erased<M>> || PowerSpace<M>,
                  "IntegratorFor: where info.needs does not refuse a space, bind(problem, FixedStep or Adaptive, "
                  "NormPolicy) must give a stepper");
    if constexpr (IntegratorFor<Method, Erased<M>>) {
      entry.solve = solve<M, Method>;
      entry.timed = [](std::unique_ptr<Erased<M>> problem, Plan const& plan) {
        return timed_solve_of<Method, Erased<M>>(std::move(problem), plan);
      };
    } else {
      entry.refusal = "is written for one body";
    }
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

// Their addresses, kept, make every space of the kind an instance in this unit.
template <class... M>
auto instances(Types<M...>) {
  return std::tuple{&methods_on<M, POLHODE_METHODS>...};
}
[[gnu::used]] auto const kept = instances(POLHODE_SPACES{});

}  // namespace
}  // namespace polhode::bench
