#pragma once
/// Methods on Lie groups.
#include "integrators/catalog/lists.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/commutator_free_pair.hpp"
#include "integrators/crouch_grossman.hpp"
#include "integrators/lie_gauss.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/magnus.hpp"

namespace polhode {

/// Methods that step on a Lie group.
struct GroupMethods : Types<LieEuler, Rkmk2, Rkmk3, Rkmk4,  // Munthe-Kaas
                            CrouchGrossman3, CrouchGrossman4, CommutatorFree3, CommutatorFree4, CommutatorFreeAdaptive,
                            LieGaussEntry<1>, LieGaussEntry<2>, LieGaussEntry<3>, LieGaussEntry<4>, Magnus4, Magnus6> {
};

}  // namespace polhode
