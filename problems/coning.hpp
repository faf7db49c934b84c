#pragma once
/// Coning: one body axis goes round a cone while the body does not spin about it. The motion on which strapdown
/// attitude algorithms are judged: body rates are given as functions of time, as gyros deliver them, and what is lost
/// of their commutators turns up as a steady drift.
///
/// q(t)      (0, sin(angle/2) cos(rate t), sin(angle/2) sin(rate t), cos(angle/2))
/// omega(t)  (-2 rate sin^2(angle/2), -rate sin(angle) sin(rate t), rate sin(angle) cos(rate t))
///
/// Sources: Bortz (1971), IEEE Trans. Aerospace Electron. Syst. 7, 61; Miller (1983), J. Guidance 6, 287
///
/// Chosen: the defaults.
///
/// state   attitude; velocity: the body rate [rad/s, body]
///
/// params  cone_angle [rad], the half angle of the cone; cone_rate [rad/s]
#include <algorithm>

#include "problems/definition.hpp"
#include "problems/formulations.hpp"

namespace polhode {

/// The motion in closed form, and its rates.   R  a real number, S  the scalar of time
template <class R>
class ConingMotion {
 public:
  ConingMotion(R const& angle, R const& rate)
      : rate_(rate), sine_(sin(R(R(0.5) * angle))), cosine_(cos(R(R(0.5) * angle))) {}

  template <class S>
  Quat<S> attitude(S const& t) const {
    S const turned = rate_ * t;
    return {S(0.0), sine_ * cos(turned), sine_ * sin(turned), S(cosine_)};
  }
  /// [rad/s, body]
  template <class S>
  Vec3<S> body_rate(S const& t) const {
    S const turned = rate_ * t;
    R const across = R(2.0) * rate_ * sine_ * cosine_, along = R(-2.0) * rate_ * sine_ * sine_;
    return {S(along), -across * sin(turned), across * cos(turned)};
  }

 private:
  R rate_, sine_, cosine_;
};

/// The field: one craft.   A  attitude
template <Scalar S, Attitude A>
struct ConingCraft {
  using Space = Attitudes<A>;
  using State = Point<Space>;
  static constexpr bool prescribed_rates() { return true; }

  ConingMotion<Real<S>> motion;

  void operator()(S const& t, State const&, Velocity<Space>& v) const { v[0] = motion.body_rate(t); }
  State initial() const {
    State x(1);
    x[0] = A::from_attitude(motion.attitude(S(0.0)));
    return x;
  }
  /// coning_error
  void show(Real<S> const& t, State const& x, std::span<double> out) const {
    out[0] = double(angle_between(A::attitude(x[0]), motion.attitude(S(t))));
  }
};

/// The catalogue entry: parameters `angle`, `rate`, formulations, claims.
class Coning {
 public:
  explicit Coning(Choice const& choice) { assign(parameters(), choice.set); }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "coning",
        .summary = "an axis on a cone, by prescribed body rates: what strapdown attitude algorithms are judged on",
        .source = "Bortz (1971), IEEE Trans. Aerospace Electron. Syst. 7, 61; Miller (1983), J. Guidance 6, 287",
        .variants = {},
        .events = {},
        .claims = {{"coning_error", "the greatest angle from the closed form", {}, "rad"}},
        .step = 0.05};
    return facts;
  }
  std::vector<Parameter> parameters() {
    return {{"cone_angle", "rad", Rule::positive, angle_}, {"cone_rate", "rad/s", Rule::positive, rate_}};
  }

  double horizon = 60;       ///< [s]
  double sample_period = 0;  ///< continuous
  bool torque_free() const { return false; }
  std::vector<Column> columns() const { return {{"coning_error", "rad"}}; }
  std::vector<ClaimResult> claims(History const& history) const {
    std::vector<double> const error = history.column("coning_error");
    if (error.empty()) return {};
    return {{"coning_error", *std::max_element(error.begin(), error.end()), {}, {}}};
  }
  using Formulations = AttitudesFormulations;
  using TimedFormulations = AttitudesFormulations;

  template <Scalar S, template <class> class A, bool>
  auto field() const {
    return ConingCraft<S, A<S>>{ConingMotion<Real<S>>(Real<S>(angle_), Real<S>(rate_))};
  }

 private:
  double angle_ = 0.1, rate_ = 10;
};

}  // namespace polhode
