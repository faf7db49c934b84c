#pragma once
/// A problem as libraries want it: plain numbers in, plain numbers out, the flat coordinates in storage order.
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

}  // namespace polhode
