#pragma once
/// Files from outside may nest without end; copying and writing JSON recurse, and would overflow the stack.
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace polhode::results {

/// For Json::parse: throws std::invalid_argument for what is nested deeper than anything of ours.
inline bool shallow(int depth, nlohmann::ordered_json::parse_event_t, nlohmann::ordered_json&) {
  constexpr int deepest = 20;
  if (depth > deepest) throw std::invalid_argument("nested too deeply");
  return true;
}

}  // namespace polhode::results
