#pragma once
/// The laws of a space as one check that any new space gets for free.
#include <algorithm>

#include "problems/dual.hpp"
#include "problems/space.hpp"

namespace polhode {

/// The worst violation of the laws of SpaceOf at point x, chart offset du and velocity v, values and first derivatives;
/// round-off is about 1e-15. SpaceOf is a template on its scalar, tried here on dual numbers.
template <template <class> class SpaceOf, class D = Dual<1>, class M = SpaceOf<D>>
double check_space_laws(Point<M> const& x, Chart<M> const& du, Velocity<M> const& v) {
  double worst = 0;
  auto const same = [&](auto const& a, auto const& b) {
    std::decay_t<decltype(a)>::each(
        [&](D const& p, D const& q) {
          worst = std::max({worst, std::fabs(p.value - q.value), std::fabs(p.slope[0] - q.slope[0])});
        },
        a, b);
  };
  D s(0.0);  // moves along v: d/ds at s = 0
  s.slope[0] = 1;

  same(M::retract(x, M::centre(x)), x);  // 1
  Chart<M> u = M::centre(x);
  add(u, 1.0, du);
  Point<M> const y = M::retract(x, u);
  same(M::local(x, y), u);                                 // 2
  same(M::rate(x, v), M::chart_rate(x, M::centre(x), v));  // 3
  Chart<M> moved = u, own = M::centre(y);
  add(moved, s, M::chart_rate(x, u, v));
  add(own, s, M::rate(y, v));
  same(M::retract(x, moved), M::retract(y, own));  // 4
  same(M::local(x, M::retract(y, own)), moved);    // 2 and 4: the derivative of local is chart_rate
  return worst;
}

}  // namespace polhode
