/// `polhode list`: what there is.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/cell/cell.hpp"
#include "bench/commands/commands.hpp"
#include "bench/process/data.hpp"
#include "bench/solve/catalogue.hpp"

namespace polhode::bench {
namespace {

nlohmann::ordered_json to_json(ProblemWord const& word) {
  nlohmann::ordered_json json{{"name", word.name},
                              {"variants", word.variants},
                              {"formulations", word.formulations},
                              {"parameters", nlohmann::ordered_json::array()},
                              {"events", word.events},
                              {"claims", word.claims},
                              {"summary", word.summary},
                              {"source", word.source}};
  for (ParameterWord const& parameter : word.parameters) {
    nlohmann::ordered_json value = parameter.value;
    if (parameter.value.size() == 1) value = parameter.value[0];
    json["parameters"].push_back({{"name", parameter.name}, {"unit", parameter.unit}, {"default", value}});
  }
  return json;
}

std::string variants_text(ProblemWord const& word) {
  std::vector<std::string> groups;
  for (auto const& group : word.variants) {
    std::string text;
    for (std::string const& choice : group)
      if (!choice.empty()) text += (text.empty() ? "" : "|") + choice;
    groups.push_back(group.front().empty() ? "[" + text + "]" : text);
  }
  return groups.empty() ? "-" : fmt::format("{}", fmt::join(groups, " "));
}

void list_integrators(bool as_json) {
  auto const& words = vocabulary().integrators;
  if (as_json) return fmt::print("{}", catalogue_text());
  std::vector<std::array<std::string, 7>> rows{{"name", "family", "order", "steps", "needs", "keeps", "source"}};
  for (IntegratorWord const& word : words) {
    char const* steps = word.fixed && word.adaptive ? "both" : word.fixed ? "fixed" : "adaptive";
    rows.push_back({word.name, word.family, word.order ? std::to_string(*word.order) : "-", steps, word.needs,
                    word.preserves.empty() ? "-" : fmt::format("{}", fmt::join(word.preserves, ",")),
                    word.source + (word.not_built.empty() ? "" : "  (" + word.not_built + ")")});
  }
  std::array<std::size_t, 7> width{};
  for (auto const& row : rows)
    for (std::size_t i = 0; i + 1 < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  for (auto const& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) line += fmt::format("{:<{}}  ", row[i], width[i]);
    fmt::print("{}\n", line.substr(0, line.find_last_not_of(' ') + 1));
  }
}

void list_problems(bool as_json) {
  auto const& words = vocabulary().problems;
  if (as_json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (ProblemWord const& word : words) json.push_back(to_json(word));
    fmt::print("{}\n", json.dump(1));
    return;
  }
  for (ProblemWord const& word : words) {
    fmt::print("{}: {}\n  variants:     {}\n  formulations: {}\n  source:       {}\n  parameters:\n", word.name,
               word.summary, variants_text(word), fmt::join(word.formulations, " "), word.source);
    for (ParameterWord const& p : word.parameters)
      fmt::print("    {:<14} {:g} {}\n", p.name, fmt::join(p.value, ","), p.unit);
  }
}

void list_names(std::vector<std::string> const& names, bool as_json) {
  if (as_json)
    fmt::print("{}\n", nlohmann::ordered_json(names).dump(1));
  else
    for (std::string const& name : names) fmt::print("{}\n", name);
}

void list(std::string const& what, bool as_json) {
  if (what == "integrators") return list_integrators(as_json);
  if (what == "problems") return list_problems(as_json);
  if (what == "policies") return list_names(vocabulary().policies, as_json);
  if (what == "suites") return list_names(suite_names(), as_json);
  if (what == "formulations") {
    auto const names = formulation_names();
    return list_names({names.begin(), names.end()}, as_json);
  }
  throw UsageError(unknown("list", what, {"problems", "formulations", "integrators", "policies", "suites"}));
}

}  // namespace

void add_list(CLI::App& app) {
  auto const what = std::make_shared<std::string>();
  auto const as_json = std::make_shared<bool>(false);
  CLI::App* verb =
      app.add_subcommand("list", "Say what there is: problems, formulations, integrators, policies, suites");
  verb->add_option("WHAT", *what, "problems, formulations, integrators, policies or suites")->required();
  verb->add_flag("--json", *as_json, "As JSON");
  verb->callback([=] { list(*what, *as_json); });
}

}  // namespace polhode::bench
