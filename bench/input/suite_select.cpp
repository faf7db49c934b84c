#include "bench/input/suite_select.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "bench/process/text.hpp"

namespace polhode::bench {

bool glob(std::string const& pattern, std::string const& text) {
  return fnmatch(pattern.c_str(), text.c_str(), 0) == 0;
}

bool is_glob(std::string_view pattern) {
  return pattern.find_first_of("*?[") != std::string_view::npos;
}

namespace {

using results::Cell;
using Words = std::vector<std::string>;

bool number_matches(std::string const& pattern, std::optional<double> value) {
  if (!value) return false;
  auto const wanted = finite_number(pattern);
  if (!wanted) return glob(pattern, fmt::format("{}", *value));
  return std::abs(*wanted - *value) <= 1e-12 * std::abs(*wanted);
}

bool variant_matches(std::string const& pattern, std::string const& variant) {
  if (glob(pattern, variant)) return true;
  auto const wanted = fields_of(pattern);
  auto const words = fields_of(variant);
  auto const present = [&](std::string_view want) {
    return std::ranges::any_of(words,
                               [&](std::string_view word) { return glob(std::string(want), std::string(word)); });
  };
  return !wanted.empty() && std::all_of(wanted.begin(), wanted.end(), present);
}

std::string set_text(Cell const& cell) {
  Words parts;
  for (auto const& [name, value] : cell.set) parts.push_back(fmt::format("{}={}", name, fmt::join(value, ",")));
  return fmt::format("{}", fmt::join(parts, ";"));
}

using Test = bool (*)(std::string const& pattern, SuiteCell const& in);

/// The keys of a selector, and what each asks of a cell.
std::map<std::string, Test> const& selector_tests() {
  static std::map<std::string, Test> const tests{
      {"problem", [](auto const& pattern, auto const& in) { return glob(pattern, in.cell.problem); }},
      {"variant", [](auto const& pattern, auto const& in) { return variant_matches(pattern, in.cell.variant); }},
      {"formulation", [](auto const& pattern, auto const& in) { return glob(pattern, in.cell.formulation); }},
      {"integrator", [](auto const& pattern, auto const& in) { return glob(pattern, in.cell.integrator); }},
      {"policy", [](auto const& pattern, auto const& in) { return glob(pattern, in.cell.policy); }},
      {"h", [](auto const& pattern, auto const& in) { return number_matches(pattern, in.cell.h); }},
      {"rtol", [](auto const& pattern, auto const& in) { return number_matches(pattern, in.cell.rtol); }},
      {"atol", [](auto const& pattern, auto const& in) { return number_matches(pattern, in.cell.atol); }},
      {"set", [](auto const& pattern, auto const& in) { return glob(pattern, set_text(in.cell)); }},
      {"seed",
       [](auto const& pattern, auto const& in) { return number_matches(pattern, static_cast<double>(in.cell.seed)); }},
      {"t_end", [](auto const& pattern, auto const& in) { return number_matches(pattern, in.cell.t_end); }},
      {"tag",
       [](auto const& pattern, auto const& in) {
         return std::any_of(in.tags.begin(), in.tags.end(), [&](auto const& tag) { return glob(pattern, tag); });
       }},
  };
  return tests;
}

}  // namespace

std::vector<std::string> const& selector_keys() {
  static Words const keys = [] {
    Words all;
    for (auto const& [key, test] : selector_tests()) all.push_back(key);
    return all;
  }();
  return keys;
}

SelectableWords selectable_words(Vocabulary const& vocabulary, Suite const& suite) {
  std::map<std::string, std::set<std::string>> words;
  for (auto const& problem : vocabulary.problems) {
    words["problem"].insert(problem.name);
    words["formulation"].insert(problem.formulations.begin(), problem.formulations.end());
    for (auto const& group : problem.variants) words["variant"].insert(group.begin(), group.end());
  }
  for (auto const& integrator : vocabulary.integrators) words["integrator"].insert(integrator.name);
  words["policy"].insert(vocabulary.policies.begin(), vocabulary.policies.end());
  words["tag"];  // listed even if there are none
  for (auto const& cell : suite.cells) words["tag"].insert(cell.tags.begin(), cell.tags.end());
  SelectableWords listed;
  for (auto const& [key, set] : words) listed[key] = Words(set.begin(), set.end());
  return listed;
}

void check_pattern(std::string const& key, std::string const& pattern, SelectableWords const& known) {
  if (is_glob(pattern) || key == "set") return;
  auto const words = known.find(key);
  if (words == known.end()) {
    if (finite_number(pattern)) return;
    throw UsageError(fmt::format("{}: {} is neither a number nor a glob", key, quote(pattern)));
  }
  auto const parts = key == "variant" ? fields_of(pattern) : std::vector<std::string_view>{pattern};
  for (auto const& part : parts) {
    bool const found = std::find(words->second.begin(), words->second.end(), part) != words->second.end();
    if (!found) throw UsageError(unknown(key, part, words->second));
  }
}

bool matches(Selector const& selector, SuiteCell const& cell) {
  auto const& tests = selector_tests();
  return std::all_of(selector.begin(), selector.end(),
                     [&](auto const& one) { return tests.at(one.first)(one.second, cell); });
}

}  // namespace polhode::bench
