#pragma once
// A problem on a space that is none.
// expected: Space: Space of what field() makes must be a space, such as RigidBody<A<S>>
#include "problems/free_body.hpp"

namespace polhode {

template <Scalar S>
struct Growth {
  using Space = Vec3<S>;
  Vec3<S> initial() const { return {}; }
  Vec3<S> operator()(S const&, Vec3<S> const& x) const { return x; }
};
class Entry : public FreeBody {
 public:
  using FreeBody::FreeBody;
  template <Scalar S, template <class> class A, bool fast>
  auto field() const {
    return Growth<S>{};
  }
};

}  // namespace polhode
