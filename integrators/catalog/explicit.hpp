#pragma once
/// Explicit Runge-Kutta methods and power series.
#include "integrators/catalog/lists.hpp"
#include "integrators/high_order.hpp"
#include "integrators/ode45.hpp"
#include "integrators/runge_kutta.hpp"
#include "integrators/taylor.hpp"

namespace polhode {

/// Explicit methods on any space: Runge-Kutta pairs and power series.
struct ExplicitMethods : Types<Rk4, Dopri5, Dopri5Ode45, Dop853, Verner65, Verner76, Verner98, Taylor> {};

}  // namespace polhode
