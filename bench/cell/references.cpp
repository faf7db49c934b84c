#include "bench/cell/references.hpp"

namespace polhode::bench {

FoundReference References::of(PreparedCell const& prepared, double whole) {
  if (!prepared.reference) return {};
  if (std::string const why = prepared.problem->no_reference(); !why.empty()) return {nullptr, why};
  std::shared_ptr<Slot> slot;
  {
    std::lock_guard const lock(mutex_);
    auto& found = slots_[reference_subject(prepared.physics)];
    if (!found) found = std::make_shared<Slot>();
    slot = found;
  }
  std::call_once(slot->made, [&] {
    Choice choice = choice_of(prepared.physics);
    choice.step = 0;  // a reference has none
    auto const problem = problem_named(prepared.physics.problem).choose(choice);
    Schedule schedule = prepared.schedule;
    schedule.sample_period = problem->sample_period();
    schedule.output_period = 0;
    try {
      slot->reference = obtain(prepared.physics, *problem, schedule, committed_, whole);
    } catch (Uncertified const& error) {
      slot->why_none = error.what();
    }
  });
  return {slot->reference, slot->why_none};
}

}  // namespace polhode::bench
