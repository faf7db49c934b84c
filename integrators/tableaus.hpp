#pragma once
/// Butcher tableaus of explicit methods, as exact fractions: right in any scalar.
#include <array>
#include <stdexcept>

#include "integrators/integrator.hpp"

namespace polhode {

/// An exact fraction, so that a coefficient has the precision of whatever scalar it meets.
struct Ratio {
  long over = 0, under = 1;
  template <class R>
  constexpr R as() const {
    return R(double(over)) / R(double(under));
  }
  constexpr bool is_zero() const { return over == 0; }
};

/// A coefficient that is published in digits, to quadruple precision; at no cost in double.
struct Decimal {
  Quad value = 0;
  template <class R>
  constexpr R as() const {
    return R(value);
  }
  constexpr bool is_zero() const { return value == 0; }
  constexpr Decimal operator-() const { return {-value}; }
};
__extension__ typedef unsigned __int128 Digits;
/// 0.0123_q: at most 38 digits from the first that is not 0, so that they are exact, and 48 after the point, so that
/// the power of ten is. What is left is two roundings.
consteval Decimal operator""_q(char const* text) {
  Digits digits = 0;
  Quad scale = 1;
  int places = 0;
  bool fraction = false;
  for (; *text != 0; ++text) {
    if (*text == '.') {
      fraction = true;
      continue;
    }
    if (*text < '0' || '9' < *text) throw std::invalid_argument("digits and a point");
    if (digits > (~Digits(0) - 9) / 10) throw std::invalid_argument("at most 38 digits");
    digits = 10 * digits + Digits(*text - '0');
    if (!fraction) continue;
    if (++places > 48) throw std::invalid_argument("at most 48 places");
    scale *= 10;
  }
  return {Quad(digits) / scale};
}

///   0 |               Euler (1768)
///     | 1
struct Euler1 {
  static constexpr int stages = 1, order = 1;
  static constexpr Ratio a[1][1] = {{}};
  static constexpr Ratio b[1] = {{1, 1}};
  static constexpr Ratio c[1] = {{}};
};

///   0   |                        Kutta (1901); Hairer-Norsett-Wanner I, table II.1.2
///   1/2 | 1/2
///   1/2 |  0  1/2
///   1   |  0   0   1
///       | 1/6 1/3 1/3 1/6
struct Kutta4 {
  static constexpr int stages = 4, order = 4;
  static constexpr Ratio a[4][4] = {{}, {{1, 2}}, {{}, {1, 2}}, {{}, {}, {1, 1}}};
  static constexpr Ratio b[4] = {{1, 6}, {1, 3}, {1, 3}, {1, 6}};
  static constexpr Ratio c[4] = {{}, {1, 2}, {1, 2}, {1, 1}};
};

/// Dormand & Prince (1980), J. Comput. Appl. Math. 6, 19: order 5(4), first same as last.
/// Hairer-Norsett-Wanner I, table II.5.2. Six stages make the step; the seventh is f at its end, for the error alone.
/// Continuous extension: eq. (II.6.12), see EmbeddedPair.
///
/// Every pair has: `stages` that make the step; `pair_stages` that estimate its error; with first_same_as_last the
/// slope at the step's end besides. `e`, by stages, is b - b^ of order error_order.
struct DormandPrince5 {
  static constexpr int stages = 6, pair_stages = 6, order = 5, error_order = 4, dense_order = 4;
  static constexpr bool first_same_as_last = true;
  static constexpr Ratio a[6][6] = {{},
                                    {{1, 5}},
                                    {{3, 40}, {9, 40}},
                                    {{44, 45}, {-56, 15}, {32, 9}},
                                    {{19372, 6561}, {-25360, 2187}, {64448, 6561}, {-212, 729}},
                                    {{9017, 3168}, {-355, 33}, {46732, 5247}, {49, 176}, {-5103, 18656}}};
  static constexpr Ratio b[6] = {{35, 384}, {}, {500, 1113}, {125, 192}, {-2187, 6784}, {11, 84}};
  static constexpr Ratio c[6] = {{}, {1, 5}, {3, 10}, {4, 5}, {8, 9}, {1, 1}};
  /// b - b^, the error row, last entry on f at the step's end.
  static constexpr Ratio e[7] = {{71, 57600}, {}, {-71, 16695}, {71, 1920}, {-17253, 339200}, {22, 525}, {-1, 40}};
  /// d of q(s) = d0 + s d1, last row on f at the step's end.
  static constexpr Ratio dense[7][2] = {{{-12793612615, 11282082432}, {157015080, 11282082432}},
                                        {},
                                        {{88272555100, 32700410799}, {-1570150800, 32700410799}},
                                        {{-11083301675, 1880347072}, {785075400, 1880347072}},
                                        {{759212249535, 199316789632}, {-114463993320, 199316789632}},
                                        {{-1648467425, 822651844}, {389220480, 822651844}},
                                        {{74144470, 29380423}, {-8293050, 29380423}}};
};

}  // namespace polhode
