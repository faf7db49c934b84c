#include "bench/input/cell_flags.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "bench/input/suite.hpp"
#include "bench/input/suite_graphs.hpp"
#include "bench/process/text.hpp"
#include "problems/parameters.hpp"

namespace polhode::bench {
namespace {

double number_in(std::string_view text) {
  double value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) throw UsageError(quote(text) + " is beyond the range of a double");
  if (error != std::errc() || end != text.data() + text.size()) throw UsageError(quote(text) + " is not a number");
  return value;
}

}  // namespace

CLI::Option* add_number(CLI::App& verb, std::string const& flag, double& value, std::string const& help) {
  return verb.add_option(flag, value, help)->check([](std::string const& text) -> std::string {
    try {
      static_cast<void>(number_in(text));
      return {};
    } catch (UsageError const& error) {
      return error.what();
    }
  });
}

std::uint64_t whole_number(std::string_view name, std::string const& text, std::uint64_t least, std::uint64_t most) {
  std::uint64_t value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    throw UsageError(fmt::format("{} = {}: a whole number from {} to {} is wanted", name, quote(text), least, most));
  return value;
}

int whole_number(std::string_view name, double value, int least, int most) {
  if (value >= least && value <= most && value == std::floor(value)) return int(value);
  throw UsageError(fmt::format("{} = {}: a whole number from {} to {} is wanted", name, value, least, most));
}

std::pair<std::string, std::vector<double>> parse_setting(std::string const& text) {
  auto const equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("--set {}: write NAME=NUMBER[,NUMBER...]", quote(text)));
  std::string const name = text.substr(0, equals);
  std::string const value = text.substr(equals + 1);
  bool const numbers = value.find_first_not_of("0123456789+-.,eE ") == std::string::npos;
  if (name == "graph" && !numbers) {
    try {
      return {name, read_graph_file(value)};
    } catch (ParameterError const& error) {
      throw SuiteError(error.what());
    }
  }
  std::vector<double> values;
  for (std::string_view const field : fields_of(value)) {
    try {
      values.push_back(number_in(field));
    } catch (UsageError const& error) {
      throw UsageError(fmt::format("--set {}: {}", quote(text), error.what()));
    }
  }
  return {name, values};
}

void CellFlags::add_physics(CLI::App& verb, std::string const& problem) {
  verb.add_option(problem, cell.problem, "Problem; see `polhode list problems`")->required();
  verb.add_option("--variant", cell.variant, "Variant words, joined by commas");
  has_t_end = add_number(verb, "--t-end", t_end, "Horizon [s]; default the problem's own");
  verb.add_option("--set", settings, "Change a parameter: NAME=NUMBER[,NUMBER...], or graph=FILE; repeatable")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);  // what follows the value is no second one: it may be the problem
}

void CellFlags::add_method(CLI::App& verb) {
  verb.add_option("--formulation", cell.formulation, "Attitude description; see `polhode list problems`")
      ->default_str("quaternion");
  verb.add_option("--integrator", cell.integrator, "Integrator; see `polhode list integrators`")->required();
  verb.add_option("--policy", cell.policy, "Norm policy; polhode list policies")->default_str("none");
  has_h = add_number(verb, "--h", h, "Step size [s]; divides the sample period");
  has_rtol = add_number(verb, "--rtol", rtol, "Relative tolerance, instead of --h");
  has_atol = add_number(verb, "--atol", atol, "Absolute tolerance; default rtol / 100");
}

results::Cell CellFlags::chosen() const {
  results::Cell chosen = cell;
  if (chosen.formulation.empty()) chosen.formulation = "quaternion";
  for (std::string const& text : settings) {
    auto const [name, values] = parse_setting(text);
    if (!chosen.set.try_emplace(name, values).second)
      throw UsageError(fmt::format("--set {}: {} is given twice", quote(text), quote(name)));
  }
  if (has_h && has_h->count() > 0) chosen.h = h;
  if (has_rtol && has_rtol->count() > 0) chosen.rtol = rtol;
  if (has_atol && has_atol->count() > 0) chosen.atol = atol;
  if (has_t_end->count() > 0) {
    check_positive("t_end", t_end);
    chosen.t_end = t_end;
  }
  return chosen;
}

results::Cell physics_alone(results::Cell cell) {
  cell.integrator = "dopri5";  // any method serves
  cell.formulation = "quaternion";
  cell.policy = "none";
  cell.h.reset();
  cell.rtol = 1e-6;
  cell.atol.reset();
  return cell;
}

}  // namespace polhode::bench
