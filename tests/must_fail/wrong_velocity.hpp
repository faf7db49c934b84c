#pragma once
// A problem whose field returns the derivative of a quaternion, not the body rate.
// expected: Problem: a field needs  initial() const  and  operator()(t, x) const -> Velocity<Space>
#include "problems/free_body.hpp"

namespace polhode {

template <Scalar S, template <class> class A>
struct Drift {
  using Space = RigidBody<A<S>>;
  Point<Space> initial() const { return {}; }
  Pair<Quat<S>, Vec3<S>> operator()(S const&, Point<Space> const& x) const { return {{}, x.second}; }
};
class Entry : public FreeBody {
 public:
  using FreeBody::FreeBody;
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return Drift<S, A>{};
  }
};

}  // namespace polhode
