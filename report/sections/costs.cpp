#include <fmt/format.h>

#include <algorithm>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

Entry cost_entry(Cost const& cost, Measure measure) {
  Entry entry =
      measure == Measure::time ? cpu_time(cost) : Entry(significant(cost.value, 4) + " evaluations", exact(cost.value));
  if (cost.interpolated) entry.text = "≈ " + entry.text;
  return entry;
}

/// Who reaches one accuracy on one problem at the least cost, if anybody does.
struct Verdict {
  std::optional<Cost> best;
  std::optional<Cost> opponent;  ///< the best of the other camp: rivals if an own method wins, and vice versa

  bool rival_wins() const { return best && is_rival(best->run->of.integrator); }
  bool tied() const { return opponent && opponent->low <= best->high; }
};

Verdict verdict_on(std::vector<Cost> const& ranked) {
  Verdict v;
  if (ranked.empty()) return v;
  v.best = ranked.front();
  if (Cost const* other = first_of(ranked, !v.rival_wins())) v.opponent = *other;
  return v;
}

/// The two targets of one problem [rad].
constexpr double coarse_target = 1e-6, fine_target = 1e-9;

/// "1.83 and 4.65 µs", "0.9 ms", "200 and 500 evaluations".
std::string both_costs(std::vector<Verdict> const& verdicts, Measure measure) {
  std::vector<std::string> texts;
  for (Verdict const& v : verdicts) {
    texts.push_back(measure == Measure::time ? duration(v.best->value, 2)
                                             : significant(v.best->value, 3) + " evaluations");
  }
  // a unit that both have is said once
  if (texts.size() == 2) {
    auto const first = texts[0].find(' '), second = texts[1].find(' ');
    if (texts[0].substr(first) == texts[1].substr(second)) texts[0].erase(first);
  }
  return listed(texts);
}

/// Who wins on one problem, and by how much: "(cf4, dopri5; best rival 1.3 and 1.07 times that)".
std::string both_winners(std::vector<Verdict> const& verdicts, bool in_full) {
  std::vector<std::string> names, factors;
  std::size_t rivals = 0;
  for (Verdict const& v : verdicts) {
    std::string const name = v.best->run->of.integrator;
    rivals += v.rival_wins() ? 1U : 0U;
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    if (v.opponent) factors.push_back(significant(v.opponent->value / v.best->value) + (v.tied() ? " (a tie)" : ""));
  }
  bool const mixed = rivals > 0 && rivals < verdicts.size();
  std::string const who = rivals == 0 ? "" : mixed ? "rivals included: " : names.size() > 1 ? "rivals " : "rival ";
  std::string const other = mixed ? "the other side" : rivals > 0 ? "ours" : "best rival";
  std::string text = fmt::format("({}{}; ", who, fmt::join(names, ", "));
  if (factors.empty()) return text + (rivals > 0 ? "no own method does)" : "no rival does)");
  return text + fmt::format("{} {}{})", other, listed(factors), in_full ? " times that" : "");
}

}  // namespace

std::string cost_sentence(Facts const& facts) {
  std::vector<std::string> parts;
  bool timed = true;
  for (Headline const& headline : headlines) {
    Instance const* instance = facts.headline(headline);
    if (!instance) continue;
    Measure const measure = measure_of(*instance);
    Verdict const coarse = verdict_on(ranking(*instance, coarse_target, measure));
    Verdict const fine = verdict_on(ranking(*instance, fine_target, measure));
    std::vector<Verdict> reached;
    for (Verdict const& v : {coarse, fine}) {
      if (v.best) reached.push_back(v);
    }
    if (reached.empty()) continue;
    timed = timed && measure == Measure::time;
    bool const is_first = parts.empty();
    std::string text = fmt::format("{}{} {} {}", headline.words, is_first ? " takes" : "", both_costs(reached, measure),
                                   both_winners(reached, is_first));
    if (!coarse.best) text += " to 1e-9 alone";
    if (!fine.best) text += ", nothing reaching 1e-9";
    parts.push_back(std::move(text));
  }
  if (parts.empty()) {
    return "What it costs cannot be said: no run of free_body, pd_slew or tether_capture's case1 is known to reach an "
           "attitude error of 1e-6 rad with its work counted.";
  }
  return fmt::format("To 1e-6 and 1e-9 rad {}{}.", fmt::join(parts, ", "),
                     timed ? "" : "; evaluations are counted where nothing was timed");
}

void add_winners(Document& document, Facts const& facts) {
  Table table{.name = "answer",
              .caption = Text(
                  "Cheapest way to a given attitude error (largest over the run), own methods against rivals. Costs "
                  "marked ≈ are interpolated between two runs, in logarithms; \"tie\" means that the intervals of the "
                  "two medians overlap. " +
                  timing_note(facts)),
              .columns = {{"problem"},
                          {"attitude error [rad]", true},
                          {"[arcsec]", true},
                          {"winner"},
                          {"cost", true},
                          {"low", true, true},
                          {"high", true, true},
                          {"best of the other side"},
                          {"cost", true},
                          {"low", true, true},
                          {"high", true, true},
                          {"factor", true}}};
  for (Instance const& instance : facts.instances) {
    if (!instance.comparable() || is_aside(instance.like())) continue;
    Measure const measure = measure_of(instance);
    for (double const target : {coarse_target, fine_target}) {
      Verdict const v = verdict_on(ranking(instance, target, measure));
      std::vector<Entry> row{instance.label, number(target), number(arcseconds(target))};
      for (auto const& cost : {v.best, v.opponent}) {
        row.push_back(cost ? Entry(method_of(cost->run->of)) : Entry("nobody"));
        row.push_back(cost ? cost_entry(*cost, measure) : Entry(absent));
        row.push_back(cost ? number(cost->low) : Entry(absent));
        row.push_back(cost ? number(cost->high) : Entry(absent));
      }
      Entry factor = v.opponent ? number(v.opponent->value / v.best->value) : Entry(absent);
      if (v.tied()) factor.text += " (tie)";
      row.push_back(std::move(factor));
      table.rows.push_back(std::move(row));
    }
  }
  if (!table.rows.empty()) document.add(std::move(table));
}

}  // namespace polhode::report
