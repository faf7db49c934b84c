#pragma once
/// Two methods of order 2: one by its tableau, one with a step of its own.
#include "integrators/runge_kutta.hpp"

namespace polhode {

///   0 |
///   1 |  1          Heun (1900); Hairer-Norsett-Wanner I, table II.1.1
///     | 1/2 1/2
struct HeunTableau {
  static constexpr int stages = 2, order = 2;
  static constexpr Ratio a[2][2] = {{}, {{1, 1}}};
  static constexpr Ratio b[2] = {{1, 2}, {1, 2}};
  static constexpr Ratio c[2] = {{}, {1, 1}};
};
struct Heun : Explicit<HeunTableau> {
  static constexpr MethodInfo info{
      .name = "heun", .family = Family::explicit_rk, .order = 2, .needs = Needs::flat, .source = "Heun (1900)"};
};

/// Midpoint rule on a group: an exponential of half a step, then one of the whole.   order 2, 2 evaluations per step
struct LieMidpoint {
  static constexpr MethodInfo info{.name = "lie_midpoint",
                                   .family = Family::lie_group,
                                   .order = 2,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Munthe-Kaas (1995), BIT 35, 572"};
  template <Problem P>
    requires SmallSpace<typename P::Space>  // one body: points and velocities are values
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<LieMidpoint, P>(*this, p, control, policy);
  }
  template <Space M>
  struct Frame {};  // storage that a step needs, if any
  template <Space M>
  using Memory = NoMemory;  // what a step leaves for the next, if anything

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>&, NoMemory&) const {
    R const half = R(0.5) * h;
    Point<M> const middle = moved<M>(x, half, M::rate(x, p(t, x)));
    x = moved<M>(x, h, M::rate(middle, p(S(t + half), middle)));
  }

 private:
  /// The point that the velocity k reaches from x in h seconds.
  template <Space M, class R>
  static POLHODE_INLINE Point<M> moved(Point<M> const& x, R const& h, Chart<M> const& k) {
    Chart<M> u = M::centre(x);
    add(u, h, k);
    return M::retract(x, u);
  }
};

}  // namespace polhode
