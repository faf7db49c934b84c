#pragma once
/// Methods for rigid bodies, free, under torques and under constraints.
#include "integrators/catalog/lists.hpp"
#include "integrators/constrained.hpp"
#include "integrators/exact.hpp"
#include "integrators/generalized_alpha.hpp"
#include "integrators/lgvi.hpp"
#include "integrators/moser_veselov.hpp"
#include "integrators/splitting.hpp"

namespace polhode {

/// Methods for one rigid body and for bodies under a constraint.
struct BodyMethods : Types<Exact, MoserVeselov<2>, MoserVeselov<4>, MoserVeselov<6>, MoserVeselov<8>, MoserVeselov<10>,
                           LieVariational2, SplitStrang, SplitYoshida4, SplitBm4, SplitSrStrang, SplitSrBm4, ExactKicks,
                           ExactKicks4, HalfExplicit4, Rattle, GeneralizedAlpha> {};

}  // namespace polhode
