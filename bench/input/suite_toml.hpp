#pragma once
/// How a suite file becomes typed values: reading, TOML parsing, and reads that fail with "file:line: key: ...".
/// A part of suite.cpp in a file of its own; nobody else includes it, for the parser is slow to compile.
#include <fmt/format.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <toml.hpp>
#include <vector>

#include "bench/input/suite.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench::suite_toml {

using Toml = toml::basic_value<toml::discard_comments, std::map, std::vector>;
using Words = std::vector<std::string>;

[[noreturn]] inline void fail(std::string_view file, std::size_t line, std::string_view message) {
  throw SuiteError(fmt::format("{}:{}: {}", file, line, message));
}

[[noreturn]] inline void fail(Toml const& at, std::string_view message) {
  auto const place = at.location();
  fail(place.file_name(), place.line(), message);
}

/// Runs `action`; a UsageError in it becomes a SuiteError at `at`.
template <class Action>
auto located(Toml const& at, Action&& action) {
  try {
    return action();
  } catch (UsageError const& error) {
    fail(at, error.what());
  }
}

// --- From the file to a TOML value -----------------------------------------------------------------------------------

inline std::string read_text(std::filesystem::path const& file) {
  constexpr std::uintmax_t most_bytes = 16 << 20;
  try {
    return results::read_whole(file, most_bytes);
  } catch (results::StoreError const& error) {
    throw SuiteError(error.what());
  }
}

/// Brackets and dots beyond this depth: no suite needs them, and the parser's recursion would overflow the stack.
inline bool too_deep(std::string_view row, int& brackets) {
  constexpr int max_depth = 100;
  auto const first = row.find_first_not_of(" \t");
  bool const comment = first != std::string_view::npos && row[first] == '#';
  if (comment) return false;
  int dots = 0;
  for (char const c : row) {
    // Those in strings are counted as well, which the generous limit allows for.
    if (c == '[' || c == '{') ++brackets;
    if ((c == ']' || c == '}') && brackets > 0) --brackets;
    if (c == '.') ++dots;
    if (c == ',' || c == '=') dots = 0;
    if (brackets > max_depth || dots > max_depth) return true;
  }
  return false;
}

/// What the parser does not check itself: deep nesting, and bytes that are no text.
inline void check_text(std::string_view text, std::string_view file) {
  std::size_t line = 1;
  int brackets = 0;
  for (std::size_t begin = 0; begin < text.size(); ++line) {
    auto const row = text.substr(begin, text.find('\n', begin) - begin);
    begin += row.size() + 1;
    if (too_deep(row, brackets)) fail(file, line, "not valid TOML: nested too deeply");
    try {
      static_cast<void>(nlohmann::json(row).dump());
    } catch (nlohmann::json::exception const&) {
      fail(file, line, "not valid TOML: not UTF-8");
    }
  }
}

/// The parser's drawing of several lines as one: the headline, or the last remark under the drawing if that is empty.
inline std::string one_line(std::string const& drawing) {
  std::istringstream lines(drawing);
  std::string headline;
  std::getline(lines, headline);
  for (std::string_view const prefix : {"[error] ", "toml::"}) {
    if (!headline.starts_with(prefix)) continue;
    // After "toml::" comes the parser's function, which is no news to the user.
    auto const end = prefix == "toml::" ? headline.find_first_of(": ", prefix.size()) : prefix.size() - 1;
    headline.erase(0, end == std::string::npos ? end : headline.find_first_not_of(": ", end));
  }
  for (std::string row; headline.empty() && std::getline(lines, row);) {
    auto const mark = row.find("^--- ");
    if (mark != std::string::npos) headline = row.substr(mark + 5);
  }
  headline.resize(headline.find_last_not_of(" .") + 1);
  for (char& c : headline) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return headline;
}

inline Toml parse(std::string const& text, std::string const& file) {
  check_text(text, file);
  std::istringstream in(text);
  try {
    return toml::parse<toml::discard_comments, std::map, std::vector>(in, file);
  } catch (toml::exception const& error) {
    fail(file, error.location().line(), "not valid TOML: " + one_line(error.what()));
  } catch (std::exception const& error) {
    fail(file, 1, "not valid TOML: " + one_line(error.what()));
  }
}

// --- From TOML values to typed ones ----------------------------------------------------------------------------------

[[noreturn]] inline void wrong_type(Toml const& value, std::string_view key, std::string_view wanted) {
  auto const found = value.is_floating() ? "float" : toml::stringize(value.type());
  fail(value, fmt::format("{}: {} expected, {} found", key, wanted, found));
}

/// The table at `value`, all of whose keys are among `known`.
inline Toml::table_type const& table(Toml const& value, std::string const& where, Words const& known) {
  if (!value.is_table()) wrong_type(value, where, "table");
  for (auto const& [key, member] : value.as_table()) {
    bool const found = std::find(known.begin(), known.end(), key) != known.end();
    if (!found) fail(member, unknown("key", key, known, "in " + where));
  }
  return value.as_table();
}

/// The member of a table, or null.
inline Toml const* find(Toml const& in, std::string const& key) {
  auto const& members = in.as_table();
  auto const found = members.find(key);
  return found == members.end() ? nullptr : &found->second;
}

inline Toml const& need(Toml const& in, std::string const& where, std::string const& key, std::string_view example) {
  if (auto const* member = find(in, key)) return *member;
  fail(in, fmt::format("{} has no '{}'; give e.g. {}", where, key, example));
}

inline std::string text(Toml const& value, std::string_view key) {
  if (!value.is_string()) wrong_type(value, key, "string");
  return value.as_string().str;
}

inline bool truth(Toml const& value, std::string_view key) {
  if (!value.is_boolean()) wrong_type(value, key, "true or false");
  return value.as_boolean();
}

inline double number(Toml const& value, std::string_view key) {
  if (value.is_integer()) return static_cast<double>(value.as_integer());
  if (!value.is_floating()) wrong_type(value, key, "number");
  double const found = value.as_floating();
  // The parser turns 1e999 into the largest double.
  bool const finite = std::abs(found) < DBL_MAX;
  if (!finite) fail(value, fmt::format("{} = {}: not a finite number", key, found));
  return found;
}

inline std::int64_t whole(Toml const& value, std::string_view key, std::int64_t least, std::int64_t most) {
  if (!value.is_integer()) wrong_type(value, key, "whole number");
  auto const found = value.as_integer();
  if (found < least || found > most) {
    fail(value, fmt::format("{} = {}: a whole number from {} to {} is wanted", key, found, least, most));
  }
  return found;
}

/// The elements of a list, or the value itself where a list of one is meant.
inline std::vector<Toml const*> items(Toml const& value, std::string_view key) {
  if (!value.is_array()) return {&value};
  std::vector<Toml const*> all;
  for (auto const& item : value.as_array()) all.push_back(&item);
  if (all.empty()) fail(value, fmt::format("{}: empty list; give at least one value or leave the key out", key));
  return all;
}

/// From first to last, both exact, in equal ratios. What lies between is rounded to 15 digits, so that it is the number
/// that a person would write (0.025, not 0.024999999999999998) and does not depend on the mathematical library.
inline std::vector<double> logspace(Toml const& value, std::string const& key) {
  std::string const where = key + " = { logspace, count }";
  table(value, where, {"logspace", "count"});
  auto const& ends = need(value, where, "logspace", "logspace = [0.01, 0.1]");
  auto const n = whole(need(value, where, "count", "count = 4"), "count", 2, 10'000);
  bool const pair = ends.is_array() && ends.as_array().size() == 2;
  if (!pair) fail(ends, "logspace: two numbers expected, as in [0.01, 0.1]");
  double const first = number(ends.as_array()[0], "logspace");
  double const last = number(ends.as_array()[1], "logspace");
  if (first <= 0 || last <= 0) fail(ends, fmt::format("logspace = [{}, {}]: both ends must be positive", first, last));
  std::vector<double> points{first};
  for (std::int64_t i = 1; i + 1 < n; ++i) {
    double const part = static_cast<double>(i) / static_cast<double>(n - 1);
    double const point = std::pow(first, 1 - part) * std::pow(last, part);
    points.push_back(std::stod(fmt::format("{:.15g}", point)));
  }
  points.push_back(last);
  return points;
}

/// An axis of h, rtol, atol or t_end.
inline std::vector<double> positive_axis(Toml const& value, std::string const& key) {
  if (value.is_table() && key != "t_end") return logspace(value, key);
  std::vector<double> points;
  for (auto const* item : items(value, key)) {
    double const point = number(*item, key);
    located(*item, [&] { check_positive(key, point); });
    points.push_back(point);
  }
  return points;
}

}  // namespace polhode::bench::suite_toml
