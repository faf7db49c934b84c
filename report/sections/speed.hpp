#pragma once
/// Who is first to an attitude error, and by how much: what the section on speed is made of. Equal steps and adaptive
/// ones are races of their own: a step chosen with the error known is no tolerance.
#include <string>
#include <string_view>
#include <vector>

#include "report/facts.hpp"

namespace polhode::report {

/// The errors that are raced to [rad].
inline constexpr double speed_targets[] = {1e-6, 1e-9, 1e-12};

/// "Odeint", "GSL" or "SUNDIALS"; empty for our own.
std::string_view library_of(std::string_view integrator);
/// True for closed forms (the catalogue's family `exact`): they are no method for other problems, and race with nobody.
bool is_closed_form(Facts const& facts, std::string_view integrator);

/// The time to a target in one sweep of runs. Equal steps: at the target itself, where two runs bracket it. Adaptive:
/// of the cheapest run that reaches it. None if no run with a time does.
std::optional<Cost> time_to(Sweep const& sweep, double target);

enum class First { ours, rival, undecided, nobody };

/// One race: a problem, an error, one kind of control. All times are of whole solves [s].
struct Race {
  Instance const* instance = nullptr;
  double target = 0;  ///< [rad]
  bool adaptive = false;
  std::vector<Cost> costs;  ///< the best of each integrator that arrives, first come first

  /// The first of our own, or of a library (empty: of any); null if none arrives.
  Cost const* own() const;
  Cost const* rival(std::string_view library = "") const;
  /// Ours or a rival's, if the interval of their ratio tells; `nobody` arrives if there is no cost.
  First first() const;
};

/// The races of every problem on which own methods and rivals were timed: by problem, equal steps first, then target.
std::vector<Race> races_of(Facts const& facts);

/// What polhode-bench measured: part of the section.
void add_benchmarks(Document& document, Facts const& facts);

}  // namespace polhode::report
