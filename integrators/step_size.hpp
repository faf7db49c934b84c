#pragma once
/// How long the next step is to be: proportional-integral control of the local error, one law for every method.
/// Source: Gustafsson (1991), ACM TOMS 17, 533; Hairer, Norsett & Wanner, Solving ODEs I, II.4 (starting step, codes
/// DOPRI5 and DOP853), and II, IV.2 (memory)
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "problems/scalar.hpp"

namespace polhode {

/// The constants of the law: after an error e (1 is what is allowed) and one of e_last before it the next step is
///   h clamp(safety e^-(1/order - 3/4 memory) e_last^memory, least, most)
/// and no longer than h if a trial was rejected; after a rejection the same without e_last, at least `least`.
struct StepRule {
  double safety = 0.9, least = 0.2, most = 10;
  double memory = 0;    ///< beta; 0 is plain integral control
  double failed = 0.1;  ///< after a trial without an error estimate
  double held = 1;      ///< a factor from 1 to this leaves h as it is: some methods gain by equal steps
};

/// log2 x of a finite x >= 1e-300, within 5e-6: all that a step size needs, at a tenth of std::log2's latency, and the
/// same on every machine. t P(t) of t = m - 1, m = x / 2^k in [sqrt(1/2), sqrt(2)), P through Chebyshev's points.
POLHODE_INLINE double log2_nearly(double x) {
  auto const bits = std::bit_cast<std::int64_t>(x);
  auto const k = (bits - std::bit_cast<std::int64_t>(0x1.6a09e667f3bcdp-1)) >> 52;
  double const t = std::bit_cast<double>(bits - (k << 52)) - 1, z = t * t;
  double const low = 1.442700440013496 - 0.721195752393872 * t, middle = 0.47992557347074644 - 0.3669257709573897 * t;
  double const high = 0.316898187156837 - 0.20228926373030143 * t;
  return double(k) + t * (low + z * (middle + z * high));
}
/// 2^y of |y| <= 1000, within 7e-6 of its value; exact for whole y. As above: 1 + f P(f), f = y less the nearest whole
/// number.
POLHODE_INLINE double exp2_nearly(double y) {
  constexpr double round = 0x1.8p52;  // the low bits of what is added to it are its whole part
  double const shifted = y + round, f = y - (shifted - round), z = f * f;
  double const power =
      1 + f * ((0.6931367338836215 + 0.2402253009741223 * f) + z * (0.055838282946219404 + 0.009656710288545166 * f));
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(power) + (std::bit_cast<std::int64_t>(shifted) << 52));
}

/// The step size of a run, R [s].
///   order  the error estimate falls as h^order
template <class R>
class StepSize {
 public:
  StepSize(StepRule const& rule, int order)
      : order_(order),
        exponent_(0.5 * (1.0 / order - 0.75 * rule.memory)),
        memory_(0.5 * rule.memory),
        safety_(std::log2(rule.safety)),
        least_(rule.least),
        most_(rule.most),
        failed_(rule.failed),
        held_(rule.held) {}

  /// A trial: h, and whether it ends at t_end.
  struct Trial {
    R h;
    bool last;
  };
  /// The next trial from t. A step that would leave less than (reach - 1) h takes all that is left; `stretch` is then
  /// by how much its time will exceed its length (gamma of relaxation, less 1).
  Trial trial(R const& t, R const& t_end, double reach = 1 + 1e-10, R const& stretch = R(0.0)) const {
    R const left = t_end - t;
    bool const last = h_ * R(reach) >= left;
    return {last ? left / (R(1.0) + stretch) : h_, last};
  }
  /// The same, what is left being divided into equal steps: none is short because it is the last.
  Trial even_trial(R const& t, R const& t_end) const {
    R const left = t_end - t;
    double const steps = std::ceil(double(left / h_) * (1 - 1e-10));
    bool const last = !(steps > 1);
    return {last ? left : left / R(steps), last};
  }
  /// The trial is below 10 ulp of t, and not because the end is near.
  static bool underflows(Trial const& trial, R const& t) {
    return double(trial.h) <= 10 * std::numeric_limits<double>::epsilon() * std::fabs(double(t)) && !trial.last;
  }
  static bool accepts(double square) { return square <= 1; }

  /// The trial was accepted, the square of its error being `square`.
  void accept(Trial const& trial, double square) {
    double const size = log_of(square), most = rejected_ ? 1.0 : most_;
    double const growth = std::clamp(exp2_nearly(safety_ - exponent_ * size + memory_ * last_size_), least_, most);
    last_size_ = std::max(size, first_size);
    rejected_ = false;
    if (growth < 1) h_ = trial.h * R(growth);
    // A step cut short by t_end says little about the next one.
    else if (growth > held_ && (!trial.last || trial.h == h_))
      h_ = max_of(h_, R(trial.h * R(growth)));
  }
  /// It was not.
  void reject(Trial const& trial, double square) {
    rejected_ = true;
    if (std::isfinite(square))
      h_ = trial.h * R(std::max(least_, exp2_nearly(safety_ - exponent_ * log_of(square))));
    else
      h_ = trial.h * R(failed_);
  }
  /// It was not, for another reason than its error: the next is `part` of it.
  void reject_for(Trial const& trial, double part) {
    rejected_ = true;
    h_ = trial.h * R(part);
  }
  /// The error's memory is forgotten, the step size is kept: the field jumped, the time scale hardly did.
  void restart() {
    last_size_ = first_size;
    rejected_ = false;
  }
  /// A new run, the first step of which is known.
  void begin(R const& h) {
    restart();
    h_ = h;
  }
  /// A new run.
  void forget() { begin(R(0.0)); }
  bool known() const { return R(0.0) < h_; }

  /// The first step, all sizes in units of what is allowed. First a trial with Euler's method, from the sizes of the
  /// state and of its slope; then with the greater of slope and second derivative.
  ///   change(h)  the size of what an Euler step of h [s] changes the slope by
  /// Source: Hairer, Norsett & Wanner I, II.4, "starting step size"
  template <class F>
  void start(double size, double speed, R const& longest, F const& change) {
    double const most = double(longest), tiny = 1e-5;
    double const euler = std::min(size < tiny || speed < tiny ? 1e-6 : 0.01 * size / speed, most);
    double const greatest = std::max(speed, change(R(euler)) / euler);
    double const h = greatest <= 1e-15 ? std::max(1e-6, euler * 1e-3) : std::pow(0.01 / greatest, 1.0 / order_);
    h_ = R(std::min({100 * euler, h, most}));
  }

 private:
  static double log_of(double square) { return log2_nearly(std::max(square, 1e-300)); }
  static constexpr double first_size = -26.575424759098898;  ///< log2 of 1e-4 squared

  int order_;
  double exponent_, memory_;  ///< of squares
  double safety_;             ///< log2
  double least_, most_, failed_, held_;
  double last_size_ = first_size;  ///< log2 of the square of the last error, not below that
  bool rejected_ = false;          ///< the last trial
  R h_ = R(0.0);
};

}  // namespace polhode
