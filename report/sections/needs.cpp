#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

/// Attitude error that is asked for [rad].
constexpr double fine = 1e-9;

/// True if the drift is known and no more than round-off.
bool is_kept(std::optional<double> drift) {
  return finite(drift).value_or(kept) < kept;
}

/// How many bodies there are, as far as one of its runs says it.
std::int64_t bodies_of(Instance const& of) {
  std::int64_t most = 1;
  for (Record const* run : of.runs) most = std::max(most, run->bodies.value_or(1));
  return most;
}

/// True if the parameters say how many craft there are: a network made for its size.
bool is_sized(Instance const& of) {
  return bodies_of(of) > 1 && of.like().set.contains("n");
}

/// What somebody needs an integrator for, and the rule that chooses one.
struct Need {
  std::string_view name;
  std::string_view problem;      ///< where these records hold none
  std::string_view rule;         ///< in one sentence, after the problem
  std::optional<double> target;  ///< attitude error that is asked for [rad], where a reference tells it
  bool (*concerns)(Instance const& of);
  bool (*serves)(Record const& run);
  double (*extent)(Instance const& of);  ///< of several problems the one of greatest extent is asked
};

double no_extent(Instance const&) {
  return 0;
}

constexpr Need needs[] = {
    {"long free motion", "free_body",
     "norm, energy and |L| kept within 1e-13 over the longest motion here, then 1e-9 rad at the least cost", fine,
     [](Instance const& of) {
       Cell const& c = of.like();
       return c.problem == "free_body" || (c.problem == "tether_capture" && has_word(c.variant, "free"));
     },
     [](Record const& r) {
       return is_kept(r.norm_drift_max) && is_kept(r.energy_drift_max) && is_kept(r.momentum_drift_max);
     },
     [](Instance const& of) { return of.like().t_end; }},
    {"smooth loop", "pd_slew plain", "1e-9 rad at the least cost", fine,
     [](Instance const& of) { return is_headline(of.like(), headlines[1]); }, [](Record const&) { return true; },
     no_extent},
    {"sampled control", "tether_capture case1", "1e-9 rad at the least cost, steps ending on the samples", fine,
     [](Instance const& of) { return is_headline(of.like(), headlines[2]); }, [](Record const&) { return true; },
     no_extent},
    {"sliding mode",
     "dead_zone printed",
     "the end reached and no claim of the paper missed, at the least cost; what slides has no digits to compare",
     {},
     [](Instance const& of) { return of.like().problem == "dead_zone" && has_word(of.like().variant, "printed"); },
     [](Record const& r) {
       return std::ranges::none_of(r.claims,
                                   [](auto const& claim) { return claim.second.verdict == "not reproduced"; });
     },
     no_extent},
    {"fleets", "quaternion_sync", "1e-9 rad for every craft at the least cost", fine,
     [](Instance const& of) { return bodies_of(of) > 1 && !is_sized(of); }, [](Record const&) { return true; },
     no_extent},
    {"large fleets",
     "quaternion_sync, n",
     "the norm of every craft kept within 1e-13, at the least cost; nothing that large has a reference",
     {},
     is_sized,
     [](Record const& r) { return is_kept(r.norm_drift_max); },
     [](Instance const& of) { return static_cast<double>(bodies_of(of)); }},
};

/// The runs of a problem that may be recommended, and who of them does it at which cost.
struct Contest {
  std::string label;
  Measure measure = Measure::evaluations;
  std::set<std::string> ran;  ///< integrators that ended a run, whether or not it serves
  std::vector<Cost> ranked;
};

Contest contest_of(Need const& need, Instance const& instance) {
  Contest contest{instance.label, measure_of(instance), {}, {}};
  Instance serving{instance.label, {}};
  for (Record const* run : instance.runs) {
    if (!is_ok(*run) || is_foil(run->of.integrator)) continue;
    contest.ran.insert(run->of.integrator);
    if (need.serves(*run)) serving.runs.push_back(run);
  }
  contest.ranked = ranking(serving, need.target, contest.measure);
  return contest;
}

/// Of all problems that the need concerns the one to ask: of the greatest extent, with the problem's own parameters,
/// with most methods that serve.
std::optional<Contest> asked(Facts const& facts, Need const& need) {
  std::optional<Contest> best;
  std::tuple<bool, double, bool, std::size_t, std::size_t> most;
  for (Instance const& instance : facts.instances) {
    Cell const& c = instance.like();
    bool const usual = is_sized(instance) || c.set.empty();
    if (!need.concerns(instance) || is_aside(c)) continue;
    Contest contest = contest_of(need, instance);
    std::tuple const rank{contest.ran.size() > 1, need.extent(instance), usual, contest.ranked.size(),
                          contest.ran.size()};
    if (best && rank <= most) continue;
    most = rank;
    best = std::move(contest);
  }
  return best;
}

Entry cost_entry(Record const& run, Measure measure) {
  if (measure == Measure::time) return cpu_time(run.cpu_time_s);
  double const n = static_cast<double>(run.evaluations.value_or(0));
  return {fmt::format("{:.0f} evaluations", n), exact(n)};
}

std::string with_control(Cost const& cost) {
  return fmt::format("{}, {}", method_of(cost.run->of), control_of(cost.run->of));
}

/// "rk4 (quaternion), h = 0.05 s: × 1.25"
std::string other_words(Cost const& cost, Cost const& best) {
  std::string const factor = significant(cost.value / best.value);
  return fmt::format("{}: × {}{}", with_control(cost), factor, cost.low <= best.high ? " (tie)" : "");
}

std::string rival_words(std::vector<Cost> const& ranked) {
  Cost const& best = ranked.front();
  bool const rival_wins = is_rival(best.run->of.integrator);
  Cost const* other = first_of(ranked, !rival_wins);
  if (!other) return rival_wins ? "it is one; none of ours serves" : "none serves";
  return rival_wins ? "it is one; best of ours " + other_words(*other, best) : other_words(*other, best);
}

/// Why nothing is recommended.
std::string silence(std::optional<Contest> const& contest) {
  if (!contest) return "These records cannot say: they hold no such run.";
  if (contest->ran.empty()) return "These records cannot say: no such run ended well.";
  if (contest->ran.size() == 1) {
    return fmt::format("These records cannot say: nothing to compare with {}.", *contest->ran.begin());
  }
  return fmt::format("These records cannot say: none of {} has a run that serves.",
                     counted(contest->ran.size(), "integrator", "integrators"));
}

std::vector<Entry> row_of(Need const& need, std::optional<Contest> const& contest) {
  std::vector<Entry> row{std::string(need.name),
                         fmt::format("{}: {}", contest ? contest->label : std::string(need.problem), need.rule)};
  if (!contest || contest->ran.size() < 2 || contest->ranked.empty()) {
    row.emplace_back(silence(contest));
    return row;
  }
  auto const& ranked = contest->ranked;
  Cost const& best = ranked.front();
  row.emplace_back(with_control(best));
  row.push_back(number(finite(best.run->attitude_error_max)));
  row.push_back(number(finite(best.run->norm_drift_max), 2));
  row.push_back(cost_entry(*best.run, contest->measure));
  row.push_back(at_target(best, contest->measure));
  row.emplace_back(ranked.size() > 1 ? other_words(ranked[1], best) : "nobody else serves");
  row.emplace_back(rival_words(ranked));
  return row;
}

}  // namespace

void add_needs(Document& document, Facts const& facts) {
  if (facts.runs.empty()) return;
  document.say("Which method for which need?");
  Table table{.name = "needs",
              .caption =
                  "Of the runs that serve, the cheapest. × is the cost over that of the method to take, a tie "
                  "where the intervals of the two overlap.",
              .columns = {{"need"},
                          {"problem and rule"},
                          {"take"},
                          {"error [rad]", true},
                          {"norm drift", true},
                          {"cost", true},
                          {"at 1e-9 rad", true},
                          {"runner-up"},
                          {"best rival"}}};
  for (Need const& need : needs) {
    table.rows.push_back(row_of(need, asked(facts, need)));
    table.rows.back().resize(table.columns.size(), Entry(absent));
  }
  document.add(std::move(table));
  document.say(
      "The rows know these records alone. Costs are compared at 1e-9 rad where the run and the next coarser one of its "
      "sweep lie on either side of it, else as measured; the error is the largest over the run, the norm drift the "
      "delivered one. Deliberately careless methods are not chosen. Independent bodies in lanes are no runs: "
      "polhode-bench times them. " +
      timing_note(facts));
}

}  // namespace polhode::report
