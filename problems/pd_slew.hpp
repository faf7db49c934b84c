#pragma once
/// Smooth slew from a tumble to rest under proportional-derivative control: the commonest loop in practice, and an
/// order problem.
///
/// state   attitude x omega [rad/s, body]
///
/// params  inertia [kg m^2], q0, omega0 [rad/s], k_p [N m], k_d [N m s]
#include "problems/controllers/pd.hpp"
#include "problems/definition.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

class PdSlew {
 public:
  explicit PdSlew(Choice const& choice) { assign(parameters(), choice.set); }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "pd_slew",
        .summary = "slew under continuous proportional-derivative control: accuracy on a smooth closed loop",
        .source = "Wie & Barba (1985), J. Guidance 8, 360; data: Xu et al. (2017)",
        .variants = {{"plain"}},
        .events = {},
        .claims = {}};
    return facts;
  }
  std::vector<Parameter> parameters() {
    std::vector<Parameter> list = body_.list();
    list.emplace_back("k_p", "N m", Rule::non_negative, k_p_);
    list.emplace_back("k_d", "N m s", Rule::non_negative, k_d_);
    return list;
  }

  double horizon = 60;       ///< [s]
  double sample_period = 0;  ///< continuous
  bool torque_free() const { return false; }
  bool principal() const { return body_.principal(); }
  std::vector<Column> columns() const { return {}; }
  std::vector<ClaimResult> claims(History const&) const { return {}; }

  BodyParameters const& body() const { return body_; }
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return controlled_body<S, A, fast>(body_, PdController<S>{Real<S>(k_p_), Real<S>(k_d_)});
  }

 private:
  BodyParameters body_;
  double k_p_ = 4, k_d_ = 20;
};

}  // namespace polhode
