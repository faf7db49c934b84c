#include "results/run_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace polhode::results {

// 12 digits: rtol / 100 in binary is 1.0000000000000002e-06.
std::string run_name(Cell const& cell) {
  std::string name =
      fmt::format("{}/{}/{}/{}/{}", cell.problem, cell.variant, cell.formulation, cell.integrator, cell.policy);
  if (cell.h) {
    name += fmt::format("/h={:.12g}", *cell.h);
  } else if (cell.rtol) {
    name += fmt::format("/rtol={:.12g}", *cell.rtol);
    if (cell.atol) name += fmt::format(",atol={:.12g}", *cell.atol);
  }
  for (auto const& [parameter, value] : cell.set) name += fmt::format("/{}={:.12g}", parameter, fmt::join(value, ","));
  if (cell.seed != Cell{}.seed) name += fmt::format("/seed={}", cell.seed);
  return name;
}

}  // namespace polhode::results
