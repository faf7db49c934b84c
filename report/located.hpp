#pragma once
/// Errors against the step where the field jumps or has kinks: a method that ends its steps on these events keeps its
/// order, one that does not loses it.
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "report/facts.hpp"
#include "results/order.hpp"

namespace polhode::report {

/// The sweeps over fixed steps of the runs that are wanted and were not refused, by instance.
std::vector<Sweep> fixed_sweeps(Facts const& facts, std::function<bool(results::Cell const&)> const& wanted);

/// The fixed sweeps of a problem that exist with the variant `unlocated` and without it, up to the same time.
std::vector<Sweep> twins(Facts const& facts, std::string_view problem);

/// The order of a sweep from the attitude errors at the end, at steps up to `h_most`.
results::OrderResult order_of(Sweep const& sweep, double h_most = std::numeric_limits<double>::infinity());

/// How many state events were located: "3", "0 to 3" where runs differ; `absent` where there are none to locate.
Entry events_of(std::vector<results::Record const*> const& runs);

/// One row per sweep: problem variant, method, events located, measured order, and the error at the end for each step.
Table error_table(std::string name, std::string caption, std::vector<Sweep> const& sweeps,
                  double h_most = std::numeric_limits<double>::infinity());

/// Error at the end against the step, on logarithmic axes; grey below the reference's bar.
Panel error_panel(Facts const& facts, std::string title, std::vector<Sweep> const& sweeps);

/// "rk4 4.01, gauss2 4.00": the orders of these sweeps; empty if none has one.
std::string orders_in_words(std::vector<Sweep> const& sweeps, double h_most = std::numeric_limits<double>::infinity());

}  // namespace polhode::report
