#pragma once
/// The field of a problem in double, evaluated in several states at once: for methods whose stages lie in lanes.
#include "problems/lanes.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// A field that is evaluated lane after lane: of problems whose type is forgotten, and of those without over(). Gives
/// the same numbers as the field over lanes; each lane counts as an evaluation.
///   L  lanes of double
template <class L, Problem P>
class LaneByLane {
  using M = RigidBody<FlatQuaternion<L>>;
  using X = Point<RigidBody<FlatQuaternion<double>>>;

 public:
  explicit LaneByLane(P const& problem) : problem_(&problem) {}

  [[gnu::noinline]] Velocity<M> operator()(L const& t, Point<M> const& x) const {
    Velocity<M> v;
    for (int lane = 0; lane < L::count; ++lane) {
      X single;
      X::each([&](double& to, L const& from) { to = from[lane]; }, single, x);
      auto const rate = (*problem_)(t[lane], single);
      Velocity<M>::each([&](L& to, double from) { to.set(lane, from); }, v, rate);
    }
    return v;
  }

 private:
  P const* problem_;
};

/// The field of `problem` as it is now, held torques and all, over the lanes L.
template <class L, Problem P>
requires std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>> POLHODE_INLINE auto in_lanes(
    P const& problem) {
  if constexpr (requires { problem.template over<L>(); })
    return problem.template over<L>();
  else
    return LaneByLane<L, P>(problem);
}

}  // namespace polhode
