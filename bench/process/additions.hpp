#pragma once
/// What a binary adds to Polhode's catalogues. Polhode's own adds nothing; those of polhode_add_binary() do.
#include <string_view>
#include <vector>

namespace polhode::bench {

/// The names of what is added, in the order of the catalogue.
struct Additions {
  std::vector<std::string_view> integrators, problems;
  std::string_view data;  ///< share/polhode of the Polhode that the binary was built against; empty in its own build
};

/// Those of this binary, from its catalogue_unit.cpp.
Additions const& additions();

}  // namespace polhode::bench
