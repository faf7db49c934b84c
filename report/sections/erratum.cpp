#include <fmt/format.h>

#include <algorithm>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// One method and step under both signs.
struct Signs {
  Record const* correct;
  Record const* printed;
};

std::vector<Signs> pairs_of(Facts const& facts) {
  std::vector<Signs> pairs;
  auto const usable = [](Record const& run) {
    return is_ok(run) && run.of.problem == "tether_capture" && has_word(run.of.variant, "free") &&
           finite(run.momentum_direction_max) && finite(run.energy_drift_max) && finite(run.momentum_drift_max);
  };
  for (Record const* printed : facts.runs) {
    if (!usable(*printed) || !has_word(printed->of.variant, "as_printed")) continue;
    Cell wanted = printed->of;
    wanted.variant = without_word(wanted.variant, "as_printed");
    std::string const id = results::cell_id(wanted);
    auto const found = std::ranges::find_if(
        facts.runs, [&](Record const* run) { return usable(*run) && results::cell_id(run->of) == id; });
    if (found != facts.runs.end()) pairs.push_back({*found, printed});
  }
  return pairs;
}

}  // namespace

void add_erratum(Document& document, Facts const& facts) {
  document.section("The sign erratum");
  document.say(
      "The paper prints the gyroscopic term as J omega' = + omega x J omega; Euler's equation has a minus (variant "
      "as_printed has the plus). The energy and |L| are constant under either sign.");
  auto const pairs = pairs_of(facts);
  if (pairs.empty()) {
    document.say(
        "The records hold no pair of runs of tether_capture's free motion with both signs at equal step, so the signs "
        "cannot be compared.");
    return;
  }
  Table table{.name = "erratum",
              .caption =
                  "The uncontrolled target with Euler's sign and with the printed one: largest change of energy, "
                  "of |L| (both relative) and of the direction of L in space.",
              .columns = {{"integrator"},
                          {"control"},
                          {"sign"},
                          {"energy", true},
                          {"|L|", true},
                          {"direction of L [rad]", true},
                          {"[deg]", true}}};
  double length = 0, correct = 0, printed = 0;
  for (Signs const& pair : pairs) {
    for (Record const* run : {pair.correct, pair.printed}) {
      table.rows.push_back({method_of(run->of), control_of(run->of),
                            run == pair.printed ? "plus, as printed" : "minus, Euler", number(run->energy_drift_max, 2),
                            number(run->momentum_drift_max, 2), number(run->momentum_direction_max),
                            number(degrees(*run->momentum_direction_max))});
      length = std::max({length, *run->energy_drift_max, *run->momentum_drift_max});
    }
    correct = std::max(correct, *pair.correct->momentum_direction_max);
    printed = std::max(printed, *pair.printed->momentum_direction_max);
  }
  document.add(std::move(table));
  bool const tells = printed > 100 * correct && printed > 100 * length;
  document.say(
      fmt::format("Energy and |L| change by at most {} under both signs. The direction of L in space stays "
                  "within {} rad with Euler's sign and turns by up to {} rad ({} deg) with the printed one{}",
                  significant(length, 2), significant(correct, 2), significant(printed), significant(degrees(printed)),
                  tells ? ": only the angular momentum in space tells the signs apart." : "."));
}

}  // namespace polhode::report
