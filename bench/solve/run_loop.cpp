#include "bench/solve/run_loop.hpp"

#include <algorithm>
#include <cmath>

namespace polhode::bench {

std::vector<Stop> stops_of(Schedule const& schedule) {
  std::vector<Stop> all{{.time = 0, .output = true}, {.time = schedule.t_end, .output = true}};
  double const slack = 1e-9 * schedule.t_end;
  auto const every = [&](double period, auto mark) {
    if (!(period > 0)) return;
    for (std::int64_t k = 0; double(k) * period <= schedule.t_end + slack; ++k) {
      Stop stop{.time = std::min(double(k) * period, schedule.t_end)};
      mark(stop);
      all.push_back(stop);
    }
  };
  every(schedule.sample_period, [](Stop& stop) { stop.sample = true; });
  every(schedule.output_period, [](Stop& stop) { stop.output = true; });
  for (double time : schedule.jumps)
    if (time > 0 && time < schedule.t_end) all.push_back({.time = time, .jump = true});

  std::stable_sort(all.begin(), all.end(), [](Stop const& a, Stop const& b) { return a.time < b.time; });
  std::vector<Stop> merged;
  for (Stop const& stop : all) {
    if (merged.empty() || stop.time - merged.back().time > slack) {
      merged.push_back(stop);
      continue;
    }
    merged.back().sample |= stop.sample;
    merged.back().jump |= stop.jump;
    merged.back().output |= stop.output;
  }
  merged.back().time = schedule.t_end;
  return merged;
}

}  // namespace polhode::bench
