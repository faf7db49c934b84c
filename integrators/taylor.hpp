#pragma once
/// Taylor series of the solution of any problem, by evaluating its own source on power series (Jet).
/// Source: Jorba & Zou (2005), Experimental Mathematics 14, 99 (coefficients, step size from the last two)
/// Use for references: any precision, and values between steps to that same precision.
#include <optional>
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

/// Expands the solution of p through the state x at time t, in flat coordinates, to `degree` or until the terms at
/// `longest` [s] fall below `tolerance` relative to the state. The step h keeps the last terms below that, too.
/// fails   h = 0 if the series has no radius of convergence to speak of or is not finite
template <class R, int degree, Problem P>
  requires FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, Jet<R, degree>>
      TaylorSegment<R, degree> expand(P const& p, std::vector<R> const& state, R const& t, R const& longest,
                                      double tolerance) {
    using M = typename P::Space;
    using Series = Jet<R, degree>;
    std::vector<Series> x(state.begin(), state.end());
    std::vector<Series> rate(x.size());
    Series time(t);
    auto const largest = [&](int k) {
      double most = 0;
      for (Series const& component : x) {
        double const size = std::fabs(double(component[k]));
        if (!(size <= most)) most = size;  // a NaN is the largest of all
      }
      return most;
    };
    double const size = std::max(1.0, largest(0));
    double const span = double(longest);
    int top = 0;
    Point<M> point = p.initial();  // for its length
    Velocity<M> v = shaped_like<Velocity<M>>(point);
    Chart<M> k = shaped_like<Chart<M>>(point);
    std::optional<typename Series::Memory> memory;  // from the first order on: constants are constants until then
    for (int small = 0; top < degree && small < 2;) {
      if (top == 1) memory.emplace();
      if (memory) memory->rewind();
      load(point, x.data());
      slope(p, time, point, v, k);
      store(k, rate.data());
      for (std::size_t i = 0; i < x.size(); ++i) {
        x[i].degree = top + 1;
        x[i][top + 1] = (rate[i].degree >= top ? rate[i][top] : R(0.0)) / R(double(top + 1));
      }
      ++top;
      time.degree = top;
      time[1] = R(1.0);
      small = largest(top) * std::pow(span, top) < tolerance * size ? small + 1 : 0;
    }

    double h = span;
    for (int term : {top - 1, top}) {
      double const last = largest(term);
      if (!std::isfinite(last)) h = 0;
      if (last > 0) h = std::min(h, std::pow(tolerance * size / last, 1.0 / term));
    }
    bool const reaches = h >= span * (1 - 1e-12);
    return {t, reaches ? longest : R(h), std::move(x)};
  }

}  // namespace polhode
