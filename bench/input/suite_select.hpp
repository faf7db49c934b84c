#pragma once
/// Selectors, for the suite reader: which keys there are, and whether a pattern can select anything at all.
#include <map>
#include <string>
#include <vector>

#include "bench/input/suite.hpp"

namespace polhode::bench {

/// The pattern has wildcards: * ? [.
bool is_glob(std::string_view pattern);
/// The text matches the pattern as the shell understands it.
bool glob(std::string const& pattern, std::string const& text);

/// The keys of a selector: the fields of a cell, and "tag".
std::vector<std::string> const& selector_keys();

/// Every word that a selector may spell out, by key. Keys without an entry select numbers.
using SelectableWords = std::map<std::string, std::vector<std::string>>;
SelectableWords selectable_words(Vocabulary const& vocabulary, Suite const& suite);

/// A misspelt word selects nothing, silently; so it is an error, unless it is a glob. Throws UsageError.
void check_pattern(std::string const& key, std::string const& pattern, SelectableWords const& known);

}  // namespace polhode::bench
