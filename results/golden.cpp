#include "results/golden.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "results/run_name.hpp"
#include "results/shallow.hpp"
#include "results/whole_file.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();

constexpr std::array<std::string_view, 7> counts{"steps",      "rejected",         "evaluations", "jacobians",
                                                 "iterations", "controller_calls", "projections"};
constexpr std::array<std::string_view, 15> errors_and_drifts{
    "norm_drift_raw_max",  "norm_drift_max",      "norm_drift_final",    "norm_drift_rms",
    "attitude_error_max",  "attitude_error_end",  "attitude_error_l2",   "rate_error_max",
    "rate_error_end",      "energy_drift_max",    "momentum_drift_max",  "momentum_direction_max",
    "position_defect_max", "velocity_defect_max", "multiplier_error_max"};

/// As many digits as tell something: the rest would change with every compiler.
double rounded(double number) {
  return std::stod(fmt::format("{:.6g}", number));
}

double in_digits(double golden, double value) {
  double const a = std::max(std::abs(golden), golden_floor);
  double const b = std::max(std::abs(value), golden_floor);
  bool const opposite = golden * value < 0 && (a > golden_floor || b > golden_floor);
  return opposite ? infinity : std::abs(std::log10(a / b));
}

/// A difference as a multiple of what is allowed; a width of 0 allows equality alone.
double multiple(double difference, double allowed) {
  if (difference == 0) return 0;
  return allowed > 0 ? difference / allowed : infinity;
}

Json to_json(GoldenLine const& line) {
  Json json{{"cell", line.cell}, {"name", line.name}, {"status", line.status}};
  for (std::string const& column : golden_columns()) {
    auto const value = line.column(column);
    if (!value) continue;
    if (is_count(column)) {
      json[column] = static_cast<std::int64_t>(*value);
    } else {
      json[column] = *value;
    }
  }
  return json;
}

std::string text_at(Json const& json, std::string const& key) {
  if (!json.contains(key) || !json.at(key).is_string()) throw std::invalid_argument(key + ": must be a string");
  return json.at(key).get<std::string>();
}

Json parse(std::string const& text) {
  try {
    Json json = Json::parse(text, shallow);
    if (json.is_object()) return json;
  } catch (nlohmann::json::exception const&) {
  }
  throw std::invalid_argument("must be one JSON object");
}

GoldenLine line_from(std::string const& text) {
  Json const json = parse(text);
  GoldenLine line{text_at(json, "cell"), text_at(json, "name"), text_at(json, "status"), {}};
  auto const& columns = golden_columns();
  for (auto const& [key, value] : json.items()) {
    if (key == "cell" || key == "name" || key == "status") continue;
    if (std::ranges::find(columns, key) == columns.end()) throw std::invalid_argument(key + ": no golden column");
    if (!value.is_number()) throw std::invalid_argument(key + ": must be a number");
    line.columns[key] = value.get<double>();
  }
  return line;
}

void check_head(std::string const& text) {
  Json const json = parse(text);
  bool const ours = json.value("kind", Json()) == "golden" && json.value("schema", Json()) == schema;
  if (!ours) {
    throw std::invalid_argument(fmt::format(R"(must begin with {{"schema":{},"kind":"golden","suite":...}})", schema));
  }
}

/// The lines of a golden file. Throws StoreError with file and line.
std::vector<GoldenLine> lines_from(std::string const& text, fs::path const& file) {
  std::vector<GoldenLine> lines;
  std::set<std::string> seen;
  std::istringstream in(text);
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    try {
      if (number == 1) {
        check_head(line);
        continue;
      }
      lines.push_back(line_from(line));
      if (!seen.insert(lines.back().cell).second) throw std::invalid_argument("cell: stands on an earlier line, too");
    } catch (std::invalid_argument const& error) {
      throw StoreError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
    }
  }
  return lines;
}

std::string shown(std::optional<double> value) {
  return value ? fmt::format("{}", *value) : "null";
}

std::string changes_of(GoldenLine const& before, GoldenLine const& after) {
  std::string text;
  auto const note = [&](std::string_view what, std::string const& old, std::string const& fresh) {
    if (old != fresh) text += fmt::format("{}{} {} -> {}", text.empty() ? "" : ", ", what, old, fresh);
  };
  note("status", before.status, after.status);
  for (std::string const& column : golden_columns()) {
    note(column, shown(before.column(column)), shown(after.column(column)));
  }
  return text;
}

}  // namespace

std::optional<double> GoldenLine::column(std::string const& name_of_column) const {
  auto const found = columns.find(name_of_column);
  return found == columns.end() ? std::nullopt : std::optional(found->second);
}

bool is_count(std::string_view column) {
  return std::ranges::find(counts, column) != counts.end();
}

std::vector<std::string> const& golden_columns() {
  static std::vector<std::string> const columns = [] {
    std::vector<std::string> all(counts.begin(), counts.end());
    all.insert(all.end(), errors_and_drifts.begin(), errors_and_drifts.end());
    return all;
  }();
  return columns;
}

GoldenLine golden_of(Record const& record) {
  GoldenLine line{record.cell, run_name(record.of), std::string(name_of(record.status)), {}};
  Json const json = to_json(record);
  for (std::string const& column : golden_columns()) {
    Json const& value = json.at(column);
    if (value.is_number()) line.columns[column] = is_count(column) ? value.get<double>() : rounded(value.get<double>());
  }
  return line;
}

Tolerance default_tolerance(std::string_view column) {
  Tolerance tolerance;
  if (is_count(column)) {
    tolerance.rel = 0.02;
  } else {
    tolerance.digits = 0.3;
  }
  return tolerance;
}

std::string text_of(Tolerance const& tolerance) {
  std::string widths;
  auto const add = [&](std::string const& width) { widths += (widths.empty() ? "" : " or ") + width; };
  if (tolerance.rel) add(fmt::format("{:g}%", 100 * *tolerance.rel));
  if (tolerance.abs) add(fmt::format("{:g}", *tolerance.abs));
  if (tolerance.digits) add(fmt::format("{:g} digits", *tolerance.digits));
  return "golden within " + widths;
}

double deviation(Tolerance const& tolerance, std::optional<double> golden, std::optional<double> value) {
  if (!golden && !value) return 0;
  if (!golden || !value) return infinity;
  double const apart = std::abs(*value - *golden);
  double least = infinity;
  if (tolerance.rel) least = std::min(least, multiple(apart, *tolerance.rel * std::abs(*golden)));
  if (tolerance.abs) least = std::min(least, multiple(apart, *tolerance.abs));
  if (tolerance.digits) least = std::min(least, multiple(in_digits(*golden, *value), *tolerance.digits));
  return least;
}

std::vector<GoldenLine> read_golden(fs::path const& file) {
  auto const parse = [&](std::string const& text) { return lines_from(text, file); };
  return read_if_there(file, parse).value_or(std::vector<GoldenLine>());
}

void write_golden(fs::path const& file, std::string const& suite, std::vector<GoldenLine> const& lines) {
  std::string text = Json{{"schema", schema}, {"kind", "golden"}, {"suite", suite}}.dump() + "\n";
  for (GoldenLine const& line : lines) text += to_json(line).dump() + "\n";
  write_whole(file, text);
}

GoldenLine settled(GoldenLine const& before, GoldenLine const& now) {
  if (before.status != now.status) return now;
  GoldenLine line = now;
  for (std::string const& column : golden_columns()) {
    auto const golden = before.column(column);
    bool const agrees = deviation(default_tolerance(column), golden, now.column(column)) <= 1;
    if (golden && agrees) line.columns[column] = *golden;
  }
  return line;
}

std::vector<std::string> difference(std::vector<GoldenLine> const& before, std::vector<GoldenLine> const& after) {
  std::map<std::string, GoldenLine const*> old;
  for (GoldenLine const& line : before) old[line.cell] = &line;
  std::vector<std::string> text;
  for (GoldenLine const& line : after) {
    auto const found = old.find(line.cell);
    if (found == old.end()) {
      text.push_back("+ " + line.name);
      continue;
    }
    std::string const changes = changes_of(*found->second, line);
    if (!changes.empty()) text.push_back(fmt::format("~ {}: {}", line.name, changes));
    old.erase(found);
  }
  for (GoldenLine const& line : before) {
    if (old.contains(line.cell)) text.push_back("- " + line.name);
  }
  return text;
}

}  // namespace polhode::results
