#pragma once
/// Does a description of attitude move as the quaternion does? Two checks that any new description gets for free.
#include <algorithm>
#include <cmath>

#include "problems/dual.hpp"
#include "problems/jet.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode::test {

/// Greatest error of d/dt attitude(x(t)) against quaternion_rate, x moving with body rate omega [rad/s].
template <template <class> class SpaceOf>
double kinematics_error(Vec3<double> const& x, Vec3<double> const& omega) {
  using D = Dual<1>;
  D s(0.0);
  s.slope[0] = 1;
  Vec3<D> moved = in<D>(x);
  add(moved, s, SpaceOf<D>::rate(in<D>(x), in<D>(omega)));
  Quat<D> const got = SpaceOf<D>::attitude(moved);
  Quat<double> const at = SpaceOf<double>::attitude(x);
  Quat<double> const value{got.x.value, got.y.value, got.z.value, got.w.value};
  Quat<double> const slope{got.x.slope[0], got.y.slope[0], got.z.slope[0], got.w.slope[0]};
  return std::max(distance<double>(value, at), distance<double>(slope, quaternion_rate(at, omega)));
}

/// Greatest error of the attitude's power series at time t [s] against turning at the constant body rate omega [rad/s].
template <template <class> class SpaceOf>
double series_error(Vec3<double> const& x, Vec3<double> const& omega, double t) {
  constexpr int degree = 24;
  using J = Jet<Quad, degree>;
  Vec3<J> series = in<J>(x);
  for (int k = 0; k < degree; ++k) {
    Vec3<J> const rate = SpaceOf<J>::rate(series, in<J>(omega));
    Vec3<J>::each(
        [k](J& a, J const& slope) {
          a.degree = k + 1;
          a[k + 1] = slope[k] / Quad(k + 1);
        },
        series, rate);
  }
  Quat<J> const q = SpaceOf<J>::attitude(series);
  Quat<Quad> const got{q.x.at(t), q.y.at(t), q.z.at(t), q.w.at(t)};
  Quat<Quad> const exact = SpaceOf<Quad>::attitude(in<Quad>(x)) * exp_quaternion(Quad(t) * in<Quad>(omega));
  return double(distance<Quad>(got, exact));
}

}  // namespace polhode::test
