#include "report/sections/speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "report/sections/sections.hpp"
#include "report/text.hpp"
#include "results/meta.hpp"

namespace polhode::report {
namespace {

using results::Record;

std::string_view pace_of(bool adaptive) {
  return adaptive ? "adaptive" : "equal steps";
}

std::string_view word_of(First first) {
  switch (first) {
    case First::ours:
      return "ours";
    case First::rival:
      return "rival";
    case First::undecided:
      return "undecided";
    default:
      return "nobody arrives";
  }
}

// ---- Who is first ---------------------------------------------------------------------------------------------------

/// "gauss8_lawson, 2.5 (2.4 to 2.6)": who, and how many times its time the best of the other side takes.
Entry winner_of(Race const& race) {
  Cost const *own = race.own(), *rival = race.rival();
  First const first = race.first();
  if (first == First::nobody) return {"nobody", ""};
  bool const ours = first == First::ours || (first == First::undecided && own->value <= rival->value);
  Cost const *winner = ours ? own : rival, *other = ours ? rival : own;
  std::string const name = fmt::format("{}: {}", ours ? "ours" : "rival", winner->run->of.integrator);
  if (!other) return name + (ours ? ", no rival arrives" : ", none of ours arrives");
  Estimate const ratio = quotient(*other, *winner);
  std::string const text = fmt::format("{}, {} ({})", name, significant(ratio.value), interval_of(ratio));
  return first == First::undecided ? text + ", undecided" : text;
}

void add_winner_map(Document& document, std::vector<Race> const& races) {
  Table table{.name = "speed-winners",
              .caption =
                  "Who is first to an attitude error, and how many times as long the best of the other side "
                  "takes (with its 95% interval): our best against the best of all libraries.",
              .columns = {{"problem"}, {"control"}}};
  for (double const target : speed_targets) table.columns.push_back({significant(target) + " rad"});
  std::size_t const targets = std::size(speed_targets);
  for (std::size_t i = 0; i + targets <= races.size(); i += targets) {
    std::vector<Entry> row{races[i].instance->label, std::string(pace_of(races[i].adaptive))};
    for (std::size_t k = 0; k < targets; ++k) row.push_back(winner_of(races[i + k]));
    table.rows.push_back(std::move(row));
  }
  document.add(std::move(table));
}

/// "free_body, 50 s, to 1e-9 rad".
std::string name_of(Race const& race) {
  return fmt::format("{} to {} rad", race.instance->label, significant(race.target));
}

/// How many races each side wins, and which: losses are listed as wins are.
void say_score(Document& document, std::vector<Race> const& races, bool adaptive) {
  std::map<First, std::vector<std::string>> won;
  std::size_t all = 0;
  for (Race const& race : races) {
    if (race.adaptive != adaptive) continue;
    ++all;
    won[race.first()].push_back(name_of(race));
  }
  if (all == 0) return;
  std::vector<std::string> words;
  auto const say = [&](First first, std::string_view what) {
    if (auto const& names = won[first]; !names.empty())
      words.push_back(fmt::format("{} in {} ({})", what, names.size(), fmt::join(names, "; ")));
  };
  say(First::ours, "one of ours is first");
  say(First::rival, "a rival is first");
  say(First::undecided, "the intervals do not tell");
  say(First::nobody, "nobody arrives");
  document.say(fmt::format("{}, {}: {}.", adaptive ? "Adaptive steps" : "Equal steps",
                           counted(all, "comparison", "comparisons"), fmt::join(words, "; ")));
}

// ---- In numbers -----------------------------------------------------------------------------------------------------

void push_side(std::vector<Entry>& row, Cost const* cost, bool adaptive) {
  row.emplace_back(cost ? method_of(cost->run->of) : "none arrives");
  row.emplace_back(cost ? control_of(cost->run->of) : absent);
  row.push_back(cost ? number(cost->run->attitude_error_max) : Entry(absent));
  row.push_back(cost ? cpu_time(cost->run->cpu_time_s) : Entry(absent));
  if (!adaptive) row.push_back(cost ? at_target(*cost, Measure::time) : Entry(absent));
}

void add_races(Document& document, std::vector<Race> const& races, bool adaptive) {
  std::string const how =
      adaptive ? "Steps chosen by the method: the cheapest tolerance that reaches the error, of those that were tried."
               : "Equal steps: the cheapest step that reaches the error. It was chosen with the error known, which no "
                 "user does: this is what a method can do, not what one gets. \"At the target\" is interpolated, in "
                 "logarithms, between that run and the next coarser one.";
  Table table{.name = adaptive ? "speed-adaptive" : "speed-fixed",
              .caption = fmt::format("{} Ratio: time of the best rival over time of our best{}; below 1 the rival is "
                                     "faster. Its interval is that of the two times.",
                                     how, adaptive ? "" : ", both at the target where they are interpolated"),
              .columns = {{"problem"}, {"target [rad]", true}, {"first"}}};
  for (char const* const side : {"ours", "best rival"}) {
    table.columns.push_back({side});
    table.columns.push_back({adaptive ? "tolerance" : "step"});
    table.columns.push_back({"its error", true});
    table.columns.push_back({"time", true});
    if (!adaptive) table.columns.push_back({"at the target", true});
  }
  table.columns.insert(table.columns.end(), {{"ratio", true}, {"95%"}});
  for (Race const& race : races) {
    if (race.adaptive != adaptive) continue;
    Cost const *own = race.own(), *rival = race.rival();
    std::vector<Entry> row{race.instance->label, number(race.target), std::string(word_of(race.first()))};
    push_side(row, own, adaptive);
    push_side(row, rival, adaptive);
    auto const ratio = own && rival ? std::optional(quotient(*rival, *own)) : std::nullopt;
    row.push_back(ratio ? number(ratio->value) : Entry(absent));
    row.emplace_back(ratio ? interval_of(*ratio) : absent);
    table.rows.push_back(std::move(row));
  }
  if (!table.rows.empty()) document.add(std::move(table));
}

void add_libraries(Document& document, std::vector<Race> const& races) {
  constexpr std::string_view libraries[] = {"Odeint", "GSL", "SUNDIALS"};
  Table table{.name = "speed-libraries",
              .caption =
                  "The best of each library, and its time over that of our best (below 1: the library is "
                  "faster).",
              .columns = {{"problem"}, {"control"}, {"target [rad]", true}, {"ours"}, {"time", true}}};
  for (std::string_view const library : libraries) {
    table.columns.push_back({std::string(library)});
    table.columns.push_back({"time", true});
    table.columns.push_back({"ratio", true});
  }
  for (Race const& race : races) {
    Cost const* own = race.own();
    auto const time = [](Cost const* cost) { return cost ? cpu_time(*cost) : absent; };
    auto const who = [](Cost const* cost) { return cost ? Entry(cost->run->of.integrator) : Entry("none arrives"); };
    std::vector<Entry> row{race.instance->label, std::string(pace_of(race.adaptive)), number(race.target), who(own),
                           time(own)};
    for (std::string_view const library : libraries) {
      Cost const* rival = race.rival(library);
      row.push_back(who(rival));
      row.push_back(time(rival));
      row.push_back(own && rival ? number(quotient(*rival, *own).value) : Entry(absent));
    }
    table.rows.push_back(std::move(row));
  }
  document.add(std::move(table));
}

// ---- Every method ---------------------------------------------------------------------------------------------------

/// What the sweeps of one method, of one kind of control, say of a target.
Entry arrival(std::vector<Sweep const*> const& sweeps, double target) {
  std::optional<Cost> best;
  bool arrives = false;
  for (Sweep const* sweep : sweeps) {
    auto const cost = time_to(*sweep, target);
    if (cost && (!best || cost->value < best->value)) best = cost;
    arrives = arrives || std::ranges::any_of(sweep->runs, [&](Record const* run) { return reaches(*run, target); });
  }
  if (best) return cpu_time(*best);
  return {arrives ? "not timed" : "never", ""};
}

void add_methods(Document& document, Instance const& instance, std::size_t n) {
  std::vector<Sweep> const sweeps = instance.sweeps();
  using Key = std::tuple<bool, bool, std::string>;  // adaptive, a rival, its name
  std::map<Key, std::vector<Sweep const*>> methods;
  for (Sweep const& sweep : sweeps)
    methods[{!sweep.like().h, is_rival(sweep.like().integrator), sweep.like().integrator}].push_back(&sweep);
  Table table{.name = fmt::format("speed-methods-{}", n),
              .caption = fmt::format("{}: every method's time to an error; \"never\" if none of its runs reached it. "
                                     "Failed are runs that did not end with status ok.",
                                     instance.label),
              .columns = {{"control"}, {"method"}, {"side"}}};
  for (double const target : speed_targets) table.columns.push_back({significant(target) + " rad", true});
  table.columns.insert(table.columns.end(), {{"least error [rad]", true}, {"runs", true}, {"failed", true}});
  for (auto const& [key, of] : methods) {
    auto const& [adaptive, rival, name] = key;
    std::size_t runs = 0, failed = 0;
    std::optional<double> least;
    for (Sweep const* sweep : of) {
      for (Record const* run : sweep->runs) {
        if (run->status == results::Status::refused) continue;
        ++runs;
        failed += is_ok(*run) ? 0U : 1U;
        auto const error = is_ok(*run) ? finite(run->attitude_error_max) : std::nullopt;
        if (error && (!least || *error < *least)) least = error;
      }
    }
    if (runs == 0) continue;
    std::vector<Entry> row{std::string(pace_of(adaptive)), name,
                           rival ? std::string(library_of(name)) : std::string("own")};
    for (double const target : speed_targets) row.push_back(arrival(of, target));
    row.push_back(number(least));
    row.emplace_back(std::to_string(runs));
    row.emplace_back(std::to_string(failed));
    table.rows.push_back(std::move(row));
  }
  document.add(std::move(table));
}

/// Closed forms: the fastest run of each, and what it leaves behind.
void add_closed_forms(Document& document, Facts const& facts, std::vector<Race> const& races) {
  Table table{.name = "speed-closed-form",
              .caption =
                  "Closed forms, which hold for this problem alone and take part in no race above: their "
                  "preparations and the state at the end. \"Best rival\" is the first library at equal steps to "
                  "1e-12 rad, or to the finest error that one reaches.",
              .columns = {{"problem"},
                          {"method"},
                          {"error [rad]", true},
                          {"time", true},
                          {"best rival"},
                          {"to [rad]", true},
                          {"time", true},
                          {"ratio", true}}};
  for (Instance const& instance : facts.instances) {
    Cost closed, rival;
    double target = 0;
    for (Race const& race : races) {
      if (race.instance != &instance || race.adaptive || !race.rival()) continue;
      rival = *race.rival();
      target = race.target;
    }
    for (Record const* run : instance.runs) {
      if (!is_closed_form(facts, run->of.integrator) || !is_ok(*run) || !run->cpu_time_s) continue;
      auto const& time = *run->cpu_time_s;
      if (!closed.run || time.median < closed.value) closed = {{time.median, time.low, time.high}, run};
    }
    if (!closed.run || !rival.run) continue;
    table.rows.push_back({instance.label, method_of(closed.run->of), number(closed.run->attitude_error_max),
                          cpu_time(closed.run->cpu_time_s), rival.run->of.integrator, number(target), cpu_time(rival),
                          number(quotient(rival, closed).value)});
  }
  if (!table.rows.empty()) document.add(std::move(table));
}

// ---- The machine ----------------------------------------------------------------------------------------------------

void add_machine(Document& document, std::vector<results::Meta> const& metas) {
  constexpr std::pair<char const*, char const*> facts[] = {
      {"cpu_model", "processor"},     {"cpu_mhz", "clock [MHz]"},
      {"cpu_governor", "governor"},   {"cpu_cache", "cache"},
      {"cpus_available", "CPUs"},     {"virtualised", "virtualised"},
      {"load", "load at the start"},  {"kernel", "kernel"},
      {"compiler", "compiler"},       {"flags", "flags"},
      {"fp_contract", "fp-contract"}, {"libraries", "libraries"},
      {"git_commit", "commit"},       {"git_dirty", "modified"},
      {"utc", "time (UTC)"}};
  Table table{.name = "speed-machine",
              .caption = "The machine, the compiler and the state of both when the times were taken.",
              .columns = {{"what"}, {"value"}}};
  for (auto const& [key, what] : facts) {
    auto const values = results::entries_of(metas, key);
    table.rows.push_back({what, values.empty() ? std::string("not told") : fmt::format("{}", fmt::join(values, "; "))});
  }
  document.add(std::move(table));
}

std::vector<results::Meta> all_metas(Facts const& facts) {
  std::vector<results::Meta> metas = facts.contents.metas;
  if (!facts.contents.benchmarks.all.empty()) metas.push_back(facts.contents.benchmarks.meta);
  return metas;
}

}  // namespace

void add_speed(Document& document, Facts const& facts) {
  document.section("Speed");
  std::vector<Race> const races = races_of(facts);
  if (races.empty()) {
    document.say(
        Text({{"No problem has runs of our own and of a library that were both timed, so nothing can be said of "
               "who is faster; "},
              {"polhode run speed", true},
              {" measures it."}}));
  } else {
    document.say(
        "Time of a whole solve, from its start to its end, nobody watching; everybody stops at the same times, the "
        "samples of the controller and the end. Errors are the largest attitude errors of the same run against the "
        "certified reference, at the ends of its steps. Equal steps and adaptive ones are compared apart.");
    document.say(timing_note(facts));
    add_winner_map(document, races);
    for (bool const adaptive : {false, true}) say_score(document, races, adaptive);
    for (bool const adaptive : {false, true}) add_races(document, races, adaptive);
    add_libraries(document, races);
    add_closed_forms(document, facts, races);
    document.heading(3, "Every method");
    std::size_t n = 0;
    Instance const* last = nullptr;
    for (Race const& race : races) {
      if (race.instance == last) continue;
      last = race.instance;
      add_methods(document, *last, ++n);
    }
  }
  add_benchmarks(document, facts);
  if (races.empty() && facts.contents.benchmarks.all.empty()) return;
  document.heading(3, "Timed on");
  add_machine(document, all_metas(facts));
}

}  // namespace polhode::report
