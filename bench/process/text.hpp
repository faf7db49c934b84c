#pragma once
/// Text that users write: blanks, fields between commas, numbers.
#include <optional>
#include <string_view>
#include <vector>

namespace polhode::bench {

/// Without the blanks at its ends, carriage returns included.
std::string_view trimmed(std::string_view text);
/// What stands between commas, trimmed; fields may be empty, a blank text has none.
std::vector<std::string_view> fields_of(std::string_view text);
/// The number that is all of the text, if it is one and finite.
std::optional<double> finite_number(std::string_view text);

}  // namespace polhode::bench
