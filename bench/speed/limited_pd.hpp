#pragma once
/// A slew whose torque saturates: what the ensembles' benchmarks and tests run beside the free body. In speed it stands
/// for all laws with limits: three selections in every evaluation.
#include "bench/speed/ensemble_size.hpp"
#include "problems/controllers/pd.hpp"
#include "problems/rigid_body.hpp"

namespace polhode::bench {

/// PdController's torque, each component limited to torque_max.
/// params  torque_max [N m]
template <Scalar S>
struct LimitedPd {
  using Scalar = S;
  static constexpr bool sampled = false;

  PdController<S> law;
  Real<S> torque_max;

  POLHODE_INLINE Vec3<S> torque(S const& t, Quat<S> const& q, Vec3<S> const& omega) const {
    Vec3<S> u = law.torque(t, q, omega);
    S const most(torque_max);
    Vec3<S>::each([&](S& component) POLHODE_LAMBDA { component = clamp(component, S(-most), most); }, u);
    return u;
  }
};

/// The same, sampled and held.
template <Scalar S>
struct SampledLimitedPd : LimitedPd<S> {
  static constexpr bool sampled = true;
  POLHODE_INLINE Vec3<S> torque(Real<S> const& t, Quat<S> const& q, Vec3<S> const& omega) const {
    return LimitedPd<S>::torque(S(t), q, omega);
  }
};

/// The slew of the default body from its default tumble. Two of three components are at their limits at first.
template <Scalar S, template <class> class A = FlatQuaternion, class Control = LimitedPd<S>>
auto limited_slew(BodyParameters const& body = {}) {
  using R = Real<S>;
  Control control;
  control.law = {R(limited_k_p), R(limited_k_d)};
  control.torque_max = R(limited_torque_max);
  return controlled_body<S, A, true>(body, control);
}

}  // namespace polhode::bench
