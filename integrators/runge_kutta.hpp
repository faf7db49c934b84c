#pragma once
/// Explicit Runge-Kutta in the chart around x: the classical methods on a flat space, Munthe-Kaas (RKMK) on a group.
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, ch. II; Munthe-Kaas (1998), BIT 38, 92.
/// Use for short horizons and sampled loops; keeps no invariant on a flat space.
#include "integrators/step_control.hpp"
#include "integrators/tableaus.hpp"

namespace polhode {

/// The slopes of `count` stages, and the room to make them.
template <Space M, int count>
struct Slopes {
  std::array<Chart<M>, std::size_t(count)> k;
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

/// A tableau known at compile time: zeros vanish, loops unroll.
template <class T>
struct Explicit {
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<Explicit, P>(*this, p, control, policy);
  }

  template <Space M>
  using Frame = Slopes<M, T::stages>;
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, NoMemory&) const {
    slope(p, t, x, frame.v, frame.k[0]);
    finish(p, t, h, x, frame, x);
  }

  /// The rest of a step from x once k[0] is known; the new point goes to y, which may be x.
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  static POLHODE_INLINE void finish(P const& p, S const& t, R const& h, Point<M> const& x, auto& frame, Point<M>& y) {
    auto& k = frame.k;
    // One body: the sum with b grows as the stages arrive, or g++ would spill them all.
    [[maybe_unused]] Chart<M> next;
    auto const accumulate = [&](auto j) POLHODE_LAMBDA {
      if constexpr (SmallSpace<M> && !T::b[j].is_zero()) add(next, R(T::b[j].template as<R>() * h), k[j]);
    };
    if constexpr (SmallSpace<M>) next = M::centre(x);
    accumulate(std::integral_constant<int, 0>{});
    unroll<T::stages - 1>([&](auto m) POLHODE_LAMBDA {
      constexpr int i = m + 1;
      stage<i>(p, t, h, x, frame);
      accumulate(std::integral_constant<int, i>{});
    });
    if constexpr (SmallSpace<M>)
      y = M::retract(x, next);
    else
      displace<M>(x, step_sum(k, h), frame.u, y);
  }
  /// k[i] from those before it.
  template <int i, Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  static POLHODE_INLINE void stage(P const& p, S const& t, R const& h, Point<M> const& x, auto& frame) {
    displace<M>(x, stage_sum<i>(frame.k, h), frame.u, frame.y);
    chart_slope(p, S(t + T::c[i].template as<R>() * h), x, frame.u, frame.y, frame.v, frame.k[i]);
  }

 private:
  /// h times row i of a, and h times b, as displace() wants them.
  template <int i, class R>
  static POLHODE_INLINE auto stage_sum(auto const& k, R const& h) {
    return [&k, &h](auto& u, auto const& at) POLHODE_LAMBDA {
      unroll<i>([&](auto j) POLHODE_LAMBDA {
        if constexpr (!T::a[i][j].is_zero()) add(u, R(T::a[i][j].template as<R>() * h), at(k[j]));
      });
    };
  }
  template <class R>
  static POLHODE_INLINE auto step_sum(auto const& k, R const& h) {
    return [&k, &h](auto& u, auto const& at) POLHODE_LAMBDA {
      unroll<T::stages>([&](auto j) POLHODE_LAMBDA {
        if constexpr (!T::b[j].is_zero()) add(u, R(T::b[j].template as<R>() * h), at(k[j]));
      });
    };
  }
};

/// An embedded pair on a flat space; step control in step_control.hpp.
/// Continuous extension, where the tableau has one, from x to y with end slopes k_1 and k_e, s in [0, 1]:
///   s^2 (3 - 2s) y + (1 - s)^2 (1 + 2s) x + h s (1 - s)^2 k_1 - h s^2 (1 - s) k_e + h s^2 (1 - s)^2 sum_i q_i(s) k_i
///   q(s) = d0 + s (d1 + (1 - s) (d2 + s (d3 + (1 - s) d4))),  d a row of `dense`, as far as it goes: by stage of the
///   pair, then k_e, then stages for the extension alone (`dense_a`, `dense_c`)
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.6 (Hermite's cubic and a bubble)
template <class T, StepRule control_rule = StepRule{.memory = 0.2 / T::order}>
struct EmbeddedPair {
  static constexpr int order = T::order;
  static constexpr StepRule rule = control_rule;
  static constexpr bool first_same_as_last = T::first_same_as_last;
  /// The error is estimated twice: estimate_third().
  static constexpr bool two_estimates = requires { T::third; };
  /// There is a continuous extension.
  static constexpr bool dense = requires { T::dense; };

  template <Problem P>
    requires FlatSpace<typename P::Space>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return Controlled<EmbeddedPair, P>(*this, p, control, policy);
  }
  /// The same with interpolate().
  template <Problem P>
    requires(FlatSpace<typename P::Space> && (dense))
  auto bind_dense(P const& p, Adaptive control, NormPolicy policy) const {
    return Controlled<EmbeddedPair, P, true>(*this, p, control, policy);
  }

  template <Space M>
  using Frame = Slopes<M, T::pair_stages>;

  /// One trial step from x, whose slope is frame.k[0]; writes the new point and the error estimate, and the new slope
  /// to `last` if first_same_as_last.
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void attempt(P const& p, R const& t, R const& h, Point<M> const& x, auto& frame, Point<M>& y,
                              [[maybe_unused]] Chart<M>& last, Chart<M>& error) const {
    Explicit<T>::finish(p, S(t), h, x, frame, y);
    if constexpr (first_same_as_last) {
      slope(p, S(t + h), y, frame.v, last);
      assign_scaled(error, R(T::e[T::stages].template as<R>() * h), last);
      add_row<T::e, 0, T::stages>(error, h, frame.k);
    } else {
      unroll<T::pair_stages - T::stages>([&](auto m) POLHODE_LAMBDA {
        constexpr int i = T::stages + m;
        Explicit<T>::template stage<i>(p, S(t), h, x, frame);
      });
      assign_scaled(error, R(T::e[0].template as<R>() * h), frame.k[0]);
      add_row<T::e, 1, T::pair_stages>(error, h, frame.k);
    }
  }
  /// The estimate of order 3 beside that of order 5.   Hairer, Norsett & Wanner I, II.5, eq. (5.29)
  template <Space M, class R>
  POLHODE_INLINE void estimate_third(R const& h, Frame<M> const& frame, Chart<M>& error) const requires(two_estimates) {
    assign_scaled(error, R(T::third[0].template as<R>() * h), frame.k[0]);
    add_row<T::third, 1, T::pair_stages>(error, h, frame.k);
  }

  /// How many slopes the extension is made of.
  static constexpr int slopes_inside = [] {
    if constexpr (dense)
      return int(std::size(T::dense));
    else
      return 0;
  }();

  /// What is kept of a step to look inside it: its ends and slopes; `complete` makes those for the extension alone.
  template <Space M>
  struct Inside {
    Point<M> x, y;
    Slopes<M, slopes_inside> made;
    void fit(Point<M> const& model) {
      x = y = model;
      made.fit(model);
    }
  };
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  void complete(P const& p, R const& t, R const& t_end, Inside<M>& step) const requires(dense) {
    R const h = t_end - t;
    auto& made = step.made;
    if constexpr (!first_same_as_last) slope(p, S(t_end), step.y, made.v, made.k[T::pair_stages]);
    if constexpr (requires { T::dense_a; })
      for (std::size_t row = 0; row < std::size(T::dense_a); ++row) {  // not unrolled: that would take long to compile
        std::size_t const i = T::pair_stages + 1 + row;
        auto const& a = in_scalar<T::dense_a, R>()[row];
        auto const sum = [&](auto& u, auto const& at) {
          for (std::size_t j = 0; j < i; ++j)
            if (!T::dense_a[row][j].is_zero()) add(u, R(a[j] * h), at(made.k[j]));
        };
        displace<M>(step.x, sum, made.u, made.y);
        R const c = T::dense_c[row].template as<R>();
        chart_slope(p, S(t + c * h), step.x, made.u, made.y, made.v, made.k[i]);
      }
  }
  /// The slope at the end of a complete step.
  template <Space M>
  Chart<M> const& last_slope(Inside<M> const& step) const requires(dense) {
    return step.made.k[T::pair_stages];
  }
  /// The point at the part s of a complete step of h [s].
  template <Space M, class R>
  void interpolate(R const& s, R const& h, Inside<M> const& step, Point<M>& point) const requires(dense) {
    R const one(1.0), two(2.0), rest = one - s, bubble = h * s * s * rest * rest;
    R const to_end = s * s * (one + two * rest), to_start = rest * rest * (one + two * s);
    assign_scaled(point, to_start, step.x);
    add(point, to_end, step.y);
    add(point, R(h * s * rest * rest), step.made.k[0]);
    add(point, R(-(h * s * s * rest)), step.made.k[T::pair_stages]);
    for (std::size_t i = 0; i < std::size_t(slopes_inside); ++i) {
      if (T::dense[i][0].is_zero()) continue;
      auto const& d = in_scalar<T::dense, R>()[i];
      R q(0.0);  // from the innermost coefficient outwards
      for (std::size_t j = d.size(); j-- > 0;) q = d[j] + (j % 2 == 0 ? s : rest) * q;
      add(point, R(bubble * q), step.made.k[i]);
    }
  }

 private:
  /// sum += h times the entries from first to last of a row, but for its zeros.
  template <auto const& row, int first, int last, class R>
  static POLHODE_INLINE void add_row(auto& sum, R const& h, auto const& k) {
    unroll<last - first>([&](auto m) POLHODE_LAMBDA {
      constexpr int j = first + m;
      if constexpr (!row[j].is_zero()) add(sum, R(row[j].template as<R>() * h), k[j]);
    });
  }
  /// A matrix of the tableau in R, converted once.
  template <auto const& matrix, class R>
  static auto const& in_scalar() {
    static auto const converted = [] {
      std::array<std::array<R, std::size(matrix[0])>, std::size(matrix)> all;
      for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t j = 0; j < all[i].size(); ++j) all[i][j] = matrix[i][j].template as<R>();
      return all;
    }();
    return converted;
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
