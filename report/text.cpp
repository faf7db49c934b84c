#include "report/text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace polhode::report {

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return absent;
  std::string text = fmt::format("{:.{}g}", value, digits);
  // counts and the like: 2410, not 2.41e3
  if (std::abs(value) >= 1 && std::abs(value) < 1e6) return fmt::format("{}", std::stod(text));
  auto const exponent = text.find('e');
  if (exponent == std::string::npos) return text;
  // "1e-06" is "1e-6" and "2e+06" is "2e6" to a reader
  if (text[exponent + 1] == '+') text.erase(exponent + 1, 1);
  auto const digit = text.find_first_not_of("e-", exponent);
  if (text[digit] == '0') text.erase(digit, 1);
  return text;
}

std::string exact(double value) {
  if (!std::isfinite(value)) return "";
  return fmt::format("{}", value);
}

Entry number(std::optional<double> value, int digits) {
  if (!value || !std::isfinite(*value)) return absent;
  return {significant(*value, digits), exact(*value)};
}

Entry count(std::optional<std::int64_t> n) {
  if (!n) return absent;
  return std::to_string(*n);
}

Estimate quotient(Estimate const& over, Estimate const& under) {
  return {over.value / under.value, over.low / under.high, over.high / under.low};
}

Entry number(Estimate const& estimate) {
  Entry entry = number(estimate.value);
  entry.interval = fmt::format("{}, {}", significant(estimate.low), significant(estimate.high));
  return entry;
}

std::string interval_of(Estimate const& estimate) {
  return fmt::format("{} to {}", significant(estimate.low), significant(estimate.high));
}

namespace {

struct Unit {
  double per_second;
  char const* name;
};

Unit unit_of(double seconds) {
  if (seconds < 1e-6) return {1e9, "ns"};
  if (seconds < 1e-3) return {1e6, "µs"};
  if (seconds < 1) return {1e3, "ms"};
  return {1, "s"};
}

}  // namespace

std::string duration(double seconds, int digits) {
  if (!std::isfinite(seconds)) return absent;
  Unit const unit = unit_of(seconds);
  return significant(seconds * unit.per_second, digits) + " " + unit.name;
}

Entry cpu_time(Estimate const& seconds) {
  Entry entry(duration(seconds.value), exact(seconds.value));
  Unit const unit = unit_of(seconds.value);
  entry.interval =
      fmt::format("{}, {}", significant(seconds.low * unit.per_second), significant(seconds.high * unit.per_second));
  return entry;
}

Entry cpu_time(std::optional<results::CpuTime> const& time) {
  if (!time) return absent;
  return cpu_time(Estimate{time->median, time->low, time->high});
}

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

double arcseconds(double radians) {
  return degrees(radians) * 3600;
}

std::string angle(double radians) {
  return fmt::format("{} rad ({} arcsec)", significant(radians), significant(arcseconds(radians)));
}

std::string listed(std::vector<std::string> const& words, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? fmt::format(" {} ", last) : ", ";
    text += words[i];
  }
  return text;
}

std::string shortened(std::vector<std::string> words, std::size_t most) {
  if (words.size() > most) {
    std::size_t const others = words.size() - most + 1;
    words.resize(most - 1);
    words.push_back(fmt::format("{} others", others));
  }
  return listed(words);
}

std::string counted(std::size_t n, std::string_view singular, std::string_view plural) {
  return fmt::format("{} {}", n, n == 1 ? singular : plural);
}

namespace {

/// Length of the well-formed UTF-8 sequence that starts at `i`, 0 if there is none.
std::size_t sequence_length(std::string_view text, std::size_t i) {
  auto const byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  unsigned const lead = byte(i);
  std::size_t const length = lead < 0x80                   ? 1
                             : lead >= 0xC2 && lead < 0xE0 ? 2
                             : (lead & 0xF0) == 0xE0       ? 3
                             : lead >= 0xF0 && lead < 0xF5 ? 4
                                                           : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
  }
  if (length < 3) return length;
  // Overlong forms, surrogates, the two non-characters that XML forbids, and what lies beyond U+10FFFF.
  unsigned const second = byte(i + 1);
  bool const bad = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second >= 0xA0) ||
                   (lead == 0xEF && second == 0xBF && byte(i + 2) >= 0xBE) || (lead == 0xF0 && second < 0x90) ||
                   (lead == 0xF4 && second >= 0x90);
  return bad ? 0 : length;
}

}  // namespace

std::string_view entity_of(char c) {
  return c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : "";
}

std::string one_line(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t const length = sequence_length(text, i);
    auto const byte = static_cast<unsigned char>(text[i]);
    if (length == 0) {
      out += "\uFFFD";
    } else if (length == 1 && (byte < 0x20 || byte == 0x7F)) {
      out += ' ';
    } else {
      out += text.substr(i, length);
    }
    i += length == 0 ? 1 : length;
  }
  return out;
}

}  // namespace polhode::report
