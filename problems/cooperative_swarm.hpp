#pragma once
/// The field of five spacecraft under cooperative sliding-mode torques, their accelerations solved for together.
/// Source: Ma, Dong, Ma & Wang (2018), Journal of Astronautics 39(6), 664: see so3_cooperative.hpp
#include <algorithm>
#include <cmath>
#include <span>

#include "problems/controllers/cooperative.hpp"
#include "problems/euler.hpp"
#include "problems/graph.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

inline constexpr int cooperative_craft = 5;

/// The field: e_Omega' as wanted, for all craft at once, because each one's command turns with those that it hears:
///   (1 - rho P D) Omega' = wanted - Omega x rho P Omega_d + rho P n_d
/// On `switching` five state events: a craft's angle to its command is 20 deg.   A  attitude
template <Scalar S, Attitude A>
struct CooperativeSwarm {
  using Space = RigidBodies<A>;
  using State = Point<Space>;
  static constexpr std::size_t craft = cooperative_craft;
  static constexpr double switching_cosine = 0.93969262078590838405;  ///< of 20 deg
  template <class T>
  using Each = std::array<T, craft>;

  Graph graph;  ///< weights of a row sum to 1
  CooperativeLaw<S> law;
  CooperativeSurface surface;
  bool switching;
  Each<Mat3<Real<S>>> inertia;  ///< [kg m^2]
  State start;
  Each<bool> close{};  ///< sides, if held: within 20 deg
  bool holds_sides = false;

  void operator()(S const&, State const& x, Velocity<Space>& v) const {
    Each<Vec3<S>> const changes = accelerations(x);
    for (int i = 0; i < cooperative_craft; ++i) v[i] = {x[i].second, changes[std::size_t(i)]};
  }
  State initial() const { return start; }

  int state_events() const { return switching ? cooperative_craft : 0; }
  void event_values(S const&, State const& x, std::span<S> g) const {
    if (!switching) return;
    auto const R = rotations(x);
    for (std::size_t i = 0; i < craft; ++i) g[i] = closeness(errors(i, x, R, command(i, x, R)));
  }
  void take_sides(Real<S> const&, State const& x) {
    if (!switching) return;
    auto const R = rotations(x);
    for (std::size_t i = 0; i < craft; ++i) close[i] = is_close(errors(i, x, R, command(i, x, R)));
    holds_sides = true;
  }
  void cross(int k) { close[std::size_t(k)] = !close[std::size_t(k)]; }

  /// The matrices as the law sees them.
  Each<Mat3<S>> rotations(State const& x) const {
    Each<Mat3<S>> all;
    for (int i = 0; i < cooperative_craft; ++i) all[std::size_t(i)] = rotation_of<A>(x[i].first);
    return all;
  }
  CooperativeCommand<S> command(std::size_t i, State const& x, Each<Mat3<S>> const& R) const {
    HeardAxes<S> heard;
    graph.each_heard(int(i), [&](int j, double a) { heard.hear(Real<S>(a), R[std::size_t(j)], x[j].second); });
    return CooperativeCommand<S>(heard);
  }
  CooperativeErrors<S> errors(std::size_t i, State const& x, Each<Mat3<S>> const& R,
                              CooperativeCommand<S> const& command) const {
    return {R[i], x[int(i)].second, command, law.rho};
  }
  /// The surface that craft i, with these errors, is on.
  CooperativeSurface surface_of(std::size_t i, CooperativeErrors<S> const& e) const {
    if (!switching) return surface;
    return (holds_sides ? close[i] : is_close(e)) ? CooperativeSurface::near : CooperativeSurface::far;
  }
  /// Omega' of every craft [rad/s^2, body].
  Each<Vec3<S>> accelerations(State const& x) const {
    constexpr std::size_t n = 3 * craft;
    auto const R = rotations(x);
    std::array<std::array<S, n>, n> system;
    for (auto& row : system) row.fill(S(0.0));
    std::array<S, n> right;
    for (std::size_t i = 0; i < craft; ++i) {
      CooperativeCommand<S> const goal = command(i, x, R);
      CooperativeErrors<S> const e = errors(i, x, R, goal);
      Vec3<S> const wanted = law.wanted(law.virtual_control(surface_of(i, e), e), e.omega);
      store(wanted - polhode::cross(x[int(i)].second, e.fed) + law.rho * transposed_times(e.Q, goal.drift),
            right.data() + 3 * i);
      for (std::size_t k = 0; k < 3; ++k) system[3 * i + k][3 * i + k] = S(1.0);
      graph.each_heard(int(i), [&](int j, double a) {
        Mat3<S> const D = goal.response(Real<S>(a), R[std::size_t(j)]);
        set_column(system, 3 * i, 3 * std::size_t(j), e.Q, D.e1);
        set_column(system, 3 * i, 3 * std::size_t(j) + 1, e.Q, D.e2);
        set_column(system, 3 * i, 3 * std::size_t(j) + 2, e.Q, D.e3);
      });
    }
    solve(system, right);
    Each<Vec3<S>> changes;
    for (std::size_t i = 0; i < craft; ++i) load(changes[i], right.data() + 3 * i);
    return changes;
  }
  /// M = J Omega' + Omega x J Omega of every craft [N m, body].
  Each<Vec3<S>> torques(State const& x) const requires std::same_as<S, Real<S>> {
    Each<Vec3<S>> all = accelerations(x);
    for (std::size_t i = 0; i < craft; ++i) {
      Vec3<S> const& omega = x[int(i)].second;
      all[i] = inertia[i] * all[i] + polhode::cross(omega, inertia[i] * omega);
    }
    return all;
  }

  /// Pitch, yaw, roll [deg] about z, y, x:  R = Rz(pitch) Ry(yaw) Rx(roll).
  static std::array<double, 3> angles(Quat<double> const& q) {
    Vec3<double> const euler = EulerAngles<double>::from_attitude(q);
    double const degree = BodyParameters::degree;
    return {euler.z / degree, euler.y / degree, euler.x / degree};
  }
  /// q_a, q_geo [deg]: root mean squares over all five of the differences of angles from craft 1's, and of the angle to
  /// it. Torques [N m, body]. Of craft 2: R_23, pitch, yaw, roll [deg].
  void show(State const& x, std::span<double> out) const requires std::same_as<S, double> {
    Each<Quat<double>> q;
    for (int i = 0; i < cooperative_craft; ++i) q[std::size_t(i)] = A::attitude(x[i].first);
    std::array<double, 3> const first = angles(q[0]);
    double apart = 0, turned = 0;
    for (std::size_t i = 1; i < craft; ++i) {
      std::array<double, 3> const own = angles(q[i]);
      for (std::size_t k = 0; k < 3; ++k) apart += std::pow(std::remainder(own[k] - first[k], 360), 2);
      turned += std::pow(angle_between(q[0], q[i]) / BodyParameters::degree, 2);
    }
    out[0] = std::sqrt(apart / cooperative_craft);
    out[1] = std::sqrt(turned / cooperative_craft);
    Each<Vec3<double>> const M = torques(x);
    for (std::size_t i = 0; i < craft; ++i) store(M[i], out.data() + 2 + 3 * i);
    std::array<double, 3> const second = angles(q[1]);
    out[17] = rotations(x)[1].e3.y;
    std::copy(second.begin(), second.end(), out.begin() + 18);
  }

 private:
  /// Positive within 20 deg of the command.
  static S closeness(CooperativeErrors<S> const& e) { return e.cosine() - S(switching_cosine); }
  static bool is_close(CooperativeErrors<S> const& e) { return !(closeness(e) < S(0.0)); }
  /// -rho P d
  void set_column(auto& system, std::size_t row, std::size_t column, Mat3<S> const& Q, Vec3<S> const& d) const {
    Vec3<S> const seen = -law.rho * transposed_times(Q, d);
    system[row][column] = seen.x;
    system[row + 1][column] = seen.y;
    system[row + 2][column] = seen.z;
  }
};

}  // namespace polhode
