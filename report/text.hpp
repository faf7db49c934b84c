#pragma once
/// Numbers and lists in words: how many digits, which unit.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/document.hpp"
#include "results/record.hpp"

namespace polhode::report {

/// What stands where a run has no such value.
inline constexpr char const* absent = "–";

/// A number with so many significant digits, e.g. "5.03e-10"; `absent` if it is not finite.
std::string significant(double value, int digits = 3);
/// The shortest text that reads back as the same number; empty if it is not finite.
std::string exact(double value);
/// A table's entry: rounded to read, exact in the CSV file.
Entry number(std::optional<double> value, int digits = 3);
/// The same of a count, in full.
Entry count(std::optional<std::int64_t> n);

/// A number and the ends of its 95% interval: all three alike where nothing varies.
struct Estimate {
  double value = 0, low = 0, high = 0;
};
/// over / under, and how far the ends of the two intervals let it be off. All are positive.
Estimate quotient(Estimate const& over, Estimate const& under);
/// With its interval.
Entry number(Estimate const& estimate);
/// "1.02 to 1.05".
std::string interval_of(Estimate const& estimate);

/// A CPU time in the unit that suits it, e.g. "12.3 µs".
std::string duration(double seconds, int digits = 3);
/// The same with its interval; seconds in the CSV file.
Entry cpu_time(Estimate const& seconds);
Entry cpu_time(std::optional<results::CpuTime> const& time);

double degrees(double radians);
double arcseconds(double radians);
/// "5.03e-10 rad (0.000104 arcsec)".
std::string angle(double radians);

/// "a", "a and b", "a, b and c".
std::string listed(std::vector<std::string> const& words, std::string_view last = "and");
/// The same with at most so many words: "a, b and 7 others".
std::string shortened(std::vector<std::string> words, std::size_t most);
/// "1 run", "2 runs".
std::string counted(std::size_t n, std::string_view singular, std::string_view plural);

/// What HTML and Markdown write for &, < and >; empty for every other character.
std::string_view entity_of(char c);

/// One line of valid UTF-8 without control characters: what every renderer may rely on.
std::string one_line(std::string_view text);

}  // namespace polhode::report
