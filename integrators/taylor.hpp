#pragma once
/// Taylor series of the solution of any problem, by evaluating its own source on power series (Jet).
/// Source: Jorba & Zou (2005), Experimental Mathematics 14, 99 (coefficients, step size from the last two)
/// Use for references: any precision, and values between steps to that same precision.
#include <vector>

#include "integrators/integrator.hpp"
#include "problems/jet.hpp"

namespace polhode {

/// The solution from t on: x(t + s) = sum_k x_k s^k for 0 <= s <= h, components in storage order.
template <class R, int degree>
struct TaylorSegment {
  R t, h;
  std::vector<Jet<R, degree>> component;
};

/// Expands the solution of p through the state x at time t, in flat coordinates. The step h keeps the last terms below
/// `tolerance` relative to the state, and is at most `longest` [s].
/// fails   h = 0 if the series has no radius of convergence to speak of or is not finite
template <class R, int degree, Problem P>
  requires FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, Jet<R, degree>>
      TaylorSegment<R, degree> expand(P const& p, std::vector<R> const& state, R const& t, R const& longest,
                                      double tolerance) {
    using M = typename P::Space;
    using Series = Jet<R, degree>;
    std::vector<Series> x(state.begin(), state.end());
    Series time(t);
    std::vector<Series> rate(x.size());
    for (int k = 0; k < degree; ++k) {
      Point<M> point;
      load(point, x.data());
      store(M::rate(point, p(time, point)), rate.data());
      for (std::size_t i = 0; i < x.size(); ++i) {
        x[i].degree = k + 1;
        x[i][k + 1] = (rate[i].degree >= k ? rate[i][k] : R(0.0)) / R(double(k + 1));
      }
      time.degree = k + 1;
      time[1] = R(1.0);
    }

    double size = 1;
    for (Series const& component : x) size = std::max(size, std::fabs(double(component[0])));
    double h = double(longest);
    for (int k : {degree - 1, degree}) {
      double last = 0;
      for (Series const& component : x) last = std::max(last, std::fabs(double(component[k])));
      if (!std::isfinite(last)) h = 0;
      if (last > 0) h = std::min(h, std::pow(tolerance * size / last, 1.0 / k));
    }
    bool const reaches = h >= double(longest) * (1 - 1e-12);
    return {t, reaches ? longest : R(h), std::move(x)};
  }

}  // namespace polhode
