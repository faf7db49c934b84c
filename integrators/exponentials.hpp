#pragma once
/// Explicit steps by products of exponentials: what commutator-free and Crouch-Grossman methods have in common.
/// A point moves by exponentials of combinations of slopes, one after the other, each in the chart around where the
/// last one ended. The slopes k_1, k_2, ... are body rates seen from where they are taken: no dexp^-1 is needed.
///
/// Mirrored: the literature writes y' = A(y) y, where the factor that acts first stands last; with body rates
/// y' = y A(y), and it stands first. The order in which the exponentials act is the same.
#include <array>

#include "integrators/integrator.hpp"

namespace polhode {

/// Coefficients of slopes k_1, k_2, ... in one exponential.
template <int stages>
using Combination = std::array<Quad, std::size_t(stages)>;

/// y = from exp(h factor[0] . k) exp(h factor[1] . k) ..., `count` of them; from is the step's start or its second
/// point.
template <int stages, int most>
struct ExponentialProduct {
  bool from_second;
  int count;
  std::array<Combination<stages>, std::size_t(most)> factor;
};

/// The coefficients of a product whose j-th exponential is of k_j alone.
template <class R, int stages, int most>
constexpr std::array<R, std::size_t(most)> diagonal_of(ExponentialProduct<stages, most> const& product) {
  std::array<R, std::size_t(most)> diagonal{};
  for (std::size_t j = 0; j < std::size_t(most); ++j) diagonal[j] = R(product.factor[j][j]);
  return diagonal;
}

/// A tableau T has stages, c and
///   product[i]      how the point of stage i + 2 is reached; product[stages - 1] is the step
///   keeps_second    a product starts from the second point
///   one_slope_each  the j-th exponential of every product is of k_j alone
template <class T>
struct Exponentials {
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<Exponentials, P>(*this, p, control, policy);
  }

  template <Space M>
  struct Frame {
    std::array<Chart<M>, T::stages> k;
    Point<M> second, y;
    Velocity<M> v;
    void fit(Point<M> const& x) {
      for (Chart<M>& slope : k) slope = shaped_like<Chart<M>>(x);
      if constexpr (T::keeps_second) second = x;
      y = x;
      v = shaped_like<Velocity<M>>(x);
    }
  };
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, NoMemory&) const {
    slope(p, t, x, frame.v, frame.k[0]);
    stages(p, t, h, x, frame);
    move<M, T::stages - 1>(x, h, frame, x);
  }

  /// The slopes at all stages but the first, which is known.
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  static POLHODE_INLINE void stages(P const& p, S const& t, R const& h, Point<M> const& x, Frame<M>& frame) {
    unroll<T::stages - 1>([&](auto i) POLHODE_LAMBDA {
      constexpr R c = R(T::c[i + 1]);
      Point<M>& y = T::keeps_second && i == 0 ? frame.second : frame.y;
      move<M, i>(x, h, frame, y);
      slope(p, S(t + c * h), y, frame.v, frame.k[i + 1]);
    });
  }
  /// y = the i-th product from x; y may be x. One pass over the bodies, however many exponentials there are.
  template <Space M, int i, class R>
  static POLHODE_INLINE void move(Point<M> const& x, R const& h, Frame<M> const& frame, Point<M>& y) {
    using Body = typename BodyOf<M>::type;
    constexpr auto const& product = T::product[i];
    Point<M> const& from = product.from_second ? frame.second : x;
    for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA {
      Point<Body> here = at(from);
      if constexpr (T::one_slope_each) {
        // Many exponentials, all alike: a loop, which compiles sooner.
        static constexpr auto coefficient = diagonal_of<R>(product);
        for (std::size_t j = 0; j < std::size_t(product.count); ++j) {
          Chart<Body> u = Body::centre(here);
          add(u, R(coefficient[j] * h), at(frame.k[j]));
          here = Body::retract(here, u);
        }
      } else {
        unroll<product.count>([&](auto e) POLHODE_LAMBDA {
          Chart<Body> u = Body::centre(here);
          unroll<T::stages>([&](auto j) POLHODE_LAMBDA {
            constexpr R a = R(product.factor[e][j]);
            if constexpr (a != 0) add(u, R(a * h), at(frame.k[j]));
          });
          here = Body::retract(here, u);
        });
      }
      at(y) = here;
    });
  }
};

}  // namespace polhode
