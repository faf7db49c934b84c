#pragma once
/// The angle of a point in the plane by one formula without branches, so that lanes give what doubles give.
#include "problems/scalar.hpp"

namespace polhode {

namespace detail {

/// Where the formula holds; beyond, and for NaN, the library knows what is right.
template <class S>
POLHODE_INLINE auto ordinary_point(S const& y, S const& x) {
  S const a = abs_of(y), b = abs_of(x), least(1e-290), most(1e290);
  return (least < a) & (a < most) & (least < b) & (b < most);
}

/// The angle in the first octant is atan(z), z = less / greater up to tan(pi/8), else pi/4 + atan((z - 1) / (z + 1));
/// the others follow by reflection. Within 2 ulp.
/// Source: the polynomial of FDLIBM's atan (Sun Microsystems, 1993), valid to 7/16.
template <class S>
POLHODE_INLINE S ordinary_arctangent(S const& y, S const& x) {
  S const a = abs_of(y), b = abs_of(x);
  auto const steep = b < a, backward = x < S(0.0);
  S const less = select(steep, b, a), greater = select(steep, a, b);
  auto const far = S(0.41421356237309503) * greater < less;
  S const z = select(far, S(less - greater), less) / select(far, S(less + greater), greater);

  S const z2 = z * z, z4 = z2 * z2;
  auto const horner = [&](auto... c) POLHODE_LAMBDA {
    S r(0.0);
    ((r = r * z4 + S(c)), ...);
    return r;
  };
  S const even = z2 * horner(1.62858201153657823623e-02, 4.97687799461593236017e-02, 6.66107313738753120669e-02,
                             9.09088713343650656196e-02, 1.42857142725034663711e-01, 3.33333333333329318027e-01);
  S const odd = z4 * horner(-3.65315727442169155270e-02, -5.83357013379057348645e-02, -7.69187620504482999495e-02,
                            -1.11111104054623557880e-01, -1.99999999998764832476e-01);

  // The multiples of pi/4 that reflections leave, each with the digits that a double cannot hold.
  auto const pick = [&](double none, double quarter, double half, double three, double whole) POLHODE_LAMBDA {
    S const gentle = select(backward, select(far, S(three), S(whole)), select(far, S(quarter), S(none)));
    S const upright = select(backward, select(far, S(three), S(half)), select(far, S(quarter), S(half)));
    return select(steep, upright, gentle);
  };
  S const head = pick(0.0, 7.85398163397448279e-01, 1.57079632679489656, 2.35619449019234484, 3.14159265358979312);
  S const rest =
      pick(0.0, 3.06161699786838302e-17, 6.12323399573676604e-17, 9.18485099360514844e-17, 1.22464679914735321e-16);
  S const turn = select(steep, select(backward, S(1.0), S(-1.0)), select(backward, S(-1.0), S(1.0)));
  S const signed_z = turn * z;
  S const angle = head - ((signed_z * (even + odd) - rest) - signed_z);
  return select(y < S(0.0), S(-angle), angle);
}

}  // namespace detail

/// The angle of (x, y) from the x axis [rad], as atan2(y, x): of doubles, and of lanes of doubles with the same bits,
/// within 2 ulp; of other scalars their atan2.
template <class S>
POLHODE_INLINE S arctangent(S const& y, S const& x) {
  return atan2(y, x);
}
POLHODE_INLINE double arctangent(double y, double x) {
  return detail::ordinary_point(y, x) ? detail::ordinary_arctangent(y, x) : std::atan2(y, x);
}

}  // namespace polhode
