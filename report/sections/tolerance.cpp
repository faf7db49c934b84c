#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;

/// The claims that carry the steady rates, magnitudes [rad/s].
constexpr std::array rate_names{"g1_x", "g1_y", "g1_z", "g2_x", "g2_y", "g2_z"};
/// Rates are reproduced if they are within this of the printed ones [rad/s].
constexpr double close = 0.01;

/// Values are drawn at tolerances from here on: below, nothing is to be seen but the limit.
constexpr double shown_from = 0.99e-6;

using Rates = std::array<double, rate_names.size()>;

std::optional<Rates> rates_of(Record const& run) {
  Rates rates{};
  for (std::size_t k = 0; k < rates.size(); ++k) {
    auto const value = claimed(run, rate_names[k]);
    if (!value) return {};
    rates[k] = *value;
  }
  return rates;
}

std::optional<Rates> printed_rates(Record const& run) {
  Rates rates{};
  for (std::size_t k = 0; k < rates.size(); ++k) {
    auto const claim = run.claims.find(rate_names[k]);
    if (claim == run.claims.end() || !finite(claim->second.published)) return {};
    rates[k] = *claim->second.published;
  }
  return rates;
}

/// The largest difference of two sets of rates.
double distance(Rates const& a, Rates const& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::fabs(a[k] - b[k]));
  return most;
}

/// "1.873, 1.037, 0.635 and 0.749, 1.344, 0.567".
std::string in_words(Rates const& r, int decimals) {
  auto const number = [&](double value) { return fmt::format("{:.{}f}", value, decimals); };
  return fmt::format("{}, {}, {} and {}, {}, {}", number(r[0]), number(r[1]), number(r[2]), number(r[3]), number(r[4]),
                     number(r[5]));
}

/// One adaptive run, by how far it is from what is printed and from what is right.
struct Try {
  Record const* run;
  Rates rates;
  double from_print, from_limit;
};

struct Study {
  Rates printed, limit;
  Record const* best;                                             ///< what gave the limit
  std::vector<std::pair<std::string, std::vector<Try>>> methods;  ///< loose tolerances first
};

std::optional<Study> study_of(Facts const& facts, std::string_view start) {
  Study study{};
  for (CaseRuns const& cases : published_runs(facts, group_consensus())) {
    if (cases.title != "as published") continue;
    if (Record const* run = cases.find(start)) study.best = run;
  }
  auto const printed = study.best ? printed_rates(*study.best) : std::nullopt;
  auto const limit = study.best ? rates_of(*study.best) : std::nullopt;
  if (!printed || !limit) return {};
  study.printed = *printed;
  study.limit = *limit;
  for (Instance const& instance : facts.instances) {
    auto const& like = instance.like();
    if (like.problem != group_consensus().problem || like.variant != start || !like.set.empty()) continue;
    if (like.t_end != study.best->of.t_end) continue;
    for (Sweep const& sweep : instance.sweeps()) {
      std::vector<Try> tries;
      for (Record const* run : sweep.runs) {
        auto const rates = rates_of(*run);
        if (run->of.rtol && is_ok(*run) && rates) {
          tries.push_back({run, *rates, distance(*rates, study.printed), distance(*rates, study.limit)});
        }
      }
      if (!tries.empty()) study.methods.emplace_back(sweep.like().integrator, std::move(tries));
    }
  }
  if (study.methods.empty()) return {};
  return study;
}

/// The run that comes nearest to print.
Try const& nearest(Study const& study) {
  Try const* best = nullptr;
  for (auto const& [name, tries] : study.methods) {
    for (Try const& t : tries) {
      if (!best || t.from_print < best->from_print) best = &t;
    }
  }
  return *best;
}

/// True if some run gives what is printed, and what is printed is wrong.
bool is_hit(Study const& study) {
  double const gap = distance(study.printed, study.limit);
  return gap > close && nearest(study).from_print < gap / 4;
}

/// "1e-3", as tolerances are written.
std::string tolerance(std::optional<double> value) {
  double const v = finite(value).value_or(0);
  if (!(v > 0)) return absent;
  int const exponent = static_cast<int>(std::floor(std::log10(v) + 1e-9));
  return fmt::format("{}e{}", significant(v / std::pow(10, exponent)), exponent);
}

/// "rtol = 1e-3, atol = 1e-6".
std::string tolerances_of(Record const& run) {
  return fmt::format("rtol = {}, atol = {}", tolerance(run.of.rtol), tolerance(run.of.atol));
}

/// The tolerances that a picture spans.
struct Tolerances {
  double low = INFINITY, high = 0;

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Curve level(std::string label, double value, Tolerances const& x, int colour, Dash dash) {
  return {std::move(label), {.index = colour, .dash = dash, .points = false}, {{x.low, value}, {x.high, value}}};
}

/// A dotted line across the panel where the printed rates appear.
Curve upright(Panel const& panel, Try const& hit) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (Curve const& curve : panel.curves) {
    for (Point const& p : curve.points) {
      low = std::min(low, p.y);
      high = std::max(high, p.y);
    }
  }
  double const at = *hit.run->of.rtol;
  return {hit.run->of.integrator + " gives the printed rates",
          {.index = 4, .dash = Dash::dotted, .points = false},
          {{at, low}, {at, high}}};
}

void add_picture(Document& document, Facts const& facts, Study const& study) {
  Tolerances x;
  for (auto const& [name, tries] : study.methods) {
    for (Try const& t : tries) x.include(*t.run->of.rtol);
  }
  Tolerances const near{std::max(x.low, shown_from), x.high};
  Panel rate{.x = {"relative tolerance", true},
             .y = {"steady |omega_x| of bodies 1 to 3 [rad/s]"},
             .title = "What a run says"};
  Panel error{.x = {"relative tolerance", true},
              .y = {"distance of the six rates from the limit [rad/s]", true, 1e-10},
              .title = "What it is worth"};
  rate.curves.push_back(level("printed", study.printed[0], near, 12, Dash::dashed));
  rate.curves.push_back(level("limit", study.limit[0], near, 4, Dash::solid));
  error.curves.push_back(level("printed", distance(study.printed, study.limit), x, 12, Dash::dashed));
  for (auto const& [name, tries] : study.methods) {
    Style style = facts.style_of(tries.front().run->of);
    style.dash = Dash::solid;
    Curve value{name, style}, off{name, style};
    for (Try const& t : tries) {
      if (*t.run->of.rtol >= near.low) value.points.push_back({*t.run->of.rtol, t.rates[0]});
      if (t.from_limit > 0) off.points.push_back({*t.run->of.rtol, t.from_limit});
    }
    add_curve(rate, std::move(value));
    add_curve(error, std::move(off));
  }
  if (is_hit(study)) {
    for (Panel* panel : {&rate, &error}) panel->curves.push_back(upright(*panel, nearest(study)));
  }
  document.add(Figure{
      .name = "consensus-tolerance",
      .caption = fmt::format("Steady rates of {} against the relative tolerance (absolute: {}). Left: one of the six, "
                             "with the printed value and the limit; right: the largest distance of the six from the "
                             "limit, that of the printed ones dashed. The limit is that of {} at {}.",
                             study.best->of.variant,
                             significant(study.methods.front().second.front().run->of.atol.value_or(NAN)),
                             method_of(study.best->of), control_of(study.best->of)),
      .panels = {std::move(rate), std::move(error)},
      .columns = 2});
}

void add_table(Document& document, Study const& study, std::string const& method) {
  Table table{.name = "consensus-tolerance",
              .caption = fmt::format("Steady rates [rad/s] of {} by {}, magnitudes, for each tolerance; in the last "
                                     "columns their largest distance from print and from the limit.",
                                     study.best->of.variant, method),
              .columns = {{"rtol", true},
                          {"steps", true},
                          {"rejected", true},
                          {"g1 x", true},
                          {"y", true},
                          {"z", true},
                          {"g2 x", true},
                          {"y", true},
                          {"z", true},
                          {"from print", true},
                          {"from the limit", true}}};
  auto const line = [&](Entry first, Entry steps, Entry rejected, Rates const& rates) {
    std::vector<Entry> row{std::move(first), std::move(steps), std::move(rejected)};
    for (double const r : rates) row.push_back(number(r, 4));
    row.push_back(number(distance(rates, study.printed), 2));
    row.push_back(number(distance(rates, study.limit), 2));
    table.rows.push_back(std::move(row));
  };
  line("printed", absent, absent, study.printed);
  for (auto const& [name, tries] : study.methods) {
    if (name != method) continue;
    for (Try const& t : tries)
      line({tolerance(t.run->of.rtol), exact(*t.run->of.rtol)}, count(t.run->steps), count(t.run->rejected), t.rates);
  }
  line("limit", absent, absent, study.limit);
  document.add(std::move(table));
}

/// From which tolerance on all runs of a method are close to the limit.
std::optional<double> settled_from(std::vector<Try> const& tries) {
  std::optional<double> from;
  for (Try const& t : tries) {
    if (t.from_limit > close) {
      from.reset();
    } else if (!from) {
      from = t.run->of.rtol;
    }
  }
  return from;
}

void say(Document& document, Study const& study) {
  double const gap = distance(study.printed, study.limit);
  Record const& best = *study.best;
  document.say(
      fmt::format("The steady rates of {} converge to {} rad/s ({}, {}). Printed are {}: off by up to {} rad/s.",
                  best.of.variant, in_words(study.limit, 4), method_of(best.of), control_of(best.of),
                  in_words(study.printed, 2), significant(gap, 2)));
  Try const& hit = nearest(study);
  if (gap <= close) {
    document.say("Print and limit agree: there is nothing to explain.");
    return;
  }
  if (!is_hit(study)) {
    document.say(
        fmt::format("No tolerance here gives the printed rates; the nearest, {} rad/s off, come from {} at {}.",
                    significant(hit.from_print, 2), hit.run->of.integrator, tolerances_of(*hit.run)));
    return;
  }
  std::string others;
  for (auto const& [name, tries] : study.methods) {
    auto const same = std::ranges::find_if(tries, [&](Try const& t) { return t.run->of.rtol == hit.run->of.rtol; });
    if (name == hit.run->of.integrator || same == tries.end()) continue;
    others += fmt::format("{}{} says {:.3f}", others.empty() ? "" : ", ", name, same->rates[0]);
  }
  std::size_t runs = 0;
  double next = INFINITY;
  for (auto const& [name, tries] : study.methods) {
    for (Try const& t : tries) {
      ++runs;
      if (t.run != hit.run) next = std::min(next, t.from_print);
    }
  }
  document.say(fmt::format(
      "The printed rates are those of a program at a tolerance, not of the swarm: {} at {} gives {} rad/s, within {} "
      "of print.{}{}",
      hit.run->of.integrator, tolerances_of(*hit.run), in_words(hit.rates, 3), significant(hit.from_print, 2),
      runs > 1 ? fmt::format(" Of the other {} the nearest is {} rad/s off.",
                             counted(runs - 1, "adaptive run", "adaptive runs"), significant(next, 2))
               : "",
      others.empty() ? ""
                     : fmt::format(" At the same tolerance other programs disagree on the first rate, {:.3f}: {}.",
                                   hit.rates[0], others)));
  std::vector<std::string> settled, open;
  for (auto const& [name, tries] : study.methods) {
    auto const from = settled_from(tries);
    if (from) {
      settled.push_back(fmt::format("{} from {} on", name, tolerance(from)));
    } else {
      open.push_back(name);
    }
  }
  if (!settled.empty()) {
    document.say(fmt::format(
        "They dissolve as the relative tolerance tightens: within {} rad/s of the limit stay {}{}.", significant(close),
        listed(settled), open.empty() ? "" : fmt::format("; nowhere here: {}", listed(open))));
  }
}

}  // namespace

void add_tolerance(Document& document, Facts const& facts) {
  auto const study = study_of(facts, "ic1");
  if (!study) return;
  document.heading(3, "A published result that is an artefact of its tolerance");
  say(document, *study);
  add_picture(document, facts, *study);
  add_table(document, *study, nearest(*study).run->of.integrator);
  std::vector<std::string> agreeing, not_agreeing;
  for (auto const* start : {"ic2", "ic3"}) {
    auto const other = study_of(facts, start);
    if (!other) continue;
    double const gap = distance(other->printed, other->limit);
    (gap <= close ? agreeing : not_agreeing).push_back(fmt::format("{} within {} rad/s", start, significant(gap, 2)));
  }
  if (!agreeing.empty()) document.say(fmt::format("Of the other starts print and limit agree: {}.", listed(agreeing)));
  if (!not_agreeing.empty()) document.say(fmt::format("Of other starts they do not agree: {}.", listed(not_agreeing)));
}

}  // namespace polhode::report
