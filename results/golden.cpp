#include "results/golden.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "results/run_name.hpp"
#include "results/shallow.hpp"
#include "results/store.hpp"
#include "results/whole_file.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_count(std::string_view column) {
  static std::set<std::string_view> const counts{"steps",      "rejected",         "evaluations", "jacobians",
                                                 "iterations", "controller_calls", "projections"};
  return counts.contains(column);
}

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
    auto const found = line.columns.find(column);
    if (found == line.columns.end()) continue;
    if (is_count(column)) {
      json[column] = static_cast<std::int64_t>(found->second);
    } else {
      json[column] = found->second;
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

std::optional<double> column_of(GoldenLine const& line, std::string const& column) {
  auto const found = line.columns.find(column);
  return found == line.columns.end() ? std::nullopt : std::optional(found->second);
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
    note(column, shown(column_of(before, column)), shown(column_of(after, column)));
  }
  return text;
}

}  // namespace

std::vector<std::string> const& golden_columns() {
  static std::vector<std::string> const columns{"steps",
                                                "rejected",
                                                "evaluations",
                                                "jacobians",
                                                "iterations",
                                                "controller_calls",
                                                "projections",
                                                "norm_drift_raw_max",
                                                "norm_drift_max",
                                                "norm_drift_final",
                                                "norm_drift_rms",
                                                "attitude_error_max",
                                                "attitude_error_end",
                                                "attitude_error_l2",
                                                "rate_error_max",
                                                "rate_error_end",
                                                "energy_drift_max",
                                                "momentum_drift_max",
                                                "momentum_direction_max",
                                                "position_defect_max",
                                                "velocity_defect_max",
                                                "multiplier_error_max"};
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
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in || fs::is_directory(file)) throw StoreError(fmt::format("{}: cannot be read", file.string()));
  std::vector<GoldenLine> lines;
  std::set<std::string> seen;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    try {
      if (number == 1) {
        check_head(text);
        continue;
      }
      lines.push_back(line_from(text));
      if (!seen.insert(lines.back().cell).second) throw std::invalid_argument("cell: stands on an earlier line, too");
    } catch (std::invalid_argument const& error) {
      throw StoreError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
    }
  }
  if (in.bad()) throw StoreError(fmt::format("{}: cannot be read to its end", file.string()));
  return lines;
}

void write_golden(fs::path const& file, std::string const& suite, std::vector<GoldenLine> const& lines) {
  std::string text = Json{{"schema", schema}, {"kind", "golden"}, {"suite", suite}}.dump() + "\n";
  for (GoldenLine const& line : lines) text += to_json(line).dump() + "\n";
  write_whole(file, text);
}

GoldenLine settled(GoldenLine const& before, GoldenLine const& now) {
  bool const same = before.status == now.status;
  if (!same) return now;
  GoldenLine line = now;
  for (std::string const& column : golden_columns()) {
    auto const golden = column_of(before, column);
    bool const agrees = deviation(default_tolerance(column), golden, column_of(now, column)) <= 1;
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
