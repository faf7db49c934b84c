#pragma once
/// Tether tension and thrusters that turn a captured target until its grapple arm points along the tether.
/// Source: Xu et al. (2017), Applied Mathematics and Mechanics 38(12), 1309, eqs. (17)-(25)
#include <algorithm>

#include "problems/angle.hpp"
#include "problems/controller.hpp"
#include "problems/lanes_gather.hpp"

namespace polhode {

/// Which actuators work.
enum class TetherCase {
  both = 1,       ///< case 1: tether and thrusters
  switched = 2,   ///< case 2: thrusters alone when alpha is below the switching angle, else the tether alone
  thrusters = 3,  ///< case 3: thrusters alone
  none = 0        ///< free
};

/// Numbers of the law. Gains are not printed in the paper: set G1 was reconstructed.
///   K  double, or lanes where every body has its own
template <class K>
struct TetherLawOf {
  TetherCase actuators = TetherCase::both;
  K k_pe{40};            ///< tension per angle [N/rad]
  K k_de{120};           ///< tension per angular rate [N s/rad]
  K k_pu{8};             ///< thruster torque per angle [N m/rad]
  K k_du{80};            ///< thruster torque per body rate [N m s/rad]
  K f_max{30};           ///< greatest tension [N]
  K u_max{5};            ///< greatest thruster torque, per axis [N m]
  K switch_angle{0};     ///< [rad]
  K arm{2};              ///< grapple point at (-arm, 0, 0) in body axes [m]
  K sample_period{0.1};  ///< [s]

  template <class F, class... L>
  static void each(F&& f, L&&... l) {
    f(l.k_pe...);
    f(l.k_de...);
    f(l.k_pu...);
    f(l.k_du...);
    f(l.f_max...);
    f(l.u_max...);
    f(l.switch_angle...);
    f(l.arm...);
    f(l.sample_period...);
  }
};
using TetherLaw = TetherLawOf<double>;

/// Sampled, zero-order hold. Remembers the last angle (for its difference quotient), what it commands, and the effort
/// spent. alpha = angle between the arm d and the tether's direction r, both in body axes; r is fixed in the orbital
/// frame.
///   K  of the law's numbers
template <Scalar S, class K = double>
class TetherController {
 public:
  using Scalar = S;
  static constexpr bool sampled = true;

  explicit TetherController(TetherLawOf<K> const& law) : law_(law) {}
  /// Lane i is of(i), of one case all.
  template <class T, class Of>
  static TetherController<T, T> gathered(Of const& of) {
    auto law = from_lanes<TetherLawOf<T>>(
        T::count, [&](int i) -> auto const& { return of(i).law_; });
    law.actuators = of(0).law_.actuators;
    return TetherController<T, T>(law);
  }

  Vec3<S> torque(Real<S> const&, Quat<S> const& q, Vec3<S> const& omega) {
    effort_ += S(law_.sample_period) * dot(thrust_, thrust_);
    thrust_ = tether_ = zero<Vec3<S>>();
    tension_ = S(0.0);

    Geometry const at = geometry(q);
    S const alpha_rate = first_ ? S(0.0) : (at.alpha - last_alpha_) / S(law_.sample_period);
    last_alpha_ = at.alpha;
    first_ = false;

    auto const below = at.alpha < S(law_.switch_angle);
    if (law_.actuators != TetherCase::none && law_.actuators != TetherCase::thrusters) {
      tension_ = clamp(S(S(law_.k_pe) * at.alpha + S(law_.k_de) * alpha_rate), S(0.0), S(law_.f_max));
      tether_ = (S(law_.arm) * tension_) * at.axis;  // F d x r~
    }
    if (law_.actuators != TetherCase::none) {
      thrust_ = clipped((S(law_.k_pu) * at.alpha_over_sine) * at.axis - S(law_.k_du) * omega);
    }
    if (law_.actuators == TetherCase::switched) {
      tension_ = select(below, S(0.0), tension_);
      tether_ = chosen(below, zero<Vec3<S>>(), tether_);
      thrust_ = chosen(below, thrust_, zero<Vec3<S>>());
    }
    return tether_ + thrust_;
  }

  /// alpha at the last sample; at attitude q [rad].
  S const& last_angle() const { return last_alpha_; }
  static S pointing_angle(Quat<S> const& q) { return geometry(q).alpha; }

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
    S alpha, alpha_over_sine;
  };
  /// d = (-1, 0, 0), and so is r in the orbital frame, for the platform lies at (-200, 0, 0) m.
  static Geometry geometry(Quat<S> const& q) {
    Mat3<S> const m = matrix(q);
    S const sine_squared = m.e3.x * m.e3.x + m.e2.x * m.e2.x;
    auto const [alpha, over_sine] = angle_and_sine(sine_squared, m.e1.x);
    return {{S(0.0), S(-m.e3.x), m.e2.x}, alpha, over_sine};
  }
  template <class Mask>
  static Vec3<S> chosen(Mask const& mask, Vec3<S> const& a, Vec3<S> const& b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
  }
  Vec3<S> clipped(Vec3<S> const& u) const {
    S const most(law_.u_max);
    return {clamp(u.x, S(-most), most), clamp(u.y, S(-most), most), clamp(u.z, S(-most), most)};
  }

  template <polhode::Scalar, class>
  friend class TetherController;

  TetherLawOf<K> law_;
  bool first_ = true;
  S last_alpha_{0.0}, tension_{0.0}, effort_{0.0};
  Vec3<S> tether_ = zero<Vec3<S>>(), thrust_ = zero<Vec3<S>>();
};

}  // namespace polhode
