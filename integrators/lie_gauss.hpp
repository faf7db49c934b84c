#pragma once
/// Gauss collocation of order 2s on a group, symmetric in time: the chart is centred half way between the step's ends,
/// z = x exp(sum_j L_j / 2), so that the ends have the coordinates -/+ sum_j L_j / 2.
///
///   L_i = h b_i dexp^-1_{u_i} f(t + c_i h, z exp(u_i))      u_i = sum_j (a_ij / b_j - 1/2) L_j
///   x' = x exp(sum_j L_j)
///
/// On flat coordinates it is gauss1, gauss2, ... Of those on a group only gauss1 is symmetric, and it is lie_gauss1.
/// Use for reversible problems over long horizons on a group; not when h times the Lipschitz constant nears 1.
/// Sources: Zanna, Engo & Munthe-Kaas (2001), BIT 41, 395; Hairer, Lubich & Wanner, V.4.3; stopping rule and
/// compensated sums: Hairer, McLachlan & Razakarivony (2008), BIT 48, 231
#include "integrators/gauss.hpp"

namespace polhode {

/// Gauss in scalar R as it looks from the middle of a step: middle_ij = a_ij / b_j - 1/2, antisymmetric to the last
/// bit.
template <class R, int s>
struct MiddleGauss {
  std::array<R, s> b, c;
  std::array<std::array<R, s>, s> middle;

  MiddleGauss() {
    GaussCoefficients const& exact = gauss_coefficients(s);
    for (std::size_t i = 0; i < s; ++i) {
      b[i] = R(exact.b[i]);
      c[i] = R(exact.c[i]);
      middle[i][i] = R(0.0);
      for (std::size_t j = 0; j < i; ++j) {
        middle[i][j] = R(exact.a[i][j] / exact.b[j] - Quad(0.5));
        middle[j][i] = -middle[i][j];
      }
    }
  }
};

/// order 2s, s stages; keeps the norm, and energy and |L| of a free body; symmetric. One sweep evaluates each stage
/// once, from the newest values of the others.
///
/// fails  Status::nonlinear_fail if the sweeps come to rest far from a solution
template <int s>
struct LieGauss {
  template <class R>
  struct Method {
    MiddleGauss<R, s> table;

    /// carry: what rounding took from the state, in chart coordinates; 0 on a group.
    template <Space M>
    struct Memory {
      Chart<M> carry;
      std::int64_t iterations = 0;
      bool unconverged = false;  ///< a step's iteration came to rest far from a solution
      Memory() { restart(); }
      void fit(Point<M> const& x) {
        carry = shaped_like<Chart<M>>(x);
        restart();
      }
      void restart() { fill(carry, 0.0); }
    };
    template <Space M>
    struct Frame {
      std::array<Chart<M>, s> increment;
      Chart<M> place, now, rest;
      Point<M> middle, y;
      Velocity<M> v;
      void fit(Point<M> const& x) {
        for (Chart<M>& one : increment) one = shaped_like<Chart<M>>(x);
        place = now = rest = shaped_like<Chart<M>>(x);
        middle = y = x;
        v = shaped_like<Velocity<M>>(x);
      }
    };

    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame,
                             Memory<M>& memory) const {
      auto& [L, place, now, rest, z, y, v] = frame;
      std::array<R, s> hb, hc;
      unroll<s>([&](auto i) POLHODE_LAMBDA {
        hb[i] = h * table.b[i];
        hc[i] = h * table.c[i];
      });
      slope(p, t, x, v, now);
      unroll<s>([&](auto i) POLHODE_LAMBDA { assign_scaled(L[i], hb[i], now); });

      S change(0.0);
      AtRest<S> at_rest;
      for (int sweep = 0; sweep < most_sweeps && !at_rest; ++sweep) {
        displace<M>(
            x,
            [&](auto& half, auto const& at) POLHODE_LAMBDA {
              add(half, at(memory.carry));
              for (Chart<M> const& one : L) add(half, R(0.5), at(one));
            },
            place, z);
        change = S(0.0);
        for (std::size_t i = 0; i < s; ++i) {  // not unrolled: that would take long to compile
          displace<M>(
              z,
              [&](auto& u, auto const& at) POLHODE_LAMBDA {
                for (std::size_t j = 0; j < s; ++j) add(u, table.middle[i][j], at(L[j]));
              },
              place, y);
          chart_slope(p, S(t + hc[i]), z, place, y, v, now);
          scale(now, hb[i]);
          change = max_of(change, distance<S>(now, L[i]));
          L[i] = now;
        }
        ++memory.iterations;
        at_rest.see(change);
      }
      if (!is_solved(change, largest<S>(L[0]))) [[unlikely]]
        memory.unconverged = true;

      now = L[0];
      rest = memory.carry;
      unroll<s - 1>([&](auto j) POLHODE_LAMBDA {
        Chart<M>::each(
            [](S& total, S& lost, S const& term) POLHODE_LAMBDA {
              auto const exact = two_sum(total, term);
              total = exact.sum;
              lost += exact.rest;
            },
            now, rest, L[j + 1]);
      });
      retract_exactly<M>(x, now, rest, memory.carry);
    }
  };

  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    return Fixed<Method<R>, P>(Method<R>{}, p, control, policy);
  }

 private:
  static constexpr int most_sweeps = 200;
};

/// The catalogue's lie_gauss1 ... lie_gauss4: order 2 s on a group. Source: Zanna, Engo & Munthe-Kaas (2001)
template <int s>
struct LieGaussEntry : LieGauss<s> {
  static_assert(1 <= s && s <= 4);
  static constexpr std::string_view names[4] = {"lie_gauss1", "lie_gauss2", "lie_gauss3", "lie_gauss4"};
  static constexpr MethodInfo info{
      .name = names[s - 1],
      .family = Family::gauss,
      .order = 2 * s,
      .needs = Needs::group,
      .preserves = keeps_norm | keeps_energy | keeps_momentum | is_symmetric,
      .source = "Zanna, Engo & Munthe-Kaas (2001), BIT 41, 395; Hairer, Lubich & Wanner, V.4.3",
      .pitfall = "symmetric, not symplectic: the direction of L errs by O(h^2s)"};
};

}  // namespace polhode
