#include "bench/input/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <unordered_map>
#include <utility>

#include "bench/input/suite_expect.hpp"
#include "bench/input/suite_graphs.hpp"
#include "bench/input/suite_toml.hpp"
#include "problems/parameters.hpp"

namespace polhode::bench {
namespace {

using namespace suite_toml;
using results::Cell;

// --- Sweeps ----------------------------------------------------------------------------------------------------------

/// One setting of the step control.
struct StepControl {
  std::optional<double> h, rtol, atol;
};

/// An integrator with a control that suits it.
using Method = std::pair<std::string, StepControl>;

void check_size(Toml const& at, std::size_t cells) {
  if (cells > max_cells) fail(at, fmt::format("more than {} cells; shorten the axes or split the suite", max_cells));
}

void check_product(Toml const& at, std::size_t a, std::size_t b) {
  bool const too_many = b != 0 && a > max_cells / b;
  check_size(at, too_many ? max_cells + 1 : a * b);
}

/// Every cell with every choice of one more axis.
template <class Choice, class Apply>
std::vector<Cell> cross(Toml const& at, std::vector<Cell> const& cells, std::vector<Choice> const& choices,
                        Apply const& apply) {
  check_product(at, cells.size(), choices.size());
  std::vector<Cell> all;
  all.reserve(cells.size() * choices.size());
  for (auto const& cell : cells) {
    for (auto const& choice : choices) apply(all.emplace_back(cell), choice);
  }
  return all;
}

template <class Member>
auto assign(Member Cell::*member) {
  return [member](Cell& cell, Member const& value) { cell.*member = value; };
}

/// The controls that a sweep gives, whether or not an integrator can use them.
std::vector<StepControl> read_controls(Toml const& sweep) {
  auto const* h = find(sweep, "h");
  auto const* rtol = find(sweep, "rtol");
  auto const* atol = find(sweep, "atol");
  if (atol && !rtol) fail(*atol, "atol without rtol: give both, or rtol alone");
  if (!h && !rtol) fail(sweep, "[[sweep]]: give h (fixed steps) or rtol (adaptive)");
  std::vector<StepControl> controls;
  if (h) {
    for (double const step : positive_axis(*h, "h")) controls.push_back({step, {}, {}});
  }
  if (rtol) {
    auto const relative = positive_axis(*rtol, "rtol");
    std::vector<std::optional<double>> absolute{std::nullopt};
    if (atol) {
      auto const given = positive_axis(*atol, "atol");
      absolute.assign(given.begin(), given.end());
    }
    check_product(sweep, relative.size(), absolute.size());
    for (double const r : relative) {
      for (auto const& a : absolute) controls.push_back({{}, r, a});
    }
  }
  return controls;
}

/// Each integrator with the controls that suit it. A control that suits none of them is an error.
std::vector<Method> read_methods(Toml const& sweep, Vocabulary const& vocabulary) {
  auto const& axis = need(sweep, "[[sweep]]", "integrator", "integrator = [\"rk4\"]");
  std::vector<IntegratorWord const*> integrators;
  for (auto const* item : items(axis, "integrator")) {
    auto const name = text(*item, "integrator");
    if (!is_glob(name)) {
      integrators.push_back(located(*item, [&] { return &vocabulary.integrator(name); }));
      continue;
    }
    std::size_t const before = integrators.size();
    for (IntegratorWord const& word : vocabulary.integrators)
      if (glob(name, word.name)) integrators.push_back(&word);
    if (integrators.size() == before) fail(*item, "integrator: no name matches " + name);
  }
  auto const controls = read_controls(sweep);
  check_product(sweep, integrators.size(), controls.size());
  std::vector<Method> methods;
  bool any_fixed = false;
  bool any_adaptive = false;
  for (auto const* integrator : integrators) {
    any_fixed |= integrator->fixed;
    any_adaptive |= integrator->adaptive;
    for (auto const& [h, rtol, atol] : controls) {
      bool const suits = h ? integrator->fixed : integrator->adaptive;
      if (!suits) continue;
      Cell cell;
      cell.h = h;
      cell.rtol = rtol;
      cell.atol = atol;
      located(sweep, [&] { check_control(*integrator, cell); });
      methods.push_back({integrator->name, StepControl{cell.h, cell.rtol, cell.atol}});
    }
  }
  for (std::string const key : {"h", "rtol"}) {
    auto const* given = find(sweep, key);
    bool const suits = key == "h" ? any_fixed : any_adaptive;
    if (!given || suits) continue;
    Cell cell;
    (key == "h" ? cell.h : cell.rtol) = 1;
    located(*given, [&] { check_control(*integrators.front(), cell); });
  }
  return methods;
}

/// The words of an optional axis, each of them checked and possibly rewritten by `accept`.
template <class Accept>
Words read_words(Toml const& sweep, std::string const& key, Words const& otherwise, Accept const& accept) {
  auto const* axis = find(sweep, key);
  if (!axis) return otherwise;
  Words words;
  for (auto const* item : items(*axis, key)) {
    auto const word = text(*item, key);
    words.push_back(located(*item, [&] { return accept(word); }));
  }
  return words;
}

std::vector<double> read_links(Toml const& name, GraphFiles& graphs) {
  try {
    return graphs.read(name.as_string().str);
  } catch (ParameterError const& error) {
    fail(name, error.what());
  }
}

std::vector<decltype(Cell::set)> read_sets(Toml const& sweep, ProblemWord const& problem, GraphFiles& graphs) {
  auto const* axis = find(sweep, "set");
  if (!axis) return {{}};
  std::vector<decltype(Cell::set)> sets;
  for (auto const* item : items(*axis, "set")) {
    if (!item->is_table()) wrong_type(*item, "set", "table such as { inertia = [0.6, 0.8, 1.0] }");
    auto& set = sets.emplace_back();
    for (auto const& [name, value] : item->as_table()) {
      located(value, [&] { check_parameter(problem, name, {0}); });
      if (name == "graph" && value.is_string()) {
        set[name] = read_links(value, graphs);
        continue;
      }
      for (auto const* entry : items(value, name)) set[name].push_back(number(*entry, name));
    }
  }
  return sets;
}

std::vector<std::int64_t> read_seeds(Toml const& sweep) {
  auto const* axis = find(sweep, "seed");
  if (!axis) return {Cell{}.seed};
  // The parser turns larger numbers into the largest.
  constexpr auto most = std::numeric_limits<std::int64_t>::max() - 1;
  std::vector<std::int64_t> seeds;
  for (auto const* item : items(*axis, "seed")) seeds.push_back(whole(*item, "seed", -most, most));
  return seeds;
}

/// The cells of one sweep, in the order of its axes.
std::vector<Cell> read_sweep(Toml const& sweep, Vocabulary const& vocabulary, GraphFiles& graphs) {
  table(sweep, "[[sweep]]",
        {"problem", "variant", "formulation", "integrator", "policy", "h", "rtol", "atol", "t_end", "set", "seed",
         "tags", "reference"});
  need(sweep, "[[sweep]]", "problem", "problem = [\"free_body\"]");
  auto const problems =
      read_words(sweep, "problem", {}, [&](auto const& word) { return vocabulary.problem(word).name; });
  auto const methods = read_methods(sweep, vocabulary);
  auto const policies = read_words(sweep, "policy", {Cell{}.policy}, [&](auto const& word) {
    check_policy(vocabulary, word);
    return word;
  });
  auto const* t_end = find(sweep, "t_end");
  auto const horizons = t_end ? positive_axis(*t_end, "t_end") : std::vector<double>{0};
  auto const seeds = read_seeds(sweep);
  auto const use = [](Cell& cell, Method const& method) {
    auto const& [integrator, control] = method;
    cell.integrator = integrator;
    cell.h = control.h;
    cell.rtol = control.rtol;
    cell.atol = control.atol;
  };

  std::vector<Cell> all;
  for (auto const& name : problems) {
    auto const& problem = vocabulary.problem(name);
    auto const variants = read_words(sweep, "variant", {canonical_variant(problem, "")},
                                     [&](auto const& word) { return canonical_variant(problem, word); });
    auto const formulations = read_words(sweep, "formulation", problem.formulations, [&](auto const& word) {
      check_formulation(problem, word);
      return word;
    });
    std::vector<Cell> cells(1);
    cells.front().problem = name;
    cells = cross(sweep, cells, variants, assign(&Cell::variant));
    cells = cross(sweep, cells, formulations, assign(&Cell::formulation));
    cells = cross(sweep, cells, methods, use);
    cells = cross(sweep, cells, policies, assign(&Cell::policy));
    cells = cross(sweep, cells, horizons, assign(&Cell::t_end));
    cells = cross(sweep, cells, read_sets(sweep, problem, graphs), assign(&Cell::set));
    cells = cross(sweep, cells, seeds, assign(&Cell::seed));
    check_size(sweep, all.size() + cells.size());
    std::move(cells.begin(), cells.end(), std::back_inserter(all));
  }
  return all;
}

/// The tables of [[key]], in the order of the file.
std::vector<Toml const*> tables(Toml const& root, std::string const& key) {
  auto const* value = find(root, key);
  if (!value) return {};
  bool const good = value->is_array() && std::all_of(value->as_array().begin(), value->as_array().end(),
                                                     [](Toml const& item) { return item.is_table(); });
  if (!good) fail(*value, fmt::format("{0}: write a table that is headed [[{0}]]", key));
  std::vector<Toml const*> all;
  for (auto const& item : value->as_array()) all.push_back(&item);
  return all;
}

/// The cells of all sweeps; one that several sweeps make is listed once, with the tags of all of them.
std::vector<SuiteCell> read_sweeps(Toml const& root, Vocabulary const& vocabulary, GraphFiles& graphs) {
  auto const sweeps = tables(root, "sweep");
  if (sweeps.empty()) fail(root, "no [[sweep]]; a suite has at least one");
  std::vector<SuiteCell> all;
  std::unordered_map<std::string, std::size_t> places;
  std::size_t drawn = 0;
  for (auto const* sweep : sweeps) {
    auto cells = read_sweep(*sweep, vocabulary, graphs);
    auto const tags = read_words(*sweep, "tags", {}, [](auto const& tag) {
      if (tag.empty()) throw UsageError("tags: a tag must not be empty");
      return tag;
    });
    auto const* reference = find(*sweep, "reference");
    bool const wanted = !reference || truth(*reference, "reference");
    drawn += cells.size();
    check_size(*sweep, drawn);
    for (auto& cell : cells) {
      auto const [place, fresh] = places.try_emplace(results::cell_id(cell), all.size());
      if (fresh) all.push_back({std::move(cell), {}, false});
      all[place->second].reference |= wanted;
      auto& known = all[place->second].tags;
      for (auto const& tag : tags) {
        if (std::find(known.begin(), known.end(), tag) == known.end()) known.push_back(tag);
      }
    }
  }
  return all;
}

Timing read_timing(Toml const& root) {
  Timing timing;
  auto const* value = find(root, "timing");
  if (!value) return timing;
  table(*value, "[timing]", {"enabled", "min_time", "repetitions"});
  if (auto const* enabled = find(*value, "enabled")) timing.enabled = truth(*enabled, "enabled");
  if (auto const* min_time = find(*value, "min_time")) {
    timing.min_time = number(*min_time, "min_time");
    if (timing.min_time <= 0) fail(*min_time, fmt::format("min_time = {}: must be positive", timing.min_time));
  }
  if (auto const* repetitions = find(*value, "repetitions")) {
    timing.repetitions = static_cast<int>(whole(*repetitions, "repetitions", 1, 10'000));
  }
  return timing;
}

}  // namespace

Suite read_suite(std::filesystem::path const& file, Vocabulary const& vocabulary) {
  Suite suite;
  suite.text = read_text(file);
  suite.file = file;
  auto const root = parse(suite.text, file.string());
  table(root, "the suite", {"name", "timing", "sweep", "exclude", "expect"});
  auto const& name = need(root, "the suite", "name", "name = \"mine\"");
  suite.name = text(name, "name");
  if (suite.name.empty()) fail(name, "name: empty; give e.g. name = \"mine\"");
  suite.timing = read_timing(root);
  GraphFiles graphs(file.parent_path());
  suite.cells = read_sweeps(root, vocabulary, graphs);
  suite.files = graphs.files();

  auto const words = selectable_words(vocabulary, suite);
  std::vector<Selector> excluded;
  for (auto const* exclude : tables(root, "exclude")) {
    auto const& selector = excluded.emplace_back(read_selector(*exclude, "[[exclude]]", words));
    if (selector.empty()) fail(*exclude, "an empty [[exclude]] drops every cell; give e.g. integrator = \"rk4\"");
  }
  std::erase_if(suite.cells, [&](SuiteCell const& cell) {
    return std::any_of(excluded.begin(), excluded.end(), [&](auto const& selector) { return matches(selector, cell); });
  });
  for (auto const* expect : tables(root, "expect")) suite.expectations.push_back(read_expectation(*expect, words));
  return suite;
}

}  // namespace polhode::bench
