/// The timed solves of one problem (POLHODE_PROBLEM) by one list of methods (POLHODE_METHODS), fully typed: what a user
/// who compiled this method against this problem would run. An inertia with products of inertia is not timed, nor are
/// foils among the formulations: they are compiled for erased, counted runs alone.
#include "bench/problems.hpp"
#include "problems/catalog.hpp"

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
      : fresh_(problem),
        problem_(problem),
        stepper_(bind(problem_)),
        run_(problem_, stepper_, plan.h(), plan.locate),
        stops_(plan.stops),
        start_(problem_.initial()),
        state_(start_) {}

  Status solve() override {
    problem_ = fresh_;  // a controller remembers its last sample
    state_ = start_;
    if constexpr (requires { stepper_.begin(); })
      stepper_.begin();
    else
      stepper_.restart();
    return run_.go(state_, stops_, NoWatch{});
  }
  std::vector<double> end_state() const override {
    std::vector<double> numbers(std::size_t(size_of(state_)));
    store(state_, numbers.data());
    return numbers;
  }

 private:
  P const fresh_;
  P problem_;
  Stepper stepper_;
  RunLoop<P, Stepper> run_;
  std::vector<Stop> stops_;
  Point<M> const start_;
  Point<M> state_;
};

template <class Control, class Method, class P>
std::unique_ptr<TimedSolve> make(P const& problem, Plan const& plan) {
  auto const bind = [&](P const& own) { return Method{}.bind(own, std::get<Control>(plan.control), plan.policy); };
  return std::make_unique<Solve<P, decltype(bind(problem))>>(problem, plan, bind);
}

template <class F, class Method>
std::unique_ptr<TimedSolve> timed_on(D const& definition, Plan const& plan) {
  using P = decltype(definition.template field<double, F::template On, true>());
  if constexpr (refusal<typename P::Space>(Method::info.needs).empty() && Method::info.not_built.empty()) {
    if (!is_principal(definition) || !is_plain(definition)) return nullptr;
    P const problem = definition.template field<double, F::template On, true>();
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
  return find(definition, formulation, integrator, plan, TimedFormulationsOf<D>{});
}

}  // namespace polhode::bench
