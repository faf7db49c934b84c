#pragma once
/// Gauss collocation of order 2s in the chart around x, stages solved to round-off, sums compensated.
///
/// On flat coordinates it conserves quadratic invariants: |q|, energy and |L|, as far as the computed tableau is
/// symplectic and the stage equations are solved. It is not symplectic in (q, omega), and does not keep the direction
/// of L; gauss_canonical.hpp does. Use for long horizons and tight accuracy.
///
/// Sources: Hairer, Lubich & Wanner, Geometric Numerical Integration (HLW), II.1.3, IV.2.1; Hairer, McLachlan &
/// Razakarivony (2008), BIT 48, 231 (stopping rule, compensated sums).
#include "integrators/gauss_adaptive.hpp"
#include "integrators/gauss_foils.hpp"

namespace polhode {

/// order 2s, s stages (1 to 8); keeps the norm, energy and |L| of a free body. Symmetric on flat coordinates; on a
/// group for s = 1 alone, because the chart is centred at the beginning of the step.
///
/// evaluations  s a sweep, typically 3 to 10 sweeps a step; one more after a restart, and in every adaptive step
///
/// fails  Status::nonlinear_fail if neither the fixed point nor Newton solves the stages
struct GaussOf {
  int stages;

  template <Problem P, class M = typename P::Space>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<GaussMethod<M>, P>({stages, shape_of(p)}, p, control, policy);
  }
  template <Problem P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return GaussControlled<P>(stages, p, control, policy);
  }
};
/// Gauss collocation of s stages and order 2 s, iterated to round-off, on any space.
template <int s>
struct Gauss : GaussOf {
  static_assert(1 <= s && s <= most_gauss_stages);
  constexpr Gauss() : GaussOf{s} {}
};

/// The catalogue's gauss1 ... gauss8. Source: Hairer, Lubich & Wanner, II.1.3
template <int s>
struct GaussEntry : Gauss<s> {
  static constexpr std::string_view names[] = {"gauss1", "gauss2", "gauss3", "gauss4",
                                               "gauss5", "gauss6", "gauss7", "gauss8"};
  static constexpr MethodInfo info{
      .name = names[s - 1],
      .family = Family::gauss,
      .order = 2 * s,
      .preserves = keeps_norm | keeps_energy | keeps_momentum | is_symmetric,
      .source = "Hairer, Lubich & Wanner, II.1.3; round-off: Hairer, McLachlan & Razakarivony (2008)",
      .pitfall = s == 1 ? "on (q, omega) not symplectic: the direction of L errs by O(h^2s)"
                        : "on (q, omega) not symplectic: the direction of L errs by O(h^2s); on a group not symmetric: "
                          "there lie_gauss is"};
};

}  // namespace polhode
