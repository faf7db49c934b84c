#include "bench/input/vocabulary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "bench/process/text.hpp"

namespace polhode::bench {
namespace {

/// The entry of that name, or UsageError.
template <class Word>
Word const& entry(std::string_view kind, std::string_view name, std::vector<Word> const& words) {
  auto const found = std::find_if(words.begin(), words.end(), [&](Word const& word) { return word.name == name; });
  if (found != words.end()) return *found;
  std::vector<std::string> known;
  for (auto const& word : words) known.push_back(word.name);
  throw UsageError(unknown(kind, name, known));
}

void check_known(std::string_view kind, std::string_view word, std::vector<std::string> const& known,
                 std::string_view where = "") {
  bool const found = std::find(known.begin(), known.end(), word) != known.end();
  if (!found) throw UsageError(unknown(kind, word, known, where));
}

/// The index of the group that holds `word`, or UsageError.
std::size_t group_of(ProblemWord const& problem, std::string_view word) {
  std::vector<std::string> known;
  for (std::size_t g = 0; g < problem.variants.size(); ++g) {
    for (auto const& choice : problem.variants[g]) {
      if (choice.empty()) continue;
      if (choice == word) return g;
      known.push_back(choice);
    }
  }
  throw UsageError(unknown("variant", word, known, "of " + problem.name));
}

}  // namespace

ProblemWord const& Vocabulary::problem(std::string_view name) const {
  return entry("problem", name, problems);
}

IntegratorWord const& Vocabulary::integrator(std::string_view name) const {
  return entry("integrator", name, integrators);
}

std::string canonical_variant(ProblemWord const& problem, std::string_view selection) {
  std::vector<std::string> chosen(problem.variants.size());
  for (auto const word : fields_of(selection)) {
    if (word.empty()) throw UsageError(fmt::format("variant {}: a word is missing beside a comma", quote(selection)));
    auto& choice = chosen[group_of(problem, word)];
    if (choice == word) throw UsageError(fmt::format("variant {}: {} is given twice", quote(selection), word));
    if (!choice.empty()) {
      throw UsageError(
          fmt::format("variant {}: {} and {} exclude each other; give one", quote(selection), choice, word));
    }
    choice = word;
  }
  std::string text;
  for (std::size_t g = 0; g < chosen.size(); ++g) {
    auto const& group = problem.variants[g];
    auto const word = chosen[g].empty() && !group.empty() ? group.front() : chosen[g];
    if (word.empty()) continue;
    if (!text.empty()) text += ',';
    text += word;
  }
  return text;
}

void check_formulation(ProblemWord const& problem, std::string_view formulation) {
  check_known("formulation", formulation, problem.formulations, "of " + problem.name);
}

void check_policy(Vocabulary const& vocabulary, std::string_view policy) {
  check_known("policy", policy, vocabulary.policies);
}

void check_parameter(ProblemWord const& problem, std::string_view name, std::vector<double> const& value) {
  std::vector<std::string> known;
  for (auto const& parameter : problem.parameters) known.push_back(parameter.name);
  check_known("parameter", name, known, "of " + problem.name);
  if (value.empty()) throw UsageError(fmt::format("parameter {}: no value; give at least one number", name));
  for (double const number : value) {
    if (std::isfinite(number)) continue;
    throw UsageError(fmt::format("parameter {}: {} is not a finite number", name, number));
  }
}

void check_positive(std::string_view name, double value) {
  if (std::isfinite(value) && value > 0) return;
  std::string_view rule = "a tolerance is a positive finite number";
  if (name == "h") rule = "a step size is a positive finite number of seconds";
  if (name == "t_end") rule = "a horizon is a positive finite number of seconds";
  if (name == "every") rule = "an output interval is a positive finite number of seconds";
  throw UsageError(fmt::format("{} = {}: {}", name, value, rule));
}

void check_control(IntegratorWord const& integrator, results::Cell& cell) {
  if (cell.h && cell.rtol) throw UsageError("give h or rtol, not both");
  if (cell.h && cell.atol) throw UsageError("give h or rtol (and atol), not h and atol");
  if (cell.atol && !cell.rtol) throw UsageError("atol without rtol: give both, or rtol alone");
  if (!cell.h && !cell.rtol) throw UsageError("give h (fixed steps) or rtol (adaptive)");
  if (cell.rtol && !cell.atol) cell.atol = *cell.rtol * 1e-2;
  if (cell.h) check_positive("h", *cell.h);
  if (cell.rtol) check_positive("rtol", *cell.rtol);
  if (cell.atol) check_positive("atol", *cell.atol);
  if (cell.rtol && !integrator.adaptive) {
    throw UsageError(fmt::format("{} has no error estimate: give h, not rtol", integrator.name));
  }
  if (cell.h && !integrator.fixed) {
    throw UsageError(fmt::format("{} chooses its own steps: give rtol (and atol), not h", integrator.name));
  }
}

void check_words(Vocabulary const& vocabulary, results::Cell& cell) {
  auto const& problem = vocabulary.problem(cell.problem);
  auto const& integrator = vocabulary.integrator(cell.integrator);
  cell.variant = canonical_variant(problem, cell.variant);
  check_formulation(problem, cell.formulation);
  check_policy(vocabulary, cell.policy);
  for (auto const& [name, value] : cell.set) check_parameter(problem, name, value);
  if (cell.t_end != 0) check_positive("t_end", cell.t_end);
  check_control(integrator, cell);
}

}  // namespace polhode::bench
