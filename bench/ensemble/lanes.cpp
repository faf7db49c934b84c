#include "bench/ensemble/lanes.hpp"

#include <array>

#include "bench/ensemble/ensemble.hpp"
#include "bench/process/clock.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/free_body.hpp"

namespace polhode::bench {

std::unique_ptr<LaneFleet> lane_fleet(std::string const& problem, FleetPlan const& plan) {
  struct Entry {
    std::string_view problem;
    std::unique_ptr<LaneFleet> (*make)(FleetPlan const&);
  };
  constexpr std::array entries{Entry{"free_body", fleet_of_free_bodies}, Entry{"pd_slew", fleet_of_slews},
                               Entry{"tether_capture", fleet_of_captures}};
  for (Entry const& entry : entries)
    if (entry.problem == problem) return entry.make(plan);
  return nullptr;
}

double plain_kernel_rate(int threads) {
  constexpr std::int64_t bodies = 4096, steps = 1000;
  constexpr double h = 0.05, least_seconds = 0.2;
  FreeBody const body(Choice{});
  auto const make = [&]<class S>(BodyBlock const& block) {
    auto p = body.field<S, FlatQuaternion, true>();
    p.start.second.x = gather<S>(block, [](std::int64_t k) { return 0.1 + 1e-5 * double(k); });
    return p;
  };
  double const begin = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  double body_steps = 0;
  while (seconds_of(CLOCK_PROCESS_CPUTIME_ID) - begin < least_seconds * threads) {
    std::vector<double> ends(std::size_t(bodies * threads));
    run_ensemble_on_threads(threads, Rk4{}, EnsembleRun{h, steps, 0}, bodies * threads, make,
                            [&](std::int64_t k, auto const& x, Status) { ends[std::size_t(k)] = x.first.w; });
    body_steps += double(steps) * double(bodies) * double(threads);
  }
  return body_steps / (seconds_of(CLOCK_PROCESS_CPUTIME_ID) - begin);
}

}  // namespace polhode::bench
