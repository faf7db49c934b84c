#include "bench/ensemble/fleet.hpp"
#include "problems/free_body.hpp"

namespace polhode::bench {

std::unique_ptr<LaneFleet> fleet_of_free_bodies(FleetPlan const& plan) {
  return fleet_of<FreeBody>(plan);
}

}  // namespace polhode::bench
