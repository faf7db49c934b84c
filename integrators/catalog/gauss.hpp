#pragma once
/// Gauss collocation, and its foils.
#include "integrators/catalog/lists.hpp"
#include "integrators/gauss.hpp"
#include "integrators/gauss_canonical.hpp"
#include "integrators/gauss_lanes.hpp"

namespace polhode {

/// Gauss collocation: iterated, in canonical variables, in a co-rotating frame, and the foils.
struct GaussMethods : Types<GaussEntry<1>, GaussEntry<2>, GaussEntry<3>, GaussEntry<4>, GaussEntry<5>, GaussEntry<6>,
                            GaussEntry<7>, GaussEntry<8>,              // to round-off
                            Gauss2Sweeps1, Gauss2Sweeps2, Gauss2Tol6,  // and not
                            GaussCanonical<1>, GaussCanonical<2>, GaussCanonical<3>, GaussCanonical<4>,
                            GaussCanonical<5>, GaussCanonical<6>, GaussCanonical<7>, GaussCanonical<8>,
                            GaussLawsonEntry<4>, GaussLawsonEntry<8>, Gauss8LawsonSweeps6, Gauss8LawsonBalanced> {};

}  // namespace polhode
