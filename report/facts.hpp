#pragma once
/// The records, arranged for questions: which runs belong together, what a run is called, what reaches an accuracy at
/// which cost. Nothing here writes text for a reader except names.
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "report/document.hpp"
#include "report/text.hpp"
#include "results/store.hpp"

namespace polhode::report {

/// What a free body keeps, and how far a run was from it.
struct Invariant {
  std::string_view claim;  ///< as the catalogue says it
  std::string_view name;
  std::string_view unit;
  std::optional<double> results::Record::*drift;
};
inline constexpr Invariant invariants[] = {
    {"norm", "norm", "", &results::Record::norm_drift_max},
    {"energy", "energy", "", &results::Record::energy_drift_max},
    {"momentum", "|L|", "", &results::Record::momentum_drift_max},
    {"momentum_direction", "direction of L", " [rad]", &results::Record::momentum_direction_max}};

/// The errors in attitude at which methods are compared [rad].
inline constexpr double usual_targets[] = {1e-6, 1e-9};

/// True for the integrators of other libraries.
bool is_rival(std::string_view integrator);
/// True for methods that are careless on purpose (integrators/gauss_foils.hpp): compared, never recommended.
bool is_foil(std::string_view integrator);
/// A quantity that drifts by less is kept: some hundred roundings, accumulated over the horizon.
inline constexpr double kept = 1e-13;
/// Exact zeros have no place on a logarithmic axis: they are drawn here.
inline constexpr double drawn_zero = 1e-17;
/// Attitude errors below are not drawn, and below the larger one the picture is shaded, since rounding rules [rad].
inline constexpr double least_error = 1e-16, rounding_rules = 1e-13;
/// True if the canonical variant ("case1,g1") holds that word.
bool has_word(std::string_view variant, std::string_view word);
/// The variant without one of its words: "case1,g1" without "case1" is "g1".
std::string without_word(std::string_view variant, std::string_view word);

/// Finite values only: whatever else a record holds counts as absent.
std::optional<double> finite(std::optional<double> value);
bool is_ok(results::Record const& run);
/// True if the error is known to be at most `target`: it is, and so is the reference's bar.
bool reaches(results::Record const& run, double target);
/// True if the error is no greater than what the reference can resolve.
bool below_bar(results::Record const& run);

/// "h = 0.1 s" or "rtol = 1e-06, atol = 1e-09".
std::string control_of(results::Cell const& cell);
/// "gauss2 (quaternion)", with the policy if there is one: "gauss2 (quaternion, project)".
std::string method_of(results::Cell const& cell);

/// Runs of one method under one kind of control, from the largest step or tolerance to the smallest.
struct Sweep {
  std::vector<results::Record const*> runs;

  results::Cell const& like() const { return runs.front()->of; }
};

/// One initial value problem: runs that may be compared with each other.
struct Instance {
  std::string label;  ///< "tether_capture case1,g1, 50 s"
  std::vector<results::Record const*> runs;

  results::Cell const& like() const { return runs.front()->of; }
  std::vector<Sweep> sweeps() const;  ///< own methods first
  /// True if there is something to compare: two integrators with an error, or three steps or tolerances of one.
  bool comparable() const;
};

/// True for the variants that are another problem than the one they are scored against (`coupled`), a misprint
/// (`as_printed`), or a demonstration (`unlocated`): each has its own section and no part in any ranking.
bool is_aside(results::Cell const& cell);

/// What cost is counted in.
enum class Measure { time, evaluations };

/// What a run cost, [s] or evaluations; none if it was not timed or counted.
std::optional<Estimate> cost_of(results::Record const& run, Measure measure);

/// The cost of reaching an accuracy, [s] or evaluations.
struct Cost : Estimate {
  results::Record const* run = nullptr;  ///< the cheapest run that reaches it
  double measured = 0;                   ///< the cost of that run
  bool interpolated = false;             ///< `value` is at the target itself, between `run` and its neighbour
};

/// The cheapest run of one sweep that reaches an attitude error of `target` [rad], and what the target itself costs;
/// none if no run reaches it with its cost known. Without a target the cheapest run that is ok, whatever its error.
std::optional<Cost> cheapest(Sweep const& sweep, std::optional<double> target, Measure measure);
/// Cheapest way of each integrator to an attitude error of `target` [rad], cheapest first; without one as `cheapest`.
std::vector<Cost> ranking(Instance const& instance, std::optional<double> target, Measure measure);
/// The first of a ranking that is a rival, or that is ours; null if none is.
Cost const* first_of(std::vector<Cost> const& ranked, bool rivals);
/// What the target itself costs, with its interval in the unit shown; `absent` unless it is interpolated.
Entry at_target(Cost const& cost, Measure measure);
/// Time if some run of the instance was timed, otherwise evaluations.
Measure measure_of(Instance const& instance);

/// The step at which to compare, from the methods that were run with each: nearest 0.1 s, in logarithms, among those
/// that all methods but one at most, of the best covered step, share.
std::optional<double> common_step(std::map<double, std::set<std::string>> const& methods);

/// What the report's question is first asked of: motion without control, a smooth closed loop, sampled control.
struct Headline {
  std::string_view problem, word;  ///< and a word of its variant, if it has one
  std::string_view words;          ///< what it is
};
inline constexpr Headline headlines[] = {{"free_body", "", "free motion"},
                                         {"pd_slew", "plain", "the smooth loop"},
                                         {"tether_capture", "case1", "sampled control"}};

/// True if the cell is of that problem and variant, whatever its parameters.
bool is_headline(results::Cell const& cell, Headline const& headline);

/// All records, one per cell.
class Facts {
 public:
  explicit Facts(results::Contents const& contents);

  results::Contents const& contents;
  std::vector<results::Record const*> runs;  ///< of every status; a cell run by several builds counts once, the last
  std::vector<Instance> instances;           ///< the headlines first, then by name
  std::size_t superseded = 0;                ///< records that a later build replaced

  /// The series of that name that belongs to the run, or null.
  results::Series const* series_of(results::Record const& run, std::string_view name) const;
  /// The instance of a headline with the problem's default parameters, or null.
  Instance const* headline(Headline const& which) const;
  /// How a method looks in every figure: colour and symbol by integrator, open for rivals; adaptive runs are dashed, a
  /// norm policy is dotted.
  Style style_of(results::Cell const& cell) const;

 private:
  std::map<std::pair<std::string, std::string>, results::Series const*> series_;
  std::map<std::string, int> styles_;
};

/// Position of a column of a series, if it has it.
std::optional<std::size_t> column_of(results::Series const& series, std::string_view name);

}  // namespace polhode::report
