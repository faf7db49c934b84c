#pragma once
/// Every integrator. Adding one is a header and a line here; list, run, report, benchmarks and conformance tests
/// follow.
#include "integrators/commutator_free.hpp"
#include "integrators/commutator_free_pair.hpp"
#include "integrators/constrained.hpp"
#include "integrators/crouch_grossman.hpp"
#include "integrators/gauss.hpp"
#include "integrators/generalized_alpha.hpp"
#include "integrators/lie_gauss.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/ode45.hpp"
#include "integrators/rivals/arkode.hpp"
#include "integrators/rivals/cvode.hpp"
#include "integrators/rivals/ida.hpp"
#include "integrators/rivals/odeint.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/formulations.hpp"

namespace polhode {

using ExplicitMethods = Types<Rk4, Dopri5, Dopri5Ode45>;
using GaussMethods = Types<GaussEntry<1>, GaussEntry<2>, GaussEntry<3>, GaussEntry<4>,  // to round-off
                           Gauss2Sweeps1, Gauss2Sweeps2, Gauss2Tol6>;                   // and not
using GroupMethods =
    Types<LieEuler, Rkmk2, Rkmk3, Rkmk4,                                       // Munthe-Kaas
          CrouchGrossman3, CrouchGrossman4, CommutatorFree3, CommutatorFree4,  // products of exponentials
          CommutatorFreeAdaptive, LieGaussEntry<1>, LieGaussEntry<2>, LieGaussEntry<3>>;
using BodyMethods = Types<HalfExplicit4, Rattle, GeneralizedAlpha>;  // constrained bodies
using Rivals = Types<OdeintRk4, OdeintCashKarp54, OdeintDopri5, OdeintRkf78, OdeintBulirschStoer, OdeintAbm8,  // Boost
                     Cvode<true>, Cvode<false>, ArkodeErk<4>, ArkodeErk<5>, ArkodeErk<8>, Ida>;  // SUNDIALS

/// Our own; the build compiles one list at a time.
using OwnMethods = Joined<ExplicitMethods, GaussMethods, GroupMethods, BodyMethods>;
using MethodLists = Types<ExplicitMethods, GaussMethods, GroupMethods, BodyMethods, Rivals>;
/// Those of our own that are raced: compiled for every problem as typed code, which is what the build spends its time
/// on. The others run and are measured, but have no time of their own: behind virtual calls it would not be theirs.
using RacedMethods = Joined<ExplicitMethods, GaussMethods, Types<LieEuler, Rkmk4, CommutatorFree4>>;

}  // namespace polhode
