#pragma once
/// Explicit Runge-Kutta in the chart around x: the classical methods on a flat space, Munthe-Kaas (RKMK) on a group.
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, ch. II; Munthe-Kaas (1998), BIT 38, 92.
/// Use for short horizons and sampled loops; keeps no invariant on a flat space.
#include "integrators/step_control.hpp"
#include "integrators/tableaus.hpp"

namespace polhode {

/// A tableau known at compile time: zeros vanish, loops unroll.
template <class T>
struct Explicit {
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<Explicit, P>(*this, p, control, policy);
  }

  template <Space M>
  struct Frame {
    std::array<Chart<M>, T::stages> k;
  };
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, NoMemory&) const {
    frame.k[0] = M::rate(x, p(t, x));
    x = finish<M>(x, h, frame.k, [&](auto stage, Chart<M> const& u, Point<M> const& y) POLHODE_LAMBDA {
      return M::chart_rate(x, u, p(S(t + T::c[stage].template as<R>() * h), y));
    });
  }

  /// The rest of a step once k[0] is known; slope(stage, u, y) evaluates one stage at y, whose chart coordinates are u.
  /// Returns the new point; the sum with b grows as the stages arrive, or g++ would spill them all.
  template <Space M, class R, class Slope>
  static POLHODE_INLINE Point<M> finish(Point<M> const& x, R const& h, std::array<Chart<M>, T::stages>& k,
                                        Slope slope) {
    Chart<M> next = M::centre(x);
    auto const accumulate = [&](auto j) POLHODE_LAMBDA {
      if constexpr (T::b[j].over != 0) add(next, R(T::b[j].template as<R>() * h), k[j]);
    };
    accumulate(std::integral_constant<int, 0>{});
    unroll<T::stages - 1>([&](auto m) POLHODE_LAMBDA {
      constexpr int i = m + 1;
      Chart<M> u = M::centre(x);
      unroll<i>([&](auto j) POLHODE_LAMBDA {
        if constexpr (T::a[i][j].over != 0) add(u, R(T::a[i][j].template as<R>() * h), k[j]);
      });
      k[i] = slope(std::integral_constant<int, i>{}, u, M::retract(x, u));
      accumulate(std::integral_constant<int, i>{});
    });
    return M::retract(x, next);
  }
};

/// An embedded pair on a flat space, its first stage being the last of the step before; step control in
/// step_control.hpp.
template <class T>
struct EmbeddedPair {
  template <Problem P>
    requires FlatSpace<typename P::Space>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return Controlled<EmbeddedPair, P>(*this, p, control, policy);
  }
  static constexpr int order = T::order, error_order = T::error_order;

  template <Space M>
  struct Frame {
    std::array<Chart<M>, T::stages> k;
  };

  /// One trial step from x with slope `first`; writes the new point, its slope and the error estimate.
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void attempt(P const& p, R const& t, R const& h, Point<M> const& x, Chart<M> const& first,
                              Frame<M>& frame, Point<M>& y, Chart<M>& last, Chart<M>& error) const {
    auto& k = frame.k;
    k[0] = first;
    y = Explicit<T>::template finish<M>(x, h, k, [&](auto stage, Chart<M> const& u, Point<M> const& z) POLHODE_LAMBDA {
      return M::chart_rate(x, u, p(S(t + T::c[stage].template as<R>() * h), z));
    });
    last = M::rate(y, p(S(t + h), y));
    error = scaled(R(T::e[T::stages].template as<R>() * h), last);
    unroll<T::stages>([&](auto j) POLHODE_LAMBDA {
      if constexpr (T::e[j].over != 0) add(error, R(T::e[j].template as<R>() * h), k[j]);
    });
  }
};

/// Kutta's method on flat coordinates.   order 4, 4 stages, 4 evaluations per step; keeps nothing
struct Rk4 : Explicit<Kutta4> {
  static constexpr MethodInfo info{.name = "rk4",
                                   .family = Family::explicit_rk,
                                   .order = 4,
                                   .needs = Needs::flat,
                                   .source = "Kutta (1901)",
                                   .pitfall = "the norm drifts as h^5 per step; on a group the same tableau is rkmk4"};
};

/// Dormand and Prince's pair.   order 5, 6 evaluations per fixed step, 6 per adaptive one; keeps nothing
struct Dopri5 : Explicit<DormandPrince5>, EmbeddedPair<DormandPrince5> {
  using Explicit<DormandPrince5>::bind;
  using EmbeddedPair<DormandPrince5>::bind;
  static constexpr MethodInfo info{.name = "dopri5",
                                   .family = Family::explicit_rk,
                                   .order = 5,
                                   .needs = Needs::flat,
                                   .source = "Dormand & Prince (1980); step control: Hairer, Norsett & Wanner I, II.4",
                                   .pitfall = "a tolerance bounds the local error, not the attitude error"};
};

}  // namespace polhode
