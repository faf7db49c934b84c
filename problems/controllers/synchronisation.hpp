#pragma once
/// Attitude synchronisation of spacecraft by commanded body rates, in quaternions whose sign counts.
/// Source: Meng, San & Zhang (2022), Journal of Henan Normal University (Natural Science) 50(6), 1, eqs. (7) and (13)
/// Written link by link: a command is the sum over the craft j that craft i hears, in any order, at a cost of its own.
#include "problems/attitude.hpp"

namespace polhode {

/// The share of craft j in the body rate [rad/s] of craft i under protocol (7):  a_ij (q_j - q_i), vector parts.
/// Leads to equal quaternions where all scalar parts are non-negative; other craft may stay apart, each at rest.
template <class S>
POLHODE_INLINE Vec3<S> protocol7(Real<S> const& a, Quat<S> const& own, Quat<S> const& heard) {
  return a * (vec(heard) - vec(own));
}

/// The same under protocol (13):  a_ij (s_i s_j q_j - q_i), s the sign of the scalar part, sgn(0) = +1.
/// same_side  whether s_i = s_j. Turning one craft's quaternion to -q turns its rate around: the law is a function of
/// quaternions, not of attitudes.
template <class S>
POLHODE_INLINE Vec3<S> protocol13(Real<S> const& a, Quat<S> const& own, Quat<S> const& heard, bool same_side) {
  Real<S> const product(double(2 * int(same_side) - 1));  // no branch: in a swarm nobody can predict it
  return a * (product * vec(heard) - vec(own));
}

}  // namespace polhode
