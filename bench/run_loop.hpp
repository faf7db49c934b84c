#pragma once
/// The run loop: from event to event. Events are the samples of a digital controller, announced jumps of the field, and
/// output times; they are stops: every method lands on them. Between stops a method is on its own.
#include <vector>

#include "integrators/integrator.hpp"

namespace polhode::bench {

/// A time [s] that every method lands on, and what happens there.
struct Stop {
  double time = 0;
  bool sample = false;  ///< the controller is asked; methods restart
  bool jump = false;    ///< the field is not smooth here; methods restart
  bool output = false;  ///< the state is wanted
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

/// Runs `stepper` on `problem` from the first stop to the last. watch.at_stop(stop, x) is called at each stop after its
/// sample was taken; if Watch::each_step, watch.after_step(t, x, projections) is called after every accepted step.
/// Returns the first status that is not ok; x is then the last state that was reached.
/// h [s] is the step of a fixed-step method, and 0 for methods that choose their own.
template <class P, class Stepper, class M = typename P::Space, class Watch>
Status run_from_stop_to_stop(P& problem, Stepper& stepper, Point<M>& x, std::vector<Stop> const& stops, double h,
                             Watch&& watch) {
  for (std::size_t k = 0; k < stops.size(); ++k) {
    Stop const& here = stops[k];
    if constexpr (requires { problem.sample(here.time, x); })
      if (here.sample) problem.sample(here.time, x);
    if constexpr (requires { problem.enter_phase(here.time); })
      if (here.jump) problem.enter_phase(here.time);
    if (here.sample || here.jump) stepper.restart();
    watch.at_stop(here, x);
    if (k + 1 == stops.size()) break;

    double const next = stops[k + 1].time;
    Status status = Status::ok;
    if constexpr (!std::decay_t<Watch>::each_step) {
      status = stepper.advance(x, here.time, next);
    } else if constexpr (requires(double t) { stepper.step(x, t, next); }) {
      for (double t = here.time; t < next && status == Status::ok;) {
        status = stepper.step(x, t, next);
        if (status == Status::ok) watch.after_step(t, x, stepper.projections());
      }
    } else {
      // The same steps as one advance would take, one at a time.
      double t = here.time;
      for (std::int64_t i = 1; t < next && status == Status::ok; ++i) {
        double const ahead = here.time + double(i) * h;
        double const t_next = ahead > next - 1e-9 * h ? next : ahead;
        status = stepper.advance(x, t, t_next);
        t = t_next;
        if (status == Status::ok) watch.after_step(t, x, stepper.projections());
      }
    }
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

}  // namespace polhode::bench
