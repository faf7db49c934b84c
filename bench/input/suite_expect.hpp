#pragma once
/// How a suite's selectors and expectations are read. A part of suite.cpp in a file of its own, as is suite_toml.hpp.
#include <optional>
#include <type_traits>

#include "bench/input/suite_select.hpp"
#include "bench/input/suite_toml.hpp"

namespace polhode::bench::suite_toml {

inline constexpr std::size_t max_cells = 1'000'000;

// --- Selectors -------------------------------------------------------------------------------------------------------

inline Selector read_selector(Toml const& value, std::string const& where, SelectableWords const& known) {
  Selector selector;
  for (auto const& [key, member] : table(value, where, selector_keys())) {
    bool const numeric = member.is_integer() || member.is_floating();
    auto const pattern = numeric ? fmt::format("{}", number(member, key)) : text(member, key);
    located(member, [&] { check_pattern(key, pattern, known); });
    selector[key] = pattern;
  }
  return selector;
}

// --- Expectations ----------------------------------------------------------------------------------------------------

template <class T>
inline constexpr bool is_number = std::is_arithmetic_v<T>;
template <class T>
inline constexpr bool is_number<std::optional<T>> = std::is_arithmetic_v<T>;

/// What may be said of each field of a record: the keys of its bound.
inline std::map<std::string, Words> const& boundable_fields() {
  static std::map<std::string, Words> const fields = [] {
    Words const number_keys{"min", "max", "is", "golden", "rel", "abs", "digits"};
    std::map<std::string, Words> all{{"norm_drift", number_keys}, {"order", {"min", "max", "nominal", "within"}}};
    results::Record const record;
    results::for_each_field(record, [&]<class Member>(std::string const& name, std::string_view, Member const&) {
      all[name] = is_number<Member> ? number_keys : Words{"is", "golden"};
    });
    all.erase("cpu_time_s");  // seconds are never gated
    return all;
  }();
  return fields;
}

inline std::optional<double> optional_number(Toml const& in, std::string const& field, std::string const& key) {
  auto const* value = find(in, key);
  return value ? std::optional(number(*value, field + "." + key)) : std::nullopt;
}

/// A width: how far a value may be off.
inline std::optional<double> optional_width(Toml const& in, std::string const& field, std::string const& key) {
  auto const value = optional_number(in, field, key);
  if (value && *value < 0) fail(*find(in, key), fmt::format("{}.{} = {}: must not be negative", field, key, *value));
  return value;
}

inline Bound read_bound(Toml const& value, std::string const& field, Words const& keys) {
  bool const numeric = keys.front() == "min";
  std::string const example = numeric ? "{ max = 1e-9 }" : "{ is = \"ok\" }";
  if (!value.is_table()) wrong_type(value, field, "table such as " + example);
  table(value, field, keys);
  auto const flag = [&](std::string const& key) {
    auto const* member = find(value, key);
    return member != nullptr && truth(*member, field + "." + key);
  };
  Bound bound;
  bound.field = field;
  bound.min = optional_number(value, field, "min");
  bound.max = optional_number(value, field, "max");
  if (auto const* is = find(value, "is")) {
    bound.is = numeric ? fmt::format("{}", number(*is, field + ".is")) : text(*is, field + ".is");
  }
  bound.nominal = flag("nominal");
  bound.within = optional_width(value, field, "within");
  bound.golden = flag("golden");
  bound.rel = optional_width(value, field, "rel");
  bound.abs = optional_width(value, field, "abs");
  bound.digits = optional_width(value, field, "digits");
  if (bound.min && bound.max && *bound.min > *bound.max) {
    fail(value, fmt::format("{}: min = {} is above max = {}", field, *bound.min, *bound.max));
  }
  if (bound.within && !bound.nominal) fail(value, field + ": 'within' needs nominal = true");
  bool const tolerance = bound.rel || bound.abs || bound.digits;
  if (tolerance && !bound.golden) fail(value, field + ": 'rel', 'abs' and 'digits' need golden = true");
  bool const bounds = bound.min || bound.max || bound.is || bound.nominal || bound.golden;
  if (!bounds) fail(value, field + " is not bounded; give e.g. " + example);
  return bound;
}

inline Expectation read_expectation(Toml const& value, SelectableWords const& words) {
  std::string const where = "[[expect]]";
  if (auto const* seconds = find(value, "cpu_time_s")) fail(*seconds, "cpu_time_s: seconds are never gated");
  auto const& fields = boundable_fields();
  Words keys{"select", "min_cells", "xfail"};
  for (auto const& [field, bound_keys] : fields) keys.push_back(field);
  auto const& members = table(value, where, keys);

  Expectation expectation;
  expectation.line = static_cast<int>(value.location().line());
  auto const& select = need(value, where, "select", "select = { integrator = \"rk4\" }, or select = {} for every cell");
  expectation.select = read_selector(select, "select", words);
  for (auto const& [key, member] : members) {
    auto const field = fields.find(key);
    if (field != fields.end()) expectation.bounds.push_back(read_bound(member, key, field->second));
  }
  if (expectation.bounds.empty()) fail(value, where + " bounds nothing; give e.g. norm_drift = { max = 1e-9 }");
  if (auto const* least = find(value, "min_cells")) {
    expectation.min_cells = static_cast<int>(whole(*least, "min_cells", 1, max_cells));
  }
  if (auto const* reason = find(value, "xfail")) {
    expectation.xfail = text(*reason, "xfail");
    if (expectation.xfail->empty()) fail(*reason, "xfail: empty; say why the expectation fails");
  }
  return expectation;
}

}  // namespace polhode::bench::suite_toml
