#pragma once
/// Errors against the step where the field jumps or has kinks: a method that ends its steps on these events keeps its
/// order, one that does not loses it. Orders of other errors, too.
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/facts.hpp"
#include "results/order.hpp"

namespace polhode::report {

/// The sweeps over fixed steps of the runs that are wanted and were not refused, by instance.
std::vector<Sweep> fixed_sweeps(Facts const& facts, std::function<bool(results::Cell const&)> const& wanted);

/// A defect or a drift that stays below this part of its scale is round-off.
inline constexpr double round_off = results::OrderRules{}.round_off;

/// The fixed sweeps of a problem that exist with the variant `unlocated` and without it, up to the same time.
std::vector<Sweep> twins(Facts const& facts, std::string_view problem);
/// Those of them that end steps on the events, or that do not (`unlocated`).
std::vector<Sweep> part_of(std::vector<Sweep> sweeps, bool located);

/// An error of a run: where it stands, and when it tells something.
struct ErrorKind {
  std::string_view label;  ///< of an axis, with its unit
  std::optional<double> (*of)(results::Record const& run);
  double scale = 1;     ///< what 1 rad is to attitudes: a 1e-12th of it is round-off, a tenth too large for an order
  bool has_bar = true;  ///< the reference's bar is its own
};
inline constexpr ErrorKind attitude_at_end{"attitude error at the end [rad]",
                                           [](results::Record const& run) { return run.attitude_error_end; }};

/// The largest of the successful runs' errors; none if no such run has one.
std::optional<double> largest(Sweep const& sweep, ErrorKind const& kind);
/// The order of a sweep at steps up to `h_most`.
results::OrderResult order_of(Sweep const& sweep, double h_most = std::numeric_limits<double>::infinity(),
                              ErrorKind const& kind = attitude_at_end);
/// A slope with no more digits than its interval allows; ~ before one through two points.
std::string slope_of(results::OrderFit const& fit);
/// Half of its 95% interval, "< 0.01" where that is all there is to say.
Entry half_width_of(results::OrderFit const& fit);

/// How many state events were located: "3", "0 to 3" where runs differ; `absent` where there are none to locate.
Entry events_of(std::vector<results::Record const*> const& runs);

/// One row per sweep: problem variant, method, events located, measured order, and the error at the end for each step.
Table error_table(std::string name, std::string caption, std::vector<Sweep> const& sweeps,
                  double h_most = std::numeric_limits<double>::infinity());

/// Error against the step, on logarithmic axes; grey below the reference's bar.
Panel error_panel(Facts const& facts, std::string title, std::vector<Sweep> const& sweeps,
                  ErrorKind const& kind = attitude_at_end);

/// Figure and table, both of this name, of the sweeps that end steps on events, and of those that do not. `event`, with
/// its plural `events`: a kink of the actuators, a change of surface.
void add_located(Document& document, Facts const& facts, std::string const& name, std::string_view event,
                 std::string_view events, std::vector<Sweep> const& sweeps);

/// "rk4 4.01, gauss2 4.00": the orders of these sweeps; empty if none has one.
std::string orders_in_words(std::vector<Sweep> const& sweeps, double h_most = std::numeric_limits<double>::infinity(),
                            ErrorKind const& kind = attitude_at_end);

}  // namespace polhode::report
