#pragma once
/// Dormand and Prince's pair under the step control that most engineers run without knowing it: that of the 4(5)
/// solvers of interactive numerical environments. It is here because published figures depend on it at loose
/// tolerances. Source: Shampine & Reichelt (1997), SIAM J. Sci. Comput. 18, 1 (control); continuous extension: Hairer,
/// Norsett & Wanner, Solving ODEs I, II.6
#include <algorithm>
#include <limits>

#include "integrators/runge_kutta.hpp"

namespace polhode {

/// The stepper of dopri5_ode45. Outputs do not shorten steps: between steps the continuous extension of order 4
/// answers. err = max |e_i| / max(|y_i|, |y_new,i|, atol / rtol) is held below rtol.
///
/// fails  Status::step_underflow below 16 ulp of t, Status::diverged if the slope is not finite
template <Problem P>
class Ode45Stepper {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using R = Real<S>;
  using Pair5 = EmbeddedPair<DormandPrince5>;

 public:
  Ode45Stepper(P const& problem, Adaptive control, NormPolicy policy)
      : problem_(&problem), control_(control), policy_(policy), y_(problem.initial()) {
    slope_ = error_ = shaped_like<Chart<M>>(y_);
    if constexpr (PowerSpace<M>) last_.fit(y_);
  }

  /// The end of the smooth arc that begins now [s]: steps are at most a tenth of it, and the last one is stretched.
  void set_horizon(R const& t, R const& t_end) {
    horizon_ = t_end;
    longest_ = (t_end - t) / R(10.0);
  }
  Status advance(Point<M>& x, R t, R t_end) {
    return in_own_steps(
        t, t_end, [&](R& now) { return step(x, now, t_end); }, [&] { return work_.steps + work_.rejected; });
  }
  /// To the end of the next step, or to t_end if that comes first.
  Status step(Point<M>& x, R& t, R t_end) {
    if (!(t < horizon_)) set_horizon(t, t_end);  // nobody has said where the arc ends
    if (fresh_) {
      y_ = x;
      reached_ = t;
      slope_at(reached_);
      if (!all_finite(slope_)) return Status::diverged;
      if (!(R(0.0) < h_)) h_ = first_step();
      fresh_ = false;
    }
    if (!(t < reached_))
      if (Status const status = go_on(); status != Status::ok) return status;
    if (t_end < reached_) {
      interpolate(t_end, x);
      t = t_end;
    } else {
      x = y_;
      t = reached_;
    }
    return Status::ok;
  }
  void restart() {
    fresh_ = true;
    h_ = R(0.0);
  }
  void begin() {
    restart();
    horizon_ = R(0.0);
  }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  /// One accepted step of the method's own, from reached_.
  Status go_on() {
    double const least = 16 * std::numeric_limits<double>::epsilon() * std::fabs(double(reached_));
    h_ = std::min(std::max(h_, R(least)), longest_);
    for (bool failed = false;; failed = true) {
      R const left = horizon_ - reached_;
      R const h = R(1.1) * h_ >= left ? left : h_;
      last_.made.k.front() = slope_;
      pair_.attempt(*problem_, reached_, h, y_, last_.made, last_.y, last_.made.k.back(), error_);
      double const err = size_of_error();
      if (err <= control_.rtol) {
        accept(h);
        if (!failed) h_ = h / R(std::max(0.2, 1.25 * std::pow(err / control_.rtol, 0.2)));
        return all_finite(slope_) ? Status::ok : Status::diverged;
      }
      ++work_.rejected;
      if (!(double(h) > least)) return all_finite(last_.y) ? Status::step_underflow : Status::diverged;
      double const factor = std::isfinite(err) ? std::max(0.1, 0.8 * std::pow(control_.rtol / err, 0.2)) : 0.1;
      h_ = std::max(R(least), h * R(failed ? 0.5 : factor));
    }
  }
  void accept(R const& h) {
    begun_ = reached_;
    last_.x = y_;
    y_ = last_.y;
    slope_ = last_.made.k.back();
    // The last step ends where it was meant to, whatever rounding made of the sum.
    reached_ = horizon_ - (reached_ + h) < R(1e-12) * h ? horizon_ : reached_ + h;
    h_ = h;
    ++work_.steps;
    if (policy_ == NormPolicy::none) return;
    projections_.template apply<M>(y_, policy_, double(h));
    slope_at(reached_);
  }
  /// slope_ at y_.
  void slope_at(R const& t) { slope(*problem_, S(t), y_, last_.made.v, slope_); }
  double threshold() const { return control_.atol / control_.rtol; }
  double size_of_error() const {
    double most = 0;
    Chart<M>::each(
        [&](S const& e, S const& a, S const& b) {
          double const scale = std::max({std::fabs(double(a)), std::fabs(double(b)), threshold()});
          double const part = std::fabs(double(e)) / scale;
          if (!(part <= most)) most = part;  // a NaN is the largest of all
        },
        error_, y_, last_.y);
    return most;
  }
  R first_step() const {
    double most = 0;
    Chart<M>::each(
        [&](S const& f, S const& a) {
          most = std::max(most, std::fabs(double(f)) / std::max(std::fabs(double(a)), threshold()));
        },
        slope_, y_);
    double const rate = most / (0.8 * std::pow(control_.rtol, 0.2));
    return double(longest_) * rate > 1 ? R(1 / rate) : longest_;
  }
  /// The state at time t [s] within the last step, under the norm policy as its end is.
  void interpolate(R const& t, Point<M>& x) const {
    R const h = reached_ - begun_;
    pair_.template interpolate<M>(R((t - begun_) / h), h, last_, x);
    if (policy_ != NormPolicy::none) Projections::apply_inside<M>(last_.x, x, policy_, double(t - begun_), R(0.0));
  }

  Pair5 pair_;
  P const* problem_;
  Adaptive control_;
  NormPolicy policy_;
  typename Pair5::template Inside<M> last_;  ///< the last step, before the norm policy; while one is tried, its trial
  Point<M> y_;                               ///< where the last step ended
  Chart<M> slope_, error_;
  R begun_ = R(0.0), reached_ = R(0.0), horizon_ = R(0.0), longest_ = R(0.0), h_ = R(0.0);
  bool fresh_ = true;
  Work work_;
  Projections projections_;
};

/// The pair under that control.   order 5, by local extrapolation, adaptive only, 6 evaluations a step; keeps nothing
struct Dopri5Ode45 {
  static constexpr MethodInfo info{
      .name = "dopri5_ode45",
      .family = Family::explicit_rk,
      .needs = Needs::flat,
      .source = "Dormand & Prince (1980); step control: Shampine & Reichelt (1997)",
      .pitfall = "its customary tolerance, 1e-3, has printed wrong digits in more than one paper",
      .no_relaxation = "its steps are those of a published step control, which knows no relaxed time"};
  template <Problem P>
    requires FlatSpace<typename P::Space>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const { return Ode45Stepper<P>(p, control, policy); }
};

}  // namespace polhode
