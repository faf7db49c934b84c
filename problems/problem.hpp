#pragma once
/// A problem is a vector field that returns body-frame velocities, written once for every formulation and scalar.
#include <span>
#include <string>
#include <vector>

#include "problems/space.hpp"

namespace polhode {

/// p(t, x) returns the velocity at time t [s] in state x; initial() is the state at 0 s.
template <class P>
concept Problem = Space<typename P::Space> &&
    requires(P const p, typename P::Space::Scalar t, Point<typename P::Space> x) {
  { p.initial() } -> std::same_as<Point<typename P::Space>>;
  { p(t, x) } -> std::same_as<Velocity<typename P::Space>>;
};

/// A problem with a digital controller. The run loop calls sample(t, x) every sample period, the output is held
/// between, and methods restart there. The period belongs to the problem: steps divide it.
template <class P>
concept SampledProblem = Problem<P> && requires(P p, Real<typename P::Space::Scalar> t, Point<typename P::Space> x) {
  p.sample(t, x);
};

/// A quantity that a problem shows beside its state: a column of `simulate`.
struct Column {
  std::string name, unit;
};

}  // namespace polhode
