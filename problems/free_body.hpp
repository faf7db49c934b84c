#pragma once
/// Free asymmetric rigid body: no torque, so energy, |L| and the direction of L in space are invariants, and the
/// solution is elliptic functions of time.
/// Source: Landau & Lifshitz, Mechanics, sec. 37; data of the tether paper's target
///
/// state   attitude x omega [rad/s, body]
///
/// params  inertia [kg m^2], q0, omega0 [rad/s, body]
#include "problems/definition.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// The catalogue entry: parameters `inertia` [kg m^2], `q0`, `omega0` [rad/s]; torque-free.
class FreeBody {
 public:
  explicit FreeBody(Choice const& choice) { assign(parameters(), choice.set); }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "free_body",
        .summary = "free asymmetric body: which invariants does a method keep, and how well does it keep time?",
        .source = "Landau & Lifshitz, Mechanics, sec. 37; data: Xu et al. (2017)",
        .variants = {},
        .events = {},
        .claims = {}};
    return facts;
  }
  std::vector<Parameter> parameters() { return body_.list(); }

  double horizon = 50;       ///< [s]
  double sample_period = 0;  ///< continuous
  bool torque_free() const { return true; }
  bool principal() const { return body_.principal(); }
  std::vector<Column> columns() const { return {}; }
  std::vector<ClaimResult> claims(History const&) const { return {}; }

  BodyParameters const& body() const { return body_; }
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return controlled_body<S, A, fast>(body_, NoTorque<S>{});
  }

 private:
  BodyParameters body_;
};

}  // namespace polhode
