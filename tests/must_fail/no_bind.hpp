#pragma once
// A method whose bind has an argument too few.
// expected: IntegratorFor: where info.needs does not refuse a space, bind(problem, FixedStep or Adaptive, NormPolicy)
#include "integrators/runge_kutta.hpp"

namespace polhode {

struct NoBind {
  static constexpr MethodInfo info{
      .name = "no_bind", .family = Family::explicit_rk, .order = 4, .needs = Needs::none, .source = "nobody"};
  template <Problem P>
  auto bind(P const& p, FixedStep control) const {
    return Rk4{}.bind(p, control, NormPolicy::none);
  }
};
struct Entries : Types<NoBind> {};

}  // namespace polhode
