#pragma once
/// Butcher tableaus of explicit methods, as exact fractions: right in any scalar.
#include <array>

#include "integrators/integrator.hpp"

namespace polhode {

/// An exact fraction, so that a coefficient has the precision of whatever scalar it meets.
struct Ratio {
  long over = 0, under = 1;
  template <class R>
  constexpr R as() const {
    return R(double(over)) / R(double(under));
  }
};

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
struct DormandPrince5 {
  static constexpr int stages = 6, order = 5, error_order = 4;
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
};

}  // namespace polhode
