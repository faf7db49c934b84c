#include "bench/solve/catalogue.hpp"

#include <nlohmann/json.hpp>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {
namespace {

nlohmann::ordered_json to_json(IntegratorWord const& word) {
  nlohmann::ordered_json json{{"name", word.name}, {"family", word.family}};
  json["order"] = word.order && word.fixed ? nlohmann::ordered_json(*word.order) : nlohmann::ordered_json();
  json["adaptive_only"] = word.adaptive && !word.fixed;
  json["rival"] = word.rival;
  json["preserves"] = word.preserves;
  json["needs"] = word.needs_of_space;
  json["needs_problem"] = nullptr;
  if (word.needs != word.needs_of_space) json["needs_problem"] = word.needs;
  json["source"] = word.source;
  json["pitfall"] = word.pitfall;
  if (!word.not_built.empty()) json["not_built"] = word.not_built;
  return json;
}

}  // namespace

std::string catalogue_text() {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (IntegratorWord const& word : vocabulary().integrators) json.push_back(to_json(word));
  return json.dump(1) + '\n';
}

}  // namespace polhode::bench
