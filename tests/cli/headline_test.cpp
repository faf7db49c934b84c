/// The README's picture and table are what a run gives today; `bench/headline` makes them again.
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

fs::path const root = POLHODE_SOURCE_DIR;

/// Cells between `separator`, without the blanks around them.
Rows rows_of(std::string const& text, char separator) {
  Rows rows;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, separator);) {
      auto const first = cell.find_first_not_of(' ');
      rows.back().push_back(first == std::string::npos ? ""
                                                       : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
    }
  }
  return rows;
}

/// Equal words; numbers within 2%, or both so small that rounding made them.
void expect_same(std::string const& committed, std::string const& now) {
  char *end_a = nullptr, *end_b = nullptr;
  double const a = std::strtod(committed.c_str(), &end_a), b = std::strtod(now.c_str(), &end_b);
  bool const numbers = !committed.empty() && *end_a == '\0' && !now.empty() && *end_b == '\0';
  if (!numbers) {
    EXPECT_EQ(committed, now);
  } else if (std::max(std::abs(a), std::abs(b)) > 1e-12) {
    EXPECT_NEAR(a, b, 0.02 * std::abs(b));
  }
}
void expect_same(Rows const& committed, Rows const& now) {
  ASSERT_EQ(committed.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    ASSERT_EQ(committed[i].size(), now[i].size()) << "row " << i;
    for (std::size_t k = 0; k < now[i].size(); ++k) {
      SCOPED_TRACE(testing::Message() << "row " << i << ", column " << k);
      expect_same(committed[i][k], now[i][k]);
    }
  }
}

/// The lines of `text` from the first that holds `from` to the last that begins like a table's.
std::string table_from(std::string const& text, std::string const& from) {
  std::istringstream in(text);
  std::string table;
  for (std::string line; std::getline(in, line);) {
    if (table.empty() && line.find(from) == std::string::npos) continue;
    if (!line.starts_with('|')) break;
    table += line + '\n';
  }
  return table;
}

TEST(Headline, OfTheReadmeIsWhatARunGives) {
  Folder const folder;
  ASSERT_EQ(polhode(folder, "run headline --out results").code, 0);
  ASSERT_EQ(polhode(folder, "report results").code, 0);
  fs::path const made = folder.path / "results/report";
  std::string const heading = "evaluations to 1e-6 rad";
  Rows const table = rows_of(table_from(text_of(made / "report.md"), heading), '|');
  EXPECT_GE(table.size(), 8U);
  expect_same(rows_of(table_from(text_of(root / "README.md"), heading), '|'), table);
  expect_same(rows_of(text_of(root / "bench/headline.csv"), ','), rows_of(text_of(made / "figures/headline.csv"), ','));
}

}  // namespace
}  // namespace polhode::cli
