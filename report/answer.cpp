#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// A norm that stays within this is kept: some hundred roundings, accumulated over the horizon.
constexpr double kept = 1e-13;
/// A change of the error by less is no change: it is what another rounding does.
constexpr double noticeable = 0.1;

/// The motions that the question is about: torque-free, and the paper's first strategy, from a unit quaternion.
bool is_asked(Cell const& c) {
  if (c.set.contains("q0")) return false;
  if (c.problem == "free_body") return true;
  bool const controlled = has_word(c.variant, "case1"), free = has_word(c.variant, "free");
  return c.problem == "tether_capture" && (controlled || free) && !has_word(c.variant, "raw_q0") &&
         !has_word(c.variant, "coupled");
}

/// The drift of one method over all of its runs.
struct Keeping {
  double worst = 0, h_low = INFINITY, h_high = 0, t_end = 0;
};

std::map<std::string, Keeping> keeping_of(Facts const& facts, bool quaternion) {
  std::map<std::string, Keeping> methods;
  for (Record const* run : facts.runs) {
    auto const drift = finite(run->norm_drift_max);
    bool const flat = run->of.formulation == "quaternion";
    if (!is_ok(*run) || !is_asked(run->of) || run->of.policy != "none" || !drift || flat != quaternion) continue;
    if (!quaternion && run->of.formulation != "s3" && run->of.formulation != "so3") continue;
    Keeping& k = methods[run->of.integrator];
    k.worst = std::max(k.worst, *drift);
    k.t_end = std::max(k.t_end, run->of.t_end);
    if (!run->of.h) continue;
    k.h_low = std::min(k.h_low, *run->of.h);
    k.h_high = std::max(k.h_high, *run->of.h);
  }
  return methods;
}

std::string norm_sentence(Facts const& facts, std::map<std::string, Keeping> const& methods) {
  if (methods.empty()) {
    return "Which integrator keeps the norm cannot be said: the records hold no successful run in quaternions, without "
           "projection, of free_body or of tether_capture's variants free and case1.";
  }
  std::vector<std::string> keepers, others;
  Keeping all;
  for (auto const& [name, k] : methods) {
    if (k.worst >= kept) {
      others.push_back(fmt::format("{} ({})", name, significant(k.worst, 2)));
      continue;
    }
    keepers.push_back(name);
    all.worst = std::max(all.worst, k.worst);
    all.t_end = std::max(all.t_end, k.t_end);
    all.h_low = std::min(all.h_low, k.h_low);
    all.h_high = std::max(all.h_high, k.h_high);
  }
  std::string text = "Without projection no integrator here keeps the quaternion's norm to 1e-13";
  if (!keepers.empty()) {
    text = fmt::format(
        "Without projection {} the quaternion's norm to better than 1e-13 in every successful run here (largest "
        "drift {}",
        listed(keepers) + (keepers.size() == 1 ? " keeps" : " keep"), significant(all.worst, 2));
    if (all.h_high > 0) text += fmt::format(", h from {} to {} s", significant(all.h_low), significant(all.h_high));
    if (all.t_end > 0) text += fmt::format(", up to {} s", significant(all.t_end));
    text += ")";
  }
  if (!others.empty()) text += fmt::format("; the largest drift of the others: {}", listed(others));
  std::vector<std::string> on_group;
  double worst = 0;
  for (auto const& [name, k] : keeping_of(facts, false)) {
    if (k.worst < kept) on_group.push_back(name);
    if (k.worst < kept) worst = std::max(worst, k.worst);
  }
  if (!on_group.empty()) {
    text += fmt::format("; on the group itself (s3, so3) {} {} it too (at most {})", listed(on_group),
                        on_group.size() == 1 ? "keeps" : "keep", significant(worst, 2));
  }
  double delivered = 0, raw = 0;
  for (Record const* run : facts.runs) {
    if (!is_ok(*run) || !is_asked(run->of) || run->of.policy != "project" || !finite(run->norm_drift_max)) continue;
    delivered = std::max(delivered, *run->norm_drift_max);
    raw = std::max(raw, finite(run->norm_drift_raw_max).value_or(0));
  }
  if (raw > 0 || delivered > 0) {
    text += fmt::format(
        "; with projection what is delivered stays within {} in every method, though a step before its projection is "
        "off by up to {}",
        significant(delivered, 2), significant(raw, 2));
  }
  return text + ".";
}

/// The same run without and with projection.
struct Pair {
  Record const* none;
  Record const* project;

  double ratio() const { return *project->attitude_error_max / *none->attitude_error_max; }
  bool changed() const {
    double const difference = std::abs(*project->attitude_error_max - *none->attitude_error_max);
    double const bar = finite(none->reference_bar).value_or(0);
    return difference > noticeable * *none->attitude_error_max && difference > std::max(bar, 1e-14);
  }
};

std::vector<Pair> pairs_of(Instance const& instance) {
  std::map<std::tuple<std::string, std::string, std::string>, Record const*> plain;
  auto const key = [](Cell const& c) { return std::tuple(c.integrator, c.formulation, control_of(c)); };
  auto const usable = [](Record const& run) { return is_ok(run) && finite(run.attitude_error_max); };
  for (Record const* run : instance.runs) {
    if (run->of.policy == "none" && usable(*run)) plain[key(run->of)] = run;
  }
  std::vector<Pair> pairs;
  for (Record const* run : instance.runs) {
    auto const found = plain.find(key(run->of));
    if (run->of.policy != "project" || !usable(*run) || found == plain.end()) continue;
    if (*found->second->attitude_error_max > 0) pairs.push_back({found->second, run});
  }
  return pairs;
}

/// The step that most of the wanted methods were run with; among equals the one nearest 0.1 s, in logarithms.
std::optional<double> common_step(Instance const& instance, std::map<std::string, Keeping> const& methods) {
  std::map<double, std::set<std::string>> by_step;
  for (Record const* run : instance.runs) {
    bool const wanted = methods.contains(run->of.integrator) && run->of.formulation == "quaternion";
    if (wanted && is_ok(*run) && run->of.h && finite(run->attitude_error_max)) {
      by_step[*run->of.h].insert(run->of.integrator);
    }
  }
  std::optional<double> best;
  auto const distance = [](double h) { return std::abs(std::log10(h / 0.1)); };
  for (auto const& [h, names] : by_step) {
    bool const more = best && names.size() > by_step[*best].size();
    bool const nearer = best && names.size() == by_step[*best].size() && distance(h) < distance(*best);
    if (!best || more || nearer) best = h;
  }
  return best;
}

/// Free motion first: there the integrator is alone with the body.
std::vector<Instance const*> asked_instances(Facts const& facts, bool controlled_first) {
  std::vector<Instance const*> asked;
  for (Instance const& instance : facts.instances) {
    if (is_asked(instance.like())) asked.push_back(&instance);
  }
  std::ranges::stable_sort(asked, {}, [&](Instance const* instance) {
    Cell const& c = instance->like();
    int const rank = c.problem == "free_body" ? 1 : has_word(c.variant, "case1") == controlled_first ? 0 : 2;
    return std::tuple(has_word(c.variant, "as_printed"), rank, !c.set.empty());
  });
  return asked;
}

std::string projection_clause(Facts const& facts, Instance const* shown, std::optional<double> h) {
  std::vector<Pair> pairs;
  Pair const* quoted = nullptr;
  for (Instance const* instance : asked_instances(facts, false)) {
    for (Pair const& pair : pairs_of(*instance)) pairs.push_back(pair);
  }
  if (pairs.empty()) return "no run was made both with and without projection at equal step";
  for (Pair const& pair : pairs) {
    bool const here = shown && std::ranges::find(shown->runs, pair.none) != shown->runs.end();
    if (!here || pair.none->of.h != h || pair.none->of.formulation != "quaternion") continue;
    if (!quoted || pair.none->of.integrator == "gauss2") quoted = &pair;
  }
  if (!quoted) quoted = &pairs.front();
  auto const changed = static_cast<std::size_t>(std::ranges::count_if(pairs, &Pair::changed));
  std::string text = fmt::format(
      "projection changes the attitude error measurably (by more than 10% and the "
      "reference's bar) in {} of {} none/project pairs at equal step ({} at {}: {} rad "
      "without, {} rad with)",
      changed == 0 ? "none" : std::to_string(changed), pairs.size(), quoted->none->of.integrator,
      control_of(quoted->none->of), significant(*quoted->none->attitude_error_max),
      significant(*quoted->project->attitude_error_max));
  if (changed == 0) return text;
  Pair const& worst = *std::ranges::max_element(pairs, {}, [](Pair const& pair) {
    double const r = std::max(pair.ratio(), 1e-300);
    return pair.changed() ? std::abs(std::log(r)) : 0.0;
  });
  return text + fmt::format(", most in {} at {}, where the error is {} times what it is without",
                            method_of(worst.none->of), control_of(worst.none->of), significant(worst.ratio(), 2));
}

std::string accuracy_sentence(Facts const& facts, std::map<std::string, Keeping> methods) {
  std::map<std::string, Keeping> keepers = methods;
  std::erase_if(keepers, [](auto const& item) { return item.second.worst >= kept; });
  if (!keepers.empty()) methods = keepers;
  for (Instance const* instance : asked_instances(facts, false)) {
    auto const h = common_step(*instance, methods);
    if (!h) continue;
    std::vector<std::string> errors;
    for (Sweep const& sweep : instance->sweeps()) {
      Cell const& c = sweep.like();
      if (c.formulation != "quaternion" || c.policy != "none" || !methods.contains(c.integrator)) continue;
      for (Record const* run : sweep.runs) {
        auto const error = finite(run->attitude_error_max);
        if (run->of.h != h || !is_ok(*run) || !error) continue;
        errors.push_back(fmt::format("{} for {}{}", angle(*error), c.integrator,
                                     below_bar(*run) ? " (below the reference's bar)" : ""));
      }
    }
    if (errors.empty()) continue;
    return fmt::format("{} attitude error at h = {} s is at most {} ({}); {}.", keepers.empty() ? "The" : "Their",
                       significant(*h), listed(errors), instance->label, projection_clause(facts, instance, h));
  }
  return "How accurate it is cannot be said: no such run was compared with a reference.";
}

std::string cost_text(double value, Measure measure) {
  return measure == Measure::time ? duration(value) : significant(value, 4) + " evaluations";
}

std::string cost_text(Cost const& cost, Measure measure) {
  return (cost.interpolated ? "≈ " : "") + cost_text(cost.value, measure);
}

/// Who reaches one accuracy on one problem at the least cost.
struct Verdict {
  std::vector<Cost> costs;
  Cost const* best = nullptr;
  Cost const* opponent = nullptr;  ///< the best of the other camp: rivals if an own method wins, and vice versa

  explicit Verdict(std::vector<Cost> ranked) : costs(std::move(ranked)) {
    if (costs.empty()) return;
    best = &costs.front();
    auto const other = std::ranges::find_if(costs, [&](Cost const& c) { return rival(c) != rival(*best); });
    if (other != costs.end()) opponent = &*other;
  }
  Verdict(Verdict const&) = delete;
  Verdict& operator=(Verdict const&) = delete;

  static bool rival(Cost const& cost) { return is_rival(cost.run->of.integrator); }
  bool tied() const { return opponent && opponent->low <= best->high; }
};

std::string verdict_text(Verdict const& v, double target, Measure measure) {
  std::string const goal = significant(target) + " rad";
  if (!v.best) return "no run reaches " + goal;
  std::string text = fmt::format("{}{} reaches {} in {}", Verdict::rival(*v.best) ? "the rival " : "",
                                 method_of(v.best->run->of), goal, cost_text(*v.best, measure));
  if (!v.opponent) {
    return text + (Verdict::rival(*v.best) ? ", and no own method does" : ", and no rival here does");
  }
  std::string const camp = Verdict::rival(*v.best) ? "the best own method " : "the best rival ";
  if (v.tied()) {
    return text + fmt::format(", which is no measurable difference to {}{} ({})", camp, method_of(v.opponent->run->of),
                              cost_text(*v.opponent, measure));
  }
  return text + fmt::format(", {} times less than {}{} ({})", significant(v.opponent->value / v.best->value), camp,
                            method_of(v.opponent->run->of), cost_text(*v.opponent, measure));
}

std::string cost_sentence(Facts const& facts) {
  for (Instance const* instance : asked_instances(facts, true)) {
    Measure const measure = measure_of(*instance);
    Verdict const coarse(ranking(*instance, 1e-6, measure)), fine(ranking(*instance, 1e-9, measure));
    if (!coarse.best && !fine.best) continue;
    bool const timed = measure == Measure::time;
    return fmt::format("At the least {} ({}) {}; {}.",
                       timed ? "CPU time" : "number of evaluations, since nothing was timed", instance->label,
                       verdict_text(coarse, 1e-6, measure), verdict_text(fine, 1e-9, measure));
  }
  return "What it costs cannot be said: no run of these motions is known to reach an attitude error of 1e-6 rad with "
         "its "
         "work counted.";
}

Table winners(Facts const& facts) {
  Table table{.name = "answer",
              .caption =
                  "Cheapest way to a given attitude error (largest over the run), own methods against rivals. "
                  "Costs marked ≈ are interpolated between two runs, in logarithms; section 3 has the runs.",
              .columns = {{"problem"},
                          {"attitude error [rad]", true},
                          {"[arcsec]", true},
                          {"winner"},
                          {"cost", true},
                          {"best of the other side"},
                          {"cost", true},
                          {"factor", true}},
              .rows = {}};
  for (Instance const* instance : asked_instances(facts, true)) {
    Measure const measure = measure_of(*instance);
    auto const cost = [&](Cost const& c) { return Entry(cost_text(c, measure), exact(c.value)); };
    for (double const target : {1e-6, 1e-9}) {
      Verdict const v(ranking(*instance, target, measure));
      std::vector<Entry> row{instance->label, number(target), number(arcseconds(target))};
      row.push_back(v.best ? Entry(method_of(v.best->run->of)) : Entry("nobody"));
      row.push_back(v.best ? cost(*v.best) : Entry(absent));
      row.push_back(v.opponent ? Entry(method_of(v.opponent->run->of)) : Entry("nobody"));
      row.push_back(v.opponent ? cost(*v.opponent) : Entry(absent));
      row.push_back(v.opponent ? number(v.opponent->value / v.best->value) : Entry(absent));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

}  // namespace

void add_answer(Document& document, Facts const& facts) {
  document.heading(2, "1. The answer");
  document.say("Which integrator keeps the norm, how accurate is it, what does it cost?");
  auto const methods = keeping_of(facts, true);
  document.say(norm_sentence(facts, methods));
  document.say(accuracy_sentence(facts, methods));
  document.say(cost_sentence(facts));
  Table table = winners(facts);
  if (!table.rows.empty()) document.add(std::move(table));
}

}  // namespace polhode::report
