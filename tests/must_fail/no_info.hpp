#pragma once
// A method without facts.
// expected: Described: a method needs  static constexpr MethodInfo info{...}
#include "integrators/runge_kutta.hpp"

namespace polhode {

struct NoInfo : Explicit<Kutta4> {};
struct Entries : Types<NoInfo> {};

}  // namespace polhode
