#include <fmt/format.h>

#include "report/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// Errors below are round-off, not the method's.
constexpr double round_off = 1e-12;
/// Errors above are too large for the leading term to rule [rad].
constexpr double asymptotic = 0.1;

bool is_usable(Record const& run) {
  auto const error = finite(run.attitude_error_end);
  double const bar = finite(run.reference_bar).value_or(0);
  return is_ok(run) && error && *error > std::max(10 * bar, round_off) && *error < asymptotic && finite(run.of.h) &&
         *run.of.h > 0;
}

/// No more digits than the interval allows.
Entry slope_of(Order const& order) {
  if (!order.half_width) return {fmt::format("~ {:.1f}", order.slope), exact(order.slope)};
  return {fmt::format("{:.{}f}", order.slope, *order.half_width < 0.1 ? 2 : 1), exact(order.slope)};
}

Entry half_width_of(Order const& order) {
  if (!order.half_width) return absent;
  double const w = *order.half_width;
  return {w < 0.01 ? "< 0.01" : fmt::format("{:.{}f}", w, w < 0.1 ? 2 : 1), exact(w)};
}

}  // namespace

void add_orders(Document& document, Facts const& facts) {
  document.section("Measured orders");
  document.say(
      fmt::format("Least squares of the logarithm of the attitude error at the end against that of h, over errors "
                  "above ten times the reference's bar and {} rad (round-off), and below {} rad; fixed steps only. The "
                  "interval holds the slope with 95% confidence; it is wide where the points do not lie on a line. A "
                  "slope through two points is marked ~ and has none.",
                  significant(round_off), significant(asymptotic)));
  Table table{.name = "orders",
              .caption = "Measured order of each method with fixed steps.",
              .columns = {{"problem"},
                          {"integrator"},
                          {"formulation"},
                          {"policy"},
                          {"order", true},
                          {"± 95%", true},
                          {"points", true},
                          {"h from [s]", true},
                          {"to [s]", true}},
              .rows = {}};
  std::size_t left_out = 0;
  for (Instance const& instance : facts.instances) {
    if (is_aside(instance.like())) continue;
    for (Sweep const& sweep : instance.sweeps()) {
      if (!sweep.like().h || sweep.runs.size() < 2) continue;
      std::vector<std::pair<double, double>> points;
      for (Record const* run : sweep.runs) {
        if (is_usable(*run)) points.emplace_back(*run->of.h, *run->attitude_error_end);
      }
      auto const order = fit_order(points);
      if (!order) {
        ++left_out;
        continue;
      }
      auto const& c = sweep.like();
      table.rows.push_back({instance.label, c.integrator, c.formulation, c.policy, slope_of(*order),
                            half_width_of(*order), std::to_string(order->points), number(points.back().first),
                            number(points.front().first)});
    }
  }
  if (table.rows.empty()) {
    document.say("No method has two such points, so no order can be measured.");
  } else {
    document.add(std::move(table));
    if (left_out > 0) {
      document.say(fmt::format("{} left out: fewer than two such points, the rest being round-off.",
                               left_out == 1 ? "1 sweep is" : std::to_string(left_out) + " sweeps are"));
    }
  }
}

}  // namespace polhode::report
