#include "bench/score/check_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace polhode::bench {
namespace {

constexpr std::array columns{"line", "selector", "field", "bound", "worst value", "verdict"};
using Line = std::array<std::string, columns.size()>;

/// More than these make a log unreadable; the files hold all of them.
constexpr std::size_t most_failures_shown = 20;

Line cells_of(Row const& row) {
  std::string const worst = row.worst.empty() ? "-" : fmt::format("{} in {}", row.worst, row.worst_cell);
  return {std::to_string(row.line), row.selector, row.field, row.bound, worst, std::string(name_of(row.verdict))};
}

/// A number with 4 digits where a window's width is limited; what fails is told in full below the table.
std::string in_table(std::string const& value, results::Outlet const& outlet) {
  if (value.empty()) return "-";
  double number = 0;
  auto const [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  bool const is_number = error == std::errc() && end == value.data() + value.size();
  return outlet.width > 0 && is_number ? fmt::format("{:.4g}", number) : value;
}

results::Tone tone_of(Row const& row) {
  return results::tone_of(name_of(row.verdict));
}

std::string count_of(std::vector<Row> const& rows) {
  auto const with = [&](Verdict verdict) { return std::ranges::count(rows, verdict, &Row::verdict); };
  auto const bad = std::ranges::count_if(rows, [](Row const& row) { return !is_good(row.verdict); });
  std::string text = fmt::format("{} checks: {} passed, {} failed", rows.size(), with(Verdict::passed), bad);
  if (auto const expected = with(Verdict::expected_fail); expected > 0) {
    text += fmt::format(", {} expected to fail", expected);
  }
  return text;
}

std::string subject_text(CheckSubject const& subject) {
  return fmt::format("suite {} ({}): {} of {} cells have records of build {}{}", subject.suite, subject.file,
                     subject.records, subject.cells, subject.build,
                     subject.made.empty() ? "" : " (" + subject.made + ")");
}

/// For text and attributes alike. XML 1.0 has no escape for control characters.
std::string xml(std::string_view text) {
  std::string safe;
  for (char const c : text) {
    bool const control = static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t';
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&apos;";
        break;
      case '\n':
        safe += "&#10;";
        break;
      default:
        safe += control ? '?' : c;
    }
  }
  return safe;
}

std::string all_failures(Row const& row) {
  std::string text;
  for (std::string const& failure : row.failures) text += failure + "\n";
  return text;
}

std::string testcase(CheckSubject const& subject, Row const& row) {
  std::string const name = fmt::format("line {}: {} {} {}", row.line, row.selector, row.field, row.bound);
  std::string text = fmt::format("  <testcase classname=\"{}\" name=\"{}\" file=\"{}\" line=\"{}\" time=\"0\"",
                                 xml("polhode.check." + subject.suite), xml(name), xml(subject.file), row.line);
  if (row.verdict == Verdict::passed) return text + "/>\n";
  text += ">\n";
  if (row.verdict == Verdict::expected_fail) {
    text += fmt::format("    <skipped message=\"{}\"/>\n", xml("expected failure: " + row.xfail));
  } else {
    std::string const& first = row.failures.front();
    text += fmt::format("    <failure message=\"{}\" type=\"{}\">{}</failure>\n", xml(first), xml(name_of(row.verdict)),
                        xml(all_failures(row)));
  }
  return text + "  </testcase>\n";
}

/// For workflow commands; in a property, colons and commas end it.
std::string github(std::string_view text, bool property) {
  std::string safe;
  for (char const c : text) {
    bool const special = c == '%' || c == '\r' || c == '\n' || (property && (c == ':' || c == ','));
    safe += special ? fmt::format("%{:02X}", static_cast<unsigned char>(c)) : std::string(1, c);
  }
  return safe;
}

/// A cell of a Markdown table.
std::string markdown(std::string_view text) {
  std::string safe;
  for (char const c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_' || c == '`' || c == '\\') safe += '\\';
    safe += c == '\n' ? ' ' : c;
  }
  return safe;
}

}  // namespace

std::string table_text(CheckSubject const& subject, std::vector<Row> const& rows, results::Outlet const& outlet) {
  // A value that lost its exponent would lie: it has a column of its own, and runs may be shortened.
  std::vector<results::TextColumn> const heads{
      {"line", true}, {"selector"}, {"field"}, {"bound"}, {"worst value", true}, {"of run"}, {"verdict", false, true}};
  std::vector<std::vector<results::TextCell>> lines;
  for (Row const& row : rows) {
    lines.emplace_back();
    for (std::string const& cell :
         {std::to_string(row.line), row.selector, row.field, row.bound, in_table(row.worst, outlet), row.worst_cell})
      lines.back().emplace_back(cell, results::Tone::plain);
    lines.back().emplace_back(std::string(name_of(row.verdict)), tone_of(row));
  }
  std::string text = subject_text(subject) + "\n\n" + results::text_table(heads, lines, outlet) + "\n";
  for (Row const& row : rows) {
    if (is_good(row.verdict)) continue;
    std::string const place = fmt::format("{}:{}: ", subject.file, row.line);
    std::size_t const shown = std::min(row.failures.size(), most_failures_shown);
    for (std::size_t i = 0; i < shown; ++i) {
      text += place + results::toned(row.failures[i], tone_of(row), outlet) + "\n";
    }
    if (shown < row.failures.size()) text += fmt::format("{}and {} more\n", place, row.failures.size() - shown);
  }
  return text + count_of(rows) + "\n";
}

std::string junit_text(CheckSubject const& subject, std::vector<Row> const& rows) {
  auto const bad = std::ranges::count_if(rows, [](Row const& row) { return !is_good(row.verdict); });
  auto const skipped = std::ranges::count(rows, Verdict::expected_fail, &Row::verdict);
  std::string const counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"0\"", rows.size(), bad, skipped);
  std::string text = fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n", counts);
  text += fmt::format(" <testsuite name=\"{}\" {}>\n", xml("polhode check " + subject.suite), counts);
  text += fmt::format("  <properties><property name=\"build\" value=\"{}\"/></properties>\n", xml(subject.build));
  for (Row const& row : rows) text += testcase(subject, row);
  return text + " </testsuite>\n</testsuites>\n";
}

std::string markdown_text(CheckSubject const& subject, std::vector<Row> const& rows) {
  std::string text = fmt::format("## polhode check: {}\n\n{}. {}.\n\n", markdown(subject.suite),
                                 markdown(subject_text(subject)), count_of(rows));
  text += "|";
  for (char const* column : columns) text += fmt::format(" {} |", column);
  text += "\n|---:|---|---|---|---|---|\n";
  for (Row const& row : rows) {
    text += "|";
    for (std::string const& cell : cells_of(row)) text += fmt::format(" {} |", markdown(cell));
    text += "\n";
  }
  for (Row const& row : rows) {
    if (is_good(row.verdict)) continue;
    text += fmt::format("\n{}:{}, {}:\n\n", markdown(subject.file), row.line, markdown(row.field));
    for (std::string const& failure : row.failures) text += fmt::format("- {}\n", markdown(failure));
  }
  return text;
}

std::string github_text(CheckSubject const& subject, std::vector<Row> const& rows) {
  constexpr std::size_t most = 10;
  std::vector<std::string> lines;
  std::string const& file = subject.source.empty() ? subject.file : subject.source;
  for (Row const& row : rows) {
    if (is_good(row.verdict)) continue;
    std::string const place = fmt::format("file={},line={},title={}", github(file, true), row.line,
                                          github("polhode check: " + row.field, true));
    for (std::string const& failure : row.failures)
      lines.push_back(fmt::format("::error {}::{}\n", place, github(failure, false)));
  }
  std::string text;
  for (std::size_t i = 0; i < std::min(lines.size(), most); ++i) text += lines[i];
  return text;
}

}  // namespace polhode::bench
