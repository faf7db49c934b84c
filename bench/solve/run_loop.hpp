#pragma once
/// The run loop: from event to event. The samples of a digital controller, announced jumps of the field and output
/// times are stops: every method lands on them, but for outputs of methods with dense output, which look back into
/// their steps. Between stops a method is on its own, except where the field switches with the state and the method can
/// be told where, and where points are replaced by equivalent ones.
#include <optional>
#include <span>
#include <vector>

#include "integrators/events.hpp"

namespace polhode::bench {

/// A time [s] of a run, and what happens there.
struct Stop {
  double time = 0;
  bool sample = false;  ///< the controller is asked; methods restart
  bool jump = false;    ///< the field is not smooth here; methods restart
  bool output = false;  ///< the state is wanted

  bool restarts() const { return sample || jump; }
};

/// What decides the stops of a run.
struct Schedule {
  double t_end = 0;           ///< [s]
  double sample_period = 0;   ///< [s]; 0 = continuous control
  std::vector<double> jumps;  ///< announced time events [s]
  double output_period = 0;   ///< [s]; 0 = no outputs but the end
};

/// All stops from 0 to t_end, ascending; times that agree to 1e-9 of the horizon are one stop.
std::vector<Stop> stops_of(Schedule const& schedule);

/// Does nothing at stops and steps: timed runs.
struct NoWatch {
  static constexpr bool each_step = false;
  template <class X>
  void at_stop(Stop const&, X const&) {}
};

/// What the run loop did to find events.
struct Located {
  std::int64_t events = 0;      ///< crossings of switching functions that steps ended on
  std::int64_t trials = 0;      ///< steps taken and given up to find them
  std::vector<double> times{};  ///< of the first 256 [s]
};

/// One run of `stepper` on `problem` from stop to stop.
///   h       [s] the step of a fixed-step method, 0 for methods that choose their own
///   locate  find the zeros of the problem's switching functions, and have steps end there
template <class P, class Stepper>
class RunLoop {
  using M = typename P::Space;
  using R = Real<typename M::Scalar>;
  static constexpr bool chooses_steps = requires(Stepper s, Point<M> x, R t) { s.step(x, t, t); };
  static constexpr bool finds_roots = requires(Stepper s) { s.find_roots(); };
  static constexpr bool looks_back = requires(Stepper s, Point<M> x, R t) { s.interpolate(t, x); };

 public:
  RunLoop(P& problem, Stepper& stepper, double h, bool locate) : problem_(problem), stepper_(stepper), h_(h) {
    if constexpr (SwitchingProblem<P>)
      if (locate && problem.state_events() > 0) locator_.emplace(problem, problem.initial());
    if constexpr (finds_roots)
      if (locator_) stepper.find_roots();
  }

  /// watch.at_stop(stop, x) is called at each stop after its sample was taken; if Watch::each_step,
  /// watch.after_step(t, x, projections) is called after every accepted step. Returns the first status that is not ok;
  /// x is then the last state that was reached.
  template <class Watch>
  Status go(Point<M>& x, std::vector<Stop> const& stops, Watch&& watch) {
    for (std::size_t k = 0; k < stops.size();) {
      Stop const& here = stops[k];
      R const now(here.time);
      if constexpr (requires { problem_.sample(now, x); })
        if (here.sample) problem_.sample(now, x);
      if constexpr (requires { problem_.enter_phase(now); })
        if (here.jump) problem_.enter_phase(now);
      if (here.restarts()) stepper_.restart();
      if constexpr (requires { stepper_.set_horizon(now, now); })
        if (k == 0 || here.restarts()) stepper_.set_horizon(now, R(stops[arc_end(stops, k)].time));
      if (locator_ && (k == 0 || here.restarts())) take_sides(now, x);
      watch.at_stop(here, x);
      if (k + 1 == stops.size()) break;
      std::size_t const next = looks_back && !locator_ ? arc_end(stops, k) : k + 1;
      std::span const outputs(stops.data() + k + 1, next - k - 1);
      if (Status const status = between(x, now, R(stops[next].time), outputs, watch); status != Status::ok)
        return status;
      k = next;
    }
    return Status::ok;
  }
  Located located() const {
    return locator_ ? Located{locator_->found(), locator_->trials(), locator_->times()} : Located{};
  }

 private:
  /// The stop where the smooth arc that begins at stop k ends.
  static std::size_t arc_end(std::vector<Stop> const& stops, std::size_t k) {
    for (++k; k + 1 < stops.size(); ++k)
      if (stops[k].restarts()) break;
    return std::min(k, stops.size() - 1);
  }
  /// From stop to stop; the outputs between them are for steppers that look back.
  template <class Watch>
  Status between(Point<M>& x, R const& from, R const& to, std::span<Stop const> outputs, Watch&& watch) {
    if constexpr (!std::decay_t<Watch>::each_step && !Settling<M>)
      if (!locator_ && outputs.empty()) return stepper_.advance(x, from, to);
    R t = from;
    bool on_grid = true;
    for (std::int64_t i = 1; t < to;) {
      if (locator_ && !finds_roots) locator_->before_step(t, x);
      if constexpr (chooses_steps) {
        if (Status const status = stepper_.step(x, t, to); status != Status::ok) return status;
      } else {
        R const next = from + R(double(i) * h_);
        if (Status const status = fixed_step(x, t, next, to, on_grid); status != Status::ok) return status;
      }
      bool crossed = false;
      if (locator_)
        if (Status const status = locate(t, x, crossed); status != Status::ok) return status;
      if (!crossed) ++i;
      on_grid = !crossed;
      if constexpr (looks_back)
        for (; !outputs.empty() && !(t < R(outputs.front().time)); outputs = outputs.subspan(1)) {
          Point<M> inside = x;
          stepper_.interpolate(R(outputs.front().time), inside);
          if constexpr (Settling<M>) M::settle(inside);
          watch.at_stop(outputs.front(), inside);
        }
      if constexpr (requires { watch.multiplier(stepper_.multiplier()); }) watch.multiplier(stepper_.multiplier());
      if constexpr (std::decay_t<Watch>::each_step) watch.after_step(t, x, stepper_.projections());
      if constexpr (Singular<M> && std::decay_t<Watch>::each_step)
        if (M::singular(x)) return Status::diverged;
      if constexpr (Settling<M>)
        if (M::settle(x)) {
          stepper_.restart();
          if (locator_) take_sides(t, x);
        }
    }
    return Status::ok;
  }
  /// The same steps as one advance would take, one at a time: to `ahead`, or to `to` if that comes first; after an
  /// event, the rest of the step it was in. In relaxed time the stepper itself says where a step ends.
  Status fixed_step(Point<M>& x, R& t, R const& ahead, R const& to, bool on_grid) {
    if constexpr (requires { stepper_.moves_time(); })
      if (stepper_.moves_time()) return stepper_.relaxed_step(x, t, to);
    R const begun = t;
    t = ahead > to - R(1e-9 * h_) ? to : ahead;
    return on_grid ? stepper_.advance(x, begun, t) : advance_exactly(stepper_, x, begun, t);
  }
  Status locate(R& t, Point<M>& x, bool& crossed) {
    if constexpr (!SwitchingProblem<P>) return Status::ok;
    if constexpr (SwitchingProblem<P> && finds_roots) {
      for (int const k : stepper_.roots()) locator_->cross(problem_, t, k);
      crossed = !stepper_.roots().empty();
      if (crossed) stepper_.restart();
      return Status::ok;
    } else if constexpr (SwitchingProblem<P>) {
      return locator_->after_step(problem_, stepper_, t, x, crossed);
    }
  }
  void take_sides([[maybe_unused]] R const& t, [[maybe_unused]] Point<M> const& x) {
    if constexpr (SwitchingProblem<P>) locator_->take_sides(problem_, t, x);
  }

  P& problem_;
  Stepper& stepper_;
  double h_;
  std::optional<EventLocator<M>> locator_;
};

}  // namespace polhode::bench
