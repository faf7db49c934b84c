#pragma once
/// Adaptive steps for Gauss collocation, on every space.
///
/// Error estimate: h gamma (f(x) - f^), f^ the slope that the stages' polynomial has where the step begins: the
/// embedded formula with one more node, at c = 0, of order s; gamma = 1 / (s + 1)^2, that node's weight in Radau's
/// quadrature. It falls as h^(s+1), the method's error as h^(2s+1), so the estimate is held to
/// 0.1 tol^((s+1)/(2s)): errors then are in proportion to the tolerance that was asked for.
///
/// Sources: Hairer & Wanner, Solving ODEs II, IV.8 (estimate; the tolerance as in their code RADAU); the norm:
/// error_norm.hpp; the law of the step size: step_size.hpp.
#include <cmath>
#include <limits>

#include "integrators/error_norm.hpp"
#include "integrators/gauss_stages.hpp"

namespace polhode {

/// Drives Gauss collocation with error control.
/// evaluations  those of the stages, and one for the slope at x
/// fails   Status::step_underflow if the step falls below 10 ulp of t, Status::nonlinear_fail if that is because stages
///         cannot be solved, Status::max_steps after `most_trials` trial steps in one advance, Status::diverged if the
///         state or its slope is not finite
template <Problem P>
class GaussControlled {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  GaussControlled(int stages, P const& problem, Adaptive control, NormPolicy policy)
      : stages_(stages),
        problem_(&problem),
        policy_(policy),
        norm_(inner(control, stages), shape_of(problem)),
        size_({.most = 5, .memory = 0.2 / (stages + 1), .failed = 0.2}, stages + 1),
        method_(stages, shape_of(problem)) {
    Point<M> const shape = shape_of(problem);
    memory_.fit(shape);
    trial_ = shape;
    error_ = weight_ = carry_ = shaped_like<Chart<M>>(shape);
  }

  Status advance(Point<M>& x, R t, R t_end) {
    return in_own_steps(
        t, t_end, [&](R& now) { return step(x, now, t_end); }, [&] { return work_.steps + work_.rejected; });
  }
  /// One accepted step, not beyond t_end; t moves.
  Status step(Point<M>& x, R& t, R t_end) {
    slope(*problem_, S(t), x, method_.velocity(), method_.start_slope());
    if (!all_finite(method_.start_slope())) return Status::diverged;
    if (!size_.known())
      norm_.first_step(*problem_, t, x, method_.start_slope(), t_end - t, size_,
                       {weight_, error_, trial_, method_.velocity()});
    bool unsolved = false;
    double const reach = policy_ == NormPolicy::relaxation ? relaxed_reach : 1 + 1e-10;
    R relaxed(0.0);  // gamma - 1 of a step that must land, and is taken again for it
    for (std::int64_t trials = 0; trials < most_trials; ++trials) {
      auto const trial = size_.trial(t, t_end, reach, relaxed);
      R const h = trial.h;
      if (size_.underflows(trial, t)) return unsolved ? Status::nonlinear_fail : Status::step_underflow;
      trial_ = x;
      carry_ = memory_.carry;
      method_.step(*problem_, S(t), h, trial_, memory_, true);
      unsolved = memory_.unconverged;
      double const error = unsolved ? std::numeric_limits<double>::infinity() : square_of_error(h, x);
      if (!size_.accepts(error)) {
        ++work_.rejected;
        if (!all_finite(x)) return Status::diverged;
        take_back();
        size_.reject(trial, error);
        continue;
      }
      R gamma_less_one(0.0);
      if constexpr (OneFlatQuaternion<M>)
        if (policy_ == NormPolicy::relaxation) [[unlikely]] {
          gamma_less_one = relaxation_less_one<M>(x, trial_);
          bool const possible = can_relax(gamma_less_one);
          if (!possible || (trial.last && relaxed == R(0.0) && gamma_less_one != R(0.0))) {
            take_back();
            if (possible) {
              relaxed = gamma_less_one;
            } else {
              ++work_.rejected;
              size_.reject_for(trial, 0.5);
            }
            continue;
          }
        }
      size_.accept(trial, error);
      if (policy_ != NormPolicy::none) projections_.template apply<M>(x, trial_, policy_, double(h), gamma_less_one);
      std::swap(x, trial_);
      t = trial.last ? t_end : R(t + h + gamma_less_one * h);
      ++work_.steps;
      return Status::ok;
    }
    return Status::max_steps;
  }
  /// The error's memory and the last step are forgotten, the step size is kept: the field jumped, the time scale hardly
  /// did.
  void restart() {
    memory_.restart();
    size_.restart();
  }
  /// A new run: the step size is forgotten, too.
  void begin() {
    restart();
    size_.forget();
  }
  Work work() const {
    Work work = work_;
    work.iterations = memory_.iterations;
    work.jacobians = memory_.jacobians;
    return work;
  }
  Projections projections() const { return projections_; }

 private:
  /// The last step never was.
  void take_back() {
    memory_.carry = carry_;
    memory_.last_step = R(0.0);
    memory_.unconverged = false;
  }

  /// The tolerance that the estimate is held to.
  static Adaptive inner(Adaptive const& asked, int stages) {
    double const exponent = (stages + 1) / (2.0 * stages);
    if (!(asked.rtol > 0)) return {0, 0.1 * std::pow(asked.atol, exponent)};
    double const rtol = 0.1 * std::pow(asked.rtol, exponent);
    return {rtol, rtol * asked.atol / asked.rtol};
  }
  /// Of the step from x to trial_, in units of what is allowed.
  double square_of_error(R const& h, Point<M> const& x) {
    method_.slope_by_stages(error_);
    Chart<M>::each([&](S& e, S const& slope) { e = h * slope - e; }, error_, method_.start_slope());
    norm_.weigh(x, trial_, weight_);
    double const per_gamma = (stages_ + 1) * (stages_ + 1);
    return norm_.mean_square(error_, weight_) / (per_gamma * per_gamma);
  }

  int stages_;
  P const* problem_;
  NormPolicy policy_;
  ErrorNorm<M> norm_;
  StepSize<R> size_;
  GaussMethod<M> method_;
  GaussMemory<M> memory_;
  Point<M> trial_;
  Chart<M> error_, weight_, carry_;
  Work work_;
  Projections projections_;
};

}  // namespace polhode
