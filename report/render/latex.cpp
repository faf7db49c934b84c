#include "report/render/latex.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <optional>

#include "report/text.hpp"

namespace polhode::report {
namespace {

constexpr std::size_t rows_of_a_page = 40;

/// The character that starts at `i`, which moves behind it. The text is well-formed UTF-8.
std::uint32_t next_character(std::string_view text, std::size_t& i) {
  auto const lead = static_cast<unsigned char>(text[i++]);
  if (lead < 0x80) return lead;
  int const more = lead < 0xE0 ? 1 : lead < 0xF0 ? 2 : 3;
  std::uint32_t code = lead & (0x3FU >> more);
  for (int k = 0; k < more; ++k) code = (code << 6) | (static_cast<unsigned char>(text[i++]) & 0x3FU);
  return code;
}

/// What stands for a character that means something to LaTeX, or that it does not know; nothing for all others.
std::optional<std::string_view> replacement(std::uint32_t character) {
  static std::map<std::uint32_t, std::string_view> const known{
      {'\\', "\\textbackslash{}"},
      {'{', "\\{"},
      {'}', "\\}"},
      {'$', "\\$"},
      {'&', "\\&"},
      {'#', "\\#"},
      {'%', "\\%"},
      {'_', "\\_"},
      {'^', "\\textasciicircum{}"},
      {'~', "\\textasciitilde{}"},
      {'<', "$<$"},
      {'>', "$>$"},
      {'|', "$|$"},
      {'"', "{\\char34}"},
      {'[', "{[}"},  // after the end of a row it would begin an argument
      {'*', "{*}"},  // likewise
      {'`', "{`}"},  // no ligature with ? and !
      {0xB1, "$\\pm$"},
      {0xB5, "$\\mu$"},
      {0xB0, "$^\\circ$"},
      {0xB2, "$^2$"},
      {0xB3, "$^3$"},
      {0xB7, "$\\cdot$"},
      {0xD7, "$\\times$"},
      {0x3BC, "$\\mu$"},
      {0x3B1, "$\\alpha$"},
      {0x3B8, "$\\theta$"},
      {0x3C9, "$\\omega$"},
      {0x3C3, "$\\sigma$"},
      {0x394, "$\\Delta$"},
      {0x2013, "--"},
      {0x2014, "---"},
      {0x2018, "{`}"},
      {0x2019, "{'}"},
      {0x2026, "\\ldots{}"},
      {0x2212, "$-$"},
      {0x221E, "$\\infty$"},
      {0x2248, "$\\approx$"},
      {0x2260, "$\\neq$"},
      {0x2264, "$\\leq$"},
      {0x2265, "$\\geq$"},
  };
  auto const found = known.find(character);
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

/// Letters that every LaTeX of the last years knows: ASCII, and Latin ones with accents.
bool is_known_letter(std::uint32_t character) {
  bool const latin = character >= 0xC0 && character <= 0x17F && character != 0xF7;
  return character < 0x80 || latin;
}

struct Number {
  std::string_view mantissa, exponent, unit;  ///< "-4.1", "-9", "µs"
};

std::size_t digits_from(std::string_view text, std::size_t i) {
  while (i < text.size() && std::isdigit(static_cast<unsigned char>(text[i])) != 0) ++i;
  return i;
}

/// A number, alone or before a unit of letters.
std::optional<Number> number_in(std::string_view text) {
  std::size_t const sign = text.starts_with('-') ? 1 : 0;
  std::size_t end = digits_from(text, sign);
  if (end == sign) return {};
  if (end < text.size() && text[end] == '.') {
    std::size_t const decimals = digits_from(text, end + 1);
    if (decimals == end + 1) return {};
    end = decimals;
  }
  Number number{text.substr(0, end), {}, {}};
  if (end < text.size() && text[end] == 'e') {
    std::size_t const from = end + 1, first = from + (text.substr(from).starts_with('-') ? 1 : 0);
    end = digits_from(text, first);
    if (end == first) return {};
    number.exponent = text.substr(from, end - from);
  }
  if (end == text.size()) return number;
  if (text[end] != ' ') return {};
  number.unit = text.substr(end + 1);
  bool const letters = !number.unit.empty() && number.unit.size() <= 4 && std::ranges::none_of(number.unit, [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) != 0 || std::isdigit(static_cast<unsigned char>(c)) != 0;
  });
  return letters ? std::optional(number) : std::nullopt;
}

/// Runs of letters that are no number by themselves are escaped; numbers become mathematics.
std::string quantity(std::string_view text) {
  auto const number = number_in(text);
  if (!number) return escape_latex(text);
  std::string out = fmt::format("${}", number->mantissa);
  if (!number->exponent.empty()) out += fmt::format("\\times10^{{{}}}", number->exponent);
  out += '$';
  if (!number->unit.empty()) out += "~" + escape_latex(number->unit);
  return out;
}

std::string render(Entry const& entry) {
  std::string const text = quantity(one_line(entry.text));
  return entry.interval.empty() ? text : fmt::format("{} [{}]", text, escape_latex(entry.interval));
}

std::string render(Text const& text) {
  std::string out;
  for (Span const& span : text.spans) {
    out += span.code ? fmt::format("\\texttt{{{}}}", escape_latex(span.text)) : escape_latex(span.text);
  }
  return out;
}

/// The columns that are read: the others are in the CSV file alone.
std::vector<std::size_t> shown_columns(Table const& table) {
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (!is_hidden(table, i)) shown.push_back(i);
  }
  return shown;
}

std::string alignment(Table const& table, std::vector<std::size_t> const& shown) {
  std::string letters;
  for (std::size_t const i : shown) {
    bool const is_long = std::ranges::any_of(
        table.rows, [&](auto const& row) { return i < row.size() && row[i].text.size() > short_text; });
    letters += table.columns[i].number ? "r" : is_long ? "p{0.25\\linewidth}" : "l";
  }
  return letters;
}

}  // namespace

std::string escape_latex(std::string_view raw) {
  std::string const text = one_line(raw);
  std::string out;
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t const from = i;
    std::uint32_t const character = next_character(text, i);
    bool const ligature = character == before && (character == '-' || character == '\'' || character == ',');
    if (ligature) out += "{}";
    before = character;
    if (auto const other = replacement(character)) {
      out += *other;
    } else if (is_known_letter(character)) {
      out += text.substr(from, i - from);
    } else {
      out += fmt::format("(U+{:04X})", character);
    }
  }
  return out;
}

std::string to_latex(Table const& table) {
  std::vector<std::size_t> const shown = shown_columns(table);
  bool const is_long = table.rows.size() > rows_of_a_page;
  std::string head, body;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    head += fmt::format("{}{}", k > 0 ? " & " : "", escape_latex(table.columns[shown[k]].title));
  }
  for (auto const& row : table.rows) {
    for (std::size_t k = 0; k < shown.size(); ++k) {
      body += fmt::format("{}{}", k > 0 ? " & " : "", shown[k] < row.size() ? render(row[shown[k]]) : "");
    }
    body += " \\\\\n";
  }
  std::string const caption =
      fmt::format("\\caption{{{}}}\\label{{tab:polhode-{}}}", render(table.caption), table.name);
  std::string const columns = alignment(table, shown);
  std::string const begin = fmt::format("% Made by `polhode report`. Needs \\usepackage{{booktabs,{}}}.\n",
                                        is_long ? "longtable" : "graphicx");
  if (is_long) {
    return begin + fmt::format(
                       "{{\\small\\setlength{{\\tabcolsep}}{{4pt}}\n\\begin{{longtable}}{{{}}}\n{} \\\\\n\\toprule\n"
                       "{} \\\\\n\\midrule\n\\endhead\n\\bottomrule\n\\endfoot\n{}\\end{{longtable}}}}\n",
                       columns, caption, head, body);
  }
  // What is too wide for the page is made smaller.
  return begin + fmt::format(
                     "\\begin{{table}}\n\\centering\n{}\\par\\smallskip\n"
                     "\\resizebox{{\\ifdim\\width>\\linewidth\\linewidth\\else\\width\\fi}}{{!}}{{%\n"
                     "\\begin{{tabular}}{{{}}}\n\\toprule\n{} \\\\\n\\midrule\n{}\\bottomrule\n"
                     "\\end{{tabular}}}}\n\\end{{table}}\n",
                     caption, columns, head, body);
}

}  // namespace polhode::report
