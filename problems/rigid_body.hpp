#pragma once
/// One rigid body under one controller: Euler's equation in body axes,  J omega' = J omega x omega + torque.
#include <numbers>
#include <string>
#include <vector>

#include "problems/controller.hpp"
#include "problems/lanes_gather.hpp"
#include "problems/parameters.hpp"

namespace polhode {

/// Euler's equation in principal axes; 9 multiplications. sign = -1 turns J omega x omega around: the erratum of the
/// tether paper, which prints J omega' = + omega x J omega.
template <class R>
struct PrincipalInertia {
  Vec3<R> coupling;  ///< (J_y - J_z) / J_x, ... [1]
  Vec3<R> inverse;   ///< 1 / J [1/(kg m^2)]
  Vec3<R> moments;   ///< J [kg m^2]
  R sign;

  explicit PrincipalInertia(Vec3<R> const& J, R const& s = R(1.0))
      : coupling{s * (J.y - J.z) / J.x, s * (J.z - J.x) / J.y, s * (J.x - J.y) / J.z},
        inverse{R(1.0) / J.x, R(1.0) / J.y, R(1.0) / J.z},
        moments(J),
        sign(s) {}

  Mat3<R> matrix() const {
    R const none(0.0);
    return {{moments.x, none, none}, {none, moments.y, none}, {none, none, moments.z}};
  }

  template <class S>
  POLHODE_INLINE Vec3<S> acceleration(Vec3<S> const& w) const {
    return {coupling.x * (w.y * w.z), coupling.y * (w.z * w.x), coupling.z * (w.x * w.y)};
  }
  template <class S>
  POLHODE_INLINE Vec3<S> acceleration(Vec3<S> const& w, Vec3<S> const& torque) const {
    return {coupling.x * (w.y * w.z) + inverse.x * torque.x, coupling.y * (w.z * w.x) + inverse.y * torque.y,
            coupling.z * (w.x * w.y) + inverse.z * torque.z};
  }
};

/// The same for an inertia matrix that is not diagonal.
template <class R>
struct FullInertia {
  Mat3<R> J, inverse;  ///< symmetric [kg m^2], [1/(kg m^2)]
  R sign;

  explicit FullInertia(Mat3<R> const& inertia, R const& s = R(1.0)) : J(inertia), sign(s) {
    Vec3<R> const a = cross(J.e2, J.e3), b = cross(J.e3, J.e1), c = cross(J.e1, J.e2);
    R const d = R(1.0) / dot(J.e1, a);
    inverse = {d * a, d * b, d * c};  // rows of the inverse; symmetric, so columns too
  }
  Mat3<R> const& matrix() const { return J; }
  template <class S>
  Vec3<S> acceleration(Vec3<S> const& w) const {
    return acceleration(w, Vec3<S>{S(0.0), S(0.0), S(0.0)});
  }
  template <class S>
  Vec3<S> acceleration(Vec3<S> const& w, Vec3<S> const& torque) const {
    return inverse * (sign * cross(J * w, w) + torque);
  }
};

/// A torque law depends on the body rate unless it says  static constexpr bool feels_rate = false.
template <class C>
inline constexpr bool feels_rate = true;
template <class C>
  requires requires {
    C::feels_rate;
  }
inline constexpr bool feels_rate<C> = C::feels_rate;

/// A torque that does not change.
template <Scalar S>
struct HeldTorque {
  using Scalar = S;
  static constexpr bool sampled = false, feels_rate = false;
  Vec3<S> held;  ///< [N m, body]
  POLHODE_INLINE Vec3<S> torque(S const&, Quat<S> const&, Vec3<S> const&) const { return held; }
};

/// Controllers of single bodies that can be laid into lanes T, each with numbers of its own.
template <class C, class T>
concept GathersLanes = requires(C const& (*of)(int)) {
  C::template gathered<T>(of);
};

/// The field: attitude space A over scalar S, an inertia and a controller.
/// state   attitude x omega [rad/s, body]
template <Scalar S, template <class> class A, class Inertia, Controller Control>
  requires Attitude<A<S>>
struct ControlledBody {
  using Space = RigidBody<A<S>>;
  using State = Point<Space>;

  Inertia inertia;
  Control control;
  State start;
  Vec3<S> held{S(0.0), S(0.0), S(0.0)};  ///< the torque of the last sample [N m]

  Velocity<Space> operator()(S const& t, State const& x) const {
    if constexpr (std::same_as<Control, NoTorque<S>>)
      return {x.second, inertia.acceleration(x.second)};
    else if constexpr (Control::sampled)
      return {x.second, inertia.acceleration(x.second, held)};
    else
      return {x.second, inertia.acceleration(x.second, control.torque(t, A<S>::attitude(x.first), x.second))};
  }
  State initial() const { return start; }

  /// The field as it is now over the scalar T, which has the same numbers as parameters: lanes of S. Controllers that
  /// are asked at every stage have over<T>(), too.
  template <Scalar T>
    requires std::same_as<Real<T>, Real<S>> &&
        (Control::sampled || requires(Control const& c) { c.template over<T>(); }) POLHODE_INLINE auto over() const {
      auto const everywhere = [](Vec3<S> const& v) POLHODE_LAMBDA { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
      Pair<Point<A<T>>, Vec3<T>> begin;
      Point<A<T>>::each([](T& to, S const& from) POLHODE_LAMBDA { to = T(from); }, begin.first, start.first);
      begin.second = everywhere(start.second);
      if constexpr (Control::sampled)
        return ControlledBody<T, A, Inertia, HeldTorque<T>>{inertia, {everywhere(held)}, begin, {}};
      else
        return ControlledBody<T, A, Inertia, decltype(control.template over<T>())>{
            inertia, control.template over<T>(), begin, {}};
    }

    /// Bodies of one kind in lanes T, each with parameters of its own: lane i is of(i), a body that has not begun. In
    /// principal axes, under controllers that have gathered<T>(of), too.
    template <Scalar T, class Of>
    static auto gathered(Of const& of) requires std::same_as<Inertia, PrincipalInertia<Real<S>>> &&
        GathersLanes<Control, T> {
      auto control = Control::template gathered<T>([&](int i) -> Control const& { return of(i).control; });
      PrincipalInertia<T> const moments(from_lanes<Vec3<T>>(
                                            T::count, [&](int i) -> auto const& { return of(i).inertia.moments; }),
                                        T::of([&](int i) { return of(i).inertia.sign; }));
      auto const begin = from_lanes<Pair<Point<A<T>>, Vec3<T>>>(
          T::count, [&](int i) -> auto const& { return of(i).start; });
      return ControlledBody<T, A, PrincipalInertia<T>, decltype(control)>{moments, control, begin};
    }

    /// What methods for rigid bodies ask: J [kg m^2, body]; the torque [N m, body], of sampled control the one that is
    /// held; whether there is any, and whether it depends on the body rate.
    bool is_rigid_body() const {
      return inertia.sign == Real<S>(1.0);
    }  // not with the sign that one paper prints
    Mat3<Real<S>> inertia_matrix() const {
      return inertia.matrix();
    }
    Vec3<S> torque(S const& t, State const& x) const {
      if constexpr (Control::sampled)
        return held;
      else
        return control.torque(t, A<S>::attitude(x.first), x.second);
    }
    static constexpr bool torque_free() {
      return std::same_as<Control, NoTorque<S>>;
    }
    static constexpr bool torque_feels_rate() {
      return !torque_free() && !Control::sampled && feels_rate<Control>;
    }

    void sample(Real<S> const& t, State const& x) requires(Control::sampled) {
      held = control.torque(t, A<S>::attitude(x.first), x.second);
    }
    void show(State const& x, std::span<double> out) const requires ShowingController<Control> {
      control.show(A<S>::attitude(x.first), x.second, out);
    }
};

/// What every one-body problem has: inertia and initial data, as parameters.
struct BodyParameters {
  std::vector<double> inertia{100, 120, 110};          ///< 3 principal moments, or xx yy zz xy xz yz [kg m^2]
  std::vector<double> q0{0.227, 0.383, 0.227, 0.866};  ///< scalar last; normalised unless `raw_q0`
  std::vector<double> omega0{degree * 10, degree * 10, degree * 10};  ///< [rad/s, body]
  bool raw_q0 = false;                                                ///< keep |q0| as given
  double coriolis_sign = 1;                                           ///< -1: the sign that the tether paper prints

  static constexpr double degree = std::numbers::pi / 180;  ///< [rad]

  std::vector<Parameter> list() {
    return {{"inertia", "kg m^2", Rule::inertia, inertia},
            {"q0", "", Rule::unit_quaternion, q0},
            {"omega0", "rad/s", Rule::finite, omega0}};
  }
  bool principal() const { return inertia.size() == 3; }

  /// The inertia matrix [kg m^2].
  template <class R>
  Mat3<R> matrix() const {
    auto const at = [&](std::size_t i) { return i < inertia.size() ? R(inertia[i]) : R(0.0); };
    return {{at(0), at(3), at(4)}, {at(3), at(1), at(5)}, {at(4), at(5), at(2)}};
  }
  /// Euler's equation: principal, of 3 moments, the fast form; otherwise with the full matrix.
  template <class R, bool principal>
  auto euler_equation() const {
    if constexpr (principal)
      return PrincipalInertia<R>(loaded<Vec3<R>>(inertia.data()), R(coriolis_sign));
    else
      return FullInertia<R>(matrix<R>(), R(coriolis_sign));
  }
  /// Initial attitude in scalar S, normalised in that scalar.
  template <class S>
  Quat<S> attitude() const {
    Quat<S> const q = loaded<Quat<S>>(q0.data());
    return raw_q0 ? q : normalised(q);
  }
  /// Initial body rate [rad/s].
  template <class S>
  Vec3<S> rate() const {
    return loaded<Vec3<S>>(omega0.data());
  }
};

/// The field of `body`, which is principal() or not, under `control`.
template <Scalar S, template <class> class A, bool principal, Controller Control>
auto controlled_body(BodyParameters const& body, Control const& control) {
  auto inertia = body.euler_equation<Real<S>, principal>();
  return ControlledBody<S, A, decltype(inertia), Control>{
      inertia, control, {A<S>::from_attitude(body.attitude<S>()), body.rate<S>()}};
}

}  // namespace polhode
