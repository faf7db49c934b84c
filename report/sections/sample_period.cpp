#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// One method's runs by step: with the sample period tied to the step, and with the problem's own.
struct Comparison {
  Sweep tied, own;
};

bool usable(Record const* run) {
  return is_ok(*run) && run->of.h && finite(run->attitude_error_max).value_or(0) > 0;
}

/// The usable runs of a sweep.
Sweep usable_part(Sweep sweep) {
  std::erase_if(sweep.runs, [](Record const* run) { return !usable(run); });
  return sweep;
}

std::vector<Comparison> comparisons_of(Facts const& facts) {
  std::vector<Comparison> list;
  auto const same = [](Cell const& a, Cell const& b) {
    return std::tie(a.problem, a.formulation, a.integrator, a.policy, a.set, a.t_end, a.seed) ==
           std::tie(b.problem, b.formulation, b.integrator, b.policy, b.set, b.t_end, b.seed);
  };
  std::vector<Sweep> sweeps;
  for (Instance const& instance : facts.instances) {
    for (Sweep const& sweep : instance.sweeps()) {
      Sweep part = usable_part(sweep);
      if (!part.runs.empty()) sweeps.push_back(std::move(part));
    }
  }
  for (Sweep const& tied : sweeps) {
    if (!has_word(tied.like().variant, "coupled")) continue;
    std::string const variant = without_word(tied.like().variant, "coupled");
    for (Sweep const& own : sweeps) {
      if (own.like().variant == variant && same(own.like(), tied.like())) list.push_back({tied, own});
    }
  }
  return list;
}

Curve curve_of(std::string label, Style const& style, Sweep const& sweep) {
  Curve curve{std::move(label), style};
  for (Record const* run : sweep.runs) curve.points.push_back({*run->of.h, *run->attitude_error_max, below_bar(*run)});
  return curve;
}

/// "falls from 3.46e-9 rad at h = 0.1 s to 5.53e-12 rad at h = 0.02 s".
std::string course(Sweep const& sweep) {
  Record const &coarse = *sweep.runs.front(), &fine = *sweep.runs.back();
  double const first = *coarse.attitude_error_max, last = *fine.attitude_error_max;
  if (&coarse == &fine) return fmt::format("is {} rad at h = {} s", significant(first), significant(*coarse.of.h));
  return fmt::format("{} from {} rad at h = {} s to {} rad at h = {} s", last < first ? "falls" : "grows",
                     significant(first), significant(*coarse.of.h), significant(last), significant(*fine.of.h));
}

void add(Document& document, Facts const& facts, Comparison const& c, std::size_t n) {
  Cell const& cell = c.tied.like();
  std::map<double, std::pair<Record const*, Record const*>, std::greater<>> steps;
  for (Record const* run : c.own.runs) steps[*run->of.h].first = run;
  for (Record const* run : c.tied.runs) steps[*run->of.h].second = run;
  std::string const what = fmt::format("{} {}, {}", cell.problem, c.own.like().variant, method_of(cell));
  Table table{.name = fmt::format("sample-period-{}", n),
              .caption = fmt::format("{}: largest attitude error [rad] against the trajectory under the problem's own "
                                     "sample period.",
                                     what),
              .columns = {{"h [s]", true}, {"own period", true}, {"period tied to h", true}}};
  for (auto const& [h, runs] : steps) {
    auto const error = [](Record const* run) { return run ? number(run->attitude_error_max) : Entry(absent); };
    table.rows.push_back({number(h), error(runs.first), error(runs.second)});
  }
  document.add(std::move(table));
  Style const style = facts.style_of(cell);
  Style tied = style;
  tied.dash = Dash::dashed;
  tied.open = !style.open;
  document.add(Figure{
      .name = fmt::format("sample-period-{}", n),
      .caption = fmt::format("{}: attitude error against the step, with the problem's own sample period and with one "
                             "that follows the step.",
                             what),
      .panels = {{.x = {"h [s]", true},
                  .y = {"attitude error, max [rad]", true},
                  .curves = {curve_of("own period", style, c.own), curve_of("period tied to h", tied, c.tied)}}}});
  Record const& finest = *c.tied.runs.back();
  Record const& coarsest = *c.tied.runs.front();
  bool const vanishes = *finest.attitude_error_max < *coarsest.attitude_error_max && c.tied.runs.size() > 1;
  document.say(fmt::format("With its own period the error of {} {}; tied, it {}. {}", method_of(cell), course(c.own),
                           course(c.tied),
                           vanishes ? "Refining the step changes the problem along with the accuracy."
                                    : "Refining the step changes the problem, so the error does not vanish: what looks "
                                      "like a failure to converge is another controller."));
}

}  // namespace

void add_sample_period(Document& document, Facts const& facts) {
  document.section("Tying the sample period to the step");
  document.say(
      "The sample period of a controller belongs to the problem. If each step of the integrator takes a new sample, as "
      "in the paper (variant coupled), every step size is a different control system.");
  std::size_t n = 0;
  for (Comparison const& c : comparisons_of(facts)) add(document, facts, c, ++n);
  if (n == 0) {
    document.say(
        "The records hold no runs of one method with and without the variant coupled, so its effect cannot be shown.");
  }
}

}  // namespace polhode::report
