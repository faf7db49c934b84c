#pragma once
/// Gauss collocation with its stages in the lanes of vector registers, for one rigid body on flat quaternions, in a
/// frame that turns with it: equal steps, and steps of its own choice.
///
/// Long steps of high order at a small price: on smooth problems the least time of all to 1e-6 and beyond. Does not pay
/// where steps must be short, as under fast sampling. Keeps the norm, and of a free body energy and |L|.
///
/// Adaptive steps: the error of each step, known by its tail (gauss_lawson.hpp), is held to a part of the tolerance,
/// which is rtol + atol, for a rotation is of size 1, and the rate's error counts as a part of the greatest rate. The
/// stage iteration ends a factor below.
///
/// The kernel is compiled for several instruction sets beside each other, and each solve takes the widest that the
/// machine has: with the same result to the last bit, as long as products and sums are not fused (-ffp-contract=off).
#include <algorithm>
#include <cmath>

#include "integrators/gauss_lawson.hpp"
#include "integrators/integrator.hpp"
#include "integrators/step_size.hpp"

namespace polhode {

namespace detail {
/// Runs of one body by LawsonStep, in equal steps or controlled ones.
template <int s, Problem P>
class LawsonRun {
  static_assert(s == 4 || s == 8, "stages fill their registers");
  using M = typename P::Space;
  using X = Point<M>;

 public:
  void restart() { memory_.restart(); }
  Work work() const {
    Work work = work_;
    work.iterations = memory_.iterations;
    return work;
  }
  Projections projections() const { return projections_; }

 protected:
  /// Not where the field is evaluated lane by lane anyway: the result would be the same, and the time.
  static constexpr bool chooses = chooses_registers && requires(P const& p) { p.template over<Lanes<s>>(); };

  LawsonRun(P const& problem, NormPolicy policy) : problem_(&problem), policy_(policy) {}

  /// Whether the torque may depend on the body rate: then its mean damping is asked for.
  bool damps() const {
    if constexpr (requires(P const& p) { p.torque_feels_rate(); })
      return problem_->torque_feels_rate();
    else
      return true;
  }
  template <class Result>
  POLHODE_INLINE void accept(Result const& result, double h, X& x) {
    x = result.x;
    memory_.carry = result.carry;
    memory_.slopes = result.slopes;
    memory_.last_step = h;
    if (policy_ != NormPolicy::none) [[unlikely]]
      projections_.template apply<M>(x, policy_);
  }

  P const* problem_;
  NormPolicy policy_;
  Registers registers_ = widest_registers();
  LawsonMemory<s> memory_;
  Work work_;
  Projections projections_;
};
}  // namespace detail

/// Equal steps of h.
///
/// fails  Status::nonlinear_fail where a step's sweeps do not come to rest, Status::diverged
template <int s, Problem P>
class LawsonFixed : public detail::LawsonRun<s, P> {
  using Base = detail::LawsonRun<s, P>;
  using X = Point<typename P::Space>;

 public:
  LawsonFixed(P const& problem, FixedStep control, NormPolicy policy, SweepRule const& rule)
      : Base(problem, policy), h_(control.h), rule_(rule) {}

  Status advance(X& x, double t, double t_end) {
    in_equal_steps(t, t_end, h_, [&](double from, double h, std::int64_t n) { run(x, from, h, n); });
    return health_of(x);
  }
  /// One step to t_end, however long.
  Status one_step(X& x, double t, double t_end) {
    run(x, t, t_end - t, 1);
    return health_of(x);
  }

 private:
  using Base::damps, Base::memory_, Base::problem_, Base::registers_, Base::work_;

  Status health_of(X const& x) const {
    if (!all_finite(x)) return Status::diverged;
    return memory_.unconverged ? Status::nonlinear_fail : Status::ok;
  }
  void run(X& x, double t, double h, std::int64_t n) {
    work_.steps += n;
    if constexpr (Base::chooses) {
      if (registers_ == Registers::avx512) return run_avx512(x, t, h, n);
      if (registers_ == Registers::avx2) return run_avx2(x, t, h, n);
    }
    run_here(x, t, h, n);
  }
  template <int bytes>
  POLHODE_INLINE void loop(X& x, double t, double h, std::int64_t n) {
    using Step = LawsonStep<s, bytes>;
    auto const field = in_lanes<typename Step::L>(*problem_);
    bool const feels = damps();
    X y = x;
    for (std::int64_t i = 0; i < n; ++i) {
      auto const result = Step::step(field, feels, t + double(i) * h, h, y, memory_, rule_, false);
      if (!result.solved) [[unlikely]]
        memory_.unconverged = true;
      this->accept(result, h, y);
    }
    x = y;
  }
  [[gnu::flatten, gnu::noinline]] void run_here(X& x, double t, double h, std::int64_t n) {
    loop<register_bytes>(x, t, h, n);
  }
  POLHODE_TARGET("arch=x86-64-v3")
  [[gnu::flatten, gnu::noinline]] void run_avx2(X& x, double t, double h, std::int64_t n) { loop<32>(x, t, h, n); }
  POLHODE_TARGET("arch=x86-64-v4")
  [[gnu::flatten, gnu::noinline]] void run_avx512(X& x, double t, double h, std::int64_t n) { loop<64>(x, t, h, n); }

  double h_;
  SweepRule rule_;
};

/// Steps of its own choice.
///
/// fails  Status::step_underflow below 10 ulp of t, Status::nonlinear_fail if that is because
/// stages cannot be solved, Status::max_steps after `most_trials` trials in one advance, Status::diverged
template <int s, Problem P>
class LawsonControlled : public detail::LawsonRun<s, P> {
  using Base = detail::LawsonRun<s, P>;
  using X = Point<typename P::Space>;

 public:
  LawsonControlled(P const& problem, Adaptive control, NormPolicy policy) : Base(problem, policy) {
    double const error = of_tolerance * std::max(control.rtol + control.atol, 1e-15);
    most_tail_ = std::sqrt(error / error_per_tail<s>);
    rule_ = {.goal = sweeps_part * error, .to_accuracy = true};
  }

  Status advance(X& x, double t, double t_end) { return go(x, t, t_end, false); }
  /// One accepted step, not beyond t_end; t moves.
  Status step(X& x, double& t, double t_end) { return go(x, t, t_end, true); }
  /// The last step and the error's memory are forgotten, the step size is kept.
  void restart() {
    Base::restart();
    size_.restart();
  }
  /// A new run: the step size is forgotten, too.
  void begin() {
    restart();
    size_.forget();
  }

 private:
  using Base::damps, Base::memory_, Base::problem_, Base::registers_, Base::work_;
  /// The error of a step over the tolerance, for errors add up; that of the sweeps over the error of a step.
  static constexpr double of_tolerance = 0.05, sweeps_part = 0.05;
  /// Steps that grow a little cost more than they save: their starting values are worse.
  static constexpr StepRule step_rule{.least = 0.3, .most = 3, .failed = 0.3, .held = 1.1};

  Status go(X& x, double& t, double t_end, bool one) {
    if constexpr (Base::chooses) {
      if (registers_ == Registers::avx512) return go_avx512(x, t, t_end, one);
      if (registers_ == Registers::avx2) return go_avx2(x, t, t_end, one);
    }
    return go_here(x, t, t_end, one);
  }
  /// By the rate at which the state turns, and that at which its rate changes.
  double starting_step(X const& x, double t, double longest) const {
    Vec3<double> const& w = x.second;
    auto const v = (*problem_)(t, x);
    double const rate = length(w), change = length(v.second);
    double const pace = 0.5 * rate + change / (rate + std::sqrt(change) + 1e-300);
    return pace > 0 ? std::min(longest, 4 * std::pow(most_tail_, 1.0 / s) / pace) : longest;
  }
  template <int bytes>
  POLHODE_INLINE Status loop(X& x, double& t, double t_end, bool one) {
    using Step = LawsonStep<s, bytes>;
    auto const field = in_lanes<typename Step::L>(*problem_);
    bool const feels = damps();
    if (!size_.known()) size_.begin(starting_step(x, t, t_end - t));
    bool unsolved = false;
    for (std::int64_t trials = 0; t < t_end; ++trials) {
      if (trials > most_trials) return Status::max_steps;
      auto const trial = size_.even_trial(t, t_end);
      if (StepSize<double>::underflows(trial, t)) return unsolved ? Status::nonlinear_fail : Status::step_underflow;
      auto const result = Step::step(field, feels, t, trial.h, x, memory_, rule_, true);
      unsolved = !result.solved;
      double const error = unsolved ? std::numeric_limits<double>::infinity() : result.tail / most_tail_;
      if (!StepSize<double>::accepts(error * error)) [[unlikely]] {
        ++work_.rejected;
        if (!all_finite(x)) return Status::diverged;
        size_.reject(trial, error * error);
        continue;
      }
      size_.accept(trial, error * error);
      t = trial.last ? t_end : t + trial.h;
      ++work_.steps;
      this->accept(result, trial.h, x);
      if (one) break;
    }
    return all_finite(x) ? Status::ok : Status::diverged;
  }
  [[gnu::flatten, gnu::noinline]] Status go_here(X& x, double& t, double t_end, bool one) {
    return loop<register_bytes>(x, t, t_end, one);
  }
  POLHODE_TARGET("arch=x86-64-v3")
  [[gnu::flatten, gnu::noinline]] Status go_avx2(X& x, double& t, double t_end, bool one) {
    return loop<32>(x, t, t_end, one);
  }
  POLHODE_TARGET("arch=x86-64-v4")
  [[gnu::flatten, gnu::noinline]] Status go_avx512(X& x, double& t, double t_end, bool one) {
    return loop<64>(x, t, t_end, one);
  }

  double most_tail_;
  SweepRule rule_;
  StepSize<double> size_{step_rule, s};
};

/// 4 or 8 stages; evaluations  s a sweep, 4 to 14 sweeps a step; s more after a restart
template <int s>
struct GaussLawsonBy {
  SweepRule rule;

  template <Problem P>
    requires std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return LawsonFixed<s, P>(p, control, policy, rule);
  }
};
/// order 2s: equal steps, their stages solved to round-off; or steps of its own choice
template <int s>
struct GaussLawson : GaussLawsonBy<s> {
  using GaussLawsonBy<s>::bind;
  template <Problem P>
    requires std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return LawsonControlled<s, P>(p, control, policy);
  }
};

template <int s>
struct GaussLawsonEntry : GaussLawson<s> {
  static constexpr MethodInfo info{
      .name = s == 4 ? "gauss4_lawson" : "gauss8_lawson",
      .family = Family::gauss,
      .order = 2 * s,
      .needs = Needs::quaternion,
      .preserves = keeps_norm | keeps_energy | keeps_momentum,
      .source =
          "Lawson (1967), SIAM J. Numer. Anal. 4, 372; Hairer, Lubich & Wanner, II.1.3; stages in lanes: van der "
          "Houwen & Sommeijer (1990), J. Comput. Appl. Math. 29, 111",
      .pitfall =
          "steps of its own choice keep the norm only to the tolerance of their sweeps; on (q, omega) not symplectic: "
          "the direction of L errs by O(h^2s); the frame of a step depends on the one before: not symmetric",
      .no_feedback = "the next step begins from the stages of the last",
      .no_relaxation = "the next step begins from the stages of the last"};
};
/// Of those that leave the stages unsolved, for speed.
constexpr MethodInfo unsolved_info(std::string_view name, std::string_view pitfall) {
  MethodInfo info = GaussLawsonEntry<8>::info;
  info.name = name;
  info.order = 0;
  info.preserves = keeps_nothing;
  info.pitfall = pitfall;
  return info;
}
/// 6 sweeps in every step, 8 where there is no step before.
struct Gauss8LawsonSweeps6 : GaussLawsonBy<8> {
  constexpr Gauss8LawsonSweeps6() : GaussLawsonBy<8>{{.sweeps = 6}} {}
  static constexpr MethodInfo info =
      unsolved_info("gauss8_lawson_sweeps6",
                    "long steps leave an iteration error, and with it drift of the norm: compare gauss8_lawson");
};
/// Sweeps until their error is a thirtieth of the greatest error that a step has made so far, known by its tail: as
/// accurate as with the stages solved, for two thirds of the sweeps.
struct Gauss8LawsonBalanced : GaussLawsonBy<8> {
  constexpr Gauss8LawsonBalanced() : GaussLawsonBy<8>{{.to_accuracy = true, .part = 0.03}} {}
  static constexpr MethodInfo info =
      unsolved_info("gauss8_lawson_balanced",
                    "sweeps end near the method's own error, which the invariants show: compare gauss8_lawson");
};

}  // namespace polhode
