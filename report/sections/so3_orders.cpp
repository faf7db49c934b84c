#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

constexpr ErrorKind orthogonality{.label = "|R^T R - 1|, largest",
                                  .of = [](Record const& run) { return run.norm_drift_max; },
                                  .scale = 1,
                                  .has_bar = false};

struct Description {
  std::string_view formulation, title;
};
constexpr Description descriptions[] = {
    {"rotation", "R^9 (rotation)"}, {"so3", "SO(3) (so3)"}, {"quaternion", "R^4 (quaternion)"}, {"s3", "S^3 (s3)"}};

/// The smooth example's runs with fixed steps in one description.
std::vector<Sweep> smooth(Facts const& facts, std::string_view formulation) {
  return fixed_sweeps(facts, [&](Cell const& c) {
    return c.problem == so3_cooperative().problem && c.formulation == formulation && c.set.empty() && c.seed == 1 &&
           c.policy == "none" && has_word(c.variant, "ex1") && has_word(c.variant, "method1") &&
           has_word(c.variant, "far") && has_word(c.variant, "set_e") && !has_word(c.variant, "unlocated");
  });
}

std::vector<Sweep> several_steps(std::vector<Sweep> sweeps) {
  std::erase_if(sweeps, [](Sweep const& sweep) { return sweep.runs.size() < 2; });
  return sweeps;
}

void add_order(Document& document, Facts const& facts) {
  Figure figure{.name = "so3-order",
                .caption =
                    "Attitude error at the end against the step, from small angles on the far surface, by "
                    "description of the attitude. Open symbols: rivals. The shade is where rounding rules.",
                .columns = 2,
                .same_y = true};
  std::vector<std::string> words;
  for (Description const& d : descriptions) {
    auto sweeps = several_steps(smooth(facts, d.formulation));
    figure.panels.push_back(error_panel(facts, std::string(d.title), sweeps));
    std::erase_if(sweeps, [](Sweep const& sweep) { return is_rival(sweep.like().integrator); });
    std::string const orders = orders_in_words(sweeps);
    if (!orders.empty()) words.push_back(fmt::format("on {} {}", d.title, orders));
  }
  if (std::ranges::all_of(figure.panels, [](Panel const& panel) { return panel.curves.empty(); })) return;
  document.heading(3, "Order and drift on SO(3)");
  if (!words.empty()) document.say(fmt::format("Measured orders: {}.", fmt::join(words, "; ")));
  add_figure(document, std::move(figure));
}

/// "rk4 (rotation) 7e-6 at h = 0.1 s, falling as h^4.00".
std::string drift_in_words(Sweep const& sweep) {
  Record const* shown = nullptr;
  auto const distance = [](Record const* run) { return std::fabs(std::log(*run->of.h / 0.1)); };
  for (Record const* run : sweep.runs) {
    if (is_ok(*run) && finite(run->norm_drift_max) && (!shown || distance(run) < distance(shown))) shown = run;
  }
  if (!shown) return "";
  auto const order = order_of(sweep, INFINITY, orthogonality);
  return fmt::format("{} {} at {}{}", method_of(shown->of), significant(*shown->norm_drift_max, 2),
                     control_of(shown->of), order.fit ? ", falling as h^" + slope_of(*order.fit) : "");
}

void add_orthogonality(Document& document, Facts const& facts) {
  Figure figure{.name = "so3-drift",
                .caption =
                    "How far R is from a rotation, |R^T R - 1| (Frobenius), against the step: nine numbers that "
                    "nobody keeps orthogonal, and steps that are rotations. The shade is where rounding rules.",
                .columns = 2,
                .same_y = true};
  std::vector<std::string> drifting, kept;
  double worst = 0;
  for (Description const& d : descriptions) {
    if (d.formulation != "rotation" && d.formulation != "so3") continue;
    auto const sweeps = several_steps(smooth(facts, d.formulation));
    figure.panels.push_back(error_panel(facts, std::string(d.title), sweeps, orthogonality));
    for (Sweep const& sweep : sweeps) {
      auto const most = largest(sweep, orthogonality);
      if (!most) continue;
      if (*most > round_off) {
        drifting.push_back(drift_in_words(sweep));
      } else {
        kept.push_back(method_of(sweep.like()));
        worst = std::max(worst, *most);
      }
    }
  }
  if (drifting.empty() && kept.empty()) return;
  if (!drifting.empty()) document.say(fmt::format("|R^T R - 1| drifts: {}.", fmt::join(drifting, "; ")));
  if (!kept.empty())
    document.say(
        fmt::format("It stays at round-off, at most {}, at every step here: {}.", significant(worst, 2), listed(kept)));
  add_figure(document, std::move(figure));
}

/// The law jumps where a craft changes its surface.
void add_switching(Document& document, Facts const& facts) {
  auto const sweeps = twins(facts, so3_cooperative().problem);
  if (sweeps.empty()) return;
  document.heading(3, "The change of surface, located and not");
  std::string const with = orders_in_words(part_of(sweeps, true)), without = orders_in_words(part_of(sweeps, false));
  document.say(
      fmt::format("The torque jumps where a craft comes within 20 deg of its command. Measured orders: with steps that "
                  "end there {}; with steps across {}.",
                  with.empty() ? "none" : with, without.empty() ? "none, the errors do not lie on a line" : without));
  add_located(document, facts, "so3-switching", "change of surface", "changes of surface", sweeps);
}

}  // namespace

void add_so3_orders(Document& document, Facts const& facts) {
  add_order(document, facts);
  add_orthogonality(document, facts);
  add_switching(document, facts);
}

}  // namespace polhode::report
