#pragma once
/// Two-stage Gauss as it should not be run: the stage equations are left unsolved, so nothing is conserved.
/// Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, II.1.3
#include "integrators/integrator.hpp"

namespace polhode {

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
/// Foil: one Jacobi sweep from the slopes at the beginning of the step.
struct Gauss2Sweeps1 : UnconvergedGauss2<Stop::after_sweeps, 1> {
  static constexpr MethodInfo info = foil_info("gauss2_sweeps1", "one sweep: nothing is conserved");
};
/// Foil: two such sweeps.
struct Gauss2Sweeps2 : UnconvergedGauss2<Stop::after_sweeps, 2> {
  static constexpr MethodInfo info = foil_info("gauss2_sweeps2", "two sweeps: nothing is conserved");
};
/// Foil: sweeps until they change the slopes by less than 1e-6, absolute.
struct Gauss2Tol6 : UnconvergedGauss2<Stop::below_tolerance, 0> {
  static constexpr MethodInfo info = foil_info("gauss2_tol6", "stopped at 1e-6: linear drift in every invariant");
};

}  // namespace polhode
