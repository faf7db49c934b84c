/// The document of a comparison: what stands in it, in which order, in every language.
#include "report/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/render/render.hpp"

namespace polhode::report {
namespace {

using results::Comparison;
using results::Trend;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Comparison sample() {
  Comparison c;
  c.a = {.path = "old", .build = "a1", .made = "then", .machine = "m", .unfinished = {}, .records = 3};
  c.b = {.path = "new <b>", .build = "b1", .made = "now", .machine = "m", .unfinished = {"x9"}, .records = 4};
  c.common = 2;
  c.statuses.push_back({{"c1", "free_body//quaternion/rk4/none/h=0.1"},
                        results::Status::ok,
                        results::Status::diverged,
                        "",
                        "not finite at t = 3 s",
                        Trend::worse});
  c.columns.push_back({{"c2", "free_body//s3/cf4/none/h=0.1"},
                       "attitude_error_max",
                       false,
                       1e-6,
                       4.5e-6,
                       0.6532125137753437,
                       Trend::worse});
  c.columns.push_back({{"c2", "free_body//s3/cf4/none/h=0.1"}, "evaluations", true, 2000, 1900, -0.05, Trend::better});
  c.times.push_back({{"c2", "free_body//s3/cf4/none/h=0.1"}, "cf4", 1e-4, 1.2e-4, 1.2, 1, 0.008, 0.008, Trend::worse});
  c.groups.push_back({"", 1, 1.2, 1, 1, Trend::same});
  c.groups.push_back({"cf4", 1, 1.2, 1, 1, Trend::same});
  c.smallest_p = 0.008;
  c.only_a.push_back({"x9", "free_body//s3/rkmk4/none/h=0.1"});
  c.only_b.push_back({"x8", "free_body//s3/cg4/none/h=0.1"});
  return c;
}

std::size_t at(std::string const& text, std::string const& what) {
  std::size_t const found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return found;
}

TEST(Comparison, MarkdownShowsStatusesFirst) {
  std::string const text = comparison_markdown(sample());
  EXPECT_THAT(text, HasSubstr("B is worse than A in a status, a verdict, an error or a count."));
  EXPECT_THAT(text,
              HasSubstr("| free_body//quaternion/rk4/none/h=0.1 | ok | diverged | worse | not finite at t = 3 s |"));
  EXPECT_THAT(text, HasSubstr("| attitude_error_max | 1e-6 | 4.5e-6 | \\+0.65 digits | worse |"));
  EXPECT_THAT(text, HasSubstr("| evaluations | 2000 | 1900 | \\-5% | better |"));
  EXPECT_THAT(text, HasSubstr("| 100 µs | 120 µs | 1.2 | 1 | 0.008 | slower |"));
  EXPECT_THAT(text, HasSubstr("| free_body//s3/rkmk4/none/h=0.1 | A; began in B | x9 |"));
  EXPECT_LT(at(text, "## Statuses"), at(text, "## Errors and counts"));
  EXPECT_LT(at(text, "## Errors and counts"), at(text, "## Times"));
  EXPECT_LT(at(text, "## Times"), at(text, "## Cells of one set alone"));
  EXPECT_THAT(text, Not(HasSubstr("tables/"))) << "nothing stands beside it";
  EXPECT_THAT(text, Not(HasSubstr("<b>")));
}

TEST(Comparison, WithoutChangesItSaysSo) {
  Comparison c;
  c.common = 7;
  c.why_no_times = "the machines differ: m; n";
  std::string const text = comparison_markdown(c);
  EXPECT_THAT(text,
              AllOf(HasSubstr("7 cells are in both. No status, verdict, error or count is worse in B."),
                    HasSubstr("Every cell ended as before."), HasSubstr("Nothing changes by more than 0.3 digits"),
                    HasSubstr("Times are not compared: the machines differ: m; n."), Not(HasSubstr("## Claims")),
                    Not(HasSubstr("one set alone"))));
}

TEST(Comparison, TooFewRepetitionsAreSaid) {
  Comparison c = sample();
  c.times[0].trend = Trend::same;
  c.smallest_p = 0.16;
  EXPECT_THAT(comparison_markdown(c), HasSubstr("No single cell can be told slower or faster: with so few repetitions "
                                                "of 1 cell, the smallest p is 0.16"));
}

TEST(Comparison, TheTerminalGetsColoursAndNothingWiderThanItself) {
  std::string const plain = comparison_text(sample(), {});
  EXPECT_THAT(plain, Not(HasSubstr("\033")));
  EXPECT_THAT(plain, HasSubstr("free_body//quaternion/rk4/none/h=0.1  ok  diverged  worse  not finite at t = 3 s\n"));
  std::string const narrow = comparison_text(sample(), {80, false});
  std::size_t from = 0;
  for (std::size_t to = narrow.find('\n'); to != std::string::npos; from = to + 1, to = narrow.find('\n', from))
    EXPECT_LE(results::places(narrow.substr(from, to - from)), 80u) << narrow.substr(from, to - from);
  EXPECT_THAT(comparison_text(sample(), {80, true}),
              AllOf(HasSubstr("\033[31mdiverged\033[0m"), HasSubstr("\033[32mbetter\033[0m")));
}

TEST(Comparison, ATerminalGetsTheFirstRowsOfMany) {
  Comparison c = sample();
  for (int i = 0; i < 50; ++i) c.columns.push_back(c.columns.front());
  EXPECT_THAT(comparison_text(c, {}), HasSubstr("And 22 more; --out FILE.md or FILE.html has all."));
  EXPECT_THAT(comparison_markdown(c), Not(HasSubstr("more; --out")));
}

TEST(Comparison, ThePageIsOnePage) {
  std::string const text = comparison_html(sample());
  EXPECT_THAT(text, AllOf(HasSubstr("<title>Polhode: comparison</title>"), HasSubstr("new &lt;b&gt;"),
                          Not(HasSubstr("tables/")), HasSubstr("</html>")));
}

}  // namespace
}  // namespace polhode::report
