#pragma once
/// The words that a user may say: problems, variants, formulations, parameters, integrators, policies. Plain data made
/// from the two catalogues; the command line, the suite reader and `polhode list` speak through it.
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "results/record.hpp"

namespace polhode::bench {

/// The user's mistake, in words: what, where, and what would be right. main() turns it into one line and an exit code.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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
};

struct IntegratorWord {
  std::string name, family;
  std::optional<int> order;
  bool fixed = false, adaptive = false;
  bool rival = false;
  std::vector<std::string> preserves;
  std::string needs;  ///< "none", "flat", "group", "free_body"
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

/// The word of `known` that is nearest to `word` by edit distance, or "" when none is near.
std::string nearest(std::string_view word, std::vector<std::string> const& known);
/// "unknown KIND 'word'; did you mean 'nearest'?", or with the list of all when none is near.
std::string unknown(std::string_view kind, std::string_view word, std::vector<std::string> const& known);

/// Brings a variant selection ("g2,case1") into canonical form: one word per group in the order of the groups, defaults
/// written out, groups whose choice is "" left out. Throws UsageError for unknown words and for two of one group.
std::string canonical_variant(ProblemWord const& problem, std::string_view selection);

/// Checks a cell's words and numbers against the vocabulary, and puts its variant into canonical form: names, policy,
/// parameter names and finiteness, h xor rtol, h > 0, fixed or adaptive as the integrator can. Unit checks of parameter
/// values belong to the problem. Throws UsageError.
void check_words(Vocabulary const& vocabulary, results::Cell& cell);

}  // namespace polhode::bench
