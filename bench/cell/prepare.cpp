#include "bench/cell/prepare.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/cell/refusal.hpp"
#include "bench/process/text.hpp"

namespace polhode::bench {
namespace {

bool divides(double h, double period) {
  double const ratio = period / h;
  return std::round(ratio) >= 1 && std::fabs(ratio - std::round(ratio)) <= 1e-9 * ratio;
}

/// The method can end its steps on state events, and the field has some to end on.
bool locates_events(PreparedCell const& prepared) {
  bool locates = false;
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        locates = field->state_events() > 0 && method_named<M>(prepared.cell.integrator).info->locates_events;
      },
      problem);
  return locates;
}

NormPolicy policy_named(std::string_view name) {
  for (PolicyName const& entry : policy_names)
    if (entry.name == name) return entry.policy;
  throw std::out_of_range("no norm policy " + std::string(name));
}

/// A variant text without some of its words.
std::string without(std::string const& variant, std::vector<std::string> const& dropped) {
  std::vector<std::string_view> kept = fields_of(variant);
  std::erase_if(kept, [&](std::string_view word) { return std::ranges::find(dropped, word) != dropped.end(); });
  return fmt::format("{}", fmt::join(kept, ","));
}

/// A schedule is kept in memory: a slip in a period must not fill it.
void check_number_of_stops(Schedule const& schedule) {
  constexpr double most = 1e7;
  for (double const period : {schedule.sample_period, schedule.output_period})
    if (period > 0 && schedule.t_end / period > most)
      throw UsageError(
          fmt::format("{:g} s in intervals of {:g} s are more than {:.0f}; shorten t_end or lengthen the "
                      "interval",
                      schedule.t_end, period, most));
}

}  // namespace

Choice choice_of(results::Cell const& cell) {
  Choice choice{.words = {}, .set = cell.set, .step = cell.h.value_or(0)};
  for (std::string_view const word : fields_of(cell.variant)) choice.words.emplace(word);
  return choice;
}

PreparedCell prepare(results::Cell cell, double every) {
  check_words(vocabulary(), cell);
  PreparedCell prepared;
  Choice const choice = choice_of(cell);
  try {
    prepared.problem = problem_named(cell.problem).choose(choice);
  } catch (ParameterError const& error) {
    throw UsageError(fmt::format("{}: {}", cell.problem, error.what()));
  }
  if (!(cell.t_end > 0)) cell.t_end = prepared.problem->horizon();
  double const period = prepared.problem->sample_period();
  if (cell.h && period > 0 && !divides(*cell.h, period))
    throw UsageError(
        fmt::format("h = {:g} s does not divide the sample period {:g} s of {}: a step must not straddle a "
                    "sample; h = {:g} would be right",
                    *cell.h, period, cell.problem, period / std::ceil(period / *cell.h)));
  if (cell.h && every > 0 && !divides(*cell.h, every))
    throw UsageError(
        fmt::format("outputs every {:g} s are no multiple of h = {:g} s: output times are ends of steps; "
                    "give --every {:g}",
                    every, *cell.h, *cell.h * std::max(1.0, std::round(every / *cell.h))));

  prepared.schedule = {.t_end = cell.t_end, .sample_period = period, .jumps = {}, .output_period = every};
  std::visit([&](auto const& field) { prepared.schedule.jumps = field->time_events(); }, prepared.problem->in_quad());
  check_number_of_stops(prepared.schedule);
  prepared.plan.stops = stops_of(prepared.schedule);
  prepared.plan.policy = policy_named(cell.policy);
  if (cell.h)
    prepared.plan.control = FixedStep{*cell.h};
  else
    prepared.plan.control = Adaptive{*cell.rtol, *cell.atol};
  prepared.physics = cell;
  prepared.physics.variant = without(cell.variant, prepared.problem->info().driven);
  prepared.cell = std::move(cell);
  prepared.refusal = refusal_of(prepared);
  prepared.plan.locate = prepared.problem->switches() && prepared.problem->wants_events() && prepared.refusal.empty() &&
                         locates_events(prepared);
  return prepared;
}

}  // namespace polhode::bench
