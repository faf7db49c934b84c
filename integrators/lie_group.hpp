#pragma once
/// Explicit methods that stay on the group by construction: Lie-Euler, Munthe-Kaas (RKMK), commutator-free (CF).
/// Use where the attitude must remain an attitude and steps are large; they keep the norm, not the energy.
#include "integrators/runge_kutta.hpp"

namespace polhode {

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

/// Commutator-free method of order 4: products of exponentials of combined velocities, no dexp^-1.
/// 4 evaluations, 5 exponentials per step; the fourth stage starts from the second.
/// Source: Celledoni, Marthinsen & Owren (2003), Future Generation Computer Systems 19, 341; mirrored for body rates
struct CommutatorFree4 {
  static constexpr MethodInfo info{
      .name = "cf4",
      .family = Family::lie_group,
      .order = 4,
      .needs = Needs::group,
      .preserves = keeps_norm,
      .source = "Celledoni, Marthinsen & Owren (2003)",
      .pitfall = "the order of the two last exponentials depends on the frame of the rates"};
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<CommutatorFree4, P>(*this, p, control, policy);
  }

  template <Space M>
  struct Frame {};
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>&, NoMemory&) const {
    R const half = R(0.5) * h, one = h / R(12.0), two = R(2.0) * one, three = R(3.0) * one;
    // The velocity at y, seen from y itself: only combinations of velocities are exponentiated.
    auto const slope = [&](S const& time, Point<M> const& y) POLHODE_LAMBDA { return M::rate(y, p(time, y)); };
    auto const moved = [](Point<M> const& y, auto const&... term) POLHODE_LAMBDA {
      Chart<M> u = M::centre(y);
      (add(u, term.first, term.second), ...);
      return M::retract(y, u);
    };
    auto const times = [](R const& c, Chart<M> const& k) POLHODE_LAMBDA { return std::pair<R, Chart<M> const&>(c, k); };

    Chart<M> const k1 = slope(t, x);
    Point<M> const y2 = moved(x, times(half, k1));
    Chart<M> const k2 = slope(S(t + half), y2);
    Chart<M> const k3 = slope(S(t + half), moved(x, times(half, k2)));
    Chart<M> const k4 = slope(S(t + h), moved(y2, times(-half, k1), times(h, k3)));
    Point<M> const middle = moved(x, times(three, k1), times(two, k2), times(two, k3), times(-one, k4));
    x = moved(middle, times(-one, k1), times(two, k2), times(two, k3), times(three, k4));
  }
};

}  // namespace polhode
