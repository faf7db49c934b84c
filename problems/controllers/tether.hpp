#pragma once
/// Tether tension and thrusters that turn a captured target until its grapple arm points along the tether.
/// Source: Xu et al. (2017), Applied Mathematics and Mechanics 38(12), 1309, eqs. (17)-(25)
#include <algorithm>

#include "problems/controller.hpp"

namespace polhode {

/// Which actuators work.
enum class TetherCase {
  both = 1,       ///< case 1: tether and thrusters
  switched = 2,   ///< case 2: thrusters alone when alpha is below the switching angle, else the tether alone
  thrusters = 3,  ///< case 3: thrusters alone
  none = 0        ///< free
};

/// Numbers of the law, in plain doubles. Gains are not printed in the paper: set G1 was reconstructed.
struct TetherLaw {
  TetherCase actuators = TetherCase::both;
  double k_pe = 40;            ///< tension per angle [N/rad]
  double k_de = 120;           ///< tension per angular rate [N s/rad]
  double k_pu = 8;             ///< thruster torque per angle [N m/rad]
  double k_du = 80;            ///< thruster torque per body rate [N m s/rad]
  double f_max = 30;           ///< greatest tension [N]
  double u_max = 5;            ///< greatest thruster torque, per axis [N m]
  double switch_angle = 0;     ///< [rad]
  double arm = 2;              ///< grapple point at (-arm, 0, 0) in body axes [m]
  double sample_period = 0.1;  ///< [s]
};

/// Sampled, zero-order hold. Remembers the last angle (for its difference quotient), what it commands, and the effort
/// spent. alpha = angle between the arm d and the tether's direction r, both in body axes; r is fixed in the orbital
/// frame.
template <Scalar S>
class TetherController {
 public:
  using Scalar = S;
  static constexpr bool sampled = true;

  explicit TetherController(TetherLaw const& law) : law_(law) {}

  Vec3<S> torque(Real<S> const&, Quat<S> const& q, Vec3<S> const& omega) {
    effort_ += S(law_.sample_period) * dot(thrust_, thrust_);
    thrust_ = tether_ = zero<Vec3<S>>();
    tension_ = S(0.0);

    Geometry const at = geometry(q);
    S const alpha_rate = first_ ? S(0.0) : (at.alpha - last_alpha_) / S(law_.sample_period);
    last_alpha_ = at.alpha;
    first_ = false;

    bool const below = at.alpha < S(law_.switch_angle);
    bool const by_tether = law_.actuators == TetherCase::both || (law_.actuators == TetherCase::switched && !below);
    bool const by_thrusters = law_.actuators == TetherCase::both || law_.actuators == TetherCase::thrusters ||
                              (law_.actuators == TetherCase::switched && below);
    if (by_tether) {
      tension_ = clamp(S(S(law_.k_pe) * at.alpha + S(law_.k_de) * alpha_rate), S(0.0), S(law_.f_max));
      tether_ = (S(law_.arm) * tension_) * at.axis;  // F d x r~
    }
    if (by_thrusters) {
      Vec3<S> const towards = S(0.0) < at.sine ? (S(law_.k_pu) * at.alpha / at.sine) * at.axis : zero<Vec3<S>>();
      thrust_ = clipped(towards - S(law_.k_du) * omega);
    }
    return tether_ + thrust_;
  }

  /// alpha [rad], tether_force [N], torque_x, torque_y, torque_z [N m, held from now on], energy_c [N^2 m^2 s].
  static std::vector<Column> columns() {
    return {{"alpha", "rad"},    {"tether_force", "N"}, {"torque_x", "N m"},
            {"torque_y", "N m"}, {"torque_z", "N m"},   {"energy_c", "N^2 m^2 s"}};
  }
  void show(Quat<S> const& q, Vec3<S> const&, std::span<double> out) const {
    Vec3<S> const held = tether_ + thrust_;
    double i[] = {
        double(geometry(q).alpha), double(tension_), double(held.x), double(held.y), double(held.z), double(effort_)};
    std::copy(std::begin(i), std::end(i), out.begin());
  }

 private:
  struct Geometry {
    Vec3<S> axis;  ///< d~ x r~
    S sine, alpha;
  };
  static Geometry geometry(Quat<S> const& q) {
    Vec3<S> const d{S(-1.0), S(0.0), S(0.0)};
    Vec3<S> const r = to_body(q, d);  // the platform lies at (-200, 0, 0) m in the orbital frame: along -x, too
    Vec3<S> const axis = cross(d, r);
    S const sine_squared = dot(axis, axis);
    S const sine = S(0.0) < sine_squared ? S(sqrt(sine_squared)) : S(0.0);  // a series has no square root at 0
    return {axis, sine, atan2(sine, dot(d, r))};
  }
  Vec3<S> clipped(Vec3<S> const& u) const {
    S const most(law_.u_max);
    return {clamp(u.x, S(-most), most), clamp(u.y, S(-most), most), clamp(u.z, S(-most), most)};
  }

  TetherLaw law_;
  bool first_ = true;
  S last_alpha_{0.0}, tension_{0.0}, effort_{0.0};
  Vec3<S> tether_ = zero<Vec3<S>>(), thrust_ = zero<Vec3<S>>();
};

}  // namespace polhode
