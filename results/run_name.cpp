#include "results/run_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace polhode::results {

std::string run_name(Cell const& cell) {
  std::string name =
      fmt::format("{}/{}/{}/{}/{}", cell.problem, cell.variant, cell.formulation, cell.integrator, cell.policy);
  if (cell.h) {
    name += fmt::format("/h={}", *cell.h);
  } else if (cell.rtol) {
    name += fmt::format("/rtol={}", *cell.rtol);
    if (cell.atol) name += fmt::format(",atol={}", *cell.atol);
  }
  for (auto const& [parameter, value] : cell.set) name += fmt::format("/{}={}", parameter, fmt::join(value, ","));
  if (cell.seed != Cell{}.seed) name += fmt::format("/seed={}", cell.seed);
  return name;
}

}  // namespace polhode::results
