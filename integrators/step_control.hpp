#pragma once
/// Adaptive steps by control of the local error: the driver of embedded pairs. What an error is: error_norm.hpp; the
/// law of the step size: step_size.hpp.
#include <algorithm>

#include "integrators/error_norm.hpp"
#include "integrators/integrator.hpp"

namespace polhode {

/// Drives a pair: EmbeddedPair on a flat space, CommutatorFreeAdaptive on a group.
///
/// fails   Status::step_underflow if the step falls below 10 ulp of t, Status::max_steps after `most_trials` trial
/// steps
///         in one advance, Status::diverged if the state or its slope is not finite
///
/// keeps_inside: the stepper has interpolate(), for a pair with a continuous extension. It copies the slopes of every
/// accepted step, which costs memory and some time (dopri5 on one body 6%), but evaluates nothing until asked.
template <class Pair, Problem P, bool keeps_inside = false>
class Controlled {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  /// There is interpolate().
  static constexpr bool dense = keeps_inside;

  Controlled(Pair pair, P const& problem, Adaptive control, NormPolicy policy)
      : pair_(std::move(pair)),
        problem_(&problem),
        policy_(policy),
        norm_(control, shape_of(problem)),
        size_(Pair::rule, Pair::order),
        frame_(shape_of(problem)) {
    if constexpr (PowerSpace<M>) {
      slope_ = shaped_like<Chart<M>>(problem.initial());
      trial_.fit(problem.initial());
      if constexpr (dense) kept_.inside.fit(problem.initial());
    }
  }

  Status advance(Point<M>& x, R t, R t_end) {
    return in_own_steps(
        t, t_end, [&](R& now) { return step(x, now, t_end); }, [&] { return work_.steps + work_.rejected; });
  }
  /// One accepted step, not beyond t_end; t moves.
  Status step(Point<M>& x, R& t, R t_end) {
    if (!fresh_slope_) slope_at(t, x, slope_);
    fresh_slope_ = true;
    if (!all_finite(slope_)) return Status::diverged;
    if (!size_.known()) {
      auto&& room = frame_.open();
      norm_.first_step(*problem_, t, x, slope_, t_end - t, size_, {trial_.weight, trial_.slope, trial_.y, room.v});
    }
    double const reach = policy_ == NormPolicy::relaxation ? relaxed_reach : 1 + 1e-10;
    R relaxed(0.0);  // gamma - 1 of a step that must land, and is taken again for it
    for (std::int64_t trials = 0; trials < most_trials; ++trials) {
      auto const trial = size_.trial(t, t_end, reach, relaxed);
      if (size_.underflows(trial, t)) return Status::step_underflow;
      auto&& frame = frame_.open();
      double const error = attempt(t, trial.h, x, frame);
      if (!size_.accepts(error)) {
        ++work_.rejected;
        if (!std::isfinite(error) && !all_finite(x)) return Status::diverged;
        size_.reject(trial, error);
        continue;
      }
      R gamma_less_one(0.0);
      if constexpr (OneFlatQuaternion<M>)
        if (policy_ == NormPolicy::relaxation) [[unlikely]] {
          gamma_less_one = relaxation_less_one<M>(x, trial_.y);
          if (!can_relax(gamma_less_one)) {
            ++work_.rejected;
            size_.reject_for(trial, 0.5);
            continue;
          }
          if (trial.last && relaxed == R(0.0) && gamma_less_one != R(0.0)) {
            relaxed = gamma_less_one;
            continue;
          }
        }
      size_.accept(trial, error);
      R const end = trial.last ? t_end : R(t + trial.h + gamma_less_one * trial.h);
      if constexpr (dense) keep(x, t, end, gamma_less_one, frame);
      if (policy_ != NormPolicy::none)
        projections_.template apply<M>(x, trial_.y, policy_, double(trial.h), gamma_less_one);
      x = trial_.y;
      if constexpr (Pair::first_same_as_last) slope_ = trial_.slope;
      fresh_slope_ = Pair::first_same_as_last && policy_ == NormPolicy::none;
      t = end;
      ++work_.steps;
      return Status::ok;
    }
    return Status::max_steps;
  }
  /// The slope and the error's memory are forgotten, the step size is kept: the field jumped, the time scale hardly
  /// did.
  void restart() {
    fresh_slope_ = false;
    size_.restart();
    if constexpr (dense) kept_.goes_on = false;
  }
  /// A new run: the step size is forgotten, too.
  void begin() {
    restart();
    size_.forget();
  }
  /// The state at time t [s] within the last accepted step, under the norm policy as its end is. The first call after a
  /// step pays the evaluations that the extension needs beyond the step's own. Not after restart(): the field may be
  /// another.
  void interpolate(R const& t, Point<M>& x) requires(dense) {
    bool const relaxed = kept_.gamma_less_one != R(0.0);
    R const span = kept_.end - kept_.begin, h = relaxed ? R(span / (R(1.0) + kept_.gamma_less_one)) : span;
    if (!kept_.complete) {
      pair_.complete(*problem_, kept_.begin, relaxed ? R(kept_.begin + h) : kept_.end, kept_.inside);
      kept_.complete = true;
      if (kept_.goes_on && !fresh_slope_ && policy_ == NormPolicy::none) {
        slope_ = pair_.template last_slope<M>(kept_.inside);
        fresh_slope_ = true;
      }
    }
    pair_.template interpolate<M>(R((t - kept_.begin) / span), h, kept_.inside, x);
    if (policy_ != NormPolicy::none)
      Projections::apply_inside<M>(kept_.inside.x, x, policy_, double(t - kept_.begin), kept_.gamma_less_one);
  }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  /// A plain problem is copied for the length of a trial, as in EqualSteps.
  using Field = std::conditional_t<std::is_trivially_copyable_v<P>, P const, P const&>;

  /// What a trial step gives.
  struct Trial {
    Point<M> y;
    Chart<M> slope, error, third, weight;
    void fit(Point<M> const& x) {
      y = x;
      slope = error = weight = shaped_like<Chart<M>>(x);
      if constexpr (Pair::two_estimates) third = error;
    }
  };
  /// One trial step of h from x to trial_; returns the square of its error, 1 being what is allowed.
  double attempt(R const& t, R const& h, Point<M> const& x, auto& frame) {
    if constexpr (ScalarTraits<S>::flattened && !PowerSpace<M>)
      return attempt_flattened(t, h, x, frame);
    else
      return attempt_in(*problem_, t, h, x, frame, trial_);
  }
  [[gnu::flatten, gnu::noinline, gnu::noclone]] double attempt_flattened(R const& t, R const& h, Point<M> const& x,
                                                                         [[maybe_unused]] auto& frame) {
    Field p = *problem_;
    if constexpr (dense) {
      return attempt_in(p, t, h, x, frame, trial_);
    } else {
      // Nobody points at these: verner98 takes two thirds of the time.
      typename Pair::template Frame<M> own;
      Trial made;
      Point<M> const from = x;
      double const square = attempt_in(p, t, h, from, own, made);
      trial_.y = made.y;
      if constexpr (Pair::first_same_as_last) trial_.slope = made.slope;
      return square;
    }
  }
  POLHODE_INLINE double attempt_in(P const& p, R const& t, R const& h, Point<M> const& x, auto& frame,
                                   Trial& made) const {
    frame.k[0] = slope_;
    pair_.attempt(p, t, h, x, frame, made.y, made.slope, made.error);
    norm_.weigh(x, made.y, made.weight);
    double const square = norm_.mean_square(made.error, made.weight);
    if constexpr (Pair::two_estimates) {
      pair_.template estimate_third<M>(h, frame, made.third);
      double const third = norm_.mean_square(made.third, made.weight);
      return square > 0 ? square * (square / (square + 0.01 * third)) : square;
    } else {
      return square;
    }
  }

  void slope_at(R const& t, Point<M> const& x, Chart<M>& k) {
    auto&& frame = frame_.open();
    slope(*problem_, S(t), x, frame.v, k);
  }

  /// What is kept of the last step, from begin to end [s]; y is where it ended before the norm policy.
  struct Kept {
    bool complete = false;
    bool goes_on = false;  ///< the next step begins where this one ended
    R begin = R(0.0), end = R(0.0), gamma_less_one = R(0.0);
    typename Pair::template Inside<M> inside;
  };
  struct Nothing {};
  POLHODE_INLINE void keep(Point<M> const& x, R const& begin, R const& end, R const& gamma_less_one,
                           auto const& frame) {
    kept_.begin = begin;
    kept_.end = end;
    kept_.gamma_less_one = gamma_less_one;
    kept_.complete = false;
    kept_.goes_on = true;
    kept_.inside.x = x;
    kept_.inside.y = trial_.y;
    std::copy(frame.k.begin(), frame.k.end(), kept_.inside.made.k.begin());
    if constexpr (Pair::first_same_as_last) kept_.inside.made.k[frame.k.size()] = trial_.slope;
  }

  Pair pair_;
  P const* problem_;
  NormPolicy policy_;
  ErrorNorm<M> norm_;
  StepSize<R> size_;
  Workspace<M, typename Pair::template Frame<M>> frame_;
  Chart<M> slope_;
  Trial trial_;
  [[no_unique_address]] std::conditional_t<dense, Kept, Nothing> kept_;
  bool fresh_slope_ = false;
  Work work_;
  Projections projections_;
};

}  // namespace polhode
