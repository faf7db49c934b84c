#pragma once
/// Those of our own methods that are raced: compiled as typed code for every raced problem, which is what the build
/// spends its time on. There the others have no time: behind virtual calls it would not be theirs.
#include "integrators/catalog/lists.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/exact.hpp"
#include "integrators/gauss.hpp"
#include "integrators/gauss_lanes.hpp"
#include "integrators/high_order.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/ode45.hpp"
#include "integrators/runge_kutta.hpp"

namespace polhode {

/// The own methods that are timed, fully typed, on the raced problems.
struct RacedMethods
    : Types<Rk4, Dopri5, Dopri5Ode45, Dop853, Verner65, Verner76, Verner98, GaussEntry<1>, GaussEntry<2>, GaussEntry<3>,
            GaussEntry<4>, Gauss2Sweeps1, Gauss2Sweeps2, Gauss2Tol6, GaussLawsonEntry<4>, GaussLawsonEntry<8>,
            Gauss8LawsonSweeps6, Gauss8LawsonBalanced, LieEuler, Rkmk4, CommutatorFree4, Exact> {};

}  // namespace polhode
