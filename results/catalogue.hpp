#pragma once
/// What is known of the integrators before anything is run: catalogue.json of a result folder, which `polhode run` puts
/// beside the records. It is what `polhode list integrators --json` prints.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace polhode::results {

/// The name of the file in a result folder.
inline constexpr char const* catalogue_file = "catalogue.json";

/// What the catalogue says of one integrator.
struct IntegratorFacts {
  std::string family;
  std::optional<int> order;  ///< nominal; null unless it runs with fixed steps and has one
  bool adaptive_only = false;
  std::vector<std::string> preserves;  ///< of norm, energy, momentum, momentum_direction, symplectic, symmetric
  std::string source, pitfall;
};

/// By name.
using Catalogue = std::map<std::string, IntegratorFacts>;

/// Reads the text of such a file; keys that it does not know are passed over. Throws std::invalid_argument that says
/// what is wrong.
Catalogue catalogue_from(std::string const& text);
/// That of a folder; empty if it has none. Throws StoreError, which names the file.
Catalogue read_catalogue(std::filesystem::path const& folder);
/// Puts such a text into a folder, whole or not at all: a kill leaves what was there. Throws StoreError.
void write_catalogue(std::filesystem::path const& folder, std::string const& text);
/// What the folders say together, as such a text; of an integrator in several, the last is right. Nothing if none says
/// anything. Throws StoreError.
std::optional<std::string> merged_catalogues(std::vector<std::filesystem::path> const& folders);

}  // namespace polhode::results
