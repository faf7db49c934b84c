#pragma once
// A method whose step has another name.
// expected: Stepping: a method with Frame and Memory needs  void step(p, t, h, x, frame, memory) const
#include "integrators/integrator.hpp"

namespace polhode {

struct NoStep {
  static constexpr MethodInfo info{
      .name = "no_step", .family = Family::explicit_rk, .order = 1, .needs = Needs::none, .source = "nobody"};
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<NoStep, P>(*this, p, control, policy);
  }
  template <Space M>
  struct Frame {};
  template <Space M>
  using Memory = NoMemory;
  template <class P, class S, class R, class X, class F>
  void stride(P const&, S const&, R const&, X&, F&, NoMemory&) const {}
};
struct Entries : Types<NoStep> {};

}  // namespace polhode
