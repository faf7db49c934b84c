#include <algorithm>
#include <map>

#include "report/sections/speed.hpp"

namespace polhode::report {
namespace {

using results::Record;

bool is_adaptive(Sweep const& sweep) {
  return !sweep.like().h.has_value();
}

bool was_timed(Instance const& instance, bool rivals) {
  return std::ranges::any_of(instance.runs, [&](Record const* run) {
    return is_rival(run->of.integrator) == rivals && is_ok(*run) && run->cpu_time_s && finite(run->attitude_error_max);
  });
}

Race race_of(Facts const& facts, Instance const& instance, std::vector<Sweep> const& sweeps, double target,
             bool adaptive) {
  std::map<std::string, Cost> best;
  for (Sweep const& sweep : sweeps) {
    std::string const& name = sweep.like().integrator;
    if (is_adaptive(sweep) != adaptive || is_closed_form(facts, name)) continue;
    auto const cost = time_to(sweep, target);
    if (!cost) continue;
    auto const [at, is_new] = best.try_emplace(name, *cost);
    if (!is_new && cost->value < at->second.value) at->second = *cost;
  }
  Race race{.instance = &instance, .target = target, .adaptive = adaptive, .costs = {}};
  for (auto const& [name, cost] : best) race.costs.push_back(cost);
  std::ranges::stable_sort(race.costs, {}, &Cost::value);
  return race;
}

}  // namespace

std::string_view library_of(std::string_view integrator) {
  if (integrator.starts_with("odeint_")) return "Odeint";
  if (integrator.starts_with("gsl_")) return "GSL";
  return is_rival(integrator) ? "SUNDIALS" : "";
}

bool is_closed_form(Facts const& facts, std::string_view integrator) {
  auto const known = facts.contents.catalogue.find(std::string(integrator));
  return known == facts.contents.catalogue.end() ? integrator == "exact" : known->second.family == "exact";
}

std::optional<Cost> time_to(Sweep const& sweep, double target) {
  auto cost = cheapest(sweep, target, Measure::time);
  if (!cost || !is_adaptive(sweep)) return cost;
  // a tolerance between two that were asked for is not promised to give an error between theirs
  Sweep const alone{{cost->run}};
  return cheapest(alone, target, Measure::time);
}

Cost const* Race::own() const {
  return first_of(costs, false);
}

Cost const* Race::rival(std::string_view library) const {
  auto const found = std::ranges::find_if(costs, [&](Cost const& cost) {
    auto const of = library_of(cost.run->of.integrator);
    return !of.empty() && (library.empty() || of == library);
  });
  return found == costs.end() ? nullptr : &*found;
}

First Race::first() const {
  Cost const *ours = own(), *theirs = rival();
  if (!ours && !theirs) return First::nobody;
  if (!ours || !theirs) return ours ? First::ours : First::rival;
  Estimate const ratio = quotient(*theirs, *ours);
  return ratio.low > 1 ? First::ours : ratio.high < 1 ? First::rival : First::undecided;
}

std::vector<Race> races_of(Facts const& facts) {
  std::vector<Race> races;
  for (Instance const& instance : facts.instances) {
    if (is_aside(instance.like()) || !was_timed(instance, false) || !was_timed(instance, true)) continue;
    auto const sweeps = instance.sweeps();
    for (bool const adaptive : {false, true}) {
      if (std::ranges::none_of(sweeps, [&](Sweep const& sweep) { return is_adaptive(sweep) == adaptive; })) continue;
      for (double const target : speed_targets) races.push_back(race_of(facts, instance, sweeps, target, adaptive));
    }
  }
  return races;
}

}  // namespace polhode::report
