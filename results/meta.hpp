#pragma once
/// What the provenance of a file says.
#include <set>
#include <string>
#include <vector>

#include "results/record.hpp"

namespace polhode::results {

/// The text of a name, such as "cpu_model"; empty if the meta does not tell it.
inline std::string entry_of(Meta const& meta, std::string const& name) {
  auto const found = meta.find(name);
  return found == meta.end() ? "" : found->second;
}

/// The texts that several give to a name, each once.
inline std::set<std::string> entries_of(std::vector<Meta> const& metas, std::string const& name) {
  std::set<std::string> texts;
  for (Meta const& meta : metas) {
    if (std::string text = entry_of(meta, name); !text.empty()) texts.insert(std::move(text));
  }
  return texts;
}

}  // namespace polhode::results
