#pragma once
/// One solve, made once and run again and again: what is timed.
#include <memory>
#include <vector>

#include "bench/solve/methods.hpp"

namespace polhode::bench {

/// A problem that begins anew for every solve: a controller remembers its last sample, a field holds its sides.
template <Problem P>
class Renewed {
 public:
  explicit Renewed(P const& problem) : fresh_(problem), problem_(problem) {}
  P& get() { return problem_; }
  void begin() { problem_ = fresh_; }

 private:
  P const fresh_;
  P problem_;
};
template <Space M>
class Renewed<Erased<M>> {
 public:
  explicit Renewed(std::unique_ptr<Erased<M>> problem) : problem_(std::move(problem)) {}
  Erased<M>& get() { return *problem_; }
  void begin() { problem_->begin(); }

 private:
  std::unique_ptr<Erased<M>> problem_;
};

template <Problem P, class Stepper>
class Solve final : public TimedSolve {
  using M = typename P::Space;

 public:
  /// bind(problem) is the stepper; made may be a problem or, of an erased one, its owner.
  template <class Made, class Bind>
  Solve(Made&& made, Plan const& plan, Bind bind)
      : problem_(std::forward<Made>(made)),
        stepper_(bind(std::as_const(problem_.get()))),
        run_(problem_.get(), stepper_, plan.h(), plan.locate),
        stops_(plan.stops),
        start_(problem_.get().initial()),
        state_(start_) {}

  Status solve() override {
    problem_.begin();
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
  Renewed<P> problem_;
  Stepper stepper_;
  RunLoop<P, Stepper> run_;
  std::vector<Stop> stops_;
  Point<M> const start_;
  Point<M> state_;
};

/// A solve of `made`, a problem P or the owner of one, driven as the plan says. Null if the method does not know that.
template <class Method, Problem P, class Made>
std::unique_ptr<TimedSolve> timed_solve_of(Made&& made, Plan const& plan) {
  auto const with = [&]<class Control>(Control const& control) -> std::unique_ptr<TimedSolve> {
    auto const bind = [&](P const& own) { return Method{}.bind(own, control, plan.policy); };
    using Stepper = decltype(bind(std::declval<P const&>()));
    return std::make_unique<Solve<P, Stepper>>(std::forward<Made>(made), plan, bind);
  };
  if constexpr (RunsFixed<Method, P>)
    if (auto const* control = std::get_if<FixedStep>(&plan.control)) return with(*control);
  if constexpr (RunsAdaptive<Method, P>)
    if (auto const* control = std::get_if<Adaptive>(&plan.control)) return with(*control);
  return nullptr;
}

}  // namespace polhode::bench
