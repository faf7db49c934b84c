#pragma once
/// Explicit pairs of high order: Dormand and Prince's, Verner's. In equal steps and in steps of their own choice.
/// Use from tolerances of 1e-7 down; keeps no invariant.
#include "integrators/runge_kutta.hpp"
#include "integrators/tableau_dop853.hpp"
#include "integrators/tableaus_verner.hpp"

namespace polhode {

/// A pair with fixed and adaptive steps.
template <class T, StepRule rule = StepRule{.memory = 0.2 / T::order}>
struct FixedOrAdaptive : Explicit<T>, EmbeddedPair<T, rule> {
  using Explicit<T>::bind;
  using EmbeddedPair<T, rule>::bind;
};

/// Order 8(5,3) of the code DOP853.   12 evaluations per fixed step; per adaptive one 12, if rejected 11; keeps nothing
struct Dop853 : FixedOrAdaptive<DormandPrince853, StepRule{.least = 0.333, .most = 6}> {
  static constexpr MethodInfo info{.name = "dop853",
                                   .family = Family::explicit_rk,
                                   .order = 8,
                                   .needs = Needs::flat,
                                   .source = "Hairer, Norsett & Wanner, Solving ODEs I, II.5, code DOP853",
                                   .pitfall = "a tolerance bounds the local error, not the attitude error"};
};
/// Verner's 6(5).   8 evaluations per fixed step; per adaptive one 8, accepted or not; keeps nothing
struct Verner65 : FixedOrAdaptive<Verner6> {
  static constexpr MethodInfo info{.name = "verner65",
                                   .family = Family::explicit_rk,
                                   .order = 6,
                                   .needs = Needs::flat,
                                   .source = "Verner (2010), Numerical Algorithms 53, 383: most efficient 6(5)",
                                   .pitfall = "a tolerance bounds the local error, not the attitude error"};
};
/// Verner's 7(6).   9 evaluations per fixed step; per adaptive one 10, if rejected 9; keeps nothing
struct Verner76 : FixedOrAdaptive<Verner7> {
  static constexpr MethodInfo info{.name = "verner76",
                                   .family = Family::explicit_rk,
                                   .order = 7,
                                   .needs = Needs::flat,
                                   .source = "Verner (2010), Numerical Algorithms 53, 383: most efficient 7(6)",
                                   .pitfall = "a tolerance bounds the local error, not the attitude error"};
};
/// Verner's 9(8).   15 evaluations per fixed step; per adaptive one 16, if rejected 15; keeps nothing
struct Verner98 : FixedOrAdaptive<Verner9> {
  static constexpr MethodInfo info{.name = "verner98",
                                   .family = Family::explicit_rk,
                                   .order = 9,
                                   .needs = Needs::flat,
                                   .source = "Verner (2010), Numerical Algorithms 53, 383: most efficient 9(8)",
                                   .pitfall = "a tolerance bounds the local error, not the attitude error"};
};

}  // namespace polhode
