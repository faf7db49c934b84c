#pragma once
/// Adaptive steps by proportional-integral control of the local error.
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.4 (starting step, norm, code DOPRI5's constants);
///         Gustafsson (1991), ACM TOMS 17, 533.
#include <algorithm>

#include "integrators/integrator.hpp"

namespace polhode {

/// The constants of the rule: after an error e (1 is what is allowed) and one of e_last before it the next step is
///   h clamp(safety e^-(1/order - 3/4 memory) e_last^memory, least, most)
/// Source: Hairer, Norsett & Wanner I, II.4 and IV.2, codes DOPRI5 and DOP853.
struct StepRule {
  double safety = 0.9, least = 0.2, most = 10;
  double memory = 0;  ///< beta; 0 is plain integral control
};

/// Drives a pair (see EmbeddedPair) with error control per component: |e_i| <= atol + rtol max(|y_i|, |y_new,i|), RMS.
///
/// fails   Status::step_underflow if the step falls below 10 ulp of t, Status::max_steps after `most` trial steps in
/// one
///         advance, Status::diverged if the state or its slope is not finite
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
      : pair_(std::move(pair)), problem_(&problem), control_(control), policy_(policy), frame_(shape_of(problem)) {
    if constexpr (PowerSpace<M>) {
      slope_ = shaped_like<Chart<M>>(problem.initial());
      trial_.fit(problem.initial());
      if constexpr (dense) kept_.inside.fit(problem.initial());
    }
  }

  Status advance(Point<M>& x, R t, R t_end) {
    for (std::int64_t trials = work_.steps + work_.rejected; t < t_end;) {
      if (Status const status = step(x, t, t_end); status != Status::ok) return status;
      if (work_.steps + work_.rejected - trials > most) return Status::max_steps;
    }
    return Status::ok;
  }
  /// One accepted step, not beyond t_end; t moves.
  Status step(Point<M>& x, R& t, R t_end) {
    if (!fresh_slope_) slope_at(t, x, slope_);
    fresh_slope_ = true;
    if (!all_finite(slope_)) return Status::diverged;
    if (!(R(0.0) < h_)) h_ = starting_step(x, t, t_end - t);
    bool rejected_before = false;
    R const reach(policy_ == NormPolicy::relaxation ? relaxed_reach : 1 + 1e-10);
    R relaxed(0.0);  // gamma - 1 of a step that must land, and is taken again for it
    for (std::int64_t trial = 0; trial < most; ++trial) {
      R const left = t_end - t;
      bool const last = h_ * reach >= left;
      R const h = last ? left / (R(1.0) + relaxed) : h_;
      if (double(h) <= 10 * std::numeric_limits<double>::epsilon() * std::fabs(double(t)) && !last)
        return Status::step_underflow;
      auto&& frame = frame_.open();
      frame.k[0] = slope_;
      pair_.attempt(*problem_, t, h, x, frame, trial_.y, trial_.slope, trial_.error);
      double const size = size_of_error(h, x, frame);
      if (!std::isfinite(size)) {
        if (++work_.rejected; !all_finite(x)) return Status::diverged;
        h_ = h * R(0.1);
        rejected_before = true;
        continue;
      }
      constexpr double exponent = 1.0 / Pair::order - 0.75 * rule.memory;
      double const factor = std::pow(size, exponent) / std::pow(last_size_, rule.memory);
      if (size <= 1) {
        R gamma_less_one(0.0);
        if constexpr (OneFlatQuaternion<M>)
          if (policy_ == NormPolicy::relaxation) [[unlikely]] {
            gamma_less_one = relaxation_less_one<M>(x, trial_.y);
            if (!can_relax(gamma_less_one)) {
              ++work_.rejected;
              rejected_before = true;
              h_ = h * R(0.5);
              continue;
            }
            if (last && relaxed == R(0.0) && gamma_less_one != R(0.0)) {
              relaxed = gamma_less_one;
              continue;
            }
          }
        double const growth = std::clamp(rule.safety / std::max(factor, 1e-10), rule.least, rule.most);
        // A step cut short by t_end says little about the next one.
        if (!last || h == h_ || growth < 1) h_ = h * R(rejected_before ? std::min(growth, 1.0) : growth);
        last_size_ = std::max(size, 1e-4);
        R const end = last ? t_end : R(t + h + gamma_less_one * h);
        if constexpr (dense) keep(x, t, end, gamma_less_one, frame);
        if (policy_ != NormPolicy::none)
          projections_.template apply<M>(x, trial_.y, policy_, double(h), gamma_less_one);
        x = trial_.y;
        if constexpr (Pair::first_same_as_last)
          slope_ = trial_.slope;
        else
          fresh_slope_ = false;
        t = end;
        ++work_.steps;
        if (policy_ != NormPolicy::none) fresh_slope_ = false;
        return Status::ok;
      }
      ++work_.rejected;
      rejected_before = true;
      h_ = h * R(std::max(rule.least, rule.safety / std::pow(size, exponent)));
    }
    return Status::max_steps;
  }
  /// The slope and the error's memory are forgotten, the step size is kept: the field jumped, the time scale hardly
  /// did.
  void restart() {
    fresh_slope_ = false;
    last_size_ = 1e-4;
    if constexpr (dense) kept_.goes_on = false;
  }
  /// A new run: the step size is forgotten, too.
  void begin() {
    restart();
    h_ = R(0.0);
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
  static constexpr std::int64_t most = 10'000'000;
  static constexpr StepRule rule = Pair::rule;

  double norm(Chart<M> const& error, Point<M> const& x, Point<M> const& y) const {
    double sum = 0;
    Chart<M>::each(
        [&](S const& e, S const& a, S const& b) {
          double const scale = control_.atol + control_.rtol * std::max(std::fabs(double(a)), std::fabs(double(b)));
          double const part = double(e) / scale;
          sum += part * part;
        },
        error, x, y);
    return std::sqrt(sum / size_of(error));
  }
  /// Of the trial step of h, by 1.
  double size_of_error([[maybe_unused]] R const& h, Point<M> const& x, [[maybe_unused]] auto const& frame) {
    double const size = norm(trial_.error, x, trial_.y);
    if constexpr (Pair::two_estimates) {
      pair_.template estimate_third<M>(h, frame, trial_.third);
      double const third = norm(trial_.third, x, trial_.y);
      return size > 0 ? size * size / std::sqrt(size * size + 0.01 * third * third) : size;
    } else {
      return size;
    }
  }
  /// Hairer, Norsett & Wanner I, II.4, "starting step size".
  R starting_step(Point<M> const& x, R const& t, R const& longest) {
    double const size = norm(x, x, x), speed = norm(slope_, x, x);
    double h = size < 1e-5 || speed < 1e-5 ? 1e-6 : 0.01 * size / speed;
    h = std::min(h, double(longest));
    Point<M>& y = trial_.y;
    Chart<M>& change = trial_.slope;
    y = x;
    add(y, R(h), slope_);
    slope_at(R(t + R(h)), y, change);
    add(change, R(-1.0), slope_);
    double const curvature = norm(change, x, x) / h;
    double const greatest = std::max(speed, curvature);
    double const h1 = greatest <= 1e-15 ? std::max(1e-6, h * 1e-3) : std::pow(0.01 / greatest, 1.0 / pair_.order);
    return R(std::min({100 * h, h1, double(longest)}));
  }

  void slope_at(R const& t, Point<M> const& x, Chart<M>& k) {
    auto&& frame = frame_.open();
    slope(*problem_, S(t), x, frame.v, k);
  }

  /// What a trial step gives.
  struct Trial {
    Point<M> y;
    Chart<M> slope, error, third;
    void fit(Point<M> const& x) {
      y = x;
      slope = error = shaped_like<Chart<M>>(x);
      if constexpr (Pair::two_estimates) third = error;
    }
  };
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
  Adaptive control_;
  NormPolicy policy_;
  Workspace<M, typename Pair::template Frame<M>> frame_;
  Chart<M> slope_;
  Trial trial_;
  [[no_unique_address]] std::conditional_t<dense, Kept, Nothing> kept_;
  bool fresh_slope_ = false;
  R h_ = R(0.0);
  double last_size_ = 1e-4;
  Work work_;
  Projections projections_;
};

}  // namespace polhode
