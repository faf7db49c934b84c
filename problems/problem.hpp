#pragma once
/// A problem is a vector field that returns body-frame velocities, written once for every formulation and scalar.
#include <span>
#include <string>
#include <vector>

#include "problems/power.hpp"

namespace polhode {

/// p(t, x) returns the velocity at time t [s] in state x; on many bodies p(t, x, v) writes it. initial() is the state
/// at 0 s. A complete one, with what the catalogue asks of it (Definition), is tests/consumer/damped_body.hpp;
/// problems/README.md goes through it.
template <class P>
concept Problem = Space<typename P::Space> &&
    requires(P const& p, typename P::Space::Scalar t, Point<typename P::Space> const x, Velocity<typename P::Space> v) {
  { p.initial() } -> std::same_as<Point<typename P::Space>>;
  requires requires {
    { p(t, x) } -> std::same_as<Velocity<typename P::Space>>;
  } || requires {
    { p(t, x, v) } -> std::same_as<void>;
  };
};
/// k = rate(x, p(t, x)), the slope at x in the chart around x. v is the room that many bodies need.
template <Problem P, class M = typename P::Space>
POLHODE_INLINE void slope(P const& p, typename M::Scalar const& t, Point<M> const& x, Velocity<M>& v, Chart<M>& k) {
  if constexpr (PowerSpace<M>) {
    p(t, x, v);
    to_rate<M>(x, v, k);
  } else {
    k = M::rate(x, p(t, x));  // one body: no detour through memory
  }
}
/// k = chart_rate(x, u, p(t, y)), the slope at y, whose coordinates in the chart around x are u.
template <Problem P, class M = typename P::Space>
POLHODE_INLINE void chart_slope(P const& p, typename M::Scalar const& t, Point<M> const& x, Chart<M> const& u,
                                Point<M> const& y, Velocity<M>& v, Chart<M>& k) {
  if constexpr (PowerSpace<M>) {
    p(t, y, v);
    if constexpr (M::flat)
      to_chart_rate<M>(x, y, v, k);
    else
      to_chart_rate<M>(x, u, v, k);
  } else {
    k = M::chart_rate(x, u, p(t, y));
  }
}

/// A problem with a digital controller. The run loop calls sample(t, x) every sample period, the output is held
/// between, and methods restart there. The period belongs to the problem: steps divide it.
template <class P>
concept SampledProblem = Problem<P> && requires(P p, Real<typename P::Space::Scalar> t, Point<typename P::Space> x) {
  p.sample(t, x);
};

/// A problem whose field is smooth only between the zeros of functions of the state.
///   state_events()          how many functions
///   event_values(t, x, g)   their values; the sign of g[k], sgn(0) = +1, is the side of x
///   take_sides(t, x)        from now on the sides are those of this state, and held; before the first call the field
///                           looks at the state anew each time it is evaluated
///   cross(k)                the side of k turns over
template <class P>
concept SwitchingProblem = Problem<P> &&
    requires(P p, P const c, typename P::Space::Scalar t, Point<typename P::Space> const x,
             Real<typename P::Space::Scalar> time, std::span<typename P::Space::Scalar> g) {
  { c.state_events() } -> std::same_as<int>;
  c.event_values(t, x, g);
  p.take_sides(time, x);
  p.cross(0);
};

/// A quantity that a problem shows beside its state: a column of `simulate`.
struct Column {
  std::string name, unit;
};

}  // namespace polhode
