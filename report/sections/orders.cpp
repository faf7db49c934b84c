#include <fmt/format.h>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {

void add_orders(Document& document, Facts const& facts) {
  document.section("Measured orders");
  results::OrderRules const rules;
  document.say(fmt::format(
      "Least squares of the logarithm of the attitude error at the end against that of h; fixed steps only. "
      "Errors count above {} times the reference's bar and {} rad (round-off), and below {} rad; of these, "
      "the longest stretch of steps over which the local slopes agree within {}% is fitted. The interval "
      "holds the slope with 95% confidence. A slope through two points is marked ~ and has none.",
      significant(rules.bars), significant(rules.round_off), significant(rules.asymptotic),
      significant(100 * rules.agreement)));
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
                          {"to [s]", true}}};
  std::size_t left_out = 0;
  for (Instance const& instance : facts.instances) {
    if (is_aside(instance.like())) continue;
    for (Sweep const& sweep : instance.sweeps()) {
      if (!sweep.like().h || sweep.runs.size() < 2) continue;
      auto const fit = order_of(sweep).fit;
      if (!fit) {
        ++left_out;
        continue;
      }
      auto const& c = sweep.like();
      table.rows.push_back({instance.label,
                            c.integrator,
                            c.formulation,
                            c.policy,
                            {slope_of(*fit), exact(fit->slope)},
                            half_width_of(*fit),
                            std::to_string(fit->points),
                            number(fit->h_low),
                            number(fit->h_high)});
    }
  }
  if (table.rows.empty()) {
    document.say("No method has two such points, so no order can be measured.");
  } else {
    document.add(std::move(table));
    if (left_out > 0) {
      document.say(
          fmt::format("{} left out: fewer than two such points, the rest being round-off, or no two "
                      "neighbouring slopes that agree.",
                      left_out == 1 ? "1 sweep is" : std::to_string(left_out) + " sweeps are"));
    }
  }
}

}  // namespace polhode::report
