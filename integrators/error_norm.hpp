#pragma once
/// How large an error is: the norm that step control holds below 1, and the first step by it; one for every method.
///
///   |e_i| <= atol + rtol |y_i|   by coordinate of the chart, RMS over coordinates
///
/// y_i is the coordinate itself on a flat space, the greater one of the step's two ends; on a group 1 rad.
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.4, eqs. (4.10), (4.11)
#include <algorithm>
#include <cmath>

#include "integrators/method.hpp"
#include "integrators/step_size.hpp"

namespace polhode {

/// What the error of each chart coordinate is relative to: the coordinate itself on a flat space, 1 rad on a group.
template <SmallSpace M>
struct ErrorScale {
  static Chart<M> of(Point<M> const& x) {
    if constexpr (M::flat) {
      return M::centre(x);
    } else {
      Chart<M> one;
      fill(one, 1.0);
      return one;
    }
  }
};
template <SmallSpace A, SmallSpace B>
struct ErrorScale<Product<A, B>> {
  static Chart<Product<A, B>> of(Point<Product<A, B>> const& x) {
    return {ErrorScale<A>::of(x.first), ErrorScale<B>::of(x.second)};
  }
};

/// The norm of errors on M under a tolerance. Errors and weights are charts; a weight is the reciprocal of what is
/// allowed, for it is known before the error, and often used twice.
template <Space M>
class ErrorNorm {
  using S = typename M::Scalar;
  using R = Real<S>;
  using Body = typename BodyOf<M>::type;

 public:
  /// For states like `shape`.
  ErrorNorm(Adaptive control, Point<M> const& shape)
      : control_(control), per_component_(1.0 / double(size_of(shaped_like<Chart<M>>(shape)))) {}

  /// The weights of a step from x to y.
  POLHODE_INLINE void weigh(Point<M> const& x, Point<M> const& y, Chart<M>& weight) const {
    auto const reciprocal = [&](S& w, S const& a, S const& b) POLHODE_LAMBDA {
      double const size = std::max(std::fabs(double(a)), std::fabs(double(b)));
      w = S(1 / (control_.atol + control_.rtol * size));
    };
    if constexpr (M::flat)
      Chart<M>::each(reciprocal, weight, x, y);
    else
      for_each_body<M>(x, [&](auto const& at) {
        Chart<Body>::each(reciprocal, at(weight), ErrorScale<Body>::of(at(x)), ErrorScale<Body>::of(at(y)));
      });
  }
  /// The square of the norm; 1 is what is allowed.
  POLHODE_INLINE double mean_square(Chart<M> const& error, Chart<M> const& weight) const {
    double even = 0, odd = 0;  // two chains of additions: half the latency
    bool is_odd = false;
    Chart<M>::each(
        [&](S const& e, S const& w) POLHODE_LAMBDA {
          double const part = double(e) * double(w);
          (is_odd ? odd : even) += part * part;
          is_odd = !is_odd;
        },
        error, weight);
    return (even + odd) * per_component_;
  }

  /// Where first_step() works.
  struct Room {
    Chart<M>&weight, &change;
    Point<M>& y;
    Velocity<M>& v;
  };
  /// The first step of a run from (t, x), where the slope is k, goes to `size`. One evaluation.
  template <Problem P>
  void first_step(P const& p, R const& t, Point<M> const& x, Chart<M> const& k, R const& longest, StepSize<R>& size,
                  Room room) const {
    auto& [weight, change, y, v] = room;
    weigh(x, x, weight);
    for_each_body<M>(x, [&](auto const& at) { at(change) = ErrorScale<Body>::of(at(x)); });
    auto const norm = [&](Chart<M> const& error) { return std::sqrt(mean_square(error, weight)); };
    size.start(norm(change), norm(k), longest, [&](R const& h) {
      displace<M>(
          x, [&](auto& u, auto const& at) { add(u, h, at(k)); }, change, y);
      slope(p, S(t + h), y, v, change);
      add(change, R(-1.0), k);
      return norm(change);
    });
  }

 private:
  Adaptive control_;
  double per_component_;
};

}  // namespace polhode
