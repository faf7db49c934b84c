#include "results/terminal.hpp"

#include <fmt/color.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>

namespace polhode::results {
namespace {

constexpr std::size_t gap = 2, least_width = 4;

std::string_view variable(char const* name) {
  char const* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::size_t width_of_terminal(int descriptor) {
  winsize window{};
  if (::ioctl(descriptor, TIOCGWINSZ, &window) == 0 && window.ws_col > 0) return window.ws_col;
  int const columns = std::atoi(std::string(variable("COLUMNS")).c_str());
  return columns > 0 ? static_cast<std::size_t>(columns) : 80;
}

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;
}

/// The first or last characters of a text.
std::string_view head(std::string_view text, std::size_t characters) {
  std::size_t i = 0;
  while (i < text.size() && (continues(text[i]) || characters-- > 0)) ++i;
  return text.substr(0, i);
}
std::string_view tail(std::string_view text, std::size_t characters) {
  return text.substr(head(text, places(text) - characters).size());
}

/// Without its middle, and without what would steer the terminal.
std::string shortened(std::string text, std::size_t width) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  if (places(text) <= width) return text;
  std::size_t const kept = width - 1, last = kept / 2;
  return fmt::format("{}…{}", head(text, kept - last), tail(text, last));
}

fmt::text_style style_of(Tone tone) {
  switch (tone) {
    case Tone::good:
      return fmt::fg(fmt::terminal_color::green);
    case Tone::caution:
      return fmt::fg(fmt::terminal_color::yellow);
    case Tone::bad:
      return fmt::fg(fmt::terminal_color::red);
    case Tone::quiet:
      return fmt::fg(fmt::terminal_color::bright_black);
    default:
      return fmt::emphasis::bold;
  }
}

/// How wide each column is: the widest of those that may lose something lose a place until all fit.
std::vector<std::size_t> widths_of(std::vector<TextColumn> const& columns,
                                   std::vector<std::vector<TextCell>> const& rows, std::size_t limit) {
  std::vector<std::size_t> widths;
  std::size_t total = columns.empty() ? 0 : gap * (columns.size() - 1);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::size_t width = places(columns[i].title);
    for (auto const& row : rows) width = std::max(width, i < row.size() ? places(row[i].text) : 0);
    widths.push_back(width);
    total += width;
  }
  while (limit > 0 && total > limit) {
    std::size_t widest = columns.size();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      bool const fixed = columns[i].number || columns[i].keep || widths[i] <= least_width;
      if (!fixed && (widest == columns.size() || widths[i] > widths[widest])) widest = i;
    }
    if (widest == columns.size()) break;
    --widths[widest];
    --total;
  }
  return widths;
}

}  // namespace

Tone tone_of(std::string_view word) {
  static std::map<std::string_view, Tone> const tones{
      {"ok", Tone::good},
      {"passed", Tone::good},
      {"reproduced", Tone::good},
      {"better", Tone::good},
      {"faster", Tone::good},
      {"inaccurate", Tone::caution},
      {"expected failure", Tone::caution},
      {"changed", Tone::caution},
      {"not reproduced", Tone::caution},
      {"diverged", Tone::bad},
      {"step_underflow", Tone::bad},
      {"max_steps", Tone::bad},
      {"nonlinear_fail", Tone::bad},
      {"stalled", Tone::bad},
      {"timeout", Tone::bad},
      {"crashed", Tone::bad},
      {"FAILED", Tone::bad},
      {"UNEXPECTED PASS", Tone::bad},
      {"VACUOUS", Tone::bad},
      {"worse", Tone::bad},
      {"slower", Tone::bad},
      {"refused", Tone::quiet},
      {"same", Tone::quiet},
  };
  auto const found = tones.find(word);
  return found == tones.end() ? Tone::plain : found->second;
}

Outlet outlet_of(int descriptor) {
  bool const terminal = ::isatty(descriptor) != 0;
  std::string_view const forced = variable("CLICOLOR_FORCE");
  bool const wanted = (!forced.empty() && forced != "0") || (terminal && variable("TERM") != "dumb");
  return {terminal ? width_of_terminal(descriptor) : 0, wanted && variable("NO_COLOR").empty()};
}

std::string toned(std::string_view text, Tone tone, Outlet const& outlet) {
  if (!outlet.colour || tone == Tone::plain || text.empty()) return std::string(text);
  return fmt::format(style_of(tone), "{}", text);
}

std::string text_table(std::vector<TextColumn> const& columns, std::vector<std::vector<TextCell>> const& rows,
                       Outlet const& outlet) {
  std::vector<std::size_t> const widths = widths_of(columns, rows, outlet.width);
  std::string text;
  auto const draw = [&](auto const& cell_of) {
    std::string line;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      TextCell const cell = cell_of(i);
      std::string const shown = shortened(cell.text, widths[i]);
      std::string const space(widths[i] - places(shown), ' ');
      if (i > 0) line += std::string(gap, ' ');
      line += columns[i].number ? space + toned(shown, cell.tone, outlet) : toned(shown, cell.tone, outlet) + space;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  };
  draw([&](std::size_t i) { return TextCell(columns[i].title, Tone::strong); });
  for (auto const& row : rows) draw([&](std::size_t i) { return i < row.size() ? row[i] : TextCell("", Tone::plain); });
  return text;
}

std::string wrapped(std::string_view text, Outlet const& outlet) {
  if (outlet.width == 0) return std::string(text);
  std::string out;
  std::size_t used = 0;
  for (std::size_t from = 0; from < text.size();) {
    std::size_t const to = std::min(text.find(' ', from), text.size());
    std::string_view const word = text.substr(from, to - from);
    std::size_t const width = places(word);
    bool const fits = used == 0 || used + 1 + width <= outlet.width;
    if (used > 0) out += fits ? ' ' : '\n';
    out += word;
    used = fits && used > 0 ? used + 1 + width : width;
    from = to + 1;
  }
  return out;
}

std::size_t places(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return !continues(c); }));
}

}  // namespace polhode::results
