#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// A number that others have printed, and the claim that holds runs against it.
struct External {
  std::string_view problem, claim, quantity, printed;
  double scale;             ///< its magnitude
  int digits;               ///< printed: no run agrees to more
  bool is_difference;       ///< the claim's value is the difference from print already
  std::string_view source;  ///< who printed it
};
constexpr External externals[] = {
    {"heavy_top", "omega_y_2s", "inertial omega_y at 2 s [rad/s]", "-106.1638041430", 106.1638041430, 13, false,
     "Bruels & Cardona (2010), J. Comput. Nonlinear Dynam. 5, 031002"},
    {"krogh_b5", "y_20", "y at 20 s", "-0.93965707987292035, -0.34211777540007493, 0.74141265961999525",
     0.93965707987292035, 17, true,
     "Hull, Enright, Fellen & Sedgwick (1972), SIAM J. Numer. Anal. 9, 603, problem B5"}};

/// How far a run is from print, if it was held against it.
std::optional<double> difference(External const& e, Record const& run) {
  auto const value = is_ok(run) ? claimed(run, e.claim) : std::nullopt;
  if (!value || e.is_difference) return value;
  auto const published = finite(run.claims.at(std::string(e.claim)).published);
  return published ? std::optional(std::fabs(*value - *published)) : std::nullopt;
}

/// Digits on which a run and print agree.
int digits_of(External const& e, double apart) {
  if (apart <= 0) return e.digits;
  return std::clamp(int(std::floor(-std::log10(apart / e.scale))), 0, e.digits);
}

/// The runs held against one printed number, ours or rivals'.
struct Attempts {
  Record const* best = nullptr;
  double apart = INFINITY;
  std::size_t runs = 0, met = 0;
};

void add_external(Document& document, Facts const& facts) {
  Table table{.name = "classics-external",
              .caption =
                  "Numbers that others have printed, and the run that comes nearest to each: ours, and a "
                  "rival's. \"Met\" counts runs within 1e-6 rad/s (heavy_top) or 1e-12 (krogh_b5).",
              .columns = {{"problem"},
                          {"quantity"},
                          {"printed"},
                          {"whose"},
                          {"nearest run"},
                          {"difference", true},
                          {"digits agreed", true},
                          {"met", true}}};
  std::set<std::string> sources;
  for (External const& e : externals) {
    std::map<std::pair<std::string, bool>, Attempts> all;
    for (Record const* run : facts.runs) {
      if (run->of.problem != e.problem) continue;
      auto const apart = difference(e, *run);
      if (!apart) continue;
      Attempts& a = all[{run->of.variant, is_rival(run->of.integrator)}];
      ++a.runs;
      a.met += run->claims.at(std::string(e.claim)).verdict == "reproduced" ? 1 : 0;
      if (*apart >= a.apart) continue;
      a.apart = *apart;
      a.best = run;
    }
    for (auto const& [key, a] : all) {
      Cell const& c = a.best->of;
      sources.insert(std::string(e.source));
      table.rows.push_back({fmt::format("{}{}{}", c.problem, c.variant.empty() ? "" : " ", c.variant),
                            std::string(e.quantity), std::string(e.printed), key.second ? "rival" : "own",
                            fmt::format("{}, {}", method_of(c), control_of(c)), number(a.apart, 2),
                            fmt::format("{} of {}", digits_of(e, a.apart), e.digits),
                            fmt::format("{} of {}", a.met, a.runs)});
    }
  }
  if (table.rows.empty()) return;
  document.heading(3, "Numbers that others have printed");
  document.say(fmt::format("Sources: {}.", fmt::join(sources, "; ")));
  document.add(std::move(table));
}

/// The problems of this section. The constrained top has its own.
bool is_classic(Cell const& c) {
  if (!c.set.empty() || c.seed != 1 || is_aside(c)) return false;
  if (c.problem == "heavy_top") return !has_word(c.variant, "dae");
  if (c.problem == "pd_slew") return !c.variant.empty() && !has_word(c.variant, "plain");
  return c.problem == "gravity_gradient" || c.problem == "krogh_b5";
}

std::string short_name(Cell const& c) {
  return c.variant.empty() ? c.problem : fmt::format("{} {}", c.problem, c.variant);
}

/// At the target, or at most that where nothing brackets it.
Entry cost_entry(Cost const& cost, Measure measure) {
  std::string const value = measure == Measure::time ? duration(cost.value) : significant(cost.value, 4);
  return {cost.interpolated ? value : "≤ " + value, exact(cost.value)};
}

void add_methods(Document& document, Facts const& facts) {
  Table table{.name = "classics-methods",
              .caption =
                  "Which method for which problem: the cheapest of ours and of the rivals to an attitude error, "
                  "by evaluations of the field, or by CPU time where runs were timed; interpolated as in the "
                  "section on work and precision, ≤ where nothing brackets the target.",
              .columns = {{"problem"},
                          {"target [rad]", true},
                          {"ours"},
                          {"control"},
                          {"cost", true},
                          {"rival"},
                          {"control"},
                          {"cost", true},
                          {"rival over ours", true}}};
  std::map<std::string, std::vector<std::string>> winners;
  for (Instance const& instance : facts.instances) {
    if (!is_classic(instance.like()) || !instance.comparable()) continue;
    Measure const measure = measure_of(instance);
    for (double const target : usual_targets) {
      auto const costs = ranking(instance, target, measure);
      if (costs.empty()) continue;
      Cost const *own = first_of(costs, false), *rival = first_of(costs, true);
      std::vector<Entry> row{short_name(instance.like()), number(target)};
      for (Cost const* cost : {own, rival}) {
        row.emplace_back(cost ? method_of(cost->run->of) : absent);
        row.emplace_back(cost ? control_of(cost->run->of) : absent);
        row.push_back(cost ? cost_entry(*cost, measure) : Entry(absent));
      }
      row.push_back(own && rival ? number(rival->value / own->value) : Entry(absent));
      table.rows.push_back(std::move(row));
      if (target == 1e-9) winners[costs.front().run->of.integrator].push_back(short_name(instance.like()));
    }
  }
  if (table.rows.empty()) return;
  document.heading(3, "Which method for which problem");
  std::vector<std::string> words;
  for (auto const& [integrator, problems] : winners) {
    words.push_back(fmt::format("{} on {}", integrator, listed(problems)));
  }
  if (!words.empty()) document.say(fmt::format("Cheapest to 1e-9 rad: {}.", fmt::join(words, "; ")));
  document.add(std::move(table));
}

constexpr ErrorKind rate_at_end{.label = "rate error at the end, relative",
                                .of = [](Record const& run) { return run.rate_error_end; },
                                .scale = 1,
                                .has_bar = false};

void add_order_matrix(Document& document, Facts const& facts) {
  std::map<std::tuple<bool, std::string, std::string>, std::map<std::string, Entry>> rows;
  std::vector<std::string> problems;
  for (Sweep const& sweep : fixed_sweeps(facts, is_classic)) {
    Cell const& c = sweep.like();
    if (c.policy != "none" || (c.formulation != "quaternion" && c.formulation != "s3")) continue;
    // Krogh's problem has rates alone
    auto const order = order_of(sweep, INFINITY, c.problem == "krogh_b5" ? rate_at_end : attitude_at_end);
    if (!order.fit) continue;
    std::string const name = short_name(c);
    if (std::ranges::find(problems, name) == problems.end()) problems.push_back(name);
    rows[{is_rival(c.integrator), c.integrator, c.formulation}][name] = {slope_of(*order.fit), exact(order.fit->slope)};
  }
  if (rows.empty()) return;
  Table table{.name = "classics-orders",
              .caption = fmt::format("Measured order by problem, fixed steps, from the attitude error at the end (the "
                                     "rate error of krogh_b5); ~ marks a slope through two points, {} that the errors "
                                     "are round-off, or do not lie on a line.",
                                     absent),
              .columns = {{"integrator"}, {"formulation"}}};
  for (std::string const& name : problems) table.columns.push_back({name, true});
  for (auto const& [key, orders] : rows) {
    std::vector<Entry> row{std::get<1>(key), std::get<2>(key)};
    for (std::string const& name : problems) {
      auto const found = orders.find(name);
      row.push_back(found == orders.end() ? Entry(absent) : found->second);
    }
    table.rows.push_back(std::move(row));
  }
  document.add(std::move(table));
}

constexpr ErrorKind jacobi{.label = "change of Jacobi's integral, relative",
                           .of = [](Record const& run) { return claimed(run, "jacobi_drift"); },
                           .scale = 1,
                           .has_bar = false};

/// The largest step of each method that keeps the integral: "100 s: gauss4; 20 s: cf4 and rkmk4".
std::string kept_in_words(std::vector<Sweep> const& sweeps, double bound) {
  std::map<std::string, double> largest;
  for (Sweep const& sweep : sweeps) {
    double& h = largest.try_emplace(sweep.like().integrator, 0).first->second;
    for (Record const* run : sweep.runs) {
      auto const drift = jacobi.of(*run);
      if (is_ok(*run) && drift && *drift <= bound) h = std::max(h, *run->of.h);
    }
  }
  std::map<double, std::vector<std::string>, std::greater<>> by_step;
  for (auto const& [integrator, h] : largest) by_step[h].push_back(integrator);
  std::vector<std::string> words;
  for (auto const& [h, integrators] : by_step) {
    words.push_back(
        fmt::format("{}: {}", h > 0 ? significant(h) + " s" : std::string("none here"), listed(integrators)));
  }
  return fmt::format("{}", fmt::join(words, "; "));
}

void add_gravity_gradient(Document& document, Facts const& facts) {
  auto const of = [&](std::string_view formulation) {
    return fixed_sweeps(facts, [&](Cell const& c) {
      return c.problem == "gravity_gradient" && is_classic(c) && c.policy == "none" &&
             (formulation.empty() || c.formulation == formulation);
    });
  };
  auto const all = of("");
  if (std::ranges::none_of(all, [](Sweep const& s) { return jacobi.of(*s.runs.front()).has_value(); })) return;
  constexpr double bound = 1e-6;
  document.heading(3, "A satellite under the gravity gradient");
  document.say(fmt::format(
      "Neither energy nor angular momentum is kept, but Jacobi's integral is. The largest step that keeps it "
      "within {} for {} s, in whatever coordinates: {}.",
      significant(bound), significant(all.front().like().t_end, 6), kept_in_words(all, bound)));
  add_figure(document, {.name = "classics-gravity-gradient",
                        .caption = "gravity_gradient: greatest change of Jacobi's integral, and attitude error at the "
                                   "end, against the step, in quaternions and on S^3. Open symbols: rivals.",
                        .panels = {error_panel(facts, "R^4 (quaternion)", of("quaternion"), jacobi),
                                   error_panel(facts, "S^3 (s3)", of("s3"), jacobi),
                                   error_panel(facts, "R^4 (quaternion)", of("quaternion")),
                                   error_panel(facts, "S^3 (s3)", of("s3"))},
                        .columns = 2});
}

}  // namespace

void add_classics(Document& document, Facts const& facts) {
  bool const any = std::ranges::any_of(facts.runs, [](Record const* run) { return is_classic(run->of); });
  if (!any) return;
  document.section("Classics");
  document.say(
      "Problems that every integrator of rigid bodies has met: a heavy top (fast spin, or slow in a potential), "
      "Krogh's three rates, a satellite under the gravity gradient, and slews under proportional-derivative control "
      "beside a wheel (gyrostat), with a late torque (delayed) and with a torque in steps (quantized).");
  add_external(document, facts);
  add_methods(document, facts);
  add_order_matrix(document, facts);
  add_gravity_gradient(document, facts);
}

}  // namespace polhode::report
