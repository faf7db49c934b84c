#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

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
  double worst = 0;
  std::optional<double> projected;  ///< delivered under a policy that projects
  std::size_t runs = 0;             ///< without projection
};

/// By integrator; `flat` for quaternions, otherwise the groups s3 and so3.
std::map<std::string, Keeping> keeping_of(Facts const& facts, bool flat) {
  std::map<std::string, Keeping> methods;
  for (Record const* run : facts.runs) {
    auto const drift = finite(run->norm_drift_max);
    std::string const& f = run->of.formulation;
    bool const wanted = flat ? f == "quaternion" : f == "s3" || f == "so3";
    if (!is_ok(*run) || !is_asked(run->of) || !drift || !wanted) continue;
    Keeping& k = methods[run->of.integrator];
    if (run->of.policy == "none") {
      k.worst = std::max(k.worst, *drift);
      ++k.runs;
    } else if (run->of.policy == "project") {
      k.projected = std::max(k.projected.value_or(0), *drift);
    }
  }
  std::erase_if(methods, [](auto const& item) { return item.second.runs == 0; });
  return methods;
}

/// Where a visible drift can come from, as far as these records show it.
std::vector<std::string> reasons(Facts const& facts, std::map<std::string, Keeping> const& methods) {
  auto const drifts = [&](std::string_view part) {
    return std::ranges::any_of(methods, [&](auto const& item) {
      return item.first.find(part) != std::string::npos && item.second.worst >= kept;
    });
  };
  std::vector<std::string> words;
  if (drifts("_sweeps")) words.emplace_back("too few sweeps");
  if (drifts("_tol")) words.emplace_back("a loose tolerance");
  bool const raw = std::ranges::any_of(facts.runs, [](Record const* run) {
    return is_ok(*run) && has_word(run->of.variant, "raw_q0") && finite(run->norm_drift_max).value_or(0) >= kept;
  });
  if (raw) words.emplace_back("unnormalised initial data");
  return words;
}

/// Who of those that keep the norm does not claim it, if the catalogue knows all of them.
std::string by_accuracy_alone(Facts const& facts, std::vector<std::string> const& keepers) {
  std::vector<std::string> accurate;
  for (std::string const& name : keepers) {
    auto const known = facts.contents.catalogue.find(name);
    if (known == facts.contents.catalogue.end()) return "";
    auto const& claims = known->second.preserves;
    if (std::ranges::find(claims, "norm") == claims.end()) accurate.push_back(name);
  }
  if (accurate.empty()) return "";
  return fmt::format(" ({} by accuracy, not by construction)", shortened(accurate, 5));
}

std::string norm_sentence(Facts const& facts, std::map<std::string, Keeping> const& methods) {
  if (methods.empty()) {
    return "Which integrator keeps the norm cannot be said: the records hold no successful run in quaternions, without "
           "projection, of free_body or of tether_capture's variants free and case1.";
  }
  std::vector<std::string> keepers;
  double largest = 0;
  for (auto const& [name, k] : methods) {
    if (k.worst >= kept) continue;
    keepers.push_back(name);
    largest = std::max(largest, k.worst);
  }
  std::string text = "Without projection no integrator here keeps |q.q - 1| within 1e-13";
  if (!keepers.empty()) {
    text = fmt::format("Without projection {} {} |q.q - 1| within {}", shortened(keepers, 5),
                       keepers.size() == 1 ? "keeps" : "keep", significant(largest, 2));
    text += by_accuracy_alone(facts, keepers);
  }
  auto const groups = keeping_of(facts, false);
  bool const all = std::ranges::all_of(groups, [](auto const& item) { return item.second.worst < kept; });
  if (!groups.empty() && all) text += ", as does every method on s3 and so3";
  if (keepers.size() == methods.size()) return text + ".";
  auto const worst = std::ranges::max_element(methods, {}, [](auto const& item) { return item.second.worst; });
  text += fmt::format("; {}{} ({})", keepers.empty() ? "worst is " : "the others drift, worst ", worst->first,
                      significant(worst->second.worst, 2));
  auto const why = reasons(facts, methods);
  if (why.empty()) return text + ".";
  return text + fmt::format(": the visible violation of Xu et al. (2017) means {}.", listed(why, "or"));
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

/// The step to quote errors at.
std::optional<double> quoted_step(Instance const& instance) {
  std::map<double, std::set<std::string>> methods;
  for (Record const* run : instance.runs) {
    if (run->of.formulation == "quaternion" && is_ok(*run) && run->of.h && finite(run->attitude_error_max)) {
      methods[*run->of.h].insert(run->of.integrator);
    }
  }
  return common_step(methods);
}

std::vector<Instance const*> asked_instances(Facts const& facts) {
  std::vector<Instance const*> asked;
  for (Instance const& instance : facts.instances) {
    if (is_asked(instance.like()) && !is_aside(instance.like())) asked.push_back(&instance);
  }
  return asked;
}

/// What projection does to the method whose norm suffers most, at one step.
std::string projection_clause(std::vector<Pair> const& pairs, std::optional<double> h) {
  Pair const* worst = nullptr;
  for (Pair const& pair : pairs) {
    if (pair.none->of.h != h || pair.none->of.formulation != "quaternion") continue;
    auto const drift = [](Pair const& p) { return finite(p.none->norm_drift_max).value_or(0); };
    if (!worst || drift(pair) > drift(*worst)) worst = &pair;
  }
  if (!worst) return "no run was made both with and without projection at that step";
  return fmt::format("projection cures the norm{}: {} is off by {} rad without it and {} rad with it",
                     worst->changed() ? " and moves the attitude" : ", not the attitude", worst->none->of.integrator,
                     significant(*worst->none->attitude_error_max), significant(*worst->project->attitude_error_max));
}

std::string accuracy_sentence(Facts const& facts, std::map<std::string, Keeping> const& methods) {
  auto asked = asked_instances(facts);
  // where projection was tried, both halves of the sentence are about one motion
  std::ranges::stable_sort(asked, std::greater{}, [](Instance const* instance) { return pairs_of(*instance).size(); });
  for (Instance const* instance : asked) {
    auto const h = quoted_step(*instance);
    Record const* shown = nullptr;
    auto const merit = [&](Record const& run) {
      auto const found = methods.find(run.of.integrator);
      bool const keeps = found != methods.end() && found->second.worst < kept;
      return std::tuple(keeps, run.of.integrator == "gauss2", -*run.attitude_error_max);
    };
    for (Record const* run : instance->runs) {
      Cell const& c = run->of;
      bool const wanted = c.formulation == "quaternion" && c.policy == "none" && c.h == h;
      if (!h || !wanted || !is_ok(*run) || !finite(run->attitude_error_max)) continue;
      if (!shown || merit(*run) > merit(*shown)) shown = run;
    }
    if (!shown) continue;
    return fmt::format("On {}, at h = {} s {} points within {}{}; {}.", instance->label, significant(*h),
                       shown->of.integrator, angle(*shown->attitude_error_max),
                       below_bar(*shown) ? ", below the reference's bar" : "",
                       projection_clause(pairs_of(*instance), h));
  }
  return "How accurate it is cannot be said: no such run was compared with a reference.";
}

/// How often projection moved the attitude error, over all pairs.
std::string pairs_sentence(Facts const& facts) {
  std::vector<Pair> pairs;
  for (Instance const* instance : asked_instances(facts)) {
    for (Pair const& pair : pairs_of(*instance)) pairs.push_back(pair);
  }
  if (pairs.empty()) return "No run was made both with and without projection, at equal step.";
  auto const changed = static_cast<std::size_t>(std::ranges::count_if(pairs, &Pair::changed));
  std::string const text = fmt::format(
      "Of {} that differ by projection alone, {} in attitude error by more than 10% and the reference's bar",
      counted(pairs.size(), "pair of runs", "pairs of runs"),
      changed == 0 ? "none differs" : counted(changed, "differs", "differ"));
  if (changed == 0) return text + ".";
  Pair const& most = *std::ranges::max_element(pairs, {}, [](Pair const& pair) {
    return pair.changed() ? std::abs(std::log(std::max(pair.ratio(), 1e-300))) : 0.0;
  });
  return text + fmt::format(", most {} at {}: {} times what it is without.", method_of(most.none->of),
                            control_of(most.none->of), significant(most.ratio(), 2));
}

Table norm_table(Facts const& facts) {
  Table table{.name = "norm",
              .caption =
                  "Largest norm drift of each integrator over its runs of free motion and of the paper's first "
                  "strategy, coarse steps and loose tolerances included. Kept means: below 1e-13 in every run.",
              .columns = {{"integrator"},
                          {"coordinates"},
                          {"without projection", true},
                          {"with projection", true},
                          {"runs without", true},
                          {"kept without"}}};
  for (bool const flat : {true, false}) {
    auto const methods = keeping_of(facts, flat);
    std::vector<std::pair<std::string, Keeping>> sorted(methods.begin(), methods.end());
    std::ranges::stable_sort(sorted, {}, [](auto const& item) { return item.second.worst; });
    for (auto const& [name, k] : sorted) {
      table.rows.push_back({name, flat ? "quaternion" : "s3, so3", number(k.worst, 2), number(k.projected, 2),
                            std::to_string(k.runs), k.worst < kept ? "yes" : "no"});
    }
  }
  return table;
}

}  // namespace

void add_answer(Document& document, Facts const& facts) {
  document.section("The answer");
  add_needs(document, facts);
  document.say("Which integrator keeps the norm, how accurate is it, what does it cost?");
  auto const methods = keeping_of(facts, true);
  document.say(norm_sentence(facts, methods));
  document.say(accuracy_sentence(facts, methods));
  document.say(cost_sentence(facts));
  add_headline(document, facts);
  Table table = norm_table(facts);
  if (!table.rows.empty()) {
    document.add(std::move(table));
    document.say(pairs_sentence(facts));
  }
  add_winners(document, facts);
}

}  // namespace polhode::report
