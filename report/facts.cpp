#include "report/facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include "report/render/palette.hpp"

namespace polhode::report {
namespace {

using results::Cell;
using results::Record;

std::vector<std::string> words_of(std::string_view variant) {
  std::vector<std::string> words;
  std::size_t start = 0;
  while (start <= variant.size() && !variant.empty()) {
    std::size_t const end = std::min(variant.find(',', start), variant.size());
    words.emplace_back(variant.substr(start, end - start));
    start = end + 1;
  }
  return words;
}

/// The name of an initial value problem; with enough digits it is also its identity.
std::string label_of(Cell const& c, int digits = 6) {
  std::string label = c.problem;
  if (!c.variant.empty()) label += " " + c.variant;
  for (auto const& [name, values] : c.set) {
    std::vector<std::string> numbers;
    for (double const v : values) numbers.push_back(significant(v, digits));
    std::string const all = fmt::format("{}", fmt::join(numbers, " "));
    label += fmt::format(", {} = {}", name, numbers.size() == 1 ? all : "(" + all + ")");
  }
  if (c.t_end > 0) label += fmt::format(", {} s", significant(c.t_end, digits));
  if (c.seed != 1) label += fmt::format(", seed {}", c.seed);
  return label;
}

/// Large steps and loose tolerances first; what has neither comes last.
double coarseness(Cell const& c) {
  return finite(c.h).value_or(finite(c.rtol).value_or(0));
}

/// The cost of the target itself: on the straight line, in logarithms, between the run and a coarser one of its sweep
/// that misses the target. Absent if the two do not bracket it.
std::optional<Estimate> between(Record const& run, Record const& coarser, double target, Measure measure) {
  auto const fine = cost_of(run, measure), coarse = cost_of(coarser, measure);
  if (!fine || !coarse || !is_ok(coarser) || below_bar(run) || below_bar(coarser)) return {};
  double const e1 = finite(run.attitude_error_max).value_or(0), e0 = finite(coarser.attitude_error_max).value_or(0);
  if (!(e1 > 0 && e0 > target && e1 <= target && coarse->value <= fine->value)) return {};
  double const share = std::log(target / e1) / std::log(e0 / e1);
  auto const mean = [&](double a, double b) { return std::exp((1 - share) * std::log(a) + share * std::log(b)); };
  return Estimate{mean(fine->value, coarse->value), mean(fine->low, coarse->low), mean(fine->high, coarse->high)};
}

/// Place of an instance in every list; what is set or aside comes after what is asked.
std::size_t rank_of(Cell const& c) {
  std::size_t rank = 0;
  for (Headline const& h : headlines) {
    if (is_headline(c, h) && c.set.empty() && !is_aside(c)) return rank;
    ++rank;
  }
  return rank;
}

/// A place for each integrator, from which its colour and its symbol follow: those that ran on most problems choose
/// first, and each takes the colour that it shares with others in the fewest pictures.
std::map<std::string, int> styles_of(std::vector<Instance> const& instances) {
  using Picture = std::pair<Instance const*, std::string>;  // a problem in one formulation
  std::map<std::string, std::set<Picture>> where;
  for (Instance const& instance : instances) {
    for (Record const* run : instance.runs) {
      auto& pictures = where[run->of.integrator];
      if (run->status != results::Status::refused) pictures.emplace(&instance, run->of.formulation);
    }
  }
  std::vector<std::string> names;
  for (auto const& [name, pictures] : where) names.push_back(name);
  std::ranges::stable_sort(names, std::greater{},
                           [&](std::string const& name) { return std::pair(where[name].size(), !is_rival(name)); });
  std::array<std::vector<std::string>, curve_colours.size()> of_colour;
  std::map<std::string, int> looks;
  for (std::string const& name : names) {
    auto const shared = [&](std::vector<std::string> const& others) {
      std::size_t n = 0;
      for (std::string const& other : others) {
        for (Picture const& picture : where[other]) n += where[name].count(picture);
      }
      return std::pair(n, others.size());
    };
    auto* const best = std::ranges::min_element(of_colour, {}, shared);
    looks[name] =
        static_cast<int>(static_cast<std::size_t>(best - of_colour.begin()) + of_colour.size() * best->size());
    best->push_back(name);
  }
  return looks;
}

}  // namespace

bool is_rival(std::string_view integrator) {
  constexpr std::string_view prefixes[] = {"odeint_", "cvode_", "arkode_", "gsl_"};
  return integrator == "ida" || std::ranges::any_of(prefixes, [&](auto p) { return integrator.starts_with(p); });
}

bool is_foil(std::string_view integrator) {
  return integrator.starts_with("gauss2_sweeps") || integrator.starts_with("gauss2_tol");
}

bool has_word(std::string_view variant, std::string_view word) {
  auto const words = words_of(variant);
  return std::ranges::find(words, word) != words.end();
}

std::string without_word(std::string_view variant, std::string_view word) {
  auto words = words_of(variant);
  std::erase(words, word);
  return fmt::format("{}", fmt::join(words, ","));
}

std::optional<double> finite(std::optional<double> value) {
  return value && std::isfinite(*value) ? value : std::nullopt;
}

bool is_ok(Record const& run) {
  return run.status == results::Status::ok;
}

bool reaches(Record const& run, double target) {
  auto const error = finite(run.attitude_error_max);
  return is_ok(run) && error && *error <= target && finite(run.reference_bar).value_or(0) <= target;
}

bool below_bar(Record const& run) {
  auto const error = finite(run.attitude_error_max), bar = finite(run.reference_bar);
  return error && bar && *error <= *bar;
}

std::string control_of(Cell const& cell) {
  if (cell.h) return fmt::format("h = {} s", significant(*cell.h, 4));
  if (!cell.rtol) return "no step or tolerance";
  std::string text = fmt::format("rtol = {}", significant(*cell.rtol, 4));
  if (cell.atol) text += fmt::format(", atol = {}", significant(*cell.atol, 4));
  return text;
}

std::string method_of(Cell const& cell) {
  std::string text = fmt::format("{} ({}", cell.integrator, cell.formulation);
  if (cell.policy != "none") text += ", " + cell.policy;
  return text + ")";
}

std::vector<Sweep> Instance::sweeps() const {
  std::map<std::tuple<bool, std::string, std::string, std::string, bool>, Sweep> sweeps;
  for (Record const* run : runs) {
    Cell const& c = run->of;
    sweeps[{is_rival(c.integrator), c.integrator, c.formulation, c.policy, c.h.has_value()}].runs.push_back(run);
  }
  std::vector<Sweep> sorted;
  for (auto& [key, sweep] : sweeps) {
    std::ranges::stable_sort(sweep.runs, std::greater{}, [](Record const* run) { return coarseness(run->of); });
    sorted.push_back(std::move(sweep));
  }
  return sorted;
}

bool Instance::comparable() const {
  std::set<std::string> integrators;
  for (Sweep const& sweep : sweeps()) {
    auto const scored = std::ranges::count_if(
        sweep.runs, [](Record const* run) { return is_ok(*run) && finite(run->attitude_error_max); });
    if (scored > 0) integrators.insert(sweep.like().integrator);
    if (scored >= 3) return true;
  }
  return integrators.size() >= 2;
}

bool is_headline(Cell const& c, Headline const& h) {
  return c.problem == h.problem && (h.word.empty() || c.variant.empty() || has_word(c.variant, h.word));
}

bool is_aside(Cell const& cell) {
  constexpr std::string_view words[] = {"coupled", "as_printed", "unlocated"};
  return std::ranges::any_of(words, [&](auto word) { return has_word(cell.variant, word); });
}

std::optional<Estimate> cost_of(Record const& run, Measure measure) {
  if (measure == Measure::evaluations) {
    if (!run.evaluations || *run.evaluations <= 0) return {};
    auto const n = static_cast<double>(*run.evaluations);
    return Estimate{n, n, n};
  }
  if (!run.cpu_time_s || !std::isfinite(run.cpu_time_s->median) || run.cpu_time_s->median <= 0) return {};
  auto const& t = *run.cpu_time_s;
  bool const interval = t.low > 0 && std::isfinite(t.high) && t.low <= t.median && t.median <= t.high;
  return interval ? Estimate{t.median, t.low, t.high} : Estimate{t.median, t.median, t.median};
}

std::optional<Cost> cheapest(Sweep const& sweep, std::optional<double> target, Measure measure) {
  std::optional<Cost> best;
  for (std::size_t i = 0; i < sweep.runs.size(); ++i) {
    Record const& run = *sweep.runs[i];
    auto const cost = cost_of(run, measure);
    bool const serves = target ? reaches(run, *target) : is_ok(run);
    if (!cost || !serves || (best && best->measured <= cost->value)) continue;
    auto const at_the_target = i > 0 && target ? between(run, *sweep.runs[i - 1], *target, measure) : std::nullopt;
    best = Cost{at_the_target.value_or(*cost), &run, cost->value, at_the_target.has_value()};
  }
  return best;
}

std::vector<Cost> ranking(Instance const& instance, std::optional<double> target, Measure measure) {
  std::map<std::string, Cost> best;
  for (Sweep const& sweep : instance.sweeps()) {
    auto const cost = cheapest(sweep, target, measure);
    if (!cost) continue;
    auto const [at, is_new] = best.try_emplace(sweep.like().integrator, *cost);
    if (!is_new && cost->value < at->second.value) at->second = *cost;
  }
  std::vector<Cost> sorted;
  for (auto const& [name, cost] : best) sorted.push_back(cost);
  std::ranges::stable_sort(sorted, {}, &Cost::value);
  return sorted;
}

Cost const* first_of(std::vector<Cost> const& ranked, bool rivals) {
  auto const found =
      std::ranges::find_if(ranked, [&](Cost const& cost) { return is_rival(cost.run->of.integrator) == rivals; });
  return found == ranked.end() ? nullptr : &*found;
}

Entry at_target(Cost const& cost, Measure measure) {
  if (!cost.interpolated) return absent;
  if (measure == Measure::time) return cpu_time(cost);
  return {significant(cost.value, 4), exact(cost.value)};
}

Measure measure_of(Instance const& instance) {
  bool const timed = std::ranges::any_of(
      instance.runs, [](Record const* run) { return is_ok(*run) && cost_of(*run, Measure::time).has_value(); });
  return timed ? Measure::time : Measure::evaluations;
}

std::optional<double> common_step(std::map<double, std::set<std::string>> const& methods) {
  std::size_t most = 0;
  for (auto const& [h, names] : methods) most = std::max(most, names.size());
  std::optional<double> best;
  auto const distance = [](double h) { return std::abs(std::log10(h / 0.1)); };
  for (auto const& [h, names] : methods) {
    bool const shared = names.size() == most || (most > 2 && names.size() + 1 == most);
    if (shared && (!best || distance(h) < distance(*best))) best = h;
  }
  return best;
}

Facts::Facts(results::Contents const& all) : contents(all) {
  std::map<std::string, std::size_t> at;
  for (Record const& run : all.records) {
    auto const [place, is_new] = at.try_emplace(run.cell, runs.size());
    if (is_new) {
      runs.push_back(&run);
    } else {
      runs[place->second] = &run;
      ++superseded;
    }
  }
  std::map<std::string, std::size_t> index;
  for (Record const* run : runs) {
    auto const [place, is_new] = index.try_emplace(label_of(run->of, 17), instances.size());
    if (is_new) instances.push_back({label_of(run->of), {}});
    instances[place->second].runs.push_back(run);
  }
  std::ranges::stable_sort(instances, {}, [](Instance const& i) { return std::pair(rank_of(i.like()), i.label); });
  styles_ = styles_of(instances);
  for (results::Series const& series : all.series) series_[{series.cell, series.name}] = &series;
}

results::Series const* Facts::series_of(Record const& run, std::string_view name) const {
  auto const found = series_.find({run.cell, std::string(name)});
  return found == series_.end() ? nullptr : found->second;
}

Instance const* Facts::headline(Headline const& which) const {
  auto const at = static_cast<std::size_t>(&which - headlines);
  auto const found = std::ranges::find_if(instances, [&](Instance const& i) { return rank_of(i.like()) == at; });
  return found == instances.end() ? nullptr : &*found;
}

Style Facts::style_of(Cell const& cell) const {
  auto const found = styles_.find(cell.integrator);
  bool const adaptive = !cell.h, policy = cell.policy != "none";
  return {.index = found == styles_.end() ? 0 : found->second,
          .dash = adaptive ? (policy ? Dash::dash_dot : Dash::dashed)
                  : policy ? Dash::dotted
                           : Dash::solid,
          .open = is_rival(cell.integrator)};
}

std::optional<std::size_t> column_of(results::Series const& series, std::string_view name) {
  auto const at = std::ranges::find(series.columns, name);
  if (at == series.columns.end()) return {};
  return static_cast<std::size_t>(at - series.columns.begin());
}

}  // namespace polhode::report
