#include "bench/process/messages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>

namespace polhode::bench {
namespace {

/// Damerau-Levenshtein distance in its restricted form: insert, delete, replace, or swap two neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      std::size_t const replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      bool const swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string nearest(std::string_view word, std::vector<std::string> const& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (auto const& candidate : known) {
    std::size_t const longer = std::max(word.size(), candidate.size());
    std::size_t const shorter = std::min(word.size(), candidate.size());
    bool const hopeless = candidate.empty() || longer - shorter >= least;
    if (hopeless) continue;
    std::size_t const distance = edit_distance(word, candidate);
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

std::string quote(std::string_view word) {
  constexpr std::size_t longest = 60;
  std::string text(word.substr(0, longest));
  if (word.size() > longest) {
    // Not in the middle of a UTF-8 character.
    auto const continues = [&](std::size_t i) { return (static_cast<unsigned char>(word[i]) & 0xC0) == 0x80; };
    while (!text.empty() && continues(text.size())) text.pop_back();
    text += "...";
  }
  for (char& c : text) {
    bool const control = static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    if (control) c = '?';
  }
  return "'" + text + "'";
}

std::string unknown(std::string_view kind, std::string_view word, std::vector<std::string> const& known,
                    std::string_view where) {
  auto const what = fmt::format("unknown {} {}{}{}", kind, quote(word), where.empty() ? "" : " ", where);
  if (known.empty()) return what + "; there are none";
  auto const near = nearest(word, known);
  if (!near.empty()) return fmt::format("{}; did you mean '{}'?", what, near);
  return fmt::format("{}; choose from {}", what, fmt::join(known, ", "));
}

void warn(std::string const& warning) {
  if (!warning.empty()) std::fputs(fmt::format("polhode: warning: {}\n", warning).c_str(), stderr);
}

}  // namespace polhode::bench
