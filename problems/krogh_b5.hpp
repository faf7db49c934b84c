#pragma once
/// Krogh's problem, B5 of the test set DETEST: the rates of a free body, without a body or an attitude.
///   y1' = y2 y3,   y2' = -y1 y3,   y3' = -m y1 y2,   y(0) = (0, 1, 1):   y = (sn, cn, dn)(t | m)
/// Use it to hold a method against numbers that others have printed. y1^2 + y2^2 and m y1^2 + y3^2 are invariants.
///
/// Source: Hull, Enright, Fellen & Sedgwick (1972), SIAM J. Numer. Anal. 9, 603, problem B5, there by F. T. Krogh
///
/// state   y, a vector of R^3 [1]
///
/// params  m, in [0, 1); y0
///
/// The only formulation is `quaternion`, the flat one: there is no attitude, and none is made up.
#include <algorithm>
#include <optional>

#include "problems/definition.hpp"
#include "problems/elliptic.hpp"
#include "problems/formulations.hpp"

namespace polhode {

/// The field.   m [1]
template <Scalar S>
struct KroghField {
  using Space = Euclidean3<S>;

  Real<S> m;
  Vec3<S> start;

  POLHODE_INLINE Vec3<S> operator()(S const&, Vec3<S> const& y) const {
    return {y.y * y.z, -(y.x * y.z), -(m * (y.x * y.y))};
  }
  Vec3<S> initial() const { return start; }
};

/// The catalogue entry: three plain numbers and their closed form.
class KroghB5 {
 public:
  explicit KroghB5(Choice const& choice) {
    assign(parameters(), choice.set);
    if (!(m_ < 1)) throw ParameterError("parameter m: must be less than 1");
  }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "krogh_b5",
        .summary = "three coupled rates with a solution in elliptic functions: published digits to be met",
        .source = "Hull, Enright, Fellen & Sedgwick (1972), SIAM J. Numer. Anal. 9, 603, problem B5",
        .variants = {},
        .events = {},
        .claims = {{"y_20",
                    "y at 20 s is (-0.93965707987292035, -0.34211777540007493, 0.74141265961999525): the greatest "
                    "difference, at most 1e-12",
                    {},
                    ""}}};
    return facts;
  }
  std::vector<Parameter> parameters() { return {{"m", "", Rule::non_negative, m_}, {"y0", "", Rule::finite, y0_}}; }

  double horizon = 20;       ///< [s]
  double sample_period = 0;  ///< continuous
  using Formulations = Types<Formulation<FlatQuaternion>>;
  using TimedFormulations = Formulations;
  /// There is no body.
  bool torque_free() const { return false; }
  std::string refusal(std::string_view formulation) const {
    if (formulation == FlatQuaternion<double>::name) return "";
    return "the state is three numbers without an attitude; the flat formulation, quaternion, stands for them";
  }
  std::vector<Column> columns() const { return {}; }
  std::vector<ClaimResult> claims(History const& history) const;

  template <Scalar S, template <class> class, bool>
  auto field() const {
    return KroghField<S>{Real<S>(m_), loaded<Vec3<S>>(y0_.data())};
  }
  /// y at time t [s] by Jacobi's functions; null for initial data other than (0, 1, 1).
  std::optional<Vec3<Quad>> closed_form(Quad const& t) const {
    if (y0_ != std::vector<double>{0, 1, 1}) return {};
    Quad const m = m_;
    elliptic::Sncndn<Quad> const y = elliptic::Jacobi<Quad>(m, 1 - m)(t);
    return Vec3<Quad>{y.sn, y.cn, y.dn};
  }

 private:
  double m_ = 0.51;
  std::vector<double> y0_{0, 1, 1};
};

/// Nothing where the printed numbers do not belong: other parameters, or no row at 20 s.
inline std::vector<ClaimResult> KroghB5::claims(History const& history) const {
  constexpr double printed[] = {-0.93965707987292035, -0.34211777540007493, 0.74141265961999525};
  if (m_ != 0.51 || y0_ != std::vector<double>{0, 1, 1}) return {};
  auto const row = history.row_at(20);
  if (!row) return {};
  double apart = 0;
  for (std::size_t i = 0; i < 3; ++i)
    apart = std::max(apart, std::fabs(history.column("y" + std::to_string(i + 1))[*row] - printed[i]));
  return {{"y_20", apart, {}, apart <= 1e-12}};
}

}  // namespace polhode
