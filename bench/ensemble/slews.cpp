#include "bench/ensemble/fleet.hpp"
#include "problems/pd_slew.hpp"

namespace polhode::bench {

std::unique_ptr<LaneFleet> fleet_of_slews(FleetPlan const& plan) {
  return fleet_of<PdSlew>(plan);
}

}  // namespace polhode::bench
