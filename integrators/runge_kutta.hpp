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
    Chart<M> u;
    Point<M> y;
    Velocity<M> v;
    void fit(Point<M> const& x) {
      for (Chart<M>& slope : k) slope = shaped_like<Chart<M>>(x);
      u = shaped_like<Chart<M>>(x);
      y = x;
      v = shaped_like<Velocity<M>>(x);
    }
  };
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, NoMemory&) const {
    slope(p, t, x, frame.v, frame.k[0]);
    finish(p, t, h, x, frame, x);
  }

  /// The rest of a step from x once k[0] is known; the new point goes to y, which may be x.
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  static POLHODE_INLINE void finish(P const& p, S const& t, R const& h, Point<M> const& x, Frame<M>& frame,
                                    Point<M>& y) {
    auto& k = frame.k;
    // One body: the sum with b grows as the stages arrive, or g++ would spill them all.
    [[maybe_unused]] Chart<M> next;
    auto const accumulate = [&](auto j) POLHODE_LAMBDA {
      if constexpr (SmallSpace<M> && T::b[j].over != 0) add(next, R(T::b[j].template as<R>() * h), k[j]);
    };
    if constexpr (SmallSpace<M>) next = M::centre(x);
    accumulate(std::integral_constant<int, 0>{});
    unroll<T::stages - 1>([&](auto m) POLHODE_LAMBDA {
      constexpr int i = m + 1;
      displace<M>(x, stage_sum<i>(k, h), frame.u, frame.y);
      chart_slope(p, S(t + T::c[i].template as<R>() * h), x, frame.u, frame.y, frame.v, k[i]);
      accumulate(std::integral_constant<int, i>{});
    });
    if constexpr (SmallSpace<M>)
      y = M::retract(x, next);
    else
      displace<M>(x, step_sum(k, h), frame.u, y);
  }

 private:
  /// h times row i of a, and h times b, as displace() wants them.
  template <int i, class R>
  static POLHODE_INLINE auto stage_sum(auto const& k, R const& h) {
    return [&k, &h](auto& u, auto const& at) POLHODE_LAMBDA {
      unroll<i>([&](auto j) POLHODE_LAMBDA {
        if constexpr (T::a[i][j].over != 0) add(u, R(T::a[i][j].template as<R>() * h), at(k[j]));
      });
    };
  }
  template <class R>
  static POLHODE_INLINE auto step_sum(auto const& k, R const& h) {
    return [&k, &h](auto& u, auto const& at) POLHODE_LAMBDA {
      unroll<T::stages>([&](auto j) POLHODE_LAMBDA {
        if constexpr (T::b[j].over != 0) add(u, R(T::b[j].template as<R>() * h), at(k[j]));
      });
    };
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
  using Frame = typename Explicit<T>::template Frame<M>;

  /// One trial step from x, whose slope is frame.k[0]; writes the new point, its slope and the error estimate.
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void attempt(P const& p, R const& t, R const& h, Point<M> const& x, Frame<M>& frame, Point<M>& y,
                              Chart<M>& last, Chart<M>& error) const {
    Explicit<T>::finish(p, S(t), h, x, frame, y);
    slope(p, S(t + h), y, frame.v, last);
    assign_scaled(error, R(T::e[T::stages].template as<R>() * h), last);
    unroll<T::stages>([&](auto j) POLHODE_LAMBDA {
      if constexpr (T::e[j].over != 0) add(error, R(T::e[j].template as<R>() * h), frame.k[j]);
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
