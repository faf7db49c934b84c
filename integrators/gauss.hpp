#pragma once
/// Gauss collocation of order 2s in the chart around x, stages solved by fixed point to round-off, sums compensated.
/// On flat coordinates it conserves quadratic invariants: |q|, energy and |L|, as far as the computed tableau is
/// symplectic and the stage equations are solved. It is not symplectic in (q, omega), and does not keep the direction
/// of L. Sources: Hairer, Lubich & Wanner, Geometric Numerical Integration, II.1.3, IV.2.1; Hairer, McLachlan &
/// Razakarivony (2008), BIT 48, 231 (stopping rule, compensated sums); Antonana, Makazaga & Murua (2017), Numer.
/// Algorithms 76, 861 (coefficients mu_ij = a_ij / b_j with mu_ij + mu_ji = 1 exactly). Use for long horizons and tight
/// accuracy; not when h times the Lipschitz constant nears 1 (the fixed point diverges).
#include "integrators/integrator.hpp"

namespace polhode {

/// Nodes, weights and matrix of s-stage Gauss, in quadruple precision.   HLW II.1.3; matrix by the W-transformation,
/// Hairer & Wanner II, IV.5
template <int s>
struct GaussTableau {
  std::array<Quad, s> b, c;
  std::array<std::array<Quad, s>, s> a;

  GaussTableau() {
    std::array<Quad, s> x;
    for (int i = 0; i < s; ++i) {
      auto const at = std::size_t(i);
      x[at] = root(i);
      Quad const slope = legendre_slope(x[at]);
      c[at] = (x[at] + 1) / 2;
      b[at] = 1 / ((1 - x[at] * x[at]) * slope * slope);
    }
    for (std::size_t i = 0; i < s; ++i)
      for (std::size_t j = 0; j < s; ++j) {
        Quad sum = c[i];
        for (int k = 1; k < s; ++k) sum += legendre(k, x[j]) * (legendre(k + 1, x[i]) - legendre(k - 1, x[i])) / 2;
        a[i][j] = b[j] * sum;
      }
  }

 private:
  static Quad legendre(int n, Quad x) {
    Quad before = 1, now = x;
    if (n == 0) return before;
    for (int k = 1; k < n; ++k) {
      Quad const next = ((2 * k + 1) * x * now - k * before) / (k + 1);
      before = now;
      now = next;
    }
    return now;
  }
  static Quad legendre_slope(Quad x) { return s * (x * legendre(s, x) - legendre(s - 1, x)) / (x * x - 1); }
  /// The i-th root of the Legendre polynomial of degree s, ascending, by Newton.
  static Quad root(int i) {
    Quad x = -std::cos(3.14159265358979323846 * (i + 0.75) / (s + 0.5));
    for (int sweep = 0; sweep < 8; ++sweep) x -= legendre(s, x) / legendre_slope(x);
    return x;
  }
};

/// Coefficients in scalar R in the form that keeps the symplecticity condition exactly: mu_ii = 1/2, mu_ij + mu_ji = 1.
/// The step uses L_j = (h b_j) f(Y_j), Y_i = y + sum_j mu_ij L_j, y' = y + sum_j L_j: one table, never a and b apart.
template <class R, int s>
struct GaussMu {
  std::array<R, s> b, c;
  std::array<std::array<R, s>, s> mu;

  GaussMu() {
    GaussTableau<s> const exact;
    for (std::size_t i = 0; i < s; ++i) {
      b[i] = R(exact.b[i]);
      c[i] = R(exact.c[i]);
      mu[i][i] = R(0.5);
      for (std::size_t j = 0; j < i; ++j) {
        mu[i][j] = R(exact.a[i][j] / exact.b[j]);
        mu[j][i] = R(1.0) - mu[i][j];
      }
    }
  }
};

/// order 2s, s stages; keeps the norm, energy and |L| of a free body. Symmetric on flat coordinates; on a group for
/// s = 1 alone, because the chart is centred at the beginning of the step.
/// One sweep evaluates each stage once, from the newest values of the others. Iteration ends when no component of the
/// stages sets a new minimum of its change, twice running: there is nothing more to gain in this arithmetic.
/// fails  Status::nonlinear_fail if it comes to rest elsewhere: h times the Lipschitz constant of the field is too
/// large
template <int s>
struct Gauss {
  template <class R>
  struct Method {
    GaussMu<R, s> table;

    /// carry: what rounding took from the state, in chart coordinates; belongs to x + carry.
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
      std::array<Chart<M>, s> increment, stage;
      Chart<M> place, slope_here, change, least, sum, rest;
      Point<M> y;
      Velocity<M> v;
      void fit(Point<M> const& x) {
        for (auto* all : {&increment, &stage})
          for (Chart<M>& one : *all) one = shaped_like<Chart<M>>(x);
        place = slope_here = change = least = sum = rest = shaped_like<Chart<M>>(x);
        y = x;
        v = shaped_like<Velocity<M>>(x);
      }
    };

    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame,
                             Memory<M>& memory) const {
      auto& [L, Y, place, slope_here, change, least, sum, rest, y, v] = frame;
      std::array<R, s> hb, hc;
      unroll<s>([&](auto i) POLHODE_LAMBDA {
        hb[i] = h * table.b[i];
        hc[i] = h * table.c[i];
      });
      slope(p, t, x, v, slope_here);
      unroll<s>([&](auto i) POLHODE_LAMBDA {
        assign_scaled(L[i], hb[i], slope_here);
        fill(Y[i], 0.0);
      });

      fill(least, 1e300);
      for (int sweep = 0, idle = 0; sweep < most_sweeps && idle < 2; ++sweep) {
        fill(change, 0.0);
        unroll<s>([&](auto i) POLHODE_LAMBDA {
          for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA {
            using Body = typename BodyOf<M>::type;
            Chart<Body> u = at(memory.carry);
            unroll<s>([&](auto j) POLHODE_LAMBDA { add(u, table.mu[i][j], at(L[j])); });
            Chart<Body>::each([](S& most, S const& now, S const& before)
                                  POLHODE_LAMBDA { most = max_of(most, abs_of(S(now - before))); },
                              at(change), u, at(Y[i]));
            at(Y[i]) = u;
            Chart<Body> here = Body::centre(at(x));
            add(here, u);
            at(y) = Body::retract(at(x), here);
            if constexpr (!PowerSpace<M> || !M::flat) at(place) = here;  // many bodies on a flat space: y is it
          });
          chart_slope(p, S(t + hc[i]), x, place, y, v, L[i]);
          scale(L[i], hb[i]);
        });
        ++memory.iterations;
        idle = idle_after(change, least, idle);
      }
      // At rest through round-off the last change is tiny; at rest because the iteration diverges it is not.
      if (!(largest<S>(change) < S(1e-9) * largest<S>(Y[0]) + S(1e-12))) [[unlikely]]
        memory.unconverged = true;

      sum = L[0];
      rest = memory.carry;
      unroll<s - 1>([&](auto j) POLHODE_LAMBDA {
        Chart<M>::each(
            [](S& total, S& lost, S const& term) POLHODE_LAMBDA {
              auto const exact = two_sum(total, term);
              total = exact.sum;
              lost += exact.rest;
            },
            sum, rest, L[j + 1]);
      });
      retract_exactly<M>(x, sum, rest, memory.carry);
    }
  };

  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    return Fixed<Method<R>, P>(Method<R>{}, p, control, policy);
  }

 private:
  static constexpr int most_sweeps = 200;

  /// How many sweeps running none of the components changed less than ever; 2, the end, if nothing changed at all.
  template <class V>
  static POLHODE_INLINE int idle_after(V const& change, V& least, int idle) {
    bool smaller = false, still = true;
    V::each(
        [&](auto& low, auto const& now) POLHODE_LAMBDA {
          using S = std::decay_t<decltype(now)>;
          still = still && now == S(0.0);
          smaller = smaller || now < low;
          low = now < low ? now : low;
        },
        least, change);
    return still ? 2 : smaller ? 0 : idle + 1;
  }
};

template <int s>
struct GaussEntry : Gauss<s> {
  static_assert(1 <= s && s <= 8);
  static constexpr std::string_view names[] = {"gauss1", "gauss2", "gauss3", "gauss4",
                                               "gauss5", "gauss6", "gauss7", "gauss8"};
  static constexpr MethodInfo info{
      .name = names[s - 1],
      .family = Family::gauss,
      .order = 2 * s,
      .preserves = keeps_norm | keeps_energy | keeps_momentum | is_symmetric,
      .source = "Hairer, Lubich & Wanner, II.1.3; round-off: Hairer, McLachlan & Razakarivony (2008)",
      .pitfall = "on (q, omega) not symplectic: the direction of L errs by O(h^2s)"};
};

/// How a foil stops its iteration.
enum class Stop { after_sweeps, below_tolerance };

/// Two-stage Gauss as the literature often runs it: start from k1 = k2 = f(y), Jacobi sweeps, stop early. A foil: the
/// stage equations are not solved, so nothing is conserved.
///   after_sweeps      `limit` sweeps
///   below_tolerance   until max |delta k| < 1e-6, absolute
template <Stop stop, int limit>
struct UnconvergedGauss2 {
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<UnconvergedGauss2, P>(*this, p, control, policy);
  }
  template <Space M>
  struct Memory {
    std::int64_t iterations = 0;
    void restart() {}
    void fit(Point<M> const&) {}
  };
  template <Space M>
  struct Frame {
    Chart<M> k1, k2, new1, new2, u;
    Point<M> y;
    Velocity<M> v;
    void fit(Point<M> const& x) {
      k1 = k2 = new1 = new2 = u = shaped_like<Chart<M>>(x);
      y = x;
      v = shaped_like<Velocity<M>>(x);
    }
  };

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, Memory<M>& memory) const {
    auto& [k1, k2, new1, new2, u, y, v] = frame;
    R const root = sqrt(R(3.0)) / R(6.0);
    R const near = R(0.25) * h, low = (R(0.25) - root) * h, high = (R(0.25) + root) * h, half = R(0.5) * h;
    slope(p, t, x, v, k1);
    k2 = k1;
    auto const move = [&](R const& a1, R const& a2, Point<M>& to) POLHODE_LAMBDA {
      displace<M>(
          x,
          [&](auto& z, auto const& at) POLHODE_LAMBDA {
            add(z, a1, at(k1));
            add(z, a2, at(k2));
          },
          u, to);
    };
    auto const stage = [&](R const& c, R const& a1, R const& a2, Chart<M>& k) POLHODE_LAMBDA {
      move(a1, a2, y);
      chart_slope(p, S(t + c * h), x, u, y, v, k);
    };
    int const most = stop == Stop::after_sweeps ? limit : 100;
    for (int sweep = 0; sweep < most; ++sweep) {
      stage(R(0.5) - root, near, low, new1);
      stage(R(0.5) + root, high, near, new2);
      S const change = max_of(distance<S>(new1, k1), distance<S>(new2, k2));
      k1 = new1;
      k2 = new2;
      ++memory.iterations;
      if (stop == Stop::below_tolerance && change < S(1e-6)) break;
    }
    move(half, half, x);
  }
};

constexpr MethodInfo foil_info(std::string_view name, std::string_view pitfall) {
  return {.name = name,
          .family = Family::gauss,
          .source = "a foil: Hairer, Lubich & Wanner, II.1.3, left unconverged",
          .pitfall = pitfall};
}
struct Gauss2Sweeps1 : UnconvergedGauss2<Stop::after_sweeps, 1> {
  static constexpr MethodInfo info = foil_info("gauss2_sweeps1", "one sweep: nothing is conserved");
};
struct Gauss2Sweeps2 : UnconvergedGauss2<Stop::after_sweeps, 2> {
  static constexpr MethodInfo info = foil_info("gauss2_sweeps2", "two sweeps: nothing is conserved");
};
struct Gauss2Tol6 : UnconvergedGauss2<Stop::below_tolerance, 0> {
  static constexpr MethodInfo info = foil_info("gauss2_tol6", "stopped at 1e-6: linear drift in every invariant");
};

}  // namespace polhode
