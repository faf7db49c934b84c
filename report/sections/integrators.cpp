#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "report/located.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// Evaluations are counted near this step [s].
constexpr double usual_step = 0.1;
/// What is kept is seen near this one [s], where accuracy alone keeps nothing.
constexpr double coarse_step = 1;
/// Fewer points than these lie on a line whatever the order is.
constexpr std::size_t least_points = 3;
constexpr char const* not_measured = "not measured";

/// What is known of one integrator, and where it was measured.
struct Subject {
  std::string name;
  results::IntegratorFacts const* facts = nullptr;  ///< null if the folder says nothing
  std::vector<Record const*> runs;                  ///< all
  std::optional<Sweep> sweep;                       ///< with fixed steps: its order
  std::optional<results::OrderFit> order;           ///< of that sweep
  Record const* step = nullptr;                     ///< with fixed steps: its evaluations
  Record const* free = nullptr;                     ///< of a free body: what it keeps

  bool claims(std::string_view what) const {
    return facts && std::ranges::find(facts->preserves, what) != facts->preserves.end();
  }
};

double distance(Record const& run, double step) {
  return run.of.h && *run.of.h > 0 ? std::abs(std::log(*run.of.h / step)) : INFINITY;
}

int place_of_formulation(std::string_view formulation) {
  constexpr std::string_view first[] = {"quaternion", "s3", "so3"};
  return static_cast<int>(std::ranges::find(first, formulation) - std::begin(first));
}

/// Where to look first.
int place_in(std::initializer_list<std::string_view> problems, Cell const& cell) {
  return static_cast<int>(std::ranges::find(problems, cell.problem) - problems.begin());
}

bool is_plain(Cell const& cell) {
  return cell.policy == "none" && cell.set.empty() && !is_aside(cell);
}

/// Of the sweeps with fixed steps the one to show: one whose order is known, then by problem and formulation. A top
/// whose torque depends on the attitude flatters nobody; a slew to rest forgives errors, and a free body suits some.
void find_sweep(Subject& subject, Facts const& facts) {
  std::optional<std::tuple<bool, int, int>> best;
  for (Instance const& instance : facts.instances) {
    for (Sweep& sweep : instance.sweeps()) {
      Cell const& c = sweep.like();
      if (c.integrator != subject.name || !c.h || !is_plain(c)) continue;
      std::erase_if(sweep.runs, [](Record const* run) { return !is_ok(*run); });
      if (sweep.runs.empty()) continue;
      auto fit = order_of(sweep).fit;
      bool const unknown = !fit || fit->points < least_points;
      std::tuple const place(unknown, place_in({"heavy_top", "pd_slew", "free_body"}, c),
                             place_of_formulation(c.formulation));
      if (best && *best <= place) continue;
      best = place;
      subject.order = fit;
      subject.sweep = std::move(sweep);
    }
  }
}

/// Of the runs with fixed steps the one whose evaluations to show: on one problem and at one step, if they share them.
void find_step(Subject& subject) {
  auto const place = [](Record const& run) {
    return std::tuple(place_in({"pd_slew", "heavy_top", "free_body"}, run.of), place_of_formulation(run.of.formulation),
                      distance(run, usual_step));
  };
  for (Record const* run : subject.runs) {
    bool const tells =
        is_ok(*run) && run->of.h && is_plain(run->of) && run->evaluations && run->steps && *run->steps > 0;
    if (tells && (!subject.step || place(*run) < place(*subject.step))) subject.step = run;
  }
}

/// Of the successful runs of the free body: fixed steps first, the nearest to the coarse one; else the tightest
/// tolerance.
void find_free(Subject& subject, Facts const& facts) {
  Instance const* instance = facts.headline(headlines[0]);
  if (!instance) return;
  auto const place = [](Record const& run) {
    return std::tuple(!run.of.h, place_of_formulation(run.of.formulation), distance(run, coarse_step),
                      run.of.rtol.value_or(0));
  };
  for (Record const* run : instance->runs) {
    bool const tells = run->of.integrator == subject.name && run->of.policy == "none" && is_ok(*run) &&
                       finite(run->momentum_direction_max);
    if (tells && (!subject.free || place(*run) < place(*subject.free))) subject.free = run;
  }
}

/// Own methods first, then by family and name.
std::vector<Subject> subjects_of(Facts const& facts) {
  std::map<std::string, Subject> found;
  for (Record const* run : facts.runs) found[run->of.integrator].runs.push_back(run);
  std::vector<Subject> subjects;
  for (auto& [name, subject] : found) {
    subject.name = name;
    auto const known = facts.contents.catalogue.find(name);
    if (known != facts.contents.catalogue.end()) subject.facts = &known->second;
    find_sweep(subject, facts);
    find_step(subject);
    find_free(subject, facts);
    subjects.push_back(std::move(subject));
  }
  std::ranges::stable_sort(subjects, {}, [](Subject const& s) {
    return std::tuple(is_rival(s.name), s.facts ? s.facts->family : "", s.facts ? s.facts->order.value_or(0) : 0);
  });
  return subjects;
}

/// "3 diverged, 1 timeout": how the runs ended, if none ended well.
std::string ends_of(Subject const& subject) {
  std::map<std::string_view, int> ends;
  for (Record const* run : subject.runs) ++ends[name_of(run->status)];
  std::vector<std::string> words;
  for (auto const& [end, n] : ends) words.push_back(fmt::format("{} {}", n, end));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// "1.8e-16, claimed": the largest drift of a quantity, and whether the catalogue claims that it is kept.
Entry keeping_of(Subject const& subject, Invariant const& q) {
  auto const drift = subject.free ? finite(subject.free->*q.drift) : std::nullopt;
  bool const is_claimed = subject.claims(q.claim);
  if (!drift) return is_claimed ? fmt::format("claimed, {}", not_measured) : not_measured;
  Entry entry = number(drift, 2);
  if (is_claimed) entry.text += ", claimed";
  return entry;
}

/// With the problem and the step; exact in the CSV file.
Entry evaluations_of(Subject const& subject) {
  if (!subject.step) return not_measured;
  Record const& run = *subject.step;
  double const ratio = static_cast<double>(*run.evaluations) / static_cast<double>(*run.steps);
  return {fmt::format("{} ({}, {})", significant(ratio), run.of.problem, control_of(run.of)), exact(ratio)};
}

/// Where the order is from; of runs that all failed, how.
std::string place_of(Subject const& subject) {
  if (!std::ranges::any_of(subject.runs, [](Record const* run) { return is_ok(*run); })) return ends_of(subject);
  if (!subject.sweep) return "no fixed steps";
  Cell const& c = subject.sweep->like();
  return fmt::format("{}{}{}, {}", c.problem, c.variant.empty() ? "" : " ", c.variant, c.formulation);
}

Entry said(Subject const& s, std::string results::IntegratorFacts::*member) {
  return s.facts && !(s.facts->*member).empty() ? Entry(s.facts->*member) : Entry(absent);
}

Table order_table(std::vector<Subject> const& subjects) {
  Table table{.name = "integrators",
              .caption = fmt::format("Order, nominal and measured with fixed steps, and evaluations of the right-hand "
                                     "side. {} is what does not apply or is not known.",
                                     absent),
              .columns = {{"integrator"},
                          {"family"},
                          {"order", true},
                          {"measured", true},
                          {"± 95%", true},
                          {"points", true},
                          {"order measured on"},
                          {"evaluations per step"}}};
  for (Subject const& s : subjects) {
    bool const is_known = s.order && s.order->points >= least_points;
    table.rows.push_back({s.name, said(s, &results::IntegratorFacts::family),
                          s.facts && s.facts->order ? Entry(std::to_string(*s.facts->order)) : Entry(absent),
                          is_known ? Entry(slope_of(*s.order), exact(s.order->slope)) : Entry(absent),
                          is_known ? half_width_of(*s.order) : Entry(absent),
                          s.order ? Entry(std::to_string(s.order->points)) : Entry(absent), place_of(s),
                          evaluations_of(s)});
  }
  return table;
}

Table kept_table(std::vector<Subject> const& subjects) {
  Table table{.name = "integrators-kept",
              .caption = fmt::format("What each keeps of a free body: the largest drift, energy and |L| relative to "
                                     "their initial values, at the step nearest {} s, where accuracy alone keeps "
                                     "little; \"claimed\" if the catalogue says that it is kept. Symplectic and "
                                     "symmetric are claims alone, which no drift measures.",
                                     significant(coarse_step)),
              .columns = {{"integrator"}}};
  for (Invariant const& q : invariants) table.columns.push_back({fmt::format("{}{}", q.name, q.unit), true});
  table.columns.insert(table.columns.end(), {{"claimed structure"}, {"run"}, {"claims", false, true}});
  for (Subject const& s : subjects) {
    std::vector<Entry> row{s.name};
    for (Invariant const& q : invariants) row.push_back(keeping_of(s, q));
    std::vector<std::string> structure;
    for (auto const* what : {"symplectic", "symmetric"}) {
      if (s.claims(what)) structure.emplace_back(what);
    }
    row.emplace_back(structure.empty() ? absent : fmt::format("{}", fmt::join(structure, ", ")));
    row.emplace_back(s.free ? fmt::format("{}, {}", s.free->of.formulation, control_of(s.free->of)) : absent);
    row.emplace_back(s.facts ? fmt::format("{}", fmt::join(s.facts->preserves, " ")) : "");
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table source_table(std::vector<Subject> const& subjects) {
  Table table{.name = "integrators-sources",
              .caption = "Where each is from, and what to beware of.",
              .columns = {{"integrator"}, {"source"}, {"pitfall"}}};
  for (Subject const& s : subjects) {
    if (!s.facts) continue;
    table.rows.push_back(
        {s.name, said(s, &results::IntegratorFacts::source), said(s, &results::IntegratorFacts::pitfall)});
  }
  return table;
}

/// Claims that a run of the free body contradicts.
std::vector<std::string> contradictions(std::vector<Subject> const& subjects) {
  std::vector<std::string> words;
  for (Subject const& s : subjects) {
    for (Invariant const& q : invariants) {
      auto const drift = s.free ? finite(s.free->*q.drift) : std::nullopt;
      if (drift && *drift > kept && s.claims(q.claim)) {
        words.push_back(fmt::format("{} {}{} ({})", s.name, q.name, q.unit, significant(*drift, 2)));
      }
    }
  }
  return words;
}

void say_what_is_unknown(Document& document, Facts const& facts, std::vector<Subject> const& subjects) {
  if (facts.contents.catalogue.empty()) {
    document.say(
        Text({{"The folder has no "},
              {results::catalogue_file, true},
              {", which "},
              {"polhode run", true},
              {" writes beside the records: family, nominal order, claims, pitfall and source are not known."}}));
    return;
  }
  std::vector<std::string> unknown;
  for (Subject const& s : subjects) {
    if (!s.facts) unknown.push_back(s.name);
  }
  if (!unknown.empty()) document.say(fmt::format("The folder's catalogue does not know {}.", listed(unknown)));
}

}  // namespace

void add_integrators(Document& document, Facts const& facts) {
  document.section("Integrators");
  auto const subjects = subjects_of(facts);
  if (subjects.empty()) return document.say("The records hold no run.");
  document.say(
      fmt::format("Every integrator of these records. Order and evaluations per step are of fixed steps. Orders are of "
                  "the heavy top, whose torque depends on the attitude, else of pd_slew, which comes to rest and "
                  "forgives errors, else of the free body, which suits some methods better than their order says, else "
                  "of what there is; in quaternions, else on S^3 or SO(3). An order takes {} points whose slopes "
                  "agree, since two lie on a line whatever it is; methods of high order reach round-off before they "
                  "have as many. Evaluations are those at the step nearest {} s; 0 means that the method moves a free "
                  "body without asking for the torque. \"{}\" is what the records do not tell.",
                  least_points, significant(usual_step), not_measured));
  document.add(order_table(subjects));
  document.add(kept_table(subjects));
  if (Table sources = source_table(subjects); !sources.rows.empty()) document.add(std::move(sources));
  say_what_is_unknown(document, facts, subjects);
  auto const wrong = contradictions(subjects);
  bool const any_tested =
      std::ranges::any_of(subjects, [](Subject const& s) { return s.free && s.facts && !s.facts->preserves.empty(); });
  if (!wrong.empty()) {
    document.say(fmt::format("Claimed to be kept, and off by more than {} here: {}.", significant(kept),
                             fmt::join(wrong, ", ")));
  } else if (any_tested) {
    document.say(fmt::format("All that is claimed to be kept is kept within {} in these runs of the free body.",
                             significant(kept)));
  }
  add_conservation(document, facts);
}

}  // namespace polhode::report
