#pragma once
/// A heavy body that spins about a fixed point.
/// Source: Bruels & Cardona (2010), J. Comput. Nonlinear Dynam. 5, 031002 (`bruels`, `dae`); Hairer, Lubich & Wanner,
///         Geometric Numerical Integration, VII.5, example 5.4 (`potential`: its body and initial data)
///
/// bruels     a fast plate, one body about the pivot; start R = 1
/// potential  an asymmetric body in the potential m g R r.e3 = R e3.e3; `inertia` is about the pivot there
/// dae        bruels in maximal coordinates: pinned_body.hpp. Runs as the field of index 1; methods for constrained
///            systems see the constraint
///
/// Gravity points along -z. The published rate, about the inertial y axis at 2 s, is -106.1638041430 rad/s; the
/// solution is -106.163804143124 (power series, of either form), so the last two digits printed are not right.
///
/// state   attitude x omega [rad/s, body]; dae: with x [m], v [m/s] of the centre of mass, inertial
#include "problems/controllers/gravity.hpp"
#include "problems/definition.hpp"
#include "problems/pinned_body.hpp"

namespace polhode {

/// The catalogue entry: the bodies of variants `bruels`, `potential` and `dae`.
class HeavyTop {
 public:
  explicit HeavyTop(Choice const& choice) : constrained_(choice.has("dae")), about_pivot_(choice.has("potential")) {
    if (about_pivot_) {
      body_ = {.inertia = {0.5, 0.85, 1}, .q0 = {0.2, 0.4, 0.8, 0.4}, .omega0 = {0.2 / 0.5, 1 / 0.85, 0.4 / 1}};
      mass_ = 1;
      arm_ = {0, 0, 1};
      gravity_ = 1;
      horizon = 10;
    }
    assign(parameters(), choice.set);
    pivoted_ = body_;
    if (!about_pivot_) pivoted_.inertia = inertia_about_pivot();
  }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "heavy_top",
        .summary = "heavy top: fast spin under gravity, as one body about its pivot or as a constrained system",
        .source = "Bruels & Cardona (2010), J. Comput. Nonlinear Dynam. 5, 031002; Hairer, Lubich & Wanner, VII.5",
        .variants = {{"bruels", "potential", "dae"}},
        .events = {},
        .claims = {{"omega_y_2s", "rate about the inertial y axis at 2 s; holds if met to 1e-6", published, "rad/s"}},
        .step = 0.00005};  // 150 rad/s: from 2e-4 on the first-order foil gains energy without bound
    return facts;
  }
  std::vector<Parameter> parameters() {
    std::vector<Parameter> list = body_.list();
    list.emplace_back("mass", "kg", Rule::positive, mass_);
    list.emplace_back("arm", "m", Rule::finite, arm_);
    list.emplace_back("gravity", "m/s^2", Rule::non_negative, gravity_);
    return list;
  }

  double horizon = 2;        ///< [s]; potential: 10
  double sample_period = 0;  ///< continuous
  bool torque_free() const { return !constrained_ && (gravity_ == 0 || arm_ == std::vector<double>{0, 0, 0}); }
  /// dae has one form of the inertia.
  bool principal() const { return constrained_ || pivoted_.principal(); }
  bool plain() const { return !constrained_; }
  bool constrained() const { return constrained_; }
  std::string refusal(std::string_view formulation) const {
    bool const written = formulation == FlatQuaternion<double>::name || formulation == S3<double>::name ||
                         formulation == SO3<double>::name || formulation == FlatRotation<double>::name;
    return constrained_ && !written ? "variant dae is written for quaternions and matrices" : "";
  }
  std::vector<Column> columns() const {
    std::vector<Column> list{{"energy", "J"}, {"momentum_z", "N m s"}, {"omega_inertial_y", "rad/s"}};
    if (constrained_) {
      list.push_back({"position_defect", "m"});
      list.push_back({"velocity_defect", "m/s"});
    }
    return list;
  }
  std::vector<ClaimResult> claims(History const& history) const;

  /// The body about its pivot.
  BodyParameters const& body() const { return pivoted_; }

  /// The body about its pivot.
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    Vec3<S> const r = arm<S>(), moment = Real<S>(mass_) * r;
    return controlled_body<S, A, fast>(pivoted_,
                                       GravityTorque<S>{moment, acceleration<S>(), pivoted_.template matrix<S>()});
  }
  /// Calls f with the field as chosen.
  template <Scalar S, template <class> class A, bool fast, class F>
  void with_field(F f) const {
    if (constrained_)
      f(pinned_field<S, A>());
    else
      f(field<S, A, fast>());
  }
  /// The constrained body of variant dae.
  template <Scalar S>
  PinnedBody<S> pinned() const {
    using R = Real<S>;
    return {R(mass_), body_.template matrix<R>(), arm<R>(), acceleration<R>()};
  }
  template <Scalar S, template <class> class A>
  PinnedField<S, A> pinned_field() const {
    Quat<S> const q = body_.template attitude<S>();
    Mat3<S> const rotation = matrix(q);
    Vec3<S> const omega = body_.template rate<S>(), r = arm<S>();
    return {pinned<S>(), {{A<S>::from_attitude(q), omega}, {rotation * r, rotation * cross(omega, r)}}};
  }

 private:
  static constexpr double published = -106.1638041430;

  template <class S>
  Vec3<S> arm() const {
    return loaded<Vec3<S>>(arm_.data());
  }
  template <class S>
  Vec3<S> acceleration() const {
    return {S(0.0), S(0.0), S(-gravity_)};
  }
  /// J + m (r.r 1 - r r^T): 3 moments if it is diagonal, else xx yy zz xy xz yz [kg m^2].
  std::vector<double> inertia_about_pivot() const {
    std::vector<double> J = body_.inertia;
    J.resize(6);
    double const x = arm_[0], y = arm_[1], z = arm_[2];
    double const shift[] = {y * y + z * z, z * z + x * x, x * x + y * y, -x * y, -x * z, -y * z};
    for (std::size_t i = 0; i < 6; ++i) J[i] += mass_ * shift[i];
    if (J[3] == 0 && J[4] == 0 && J[5] == 0) J.resize(3);
    return J;
  }

  bool constrained_, about_pivot_;
  BodyParameters body_{.inertia = {0.234375, 0.46875, 0.234375}, .q0 = {0, 0, 0, 1}, .omega0 = {0, 150, -4.61538}};
  BodyParameters pivoted_;            ///< body_ with the inertia about the pivot
  double mass_ = 15;                  ///< [kg]
  double gravity_ = 9.81;             ///< [m/s^2]
  std::vector<double> arm_{0, 1, 0};  ///< from the pivot to the centre of mass [m, body]
};

/// Of the published top, if the run shows it at 2 s.
inline std::vector<ClaimResult> HeavyTop::claims(History const& history) const {
  std::vector<ClaimResult> results;
  if (about_pivot_) return results;
  std::vector<double> const rate = history.column("omega_inertial_y");
  if (auto const row = history.row_at(2))
    results.push_back({"omega_y_2s", rate[*row], published, std::fabs(rate[*row] - published) <= 1e-6});
  return results;
}

}  // namespace polhode
