#pragma once
/// The words that a user may say: problems, variants, formulations, parameters, integrators, policies. Plain data made
/// from the two catalogues; the command line, the suite reader and `polhode list` speak through it.
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/process/messages.hpp"
#include "results/record.hpp"

namespace polhode::bench {

struct ParameterWord {
  std::string name, unit;
  std::vector<double> value;  ///< the default
};

struct ProblemWord {
  std::string name, summary, source;
  std::vector<std::vector<std::string>> variants;  ///< groups; the first of a group is its default; "" = nothing
  std::vector<std::string> formulations;
  std::vector<ParameterWord> parameters;
  std::vector<std::string> events, claims;
  double step = 0.1;  ///< [s] at which every fixed-step method is stable on the default choice
};

struct IntegratorWord {
  std::string name, family;
  std::optional<int> order;
  bool fixed = false, adaptive = false;
  bool rival = false;
  std::vector<std::string> preserves;
  std::string needs;           ///< "none", "flat", "group", "free_body", "rigid_body", "prescribed_rates", "constraint"
  std::string needs_of_space;  ///< the same; "none" or "group" where it is of the problem that more is needed
  std::string source, pitfall;
  std::string not_built;  ///< why its runs are refused in this binary; empty if it is here
};

struct Vocabulary {
  std::vector<ProblemWord> problems;
  std::vector<IntegratorWord> integrators;
  std::vector<std::string> policies;

  /// The entry of that name. Throws UsageError "unknown problem 'x'; did you mean 'y'?".
  ProblemWord const& problem(std::string_view name) const;
  IntegratorWord const& integrator(std::string_view name) const;
};

/// The words of both catalogues, in catalogue order: from words.cpp.
Vocabulary const& vocabulary();

/// Brings a variant selection ("g2,case1") into canonical form: one word per group in the order of the groups, defaults
/// written out, groups whose choice is "" left out. Throws UsageError for unknown words and for two of one group.
std::string canonical_variant(ProblemWord const& problem, std::string_view selection);

/// The parts of check_words, for readers that know where each word stands. They throw UsageError.
void check_formulation(ProblemWord const& problem, std::string_view formulation);
void check_policy(Vocabulary const& vocabulary, std::string_view policy);
void check_parameter(ProblemWord const& problem, std::string_view name, std::vector<double> const& value);
/// `name` is "h", "rtol", "atol", "t_end" or "every", all of which are positive and finite.
void check_positive(std::string_view name, double value);
/// h xor rtol, as the integrator can; fills in the default atol = rtol / 100.
void check_control(IntegratorWord const& integrator, results::Cell& cell);

/// Checks a cell's words and numbers against the vocabulary, and puts its variant into canonical form: names, policy,
/// parameter names and finiteness, h xor rtol, h > 0, fixed or adaptive as the integrator can; t_end = 0 stands for the
/// problem's own horizon. Fills in the default atol. Unit checks of parameter values belong to the problem. An
/// integrator that is not built is a known word: its runs become refusals. Throws UsageError.
void check_words(Vocabulary const& vocabulary, results::Cell& cell);

}  // namespace polhode::bench
