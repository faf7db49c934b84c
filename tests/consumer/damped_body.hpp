#pragma once
/// A body that turns in a resisting medium.   state  attitude x omega [rad/s, body]   params  inertia, q0, omega0, drag
#include "problems/definition.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// torque = -drag omega
template <Scalar S>
struct DragTorque {
  using Scalar = S;
  static constexpr bool sampled = false;  // true: asked once a sample period, and held
  Real<S> drag;                           // [N m s]
  Vec3<S> torque(S const&, Quat<S> const&, Vec3<S> const& omega) const { return -drag * omega; }
};

class DampedBody {
 public:
  explicit DampedBody(Choice const& choice) { assign(parameters(), choice.set); }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{.name = "damped_body",
                                   .summary = "a body that turns in a resisting medium",
                                   .source = "textbook",
                                   .variants = {},
                                   .events = {},
                                   .claims = {}};
    return facts;
  }
  std::vector<Parameter> parameters() {
    std::vector<Parameter> list = body_.list();  // inertia, q0, omega0
    list.emplace_back("drag", "N m s", Rule::non_negative, drag_);
    return list;
  }
  double horizon = 50;       ///< [s]
  double sample_period = 0;  ///< continuous
  bool torque_free() const { return drag_ == 0; }
  bool principal() const { return body_.principal(); }
  std::vector<Column> columns() const { return {}; }
  std::vector<ClaimResult> claims(History const&) const { return {}; }
  BodyParameters const& body() const { return body_; }

  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return controlled_body<S, A, fast>(body_, DragTorque<S>{Real<S>(drag_)});
  }

 private:
  BodyParameters body_;
  double drag_ = 2;
};

}  // namespace polhode
