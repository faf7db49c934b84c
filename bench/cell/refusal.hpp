#pragma once
/// Why a combination of problem, formulation, method and norm policy does not run.
#include <string>

#include "bench/cell/prepare.hpp"

namespace polhode::bench {

/// The reason, in the order in which a user would want to know: the problem's, the method's, the policy's; empty if it
/// runs. Of a cell whose problem and plan are made.
std::string refusal_of(PreparedCell const& prepared);

}  // namespace polhode::bench
