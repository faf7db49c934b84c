#include "bench/suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "bench/suite_select.hpp"
#include "bench/suite_toml.hpp"
#include "problems/graph.hpp"

namespace polhode::bench {
namespace {

using namespace suite_toml;
using results::Cell;

constexpr std::size_t max_cells = 1'000'000;

// --- Selectors -------------------------------------------------------------------------------------------------------

Selector read_selector(Toml const& value, std::string const& where, SelectableWords const& known) {
  Selector selector;
  for (auto const& [key, member] : table(value, where, selector_keys())) {
    bool const numeric = member.is_integer() || member.is_floating();
    auto const pattern = numeric ? fmt::format("{}", number(member, key)) : text(member, key);
    located(member, [&] { check_pattern(key, pattern, known); });
    selector[key] = pattern;
  }
  return selector;
}

// --- Expectations ----------------------------------------------------------------------------------------------------

template <class T>
constexpr bool is_number = std::is_arithmetic_v<T>;
template <class T>
constexpr bool is_number<std::optional<T>> = std::is_arithmetic_v<T>;

/// What may be said of each field of a record: the keys of its bound.
std::map<std::string, Words> const& boundable_fields() {
  static std::map<std::string, Words> const fields = [] {
    Words const number_keys{"min", "max", "is", "golden", "rel", "abs", "digits"};
    std::map<std::string, Words> all{{"norm_drift", number_keys}, {"order", {"min", "max", "nominal", "within"}}};
    results::Record const record;
    results::for_each_field(record, [&]<class Member>(std::string const& name, std::string_view, Member const&) {
      all[name] = is_number<Member> ? number_keys : Words{"is", "golden"};
    });
    all.erase("cpu_time_s");  // seconds are never gated
    return all;
  }();
  return fields;
}

std::optional<double> optional_number(Toml const& in, std::string const& field, std::string const& key) {
  auto const* value = find(in, key);
  return value ? std::optional(number(*value, field + "." + key)) : std::nullopt;
}

/// A width: how far a value may be off.
std::optional<double> optional_width(Toml const& in, std::string const& field, std::string const& key) {
  auto const value = optional_number(in, field, key);
  if (value && *value < 0) fail(*find(in, key), fmt::format("{}.{} = {}: must not be negative", field, key, *value));
  return value;
}

Bound read_bound(Toml const& value, std::string const& field, Words const& keys) {
  bool const numeric = keys.front() == "min";
  std::string const example = numeric ? "{ max = 1e-9 }" : "{ is = \"ok\" }";
  if (!value.is_table()) wrong_type(value, field, "table such as " + example);
  table(value, field, keys);
  auto const flag = [&](std::string const& key) {
    auto const* member = find(value, key);
    return member != nullptr && truth(*member, field + "." + key);
  };
  Bound bound;
  bound.field = field;
  bound.min = optional_number(value, field, "min");
  bound.max = optional_number(value, field, "max");
  if (auto const* is = find(value, "is")) {
    bound.is = numeric ? fmt::format("{}", number(*is, field + ".is")) : text(*is, field + ".is");
  }
  bound.nominal = flag("nominal");
  bound.within = optional_width(value, field, "within");
  bound.golden = flag("golden");
  bound.rel = optional_width(value, field, "rel");
  bound.abs = optional_width(value, field, "abs");
  bound.digits = optional_width(value, field, "digits");
  if (bound.min && bound.max && *bound.min > *bound.max) {
    fail(value, fmt::format("{}: min = {} is above max = {}", field, *bound.min, *bound.max));
  }
  if (bound.within && !bound.nominal) fail(value, field + ": 'within' needs nominal = true");
  bool const tolerance = bound.rel || bound.abs || bound.digits;
  if (tolerance && !bound.golden) fail(value, field + ": 'rel', 'abs' and 'digits' need golden = true");
  bool const bounds = bound.min || bound.max || bound.is || bound.nominal || bound.golden;
  if (!bounds) fail(value, field + " is not bounded; give e.g. " + example);
  return bound;
}

Expectation read_expectation(Toml const& value, SelectableWords const& words) {
  std::string const where = "[[expect]]";
  if (auto const* seconds = find(value, "cpu_time_s")) fail(*seconds, "cpu_time_s: seconds are never gated");
  auto const& fields = boundable_fields();
  Words keys{"select", "min_cells", "xfail"};
  for (auto const& [field, bound_keys] : fields) keys.push_back(field);
  auto const& members = table(value, where, keys);

  Expectation expectation;
  expectation.line = static_cast<int>(value.location().line());
  auto const& select = need(value, where, "select", "select = { integrator = \"rk4\" }, or select = {} for every cell");
  expectation.select = read_selector(select, "select", words);
  for (auto const& [key, member] : members) {
    auto const field = fields.find(key);
    if (field != fields.end()) expectation.bounds.push_back(read_bound(member, key, field->second));
  }
  if (expectation.bounds.empty()) fail(value, where + " bounds nothing; give e.g. norm_drift = { max = 1e-9 }");
  if (auto const* least = find(value, "min_cells")) {
    expectation.min_cells = static_cast<int>(whole(*least, "min_cells", 1, max_cells));
  }
  if (auto const* reason = find(value, "xfail")) {
    expectation.xfail = text(*reason, "xfail");
    if (expectation.xfail->empty()) fail(*reason, "xfail: empty; say why the expectation fails");
  }
  return expectation;
}

// --- Sweeps ----------------------------------------------------------------------------------------------------------

/// One setting of the step control.
struct Control {
  std::optional<double> h, rtol, atol;
};

/// An integrator with a control that suits it.
using Method = std::pair<std::string, Control>;

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
std::vector<Control> read_controls(Toml const& sweep) {
  auto const* h = find(sweep, "h");
  auto const* rtol = find(sweep, "rtol");
  auto const* atol = find(sweep, "atol");
  if (atol && !rtol) fail(*atol, "atol without rtol: give both, or rtol alone");
  if (!h && !rtol) fail(sweep, "[[sweep]]: give h (fixed steps) or rtol (adaptive)");
  std::vector<Control> controls;
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
      methods.push_back({integrator->name, Control{cell.h, cell.rtol, cell.atol}});
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

/// The links in a file that the suite names: by its path, from the suite's folder, or beside the suite, where `run`
/// puts a copy. The record holds the numbers.
std::vector<double> read_graph_beside(Toml const& name, std::vector<std::filesystem::path>& files) {
  std::filesystem::path const written = name.as_string().str;
  std::filesystem::path const folder = std::filesystem::path(name.location().file_name()).parent_path();
  std::filesystem::path const beside = folder / written.filename();
  files.push_back(std::filesystem::exists(folder / written) ? folder / written : beside);
  try {
    return read_graph(files.back().string());
  } catch (ParameterError const& error) {
    fail(name, error.what());
  }
}

std::vector<decltype(Cell::set)> read_sets(Toml const& sweep, ProblemWord const& problem,
                                           std::vector<std::filesystem::path>& files) {
  auto const* axis = find(sweep, "set");
  if (!axis) return {{}};
  std::vector<decltype(Cell::set)> sets;
  for (auto const* item : items(*axis, "set")) {
    if (!item->is_table()) wrong_type(*item, "set", "table such as { inertia = [0.6, 0.8, 1.0] }");
    auto& set = sets.emplace_back();
    for (auto const& [name, value] : item->as_table()) {
      located(value, [&] { check_parameter(problem, name, {0}); });
      if (name == "graph" && value.is_string()) {
        set[name] = read_graph_beside(value, files);
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
std::vector<Cell> read_sweep(Toml const& sweep, Vocabulary const& vocabulary,
                             std::vector<std::filesystem::path>& files) {
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
    cells = cross(sweep, cells, read_sets(sweep, problem, files), assign(&Cell::set));
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
std::vector<SuiteCell> read_sweeps(Toml const& root, Vocabulary const& vocabulary,
                                   std::vector<std::filesystem::path>& files) {
  auto const sweeps = tables(root, "sweep");
  if (sweeps.empty()) fail(root, "no [[sweep]]; a suite has at least one");
  std::vector<SuiteCell> all;
  std::unordered_map<std::string, std::size_t> places;
  std::size_t drawn = 0;
  for (auto const* sweep : sweeps) {
    auto cells = read_sweep(*sweep, vocabulary, files);
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
  auto const root = parse(suite.text, file.string());
  table(root, "the suite", {"name", "timing", "sweep", "exclude", "expect"});
  auto const& name = need(root, "the suite", "name", "name = \"mine\"");
  suite.name = text(name, "name");
  if (suite.name.empty()) fail(name, "name: empty; give e.g. name = \"mine\"");
  suite.timing = read_timing(root);
  suite.cells = read_sweeps(root, vocabulary, suite.files);

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
