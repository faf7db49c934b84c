#pragma once
/// Splittings for tests, and a top under a weight that they have to cope with.
#include "integrators/splitting.hpp"
#include "problems/rigid_body.hpp"

namespace polhode::test {

template <class... Method, class F>
void for_each(F f) {
  (f(Method{}), ...);
}
/// Calls f(method) for each.
template <class F>
void for_each_splitting(F f) {
  for_each<SplitStrang, SplitYoshida4, SplitBm4, SplitSrStrang, SplitSrBm4, ExactKicks, ExactKicks4>(f);
}

/// An asymmetric body under the weight of an arm; a shaken one: the weight swings in time.
template <Scalar S>
struct Weight {
  using Scalar = S;
  static constexpr bool sampled = false;
  static constexpr bool feels_rate = false;
  bool shaken = false;
  std::int64_t* asked = nullptr;

  Vec3<S> torque(S const& t, Quat<S> const& q, Vec3<S> const&) const {
    if (asked) ++*asked;
    S const one(1.0), none(0.0), swing = shaken ? S(Real<S>(0.5) * sin(S(Real<S>(3.0) * t))) : none;
    return cross(Vec3<S>{none, none, one}, to_body(q, Vec3<S>{swing, none, -one}));
  }
  /// Of the weight [J], not shaken.
  static S energy(Quat<S> const& q) { return to_inertial(q, Vec3<S>{S(0.0), S(0.0), S(1.0)}).z; }
};
/// The same law, which keeps to itself that it does not look at the rate.
template <Scalar S>
struct SecretiveWeight {
  using Scalar = S;
  static constexpr bool sampled = false;
  Weight<S> weight;
  Vec3<S> torque(S const& t, Quat<S> const& q, Vec3<S> const& omega) const { return weight.torque(t, q, omega); }
};
inline BodyParameters top() {
  return {.inertia = {0.5, 0.85, 1}, .q0 = {0.2, 0.4, 0.8, 0.4}, .omega0 = {0.4, 1 / 0.85, 0.4}};
}
template <Scalar S, template <class> class A>
auto top_under(Weight<S> const& weight) {
  return controlled_body<S, A, true>(top(), weight);
}

}  // namespace polhode::test
