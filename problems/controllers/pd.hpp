#pragma once
/// Proportional-derivative attitude control towards the inertial axes: continuous, beside a wheel, by a computer.
#include <vector>

#include "problems/controller.hpp"

namespace polhode {

/// torque = -k_p q_v sgn(q_4) - k_d omega: smooth while the scalar part keeps its sign.
/// Source: Wie & Barba (1985), J. Guidance 8, 360
/// params  k_p [N m], k_d [N m s];  K  what they are: lanes where every body has its own
template <Scalar S, class K = Real<S>>
struct PdController {
  using Scalar = S;
  static constexpr bool sampled = false;

  K k_p, k_d;

  POLHODE_INLINE Vec3<S> torque(S const&, Quat<S> const& q, Vec3<S> const& omega) const {
    auto const towards = select(q.w < S(0.0), k_p, K(-k_p));
    return towards * vec(q) - k_d * omega;
  }
  template <class T>
  PdController<T> over() const {
    return {k_p, k_d};
  }
  /// Lane i is of(i).
  template <class T, class Of>
  static PdController<T, T> gathered(Of const& of) {
    return {T::of([&](int i) { return of(i).k_p; }), T::of([&](int i) { return of(i).k_d; })};
  }
};

/// The same law on a gyrostat, whose wheels hold a constant angular momentum h in body axes.
/// torque = h x omega + PdController's, so that  J omega' = (J omega + h) x omega + PdController's
/// Source: Hughes (1986), Spacecraft Attitude Dynamics
/// params  h [N m s, body]
template <Scalar S>
struct GyrostatPd {
  using Scalar = S;
  static constexpr bool sampled = false;

  PdController<S> law;
  Vec3<S> wheel;

  POLHODE_INLINE Vec3<S> torque(S const& t, Quat<S> const& q, Vec3<S> const& omega) const {
    return cross(wheel, omega) + law.torque(t, q, omega);
  }
  template <class T>
  GyrostatPd<T> over() const {
    return {law.template over<T>(), {T(wheel.x), T(wheel.y), T(wheel.z)}};
  }
};

/// The same law by a computer: sampled, held, commanded some samples late, in steps of an actuator.
/// delay        samples between the state and the torque that answers it; no torque before the first answer
/// torque_step  [N m] of which each component is the nearest multiple; 0: as computed
template <Scalar S>
class SampledPd {
 public:
  using Scalar = S;
  static constexpr bool sampled = true;

  SampledPd(PdController<S> const& law, std::size_t delay, Real<S> const& torque_step)
      : law_(law), torque_step_(torque_step), waiting_(delay, zero<Vec3<S>>()) {}

  Vec3<S> torque(Real<S> const& t, Quat<S> const& q, Vec3<S> const& omega) {
    Vec3<S> const answer = in_steps(law_.torque(S(t), q, omega));
    if (waiting_.empty()) return answer;
    Vec3<S> const due = waiting_[oldest_];
    waiting_[oldest_] = answer;
    oldest_ = (oldest_ + 1) % waiting_.size();
    return due;
  }

 private:
  Vec3<S> in_steps(Vec3<S> const& u) const {
    if (!(Real<S>(0.0) < torque_step_)) return u;
    auto const rounded = [&](S const& a) { return torque_step_ * nearest_whole(S(a / S(torque_step_))); };
    return {rounded(u.x), rounded(u.y), rounded(u.z)};
  }

  PdController<S> law_;
  Real<S> torque_step_;
  std::vector<Vec3<S>> waiting_;  ///< a ring of answers [N m]
  std::size_t oldest_ = 0;
};

}  // namespace polhode
