#include "bench/solve/problems.hpp"

#include <stdexcept>

namespace polhode::bench {

ProblemEntry const& problem_named(std::string_view name) {
  for (ProblemEntry const* entry : all_problems())
    if (entry->info().name == name) return *entry;
  throw std::out_of_range("no problem " + std::string(name));
}

std::vector<std::string_view> formulation_names() {
  return names_of(Formulations{});
}

}  // namespace polhode::bench
