#pragma once
/// Many equal bodies: the space of n points, n known at compile time or when the run is set up.
///
/// Values of run-time length cannot be made inside a step (nothing there allocates), so methods go through the five
/// functions below, which write into storage that they are given. A small space is handled as a value, in registers; a
/// power in one pass over its bodies.
#include <array>
#include <span>
#include <vector>

#include "problems/space.hpp"

namespace polhode {

/// The number of bodies is known when the run is set up, not before.
inline constexpr int dynamic = -1;

/// n equal vectors one after the other; dynamic: as many as it was made with, allocated then and never again.
template <class T, int n>
struct Many {
  std::conditional_t<n == dynamic, std::vector<T>, std::array<T, std::size_t(n == dynamic ? 0 : n)>> part;

  Many() = default;
  explicit Many([[maybe_unused]] int count) {
    if constexpr (n == dynamic) part.resize(std::size_t(count));
  }
  int count() const { return int(part.size()); }
  POLHODE_INLINE T& operator[](int i) { return part[std::size_t(i)]; }
  POLHODE_INLINE T const& operator[](int i) const { return part[std::size_t(i)]; }

  template <class F, class A, class... V>
  static POLHODE_INLINE void each(F&& f, A&& a, V&&... v) {
#pragma GCC unroll 1
    for (int i = 0, m = a.count(); i < m; ++i) T::each(f, a[i], v[i]...);
  }
};

/// Number of scalars in v.
template <class V>
int size_of(V const& v) {
  if constexpr (requires { v.count(); })
    return v.count() * std::decay_t<decltype(v[0])>::size;
  else
    return V::size;
}
/// A new T for as many bodies as `model` has.
template <class T, class Model>
T shaped_like([[maybe_unused]] Model const& model) {
  if constexpr (requires { model.count(); })
    return T(model.count());
  else
    return T{};
}

/// M^n: the points of n bodies, each in a chart of its own. The defect is the greatest of all.
template <SmallSpace M, int n>
struct Power {
  using Scalar = typename M::Scalar;
  using Point = Many<typename M::Point, n>;
  using Chart = Many<typename M::Chart, n>;
  using Velocity = Many<typename M::Velocity, n>;
  using Factor = M;
  static constexpr int bodies = n;
  static constexpr bool flat = M::flat;
  static constexpr bool constrained = M::constrained;

  static Scalar defect(Point const& x) {
    Scalar most(0.0);
    for (int i = 0; i < x.count(); ++i) most = max_of(most, M::defect(x[i]));
    return most;
  }
  static Scalar project(Point& x) {
    Scalar most(0.0);
    for (int i = 0; i < x.count(); ++i) most = max_of(most, M::project(x[i]));
    return most;
  }
  static bool settle(Point& x) requires Settling<M> {
    bool moved = false;
    for (int i = 0; i < x.count(); ++i) moved = M::settle(x[i]) || moved;
    return moved;
  }
  static bool singular(Point const& x) requires Singular<M> {
    for (int i = 0; i < x.count(); ++i)
      if (M::singular(x[i])) return true;
    return false;
  }
};

// ---- What methods call ----------------------------------------------------------------------------------------------

/// The part of a vector that belongs to the body in hand: all of it,
struct Whole {
  POLHODE_INLINE auto& operator()(auto& k) const { return k; }
};
/// or the i-th.
struct Part {
  int i;
  POLHODE_INLINE auto& operator()(auto& k) const { return k[i]; }
};
/// The space of one body.
template <Space M>
struct BodyOf {
  using type = M;
};
template <PowerSpace M>
struct BodyOf<M> {
  using type = typename M::Factor;
};
/// f(at) for every body of x, at(k) being its part of a vector k: one pass over memory for all that f does.
template <Space M, class F>
POLHODE_INLINE void for_each_body(Point<M> const& x, F const& f) {
  if constexpr (PowerSpace<M>) {
#pragma GCC unroll 1
    for (int i = 0, n = x.count(); i < n; ++i) f(Part{i});
  } else {
    f(Whole{});
  }
}

/// u = centre(x) + what sum(u, at) adds, y = retract(x, u). at(k) is the body's part of a chart vector k. y may be x.
/// Of many bodies on a flat space u is not written, for there it is y, and memory is what limits them.
template <Space M, class Sum>
POLHODE_INLINE void displace(Point<M> const& x, Sum const& sum, Chart<M>& u, Point<M>& y) {
  using Body = typename BodyOf<M>::type;
  for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA {
    Chart<Body> here = Body::centre(at(x));
    sum(here, at);
    at(y) = Body::retract(at(x), here);
    if constexpr (!PowerSpace<M> || !M::flat) at(u) = here;
  });
}
/// k = rate(x, v)
template <Space M>
POLHODE_INLINE void to_rate(Point<M> const& x, Velocity<M> const& v, Chart<M>& k) {
  using Body = typename BodyOf<M>::type;
  for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA { at(k) = Body::rate(at(x), at(v)); });
}
/// k = chart_rate(x, u, v)
template <Space M>
POLHODE_INLINE void to_chart_rate(Point<M> const& x, Chart<M> const& u, Velocity<M> const& v, Chart<M>& k) {
  using Body = typename BodyOf<M>::type;
  for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA { at(k) = Body::chart_rate(at(x), at(u), at(v)); });
}
/// See Space: x = retract(x, centre + carry + sum + rest), carry what rounding lost.
template <Space M>
POLHODE_INLINE void retract_exactly(Point<M>& x, Chart<M> const& sum, Chart<M> const& rest, Chart<M>& carry) {
  using Body = typename BodyOf<M>::type;
  for_each_body<M>(x,
                   [&](auto const& at) POLHODE_LAMBDA { Body::retract_exactly(at(x), at(sum), at(rest), at(carry)); });
}

/// Attitudes alone: kinematics, with body rates as commands.
template <Attitude A, int n = dynamic>
using Attitudes = Power<A, n>;
/// Attitudes with body rates.
template <Attitude A, int n = dynamic>
using RigidBodies = Power<RigidBody<A>, n>;

}  // namespace polhode
