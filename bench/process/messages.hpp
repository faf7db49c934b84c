#pragma once
/// How mistakes are told: what, where, and what would be right.
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace polhode::bench {

/// The user's mistake, in words: what, where, and what would be right. main() turns it into one line and an exit code.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A valid selection that matches no cell. Exit code 3.
struct NothingSelected : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The word of `known` that is nearest to `word` by Damerau-Levenshtein distance, or "" when none is near: a third of
/// the word may be wrong, and two letters always may.
std::string nearest(std::string_view word, std::vector<std::string> const& known);
/// "unknown KIND 'word'; did you mean 'nearest'?", or with the list of all when none is near. `where` ("of free_body",
/// "in [[sweep]]") follows the word.
std::string unknown(std::string_view kind, std::string_view word, std::vector<std::string> const& known,
                    std::string_view where = "");
/// A user's word in quotes, safe inside a one-line message: control characters replaced, very long words cut.
std::string quote(std::string_view word);

/// Tells the user on stderr; nothing if there is nothing to tell.
void warn(std::string const& warning);

}  // namespace polhode::bench
