#pragma once
/// Every integrator. Adding one is a header and a line here; list, run, report, benchmarks and conformance tests
/// follow.
#include "integrators/gauss.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/ode45.hpp"
#include "integrators/rivals/arkode.hpp"
#include "integrators/rivals/cvode.hpp"
#include "integrators/rivals/odeint.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/formulations.hpp"

namespace polhode {

using ExplicitMethods = Types<Rk4, Dopri5, Dopri5Ode45>;
using GaussMethods = Types<GaussEntry<1>, GaussEntry<2>, GaussEntry<3>, GaussEntry<4>,  // to round-off
                           Gauss2Sweeps1, Gauss2Sweeps2, Gauss2Tol6>;                   // and not
using GroupMethods = Types<LieEuler, Rkmk4, CommutatorFree4>;
using Rivals = Types<OdeintRk4, OdeintCashKarp54, OdeintDopri5, OdeintRkf78, OdeintBulirschStoer, OdeintAbm8,  // Boost
                     Cvode<true>, Cvode<false>, ArkodeErk<4>, ArkodeErk<5>, ArkodeErk<8>>;  // SUNDIALS

/// Our own; the build compiles one list at a time.
using OwnMethods = Joined<ExplicitMethods, GaussMethods, GroupMethods>;
using MethodLists = Types<ExplicitMethods, GaussMethods, GroupMethods, Rivals>;
/// Those of our own that are raced: compiled for every problem as typed code, which is what the build spends its time
/// on. The others run and are measured, but have no time of their own: behind virtual calls it would not be theirs.
using RacedMethods = OwnMethods;

}  // namespace polhode
