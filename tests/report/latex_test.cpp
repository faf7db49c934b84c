/// Tables for papers: what LaTeX prints is what Markdown prints, both are the CSV file's numbers at the printed
/// precision, and those are the records'. Walked over every table of a report.
#include "report/render/latex.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "report/text.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;
using testing::HasSubstr;
using testing::Not;
using Row = std::vector<std::string>;

// ---- Readers of the three languages ---------------------------------------------------------------------------------

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// Pieces between `separator`; one after a backslash separates nothing.
Row split(std::string const& text, std::string_view separator) {
  Row pieces(1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) {
      pieces.back() += text[i++];
      pieces.back() += text[i];
    } else if (text.compare(i, separator.size(), separator) == 0) {
      pieces.emplace_back();
      i += separator.size() - 1;
    } else {
      pieces.back() += text[i];
    }
  }
  return pieces;
}

std::string trimmed(std::string const& text) {
  auto const from = text.find_first_not_of(' ');
  return from == std::string::npos ? "" : text.substr(from, text.find_last_not_of(' ') - from + 1);
}

std::string plain_from_markdown(std::string text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\\' && i + 1 < text.size()) ++i;
    out += text[i];
  }
  replace_all(out, "&lt;", "<");
  replace_all(out, "&gt;", ">");
  replace_all(out, "&amp;", "&");
  return trimmed(out);
}

std::string plain_from_latex(std::string text) {
  text = std::regex_replace(text, std::regex(R"(\$(-?[0-9.]+)\\times10\^\{(-?[0-9]+)\}\$)"), "$1e$2");
  text = std::regex_replace(text, std::regex(R"(\$(-?[0-9.]+)\$)"), "$1");
  for (auto const& [from, to] : std::vector<std::pair<std::string, std::string>>{{"\\textbackslash{}", "\\"},
                                                                                 {"\\textasciicircum{}", "^"},
                                                                                 {"$\\mu$", "µ"},
                                                                                 {"$\\pm$", "±"},
                                                                                 {"$\\approx$", "≈"},
                                                                                 {"$\\times$", "×"},
                                                                                 {"$\\leq$", "≤"},
                                                                                 {"$<$", "<"},
                                                                                 {"$>$", ">"},
                                                                                 {"$|$", "|"},
                                                                                 {"\\_", "_"},
                                                                                 {"\\#", "#"},
                                                                                 {"\\%", "%"},
                                                                                 {"\\&", "&"},
                                                                                 {"\\$", "$"},
                                                                                 {"{\\char34}", "\""},
                                                                                 {"---", "—"},
                                                                                 {"--", "–"},
                                                                                 {"{[}", "["},
                                                                                 {"{*}", "*"},
                                                                                 {"{`}", "`"},
                                                                                 {"{}", ""},
                                                                                 {"~", " "},
                                                                                 {"\\{", "{"},
                                                                                 {"\\}", "}"}})
    replace_all(text, from, to);
  return trimmed(text);
}

struct Read {
  Row titles;
  std::vector<Row> rows;
};

/// Every table of a report in Markdown, by name.
std::map<std::string, Read> tables_of_markdown(std::string const& text) {
  std::map<std::string, Read> tables;
  std::istringstream in(text);
  std::string name;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("**Table ")) name = line.substr(8, line.find(".**") - 8);
    if (!line.starts_with("|") || line.starts_with("|---")) continue;
    Row row = split(line, "|");
    row.erase(row.begin());
    row.pop_back();
    for (std::string& entry : row) entry = plain_from_markdown(entry);
    Read& table = tables[name];
    (table.titles.empty() ? table.titles : table.rows.emplace_back()) = row;
  }
  return tables;
}

Read table_of_latex(std::string const& text) {
  Read table;
  std::size_t const head = text.find("\\toprule\n") + 9, mid = text.find("\\midrule\n");
  std::size_t const endfoot = text.find("\\endfoot\n");
  std::size_t const from = endfoot == std::string::npos ? mid + 9 : endfoot + 9;
  std::size_t const to = endfoot == std::string::npos ? text.find("\\bottomrule") : text.find("\\end{longtable}");
  auto const row_of = [](std::string line) {
    line.resize(line.rfind(" \\\\"));
    Row row = split(line, " & ");
    for (std::string& entry : row) entry = plain_from_latex(entry);
    return row;
  };
  table.titles = row_of(text.substr(head, text.find('\n', head) - head));
  std::istringstream in(text.substr(from, to - from));
  for (std::string line; std::getline(in, line);) table.rows.push_back(row_of(line));
  return table;
}

Read table_of_csv(std::string const& text) {
  std::vector<Row> rows(1, Row(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"')
      rows.back().back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      rows.back().emplace_back();
    else if (c == '\n' && !quoted)
      rows.emplace_back(1);
    else
      rows.back().back() += c;
  }
  rows.pop_back();
  return {rows.front(), {rows.begin() + 1, rows.end()}};
}

// ---- The walk -------------------------------------------------------------------------------------------------------

std::regex const number_with_unit(R"((≈ |< )?(-?[0-9.e-]+)( (ns|µs|ms|s))?( \(.*\))?)");
std::regex const plain_number(R"(-?[0-9]+(\.[0-9]+)?(e[-+]?[0-9]+)?)");

/// What is printed of a number that is known exactly: with two digits or more, in that unit.
bool is_rounded(std::string const& printed, std::string const& exactly) {
  std::smatch match;
  if (!std::regex_match(printed, match, number_with_unit)) return false;
  std::string const shown = match[2], unit = match[4];
  double const scale = unit == "ns" ? 1e9 : unit == "µs" ? 1e6 : unit == "ms" ? 1e3 : 1;
  double const value = scale * std::stod(exactly);
  if (match[1] == "< ") return std::abs(value) < std::stod(shown);
  if (shown == exactly || shown == fmt::format("{:.2f}", value)) return true;
  for (int digits = 2; digits <= 6; ++digits) {
    if (shown == significant(value, digits)) return true;
  }
  return false;
}

void collect(nlohmann::ordered_json const& json, std::set<std::string>& numbers) {
  if (json.is_number()) numbers.insert(exact(json.get<double>()));
  if (json.is_structured())
    for (auto const& item : json) collect(item, numbers);
}

/// Columns whose numbers are fields of records, untouched; `answer` has costs between runs.
bool is_recorded(std::string const& table, std::string const& column) {
  static std::set<std::string> const fields{"error [rad]", "evaluations", "CPU time", "low",
                                            "high",        "energy",      "|L|",      "direction of L [rad]"};
  return table != "answer" && (fields.contains(column) || (table.starts_with("drift") && column.starts_with("h = ")));
}

/// One report for the tests that read it.
class ReportLatexFiles : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new Folder(fs::path(testing::TempDir()) / fmt::format("polhode tables-{}", ::getpid()));
    contents = full();
    write_report(contents, folder->path);
  }
  static void TearDownTestSuite() { delete folder; }

  static inline Folder* folder = nullptr;
  static inline Contents contents;
};

TEST_F(ReportLatexFiles, EveryTableSaysWhatMarkdownTheCsvFileAndTheRecordsSay) {
  std::map<std::string, Read> const markdown = tables_of_markdown(slurp(folder->path / "report.md"));
  std::set<std::string> numbers;
  for (Record const& record : contents.records) collect(to_json(record), numbers);
  std::size_t compared = 0, rounded = 0, from_records = 0, intervals = 0;
  for (auto const& [name, shown] : markdown) {
    SCOPED_TRACE(name);
    Read const latex = table_of_latex(slurp(folder->path / "tables" / (name + ".tex")));
    Read const csv = table_of_csv(slurp(folder->path / "tables" / (name + ".csv")));
    EXPECT_EQ(latex.titles, shown.titles);
    ASSERT_EQ(latex.rows.size(), shown.rows.size());
    ASSERT_EQ(csv.rows.size(), shown.rows.size());
    for (std::size_t r = 0; r < shown.rows.size(); ++r) {
      ASSERT_EQ(latex.rows[r].size(), shown.rows[r].size());
      for (std::size_t k = 0, c = 0; k < shown.titles.size(); ++k, ++c) {
        while (csv.titles.at(c) != shown.titles[k]) ++c;  // columns for the CSV file alone
        std::string const &text = shown.rows[r][k], &full_text = csv.rows[r].at(c);
        ++compared;
        std::string const in_latex = latex.rows[r][k];
        // An interval follows its number: "12.3 µs [12.1, 12.6]".
        bool const uncertain = in_latex.starts_with(text + " [") && in_latex.ends_with("]");
        intervals += uncertain ? 1U : 0U;
        EXPECT_EQ(uncertain ? in_latex.substr(0, text.size()) : in_latex, text);
        if (text != absent && std::regex_match(full_text, plain_number)) {
          ++rounded;
          EXPECT_TRUE(is_rounded(text, full_text)) << text << " is not " << full_text;
        }
      }
      for (std::size_t c = 0; c < csv.titles.size(); ++c) {
        std::string const& text = csv.rows[r].at(c);
        if (!is_recorded(name, csv.titles[c]) || !std::regex_match(text, plain_number)) continue;
        ++from_records;
        EXPECT_TRUE(numbers.contains(exact(std::stod(text)))) << csv.titles[c] << " " << text << " is in no record";
      }
    }
  }
  EXPECT_GT(markdown.size(), 8u);
  EXPECT_GT(compared, 500u);
  EXPECT_GT(rounded, 200u);
  EXPECT_GT(from_records, 50u);
  EXPECT_GT(intervals, 50u);
}

// ---- The renderer ---------------------------------------------------------------------------------------------------

Table sample() {
  Table table{.name = "sample",
              .caption = Text({{"What "}, {"a_b --x", true}, {" costs, 50% of $5 & more"}}),
              .columns = {{"who"}, {"error [rad]", true}, {"time", true}, {"exactly", true, true}},
              .rows = {}};
  Entry time("12.3 µs");
  time.interval = "12.1, 12.6";
  table.rows = {{"rk4_x", Entry("4.1e-9", "4.1234e-9"), time, "1"},
                {"[*] \\input{x} \"q\" <a|b> é ∮", "-3", "–", "2"},
                {"µ ± 2 ≤ 3 -- it's ?` ~^{} #1", "266.1: yes", "1e6", "3"}};
  return table;
}

TEST(ReportLatex, NumbersAreMathematicsWithTheirInterval) {
  std::string const text = to_latex(sample());
  EXPECT_THAT(text, HasSubstr("rk4\\_x & $4.1\\times10^{-9}$ & $12.3$~$\\mu$s [12.1, 12.6] \\\\\n"));
  EXPECT_THAT(text, HasSubstr("& $-3$ & -- \\\\\n"));
  EXPECT_THAT(text, HasSubstr("& 266.1: yes & $1\\times10^{6}$ \\\\\n"));
  EXPECT_THAT(text, HasSubstr("\\begin{tabular}{lrr}\n\\toprule\nwho & error {[}rad] & time \\\\\n\\midrule\n"));
  EXPECT_THAT(text, HasSubstr("\\caption{What \\texttt{a\\_b -{}-x} costs, 50\\% of \\$5 \\& more}"
                              "\\label{tab:polhode-sample}"));
  EXPECT_THAT(text, Not(HasSubstr("exactly"))) << "that column is for the CSV file";
}

TEST(ReportLatex, NothingInATextIsACommand) {
  EXPECT_EQ(escape_latex("\\input{x}"), "\\textbackslash{}input\\{x\\}");
  EXPECT_EQ(escape_latex("a%b#c&d_e$f"), "a\\%b\\#c\\&d\\_e\\$f");
  EXPECT_EQ(escape_latex("~^\""), "\\textasciitilde{}\\textasciicircum{}{\\char34}");
  EXPECT_EQ(escape_latex("[1] *"), "{[}1] {*}") << "after the end of a row both would be read as its argument";
  EXPECT_EQ(escape_latex("∮"), "(U+222E)");
  EXPECT_EQ(escape_latex("a\nb\xff"), "a b(U+FFFD)");
}

TEST(ReportLatex, ATableOfManyRowsGoesOverPages) {
  Table table = sample();
  for (int i = 0; i < 50; ++i) table.rows.push_back(table.rows.front());
  std::string const text = to_latex(table);
  EXPECT_THAT(text, HasSubstr("\\begin{longtable}{lrr}"));
  EXPECT_THAT(text, HasSubstr("booktabs,longtable"));
}

/// A program on the PATH.
bool have(std::string const& program) {
  std::istringstream path(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');)
    if (fs::exists(fs::path(folder) / program)) return true;
  return false;
}

TEST_F(ReportLatexFiles, EveryTableCompiles) {
  if (!have("pdflatex") || std::system("kpsewhich -- booktabs.sty graphicx.sty longtable.sty > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "pdflatex with booktabs and longtable is not installed";
  std::string document = "\\documentclass{article}\n\\usepackage{booktabs,graphicx,longtable}\n\\begin{document}\n";
  auto const add = [&](fs::path const& file) {
    document += fmt::format("\\input{{{}}}\n\\clearpage\n", file.string());
  };
  Folder const made(fs::path(testing::TempDir()) / fmt::format("polhode_latex_{}", ::getpid()));
  fs::path const& work = made.path;
  fs::create_directories(work);
  for (auto const& entry : fs::directory_iterator(folder->path / "tables")) {
    if (entry.path().extension() != ".tex") continue;
    fs::copy_file(entry.path(), work / entry.path().filename());
    add(entry.path().filename());
  }
  Table table = sample();
  std::ofstream(work / "short.tex") << to_latex(table);
  for (int i = 0; i < 50; ++i) table.rows.push_back(table.rows[static_cast<std::size_t>(i) % 3]);
  table.name = "long";
  std::ofstream(work / "longer.tex") << to_latex(table);
  add("short.tex");
  add("longer.tex");
  std::ofstream(work / "all.tex") << document << "\\end{document}\n";
  int const code = std::system(
      fmt::format("cd '{}' && pdflatex -interaction=nonstopmode -halt-on-error all.tex > all.out 2>&1", work.string())
          .c_str());
  EXPECT_EQ(code, 0) << slurp(work / "all.out");
  EXPECT_TRUE(fs::exists(work / "all.pdf"));
}

}  // namespace
}  // namespace polhode::report
