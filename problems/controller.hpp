#pragma once
/// Torque laws as parts of their own: written once in their natural attitude variable, serving every formulation.
#include <span>

#include "problems/problem.hpp"

namespace polhode {

/// Time as a controller sees it: part of the state's arithmetic when asked at every stage, a plain number at samples.
template <class C>
using ControlTime = std::conditional_t<C::sampled, Real<typename C::Scalar>, typename C::Scalar>;

/// c.torque(t, q, omega): the body torque [N m, body axes] at time t [s], attitude q, body rate omega [rad/s].
/// Controller::sampled == false: asked at every stage, and must be a pure function of its arguments.
/// Controller::sampled == true: asked once a sample period, held until the next (zero-order hold); it may remember.
template <class C>
concept Controller = Scalar<typename C::Scalar> &&
    requires(C c, ControlTime<C> t, Quat<typename C::Scalar> q, Vec3<typename C::Scalar> w) {
  { C::sampled } -> std::convertible_to<bool>;
  { c.torque(t, q, w) } -> std::same_as<Vec3<typename C::Scalar>>;
};

/// A controller that shows quantities of its own: show(q, omega, out) writes one number a column.
template <class C>
concept ShowingController = Controller<C> &&
    requires(C const c, Quat<typename C::Scalar> q, Vec3<typename C::Scalar> w, std::span<double> out) {
  c.show(q, w, out);
};

/// No torque at all: the free body.
template <Scalar S>
struct NoTorque {
  using Scalar = S;
  static constexpr bool sampled = false;
  Vec3<S> torque(S const&, Quat<S> const&, Vec3<S> const&) const { return {S(0.0), S(0.0), S(0.0)}; }
  template <class T>
  NoTorque<T> over() const {
    return {};
  }
  template <class T, class Of>
  static NoTorque<T> gathered(Of const&) {
    return {};
  }
};

}  // namespace polhode
