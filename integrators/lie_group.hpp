#pragma once
/// Explicit methods that stay on the group by construction: Lie-Euler and Munthe-Kaas (RKMK) here; commutator-free ones
/// and Crouch-Grossman's in files of their own. Use where the attitude must remain an attitude and steps are large;
/// they keep the norm, not the energy.
#include "integrators/runge_kutta.hpp"

namespace polhode {

///   0   |            Runge (1895); Hairer-Norsett-Wanner I, table II.1.1
///   1/2 | 1/2
///       |  0   1
struct Midpoint2 {
  static constexpr int stages = 2, order = 2;
  static constexpr Ratio a[2][2] = {{}, {{1, 2}}};
  static constexpr Ratio b[2] = {{}, {1, 1}};
  static constexpr Ratio c[2] = {{}, {1, 2}};
};

///   0   |               Kutta (1901)
///   1/2 | 1/2
///   1   | -1   2
///       | 1/6 2/3 1/6
struct Kutta3 {
  static constexpr int stages = 3, order = 3;
  static constexpr Ratio a[3][3] = {{}, {{1, 2}}, {{-1, 1}, {2, 1}}};
  static constexpr Ratio b[3] = {{1, 6}, {2, 3}, {1, 6}};
  static constexpr Ratio c[3] = {{}, {1, 2}, {1, 1}};
};

/// The exponential of one velocity.   order 1, 1 evaluation, 1 exponential per step
struct LieEuler : Explicit<Euler1> {
  static constexpr MethodInfo info{.name = "lie_euler",
                                   .family = Family::lie_group,
                                   .order = 1,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Iserles, Munthe-Kaas, Norsett & Zanna (2000), Acta Numerica 9",
                                   .pitfall = "order 1: a foil"};
};

/// The midpoint tableau in the chart of the exponential map.   order 2, 2 evaluations, 2 exponentials
struct Rkmk2 : Explicit<Midpoint2> {
  static constexpr MethodInfo info{.name = "rkmk2",
                                   .family = Family::lie_group,
                                   .order = 2,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Munthe-Kaas (1998), BIT 38, 92; tableau: Runge (1895)"};
};

/// Kutta's third-order tableau in the chart of the exponential map, with the exact dexp^-1.   order 3, 3 evaluations, 3
/// exponentials
struct Rkmk3 : Explicit<Kutta3> {
  static constexpr MethodInfo info{.name = "rkmk3",
                                   .family = Family::lie_group,
                                   .order = 3,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Munthe-Kaas (1998), BIT 38, 92; tableau: Kutta (1901)",
                                   .pitfall = "a wrong dexp^-1 hides on degenerate test problems"};
};

/// Kutta's tableau in the chart of the exponential map, with the exact dexp^-1.   order 4, 4 evaluations, 4
/// exponentials
struct Rkmk4 : Explicit<Kutta4> {
  static constexpr MethodInfo info{.name = "rkmk4",
                                   .family = Family::lie_group,
                                   .order = 4,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Munthe-Kaas (1998), BIT 38, 92",
                                   .pitfall = "a wrong dexp^-1 hides on degenerate test problems"};
};

}  // namespace polhode
