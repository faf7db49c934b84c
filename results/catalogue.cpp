#include "results/catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "results/shallow.hpp"
#include "results/whole_file.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// An array of objects, each with its name.
Json list_of(std::string const& text) {
  Json json = Json::parse(text, shallow, false);
  auto const is_named = [](Json const& entry) {
    return entry.is_object() && entry.contains("name") && entry["name"].is_string();
  };
  if (!json.is_array() || !std::ranges::all_of(json, is_named)) {
    throw std::invalid_argument("must be what `polhode list integrators --json` prints");
  }
  return json;
}

int order_from(Json const& json) {
  bool const integer = json.is_number_integer() && json >= 0 && json <= 1000;
  if (!integer) throw std::invalid_argument("order: must be an integer from 0 to 1000");
  return json.get<int>();
}

IntegratorFacts facts_of(Json const& json) {
  IntegratorFacts facts;
  facts.family = json.value("family", "");
  if (json.contains("order") && !json["order"].is_null()) facts.order = order_from(json["order"]);
  facts.adaptive_only = json.value("adaptive_only", false);
  facts.preserves = json.value("preserves", std::vector<std::string>());
  facts.source = json.value("source", "");
  facts.pitfall = json.value("pitfall", "");
  return facts;
}

}  // namespace

Catalogue catalogue_from(std::string const& text) {
  Catalogue catalogue;
  for (Json const& entry : list_of(text)) {
    std::string const name = entry["name"].get<std::string>();
    try {
      catalogue[name] = facts_of(entry);
    } catch (nlohmann::json::exception const&) {
      throw std::invalid_argument(fmt::format("\"{}\": a value of the wrong type", name));
    }
  }
  return catalogue;
}

Catalogue read_catalogue(fs::path const& folder) {
  return read_if_there(folder / catalogue_file, catalogue_from).value_or(Catalogue());
}

void write_catalogue(fs::path const& folder, std::string const& text) {
  write_whole(folder / catalogue_file, text);
}

std::optional<std::string> merged_catalogues(std::vector<fs::path> const& folders) {
  Json merged = Json::array();
  for (fs::path const& folder : folders) {
    auto const list = read_if_there(folder / catalogue_file, list_of);
    if (!list) continue;
    for (Json const& entry : *list) {
      auto const known = std::ranges::find_if(merged, [&](Json const& one) { return one["name"] == entry["name"]; });
      if (known == merged.end()) {
        merged.push_back(entry);
      } else {
        *known = entry;
      }
    }
  }
  if (merged.empty()) return {};
  return merged.dump(1) + '\n';
}

}  // namespace polhode::results
