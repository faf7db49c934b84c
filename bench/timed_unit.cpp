/// The timed solves of one problem (POLHODE_PROBLEM) by one list of methods (POLHODE_METHODS), fully typed: what a user
/// who compiled this method against this problem would run. An inertia with products of inertia is not timed: its field
/// is compiled for erased, counted runs alone.
#include "bench/problems.hpp"

namespace polhode::bench {
namespace {

using D = POLHODE_PROBLEM;
using Methods = POLHODE_METHODS;

template <class P, class Stepper>
class Solve final : public TimedSolve {
  using M = typename P::Space;

 public:
  template <class Bind>
  Solve(P const& problem, Plan const& plan, Bind bind)
      : fresh_(problem), problem_(problem), stepper_(bind(problem_)), stops_(plan.stops), h_(plan.h()) {}

  Status solve() override {
    problem_ = fresh_;  // a controller remembers its last sample
    state_ = problem_.initial();
    if constexpr (requires { stepper_.begin(); })
      stepper_.begin();
    else
      stepper_.restart();
    return run_from_stop_to_stop(problem_, stepper_, state_, stops_, h_, NoWatch{});
  }
  std::vector<double> end_state() const override {
    std::vector<double> numbers(std::size_t(Point<M>::size));
    store(state_, numbers.data());
    return numbers;
  }

 private:
  P const fresh_;
  P problem_;
  Stepper stepper_;
  std::vector<Stop> stops_;
  double h_;
  Point<M> state_{};
};

template <class Control, class Method, class P>
std::unique_ptr<TimedSolve> make(P const& problem, Plan const& plan) {
  auto const bind = [&](P const& own) { return Method{}.bind(own, std::get<Control>(plan.control), plan.policy); };
  return std::make_unique<Solve<P, decltype(bind(problem))>>(problem, plan, bind);
}

template <class F, class Method>
std::unique_ptr<TimedSolve> timed_on(D const& definition, Plan const& plan) {
  using M = RigidBody<typename F::template On<double>>;
  if constexpr (refusal<M>(Method::info.needs).empty() && Method::info.not_built.empty()) {
    if (!definition.principal()) return nullptr;
    auto const problem = definition.template field<double, F::template On, true>();
    using P = std::decay_t<decltype(problem)>;
    if constexpr (RunsFixed<Method, P>)
      if (std::holds_alternative<FixedStep>(plan.control)) return make<FixedStep, Method>(problem, plan);
    if constexpr (RunsAdaptive<Method, P>)
      if (std::holds_alternative<Adaptive>(plan.control)) return make<Adaptive, Method>(problem, plan);
  }
  return nullptr;
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
  return find(definition, formulation, integrator, plan, Formulations{});
}

}  // namespace polhode::bench
