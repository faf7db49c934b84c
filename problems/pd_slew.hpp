#pragma once
/// Slew from a tumble to rest under proportional-derivative control: the commonest loop in practice. Continuous it is
/// smooth, an order problem; by a computer it is what flies.
///
/// plain      the law at every instant
/// gyrostat   the same, beside wheels of constant angular momentum:  J omega' = (J omega + h) x omega + torque
/// delayed    sampled and held, the torque coming a whole number of samples late
/// quantized  sampled and held, the torque in steps
///
/// Chosen: the gains, and the data of the variants.
///
/// state   attitude x omega [rad/s, body]
///
/// params  inertia [kg m^2], q0, omega0 [rad/s], k_p [N m], k_d [N m s], wheel_momentum [N m s, body],
///         sample_period [s], delay [s], torque_step [N m]; those of other variants are without effect
#include "problems/controllers/pd.hpp"
#include "problems/definition.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// The catalogue entry: gains `k_p` [N m], `k_d` [N m s] and the variants of the loop.
class PdSlew {
 public:
  explicit PdSlew(Choice const& choice) {
    if (choice.has("gyrostat")) control_ = Control::gyrostat;
    if (choice.has("delayed")) control_ = Control::delayed;
    if (choice.has("quantized")) control_ = Control::quantized;
    assign(parameters(), choice.set);
    if (!is_sampled()) return;
    sample_period = period_;
    if (control_ == Control::delayed) late_ = samples_late();
  }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "pd_slew",
        .summary = "slew under proportional-derivative control: accuracy on a smooth closed loop, or a sampled one",
        .source = "Wie & Barba (1985), J. Guidance 8, 360; data: Xu et al. (2017)",
        .variants = {{"plain", "gyrostat", "delayed", "quantized"}},
        .events = {"control samples (delayed, quantized)"},
        .claims = {},
        .pointing = angle_of_q};
    return facts;
  }
  std::vector<Parameter> parameters() {
    std::vector<Parameter> list = body_.list();
    list.emplace_back("k_p", "N m", Rule::non_negative, k_p_);
    list.emplace_back("k_d", "N m s", Rule::non_negative, k_d_);
    list.emplace_back("wheel_momentum", "N m s", Rule::finite, wheel_);
    list.emplace_back("sample_period", "s", Rule::positive, period_);
    list.emplace_back("delay", "s", Rule::non_negative, delay_);
    list.emplace_back("torque_step", "N m", Rule::positive, torque_step_);
    return list;
  }

  double horizon = 60;       ///< [s]
  double sample_period = 0;  ///< [s]; 0 for `plain` and `gyrostat`
  bool torque_free() const { return false; }
  bool principal() const { return body_.principal(); }
  bool plain() const { return control_ == Control::plain; }
  std::vector<Column> columns() const { return {}; }
  std::vector<ClaimResult> claims(History const&) const { return {}; }

  BodyParameters const& body() const { return body_; }
  /// The field of `plain`.
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return controlled_body<S, A, fast>(body_, law<S>());
  }
  /// Calls f(field) with the field of the variant.
  template <Scalar S, template <class> class A, bool fast, class F>
  void with_field(F f) const {
    if (plain()) {
      f(field<S, A, fast>());
    } else if (is_sampled()) {
      double const torque_step = control_ == Control::quantized ? torque_step_ : 0;
      f(controlled_body<S, A, fast>(body_, SampledPd<S>(law<S>(), late_, Real<S>(torque_step))));
    } else {
      f(controlled_body<S, A, fast>(body_, GyrostatPd<S>{law<S>(), loaded<Vec3<S>>(wheel_.data())}));
    }
  }

 private:
  enum class Control { plain, gyrostat, delayed, quantized };

  bool is_sampled() const { return control_ == Control::delayed || control_ == Control::quantized; }
  template <Scalar S>
  PdController<S> law() const {
    return {Real<S>(k_p_), Real<S>(k_d_)};
  }
  std::size_t samples_late() const {
    constexpr double most = 1e6;
    double const samples = delay_ / period_, whole = std::round(samples);
    if (std::fabs(samples - whole) > 1e-9 * samples)
      throw ParameterError("parameter delay: must be a whole number of sample periods, not " + std::to_string(samples));
    if (whole > most) throw ParameterError("parameter delay: must be at most 1000000 sample periods");
    return std::size_t(whole);
  }

  Control control_ = Control::plain;
  BodyParameters body_;
  double k_p_ = 4, k_d_ = 20;
  std::vector<double> wheel_{0, 0, 5};  ///< h [N m s, body]
  double period_ = 0.1, delay_ = 0.1;   ///< [s]
  std::size_t late_ = 0;                ///< delay in samples
  double torque_step_ = 0.01;           ///< [N m]
};

}  // namespace polhode
