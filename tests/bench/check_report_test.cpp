/// How the outcome of a check is written down: for a terminal, for a CI server, for a summary page.
#include "bench/score/check_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace polhode::bench {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

CheckSubject const subject{"a <suite> & \"more\"", "suite.toml", "b1", "2024-01-01T00:00:00Z", 7, 8};

/// One row of each verdict, with what needs an escape.
std::vector<Row> rows_of_all_kinds() {
  std::vector<Row> rows;
  for (Verdict const verdict :
       {Verdict::passed, Verdict::failed, Verdict::expected_fail, Verdict::unexpected_pass, Verdict::vacuous}) {
    Row row{.line = 9,
            .selector = "{h = 0.1, tag = <a|b>}",
            .field = "norm_drift",
            .bound = "<= 1e-9",
            .cells = 1,
            .verdict = verdict,
            .worst = "1",
            .worst_cell = "a//b",
            .failures = {},
            .xfail = ""};
    if (verdict != Verdict::passed) row.failures = {"cell \"x\" & 'y' \x01: norm_drift = 1, must be <= 1e-9", "second"};
    if (verdict == Verdict::expected_fail) row.xfail = "known <since> 1 & 2";
    rows.push_back(row);
  }
  return rows;
}

TEST(CheckReport, TheTableIsAlignedAndEndsWithTheFailures) {
  std::string const text = table_text(subject, rows_of_all_kinds(), {});
  EXPECT_THAT(text, HasSubstr("7 of 8 cells have records of build b1 (2024-01-01T00:00:00Z)"));
  EXPECT_THAT(text, HasSubstr("   9  {h = 0.1, tag = <a|b>}  norm_drift  <= 1e-9            1  a//b    passed\n"));
  EXPECT_THAT(text, HasSubstr("suite.toml:9: second\n"));
  EXPECT_THAT(text, HasSubstr("5 checks: 1 passed, 3 failed, 1 expected to fail\n"));
  EXPECT_THAT(text, Not(HasSubstr("\033")));
  EXPECT_THAT(table_text(subject, rows_of_all_kinds(), {0, true}), HasSubstr("\033[31mFAILED\033[0m"));
}

TEST(CheckReport, ManyFailuresAreCutOnTheTerminalAlone) {
  Row row{.line = 9,
          .selector = "{}",
          .field = "steps",
          .bound = "= 1",
          .cells = 50,
          .verdict = Verdict::failed,
          .worst = "2",
          .worst_cell = "c",
          .failures = {},
          .xfail = ""};
  for (int i = 0; i < 50; ++i) row.failures.push_back("failure number " + std::to_string(i) + ".");
  EXPECT_THAT(table_text(subject, {row}, {}), AllOf(HasSubstr("number 19."), Not(HasSubstr("number 20."))));
  EXPECT_THAT(table_text(subject, {row}, {}), HasSubstr("suite.toml:9: and 30 more\n"));
  EXPECT_THAT(junit_text(subject, {row}), HasSubstr("number 49."));
  EXPECT_THAT(markdown_text(subject, {row}), HasSubstr("number 49."));
}

/// The names of open elements, checked to nest; attributes must be quoted and free of < and bare &.
void expect_well_formed(std::string const& xml) {
  std::vector<std::string> open;
  for (std::size_t at = 0; at < xml.size();) {
    unsigned char const c = static_cast<unsigned char>(xml[at]);
    EXPECT_TRUE(c >= 0x20 || c == '\n') << "control character";
    if (c == '&') {
      std::size_t const end = xml.find(';', at);
      std::string const entity = xml.substr(at + 1, end - at - 1);
      EXPECT_THAT((std::vector<std::string>{"amp", "lt", "gt", "quot", "apos", "#10"}), testing::Contains(entity));
    }
    if (c != '<') {
      ++at;
      continue;
    }
    std::size_t const end = xml.find('>', at);
    ASSERT_NE(end, std::string::npos);
    std::string const tag = xml.substr(at + 1, end - at - 1);
    EXPECT_EQ(tag.find('<'), std::string::npos) << tag;
    EXPECT_EQ(std::count(tag.begin(), tag.end(), '"') % 2, 0) << tag;
    std::string const name = tag.substr(0, tag.find_first_of(" /", 1));
    if (tag[0] == '/') {
      ASSERT_FALSE(open.empty()) << tag;
      EXPECT_EQ(open.back(), tag.substr(1));
      open.pop_back();
    } else if (tag[0] != '?' && tag.back() != '/') {
      open.push_back(name);
    }
    at = end + 1;
  }
  EXPECT_THAT(open, IsEmpty());
}

TEST(CheckReport, JUnitIsWellFormedAndEscaped) {
  std::string const xml = junit_text(subject, rows_of_all_kinds());
  expect_well_formed(xml);
  EXPECT_THAT(xml, HasSubstr("<testsuites tests=\"5\" failures=\"3\" errors=\"0\" skipped=\"1\""));
  EXPECT_THAT(xml, HasSubstr("classname=\"polhode.check.a &lt;suite&gt; &amp; &quot;more&quot;\""));
  EXPECT_THAT(xml, HasSubstr("message=\"cell &quot;x&quot; &amp; &apos;y&apos; ?: norm_drift = 1"));
  EXPECT_THAT(xml, HasSubstr("<skipped message=\"expected failure: known &lt;since&gt; 1 &amp; 2\"/>"));
}

TEST(CheckReport, MarkdownIsATableWithEscapedBars) {
  std::string const text = markdown_text(subject, rows_of_all_kinds());
  EXPECT_THAT(text, HasSubstr("| line | selector | field | bound | worst value | verdict |\n|---:|---|"));
  EXPECT_THAT(text, HasSubstr("tag = \\<a\\|b>}"));
  EXPECT_THAT(text, HasSubstr("- second\n"));
}

}  // namespace
}  // namespace polhode::bench
