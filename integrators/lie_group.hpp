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
  struct Frame {
    std::array<Chart<M>, 4> k;
    Chart<M> u;
    Point<M> y2, y;
    Velocity<M> v;
    void fit(Point<M> const& x) {
      for (Chart<M>& slope : k) slope = shaped_like<Chart<M>>(x);
      u = shaped_like<Chart<M>>(x);
      y2 = y = x;
      v = shaped_like<Velocity<M>>(x);
    }
  };
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, NoMemory&) const {
    auto& [k, u, y2, y, v] = frame;
    R const half = R(0.5) * h, one = h / R(12.0), two = R(2.0) * one, three = R(3.0) * one;
    // Slopes are seen from where they are taken: only combinations of velocities are exponentiated.
    slope(p, t, x, v, k[0]);
    displace<M>(
        x, [&](auto& z, auto const& at) POLHODE_LAMBDA { add(z, half, at(k[0])); }, u, y2);
    slope(p, S(t + half), y2, v, k[1]);
    displace<M>(
        x, [&](auto& z, auto const& at) POLHODE_LAMBDA { add(z, half, at(k[1])); }, u, y);
    slope(p, S(t + half), y, v, k[2]);
    displace<M>(
        y2,
        [&](auto& z, auto const& at) POLHODE_LAMBDA {
          add(z, R(-half), at(k[0]));
          add(z, h, at(k[2]));
        },
        u, y);
    slope(p, S(t + h), y, v, k[3]);
    displace<M>(
        x,
        [&](auto& z, auto const& at) POLHODE_LAMBDA {
          add(z, three, at(k[0]));
          add(z, two, at(k[1]));
          add(z, two, at(k[2]));
          add(z, R(-one), at(k[3]));
        },
        u, y);
    displace<M>(
        y,
        [&](auto& z, auto const& at) POLHODE_LAMBDA {
          add(z, R(-one), at(k[0]));
          add(z, two, at(k[1]));
          add(z, two, at(k[2]));
          add(z, three, at(k[3]));
        },
        u, x);
  }
};

}  // namespace polhode
