#pragma once
/// A problem as libraries want it: plain numbers in, plain numbers out, the flat coordinates in storage order; and the
/// driver of their equal steps.
#include "integrators/integrator.hpp"

namespace polhode {

/// A problem that libraries can run: flat coordinates, in double.
template <class P>
concept LibraryProblem = Problem<P> && FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, double>;

/// The field of p over arrays of doubles. Many bodies need room, which is made once; one body lives in registers.
template <LibraryProblem P>
class LibraryField {
  using M = typename P::Space;

 public:
  explicit LibraryField(P const& p) : problem_(&p) {
    if constexpr (PowerSpace<M>) {
      room_.x = p.initial();
      room_.k = shaped_like<Chart<M>>(room_.x);
      room_.v = shaped_like<Velocity<M>>(room_.x);
    }
  }
  P const& problem() const { return *problem_; }
  /// How many numbers a state has.
  int size() const {
    if constexpr (PowerSpace<M>)
      return size_of(room_.x);
    else
      return Point<M>::size;
  }

  /// dydt = f(t, y)
  void operator()(double t, double const* y, double* dydt) const {
    with_point(y, [&](Point<M>& x, Velocity<M>& v, Chart<M>& k) {
      slope(*problem_, t, x, v, k);
      store(k, dydt);
    });
  }
  /// Calls f(x) with the point that y describes, and writes back what f made of it.
  template <class F>
  void change(double* y, F f) const {
    with_point(y, [&](Point<M>& x, Velocity<M>&, Chart<M>&) {
      f(x);
      store(x, y);
    });
  }
  /// Values of the switching functions.
  void event_values(double t, double const* y, double* values) const requires SwitchingProblem<P> {
    with_point(y, [&](Point<M>& x, Velocity<M>&, Chart<M>&) {
      problem_->event_values(t, x, std::span(values, std::size_t(problem_->state_events())));
    });
  }

 private:
  struct Room {
    Point<M> x;
    Velocity<M> v;
    Chart<M> k;
  };
  template <class F>
  POLHODE_INLINE void with_point(double const* y, F f) const {
    if constexpr (PowerSpace<M>) {
      load(room_.x, y);
      f(room_.x, room_.v, room_.k);
    } else {
      Room here;
      load(here.x, y);
      f(here.x, here.v, here.k);
    }
  }

  P const* problem_;
  mutable std::conditional_t<PowerSpace<M>, Room, NoMemory> room_;
};

/// Equal steps of a library's method.   Steps  made from the problem and `more`:
///   field()    the problem as the library sees it
///   numbers()  the state that it works on
///   step(t, h) one step of it from t [s]; an explicit step fails only with its field, and ours returns no errors
///   restart()  forgets what it keeps from step to step
/// fails  Status::diverged if the state is no longer finite at t_end
template <class Steps, LibraryProblem P>
class LibraryFixed {
  using X = Point<typename P::Space>;

 public:
  template <class... More>
  LibraryFixed(P const& problem, FixedStep control, NormPolicy policy, More... more)
      : steps_(problem, more...), h_(control.h), policy_(policy) {}

  Status advance(X& x, double t, double t_end) {
    return run(x, [&] {
      in_equal_steps(t, t_end, h_, [&](double from, double h, std::int64_t n) {
        for (std::int64_t i = 0; i < n; ++i) step(from + double(i) * h, h);
      });
    });
  }
  /// One step to t_end, however long.
  Status one_step(X& x, double t, double t_end) {
    return run(x, [&] { step(t, t_end - t); });
  }
  void restart() { steps_.restart(); }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  template <class F>
  Status run(X& x, F take_steps) {
    store(x, steps_.numbers());
    take_steps();
    load(x, steps_.numbers());
    return all_finite(x) ? Status::ok : Status::diverged;
  }
  void step(double t, double h) {
    steps_.step(t, h);
    ++work_.steps;
    if (policy_ == NormPolicy::none) return;
    steps_.field().change(steps_.numbers(), [&](X& x) { projections_.template apply<typename P::Space>(x, policy_); });
    steps_.restart();  // a method that reuses its last slope must not: the state moved
  }

  Steps steps_;
  double h_;
  NormPolicy policy_;
  Work work_;
  Projections projections_;
};

}  // namespace polhode
