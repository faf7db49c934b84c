#pragma once
/// A cell made ready: the user's words become a problem, a plan and a schedule, or a refusal.
#include <memory>
#include <string>

#include "bench/input/vocabulary.hpp"
#include "bench/solve/problems.hpp"

namespace polhode::bench {

/// A cell made ready: everything checked, nothing run.
struct PreparedCell {
  results::Cell cell;     ///< canonical, horizon filled in
  results::Cell physics;  ///< what it is held against: the cell without words that only drive the run
  std::unique_ptr<ChosenProblem> problem;
  Plan plan;
  Schedule schedule;
  std::string refusal;    ///< why it does not run; empty if it does
  bool reference = true;  ///< errors are wanted
};

/// Checks words and numbers and builds the problem. every [s]: output times, 0 for none but the end.
/// Throws UsageError: unknown words, broken parameter rules, an h that does not divide the sample period or `every`.
PreparedCell prepare(results::Cell cell, double every = 0);

/// What a problem is to be, by a cell's variant, parameters and step.
Choice choice_of(results::Cell const& cell);

}  // namespace polhode::bench
