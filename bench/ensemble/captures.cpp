#include "bench/ensemble/fleet.hpp"
#include "problems/tether_capture.hpp"

namespace polhode::bench {

std::unique_ptr<LaneFleet> fleet_of_captures(FleetPlan const& plan) {
  return fleet_of<TetherCapture>(plan);
}

}  // namespace polhode::bench
