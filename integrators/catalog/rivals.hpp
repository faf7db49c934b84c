#pragma once
/// Libraries, unmodified.
#include "integrators/catalog/lists.hpp"
#include "integrators/rivals/arkode.hpp"
#include "integrators/rivals/cvode.hpp"
#include "integrators/rivals/gsl.hpp"
#include "integrators/rivals/ida.hpp"
#include "integrators/rivals/odeint.hpp"

namespace polhode {

/// The methods of other libraries; those that are not built refuse, and say so.
struct Rivals : Types<OdeintRk4, OdeintCashKarp54, OdeintDopri5, OdeintRkf78, OdeintBulirschStoer, OdeintAbm8,  // Boost
                      Cvode<true>, Cvode<false>, ArkodeErk<4>, ArkodeErk<5>, ArkodeErk<8>, ArkodeDirk, Ida,  // SUNDIALS
                      GslRk8pd, GslMsadams> {};                                                              // GSL

}  // namespace polhode
