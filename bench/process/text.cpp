#include "bench/process/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace polhode::bench {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  auto const first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view text) {
  std::vector<std::string_view> fields;
  if (trimmed(text).empty()) return fields;
  for (std::size_t from = 0; from <= text.size();) {
    std::size_t const to = std::min(text.find(',', from), text.size());
    fields.push_back(trimmed(text.substr(from, to - from)));
    from = to + 1;
  }
  return fields;
}

std::optional<double> finite_number(std::string_view text) {
  double value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  bool const whole = error == std::errc() && end == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace polhode::bench
