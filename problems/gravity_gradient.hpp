#pragma once
/// Satellite on a circular orbit under the gravity gradient: smooth, a torque of the attitude, a long horizon.
///
/// Orbital axes: z (o3) to the nadir, y (o2) against the orbit's normal, x along the velocity; they turn at (0, -n, 0)
/// in orbital components. The attitude takes body to orbital axes and turns at omega - omega_orbit = omega + n o2;
/// omega is the inertial rate.
///   J omega' = J omega x omega + 3 n^2 o3 x J o3
/// Invariant: Jacobi's integral, the energy in the turning axes. Energy and angular momentum are none.
///
/// Source: Hughes (1986), Spacecraft Attitude Dynamics, ch. 9. Chosen: the body, its initial data, 6 orbits.
///
/// state   attitude (body to orbital axes) x omega [rad/s, body]
///
/// params  inertia [kg m^2], q0, omega0 [rad/s, body], orbit_rate n [rad/s]
#include <algorithm>
#include <numbers>

#include "problems/definition.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// The field.   A  attitude
template <Scalar S, Attitude A, class Inertia>
struct GravityGradientBody {
  using Space = RigidBody<A>;
  using State = Point<Space>;

  Inertia inertia;
  Real<S> n;         ///< [rad/s]
  Real<S> three_n2;  ///< 3 n^2 [1/s^2]
  State start;

  /// The torque about o3 is Euler's term of o3, turned around: 3 n^2 o3 x J o3 = -3 n^2 (J o3 x o3).
  Velocity<Space> operator()(S const&, State const& x) const {
    OrbitalAxes const o = axes(x);
    return {x.second + n * o.y, inertia.acceleration(x.second) - three_n2 * inertia.acceleration(o.z)};
  }
  State initial() const { return start; }

  /// Jacobi's integral [J]:  1/2 w.J w + 3/2 n^2 o3.J o3 - 1/2 n^2 o2.J o2,   w = omega + n o2
  S jacobi(State const& x) const {
    OrbitalAxes const o = axes(x);
    Vec3<S> const w = x.second + n * o.y;
    return Real<S>(0.5) * (moment(w) + three_n2 * moment(o.z) - (n * n) * moment(o.y));
  }
  /// Between the body's z and the nadir [rad], 0 .. pi.
  S nadir_angle(State const& x) const {
    Vec3<S> const z = axes(x).z;
    return atan2(sqrt(S(z.x * z.x + z.y * z.y)), z.z);
  }
  void show(State const& x, std::span<double> out) const {
    out[0] = double(nadir_angle(x));
    out[1] = double(jacobi(x));
  }

 private:
  struct OrbitalAxes {
    Vec3<S> y, z;  ///< o2, o3 in body components: rows of the attitude's matrix
  };
  static POLHODE_INLINE OrbitalAxes axes(State const& x) {
    Mat3<S> const m = rotation_of<A>(x.first);
    return {{m.e1.y, m.e2.y, m.e3.y}, {m.e1.z, m.e2.z, m.e3.z}};
  }
  /// v.J v
  S moment(Vec3<S> const& v) const {
    Mat3<Real<S>> const J = inertia.matrix();
    return J.e1.x * (v.x * v.x) + J.e2.y * (v.y * v.y) + J.e3.z * (v.z * v.z) +
           Real<S>(2.0) * (J.e2.x * (v.x * v.y) + J.e3.x * (v.x * v.z) + J.e3.y * (v.y * v.z));
  }
};

/// The catalogue entry: parameters of body and orbit, columns and claims.
class GravityGradient {
 public:
  explicit GravityGradient(Choice const& choice) {
    assign(parameters(), choice.set);
    double const orbits = 6 * 2 * std::numbers::pi / n_;
    horizon = 100 * std::ceil(orbits / 100);
  }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "gravity_gradient",
        .summary = "satellite under the gravity gradient: a long smooth motion whose torque depends on the attitude",
        .source = "Hughes (1986), Spacecraft Attitude Dynamics, ch. 9",
        .variants = {},
        .events = {},
        .claims = {{"jacobi_drift",
                    "Jacobi's integral is invariant: its greatest change, relative to its start, "
                    "at most 1e-6",
                    {},
                    ""}},
        .step = 20,  // 0.02 rad of the orbit
        .pointing = "nadir_angle"};
    return facts;
  }
  std::vector<Parameter> parameters() {
    std::vector<Parameter> list = body_.list();
    list.emplace_back("orbit_rate", "rad/s", Rule::positive, n_);
    return list;
  }

  double horizon;            ///< [s]; 6 orbits, up to the next 100 s, which steps divide
  double sample_period = 0;  ///< continuous
  bool torque_free() const { return false; }
  bool principal() const { return body_.principal(); }
  std::vector<Column> columns() const { return {{"nadir_angle", "rad"}, {"jacobi", "J"}}; }
  std::vector<ClaimResult> claims(History const& history) const;

  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    using R = Real<S>;
    auto inertia = body_.euler_equation<R, fast>();
    R const n(n_);
    return GravityGradientBody<S, A<S>, decltype(inertia)>{
        .inertia = inertia,
        .n = n,
        .three_n2 = R(3.0) * n * n,
        .start = {A<S>::from_attitude(body_.attitude<S>()), body_.rate<S>()}};
  }

 private:
  /// q4 = sqrt(.985); omega0 = (0, -n, 0) + (1, -2, 1) 1e-4 rad/s.
  BodyParameters body_{
      .inertia = {100, 120, 80}, .q0 = {0.05, 0.1, -0.05, 0.9924716620639604}, .omega0 = {1e-4, -1.3e-3, 1e-4}};
  double n_ = 1.1e-3;  ///< [rad/s]
};

inline std::vector<ClaimResult> GravityGradient::claims(History const& history) const {
  std::vector<double> const jacobi = history.column("jacobi");
  if (jacobi.empty() || jacobi.front() == 0) return {};
  double most = 0;
  for (double value : jacobi) most = std::max(most, std::fabs(value - jacobi.front()));
  double const drift = most / std::fabs(jacobi.front());
  return {{"jacobi_drift", drift, {}, drift <= 1e-6}};
}

}  // namespace polhode
