#pragma once
/// What a run is called where a person reads it and a tool compares it.
#include <string>

#include "results/record.hpp"

namespace polhode::results {

/// "PROBLEM/VARIANT/FORMULATION/INTEGRATOR/POLICY/h=0.1", or ".../rtol=1e-06,atol=1e-08"; parameters that were set and
/// a seed other than 1 follow. Stable between builds; runs that differ in t_end alone share a name.
std::string run_name(Cell const& cell);

}  // namespace polhode::results
