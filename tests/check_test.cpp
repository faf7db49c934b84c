/// Expectations against made-up records: what passes, what fails with which words, and how it is written down.
#include "bench/check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <deque>
#include <functional>

#include "bench/check_report.hpp"
#include "tests/suite_file.hpp"

namespace polhode::bench {
namespace {

using results::Record;
using results::Status;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// 8 cells: rk4 (order 4) and gauss2 (whose order nobody tells) with errors h^4, a drift of 1e-10 for rk4.
std::string const sweeps = R"(name = 'test'
[[sweep]]
problem = 'free_body'
formulation = 'quaternion'
integrator = ['rk4', 'gauss2']
h = [0.025, 0.05, 0.1, 0.2]
t_end = 50
tags = ['quick']
[[expect]]
)";
constexpr int expect_line = 9;

Record good_record(results::Cell const& cell) {
  Record record;
  record.of = cell;
  record.cell = results::cell_id(cell);
  record.build = "b";
  record.steps = std::llround(cell.t_end / *cell.h);
  record.norm_drift_max = cell.integrator == "rk4" ? 1e-10 : 1e-15;
  record.attitude_error_end = std::pow(*cell.h, 4);
  record.reference_bar = 1e-20;
  return record;
}

/// A suite and a run of it.
struct Trial {
  explicit Trial(std::string const& expectations) : suite(test::read(sweeps + expectations)) {
    vocabulary = test::small_vocabulary();
    for (IntegratorWord& word : vocabulary.integrators)
      if (word.name == "rk4") word.order = 4;
    for (SuiteCell const& cell : suite.cells) {
      records.push_back(good_record(cell.cell));
      cells.push_back({cell, records.back().cell, &records.back()});
    }
  }
  Trial& change(std::function<void(Record&)> const& how, std::size_t which = 0) {
    how(records.at(which));
    return *this;
  }
  Trial& forget(std::size_t which) {
    cells.at(which).record = nullptr;
    return *this;
  }
  /// What is measured now becomes golden.
  Trial& commit() {
    for (Record const& record : records) golden[record.cell] = results::golden_of(record);
    return *this;
  }
  std::vector<Row> judged() const { return judge(suite, cells, vocabulary, golden, "suite.toml"); }
  Row row() const {
    auto const rows = judged();
    EXPECT_EQ(rows.size(), 1u);
    return rows.at(0);
  }

  Suite suite;
  Vocabulary vocabulary;
  std::deque<Record> records;
  std::vector<CheckedCell> cells;
  GoldenByCell golden;
};

// --- Bounds ----------------------------------------------------------------------------------------------------------

TEST(Check, WhatIsWithinItsBoundPasses) {
  Row const row = Trial("select = { integrator = 'rk4' }\nnorm_drift = { max = 1e-9 }").row();
  EXPECT_EQ(row.verdict, Verdict::passed);
  EXPECT_EQ(row.line, expect_line);
  EXPECT_EQ(row.selector, "{integrator = rk4}");
  EXPECT_EQ(row.field, "norm_drift");
  EXPECT_EQ(row.bound, "<= 1e-09");
  EXPECT_EQ(row.cells, 4u);
  EXPECT_EQ(row.worst, "1e-10");
  EXPECT_THAT(row.failures, IsEmpty());
}

TEST(Check, AFailureNamesCellFieldValueAndBound) {
  Trial trial("select = { tag = 'quick' }\nnorm_drift = { max = 1e-9 }");
  trial.change([](Record& record) { record.norm_drift_max = 1.25e-9; }, 2);
  Row const row = trial.row();
  EXPECT_EQ(row.verdict, Verdict::failed);
  EXPECT_THAT(row.failures, ElementsAre("free_body//quaternion/rk4/none/h=0.1 [" + trial.cells[2].id +
                                        "]: norm_drift = 1.25e-09, must be <= 1e-09"));
  EXPECT_EQ(row.worst, "1.25e-09");
  EXPECT_EQ(row.worst_cell, "free_body//quaternion/rk4/none/h=0.1");
}

TEST(Check, EveryKindOfBound) {
  struct Case {
    std::string bound;
    bool holds;
  };
  // rk4 at h = 0.1: 500 steps, error 1e-4.
  for (auto const& [bound, holds] : std::vector<Case>{{"steps = { min = 500 }", true},
                                                      {"steps = { min = 501 }", false},
                                                      {"steps = { min = 400, max = 500 }", true},
                                                      {"steps = { min = 400, max = 499 }", false},
                                                      {"steps = { is = 500 }", true},
                                                      {"steps = { is = 501 }", false},
                                                      {"attitude_error_end = { is = 1e-4 }", true},
                                                      {"attitude_error_end = { max = 0 }", false},
                                                      {"norm_drift = { min = 1e-10, max = 1e-10 }", true},
                                                      {"status = { is = 'ok' }", true},
                                                      {"status = { is = 'diverged' }", false},
                                                      {"integrator = { is = 'rk4' }", true},
                                                      {"seed = { is = 1 }", true},
                                                      {"reason = { is = '' }", true},
                                                      {"set = { is = '{}' }", true}}) {
    Row const row = Trial("select = { integrator = 'rk4', h = 0.1 }\n" + bound).row();
    EXPECT_EQ(row.verdict, holds ? Verdict::passed : Verdict::failed) << bound;
  }
}

TEST(Check, AZeroBoundIsABound) {
  Trial trial("select = { integrator = 'gauss2' }\nrejected = { max = 0 }");
  for (Record& record : trial.records) record.rejected = 0;
  EXPECT_EQ(trial.row().verdict, Verdict::passed);
  trial.records.back().rejected = 1;
  EXPECT_EQ(trial.row().verdict, Verdict::failed);
}

TEST(Check, OneRowForEachBoundInTheOrderOfTheFile) {
  Trial const trial(
      "select = {}\nnorm_drift = { max = 1 }\nstatus = { is = 'ok' }\n[[expect]]\nselect = {}\nsteps = { min = 1 }");
  auto const rows = trial.judged();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[2].field, "steps");
  EXPECT_EQ(rows[2].line, expect_line + 4);
}

// --- What cannot be judged -------------------------------------------------------------------------------------------

TEST(Check, WhatIsNoNumberViolatesABoundOnANumber) {
  struct Case {
    std::function<void(Record&)> how;
    std::string why;
  };
  auto const ended = [](Status status, std::string const& reason) {
    return [=](Record& record) {
      record.status = status;
      record.reason = reason;
    };
  };
  for (auto const& [how, why] : std::vector<Case>{
           {[](Record& record) { record.norm_drift_max.reset(); }, "norm_drift = null, must be"},
           {[](Record& record) { record.norm_drift_max = std::nan(""); }, "norm_drift = null, must be"},
           {ended(Status::refused, "needs a group"), "norm_drift = refused: needs a group, must be"},
           {ended(Status::crashed, ""), "norm_drift = crashed, must be"},
           {ended(Status::inaccurate, "no digit is right"), "norm_drift = inaccurate: no digit is right, must be"},
           {ended(Status::timeout, "60 s"), "norm_drift = timeout: 60 s, must be"}}) {
    Trial trial("select = {}\nnorm_drift = { max = 1 }");
    Row const row = trial.change(how).row();
    EXPECT_EQ(row.verdict, Verdict::failed);
    EXPECT_THAT(row.failures, ElementsAre(HasSubstr(why)));
  }
}

TEST(Check, AStatusIsTextAndMayBeARefusal) {
  Trial trial("select = { h = 0.2 }\nstatus = { is = 'refused' }");
  for (Record& record : trial.records) {
    record.status = Status::refused;
    record.reason = "needs a group";
  }
  Row const row = trial.row();
  EXPECT_EQ(row.verdict, Verdict::passed);
  EXPECT_EQ(row.worst, "refused (needs a group)");
}

TEST(Check, ACellThatWasNotRunFails) {
  Row const row = Trial("select = {}\nstatus = { is = 'ok' }").forget(3).row();
  EXPECT_EQ(row.verdict, Verdict::failed);
  EXPECT_EQ(row.cells, 7u);
  EXPECT_THAT(row.failures, ElementsAre(HasSubstr("h=0.2")));
  EXPECT_THAT(row.failures, ElementsAre(HasSubstr("status = not run, must be = ok")));
}

TEST(Check, AnExpectationOfNothingIsVacuous) {
  Row const row = Trial("select = { integrator = 'gauss*', h = '0.3*' }\nnorm_drift = { max = 1 }").row();
  EXPECT_EQ(row.verdict, Verdict::vacuous);
  EXPECT_FALSE(is_good(row.verdict));
  EXPECT_THAT(row.failures, ElementsAre("{h = 0.3*, integrator = gauss*}: selects 0 cells, min_cells = 1"));
}

TEST(Check, MinCellsCountsTheCells) {
  std::string const bound = "norm_drift = { max = 1 }\nmin_cells = ";
  EXPECT_EQ(Trial("select = { integrator = 'rk4' }\n" + bound + "4").row().verdict, Verdict::passed);
  EXPECT_EQ(Trial("select = { integrator = 'rk4' }\n" + bound + "5").row().verdict, Verdict::vacuous);
}

// --- Expected failures -----------------------------------------------------------------------------------------------

TEST(Check, XfailExpectsAFailure) {
  Row const row = Trial("select = {}\nnorm_drift = { max = 1e-12 }\nxfail = 'rk4 drifts'").row();
  EXPECT_EQ(row.verdict, Verdict::expected_fail);
  EXPECT_TRUE(is_good(row.verdict));
  EXPECT_EQ(row.xfail, "rk4 drifts");
}

TEST(Check, XfailThatPassesIsAnError) {
  Row const row = Trial("select = {}\nnorm_drift = { max = 1e-9 }\nxfail = 'rk4 drifts'").row();
  EXPECT_EQ(row.verdict, Verdict::unexpected_pass);
  EXPECT_FALSE(is_good(row.verdict));
  EXPECT_THAT(row.failures, ElementsAre("{}: norm_drift is <= 1e-09 everywhere, though xfail says: rk4 drifts"));
}

TEST(Check, OfAnXfailWithTwoBoundsOneMayHold) {
  auto const rows = Trial("select = {}\nnorm_drift = { max = 1e-12 }\nsteps = { min = 1 }\nxfail = 'drifts'").judged();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].verdict, Verdict::expected_fail);
  EXPECT_EQ(rows[1].verdict, Verdict::passed);
}

TEST(Check, XfailExcusesNeitherAbsenceNorVacuity) {
  std::string const rest = "\nnorm_drift = { max = 1e-12 }\nxfail = 'drifts'";
  EXPECT_EQ(Trial("select = {}" + rest).forget(0).row().verdict, Verdict::failed);
  EXPECT_EQ(Trial("select = { h = '0.3*' }" + rest).row().verdict, Verdict::vacuous);
}

// --- Orders ----------------------------------------------------------------------------------------------------------

TEST(Check, TheOrderIsFittedForEachMethod) {
  Trial trial("select = {}\norder = { min = 3.9, max = 4.1 }");
  EXPECT_EQ(trial.row().verdict, Verdict::passed);
  for (std::size_t i = 4; i < 8; ++i)
    trial.change([](Record& record) { record.attitude_error_end = std::pow(*record.of.h, 2); }, i);
  Row const row = trial.row();
  EXPECT_THAT(row.failures, ElementsAre(AllOf(HasSubstr("gauss2"), HasSubstr("order = 2.000 +- "),
                                              HasSubstr("must be from 3.9 to 4.1"))));
}

TEST(Check, TheNominalOrderIsTheMethodsOwn) {
  std::string const nominal = "order = { nominal = true, within = 0.1 }";
  EXPECT_EQ(Trial("select = { integrator = 'rk4' }\n" + nominal).row().verdict, Verdict::passed);
  Row const nameless = Trial("select = { integrator = 'gauss2' }\n" + nominal).row();
  EXPECT_THAT(nameless.failures, ElementsAre(HasSubstr("gauss2 has no nominal order, must be nominal +- 0.1")));

  Trial off("select = { integrator = 'rk4' }\n" + nominal);
  for (Record& record : off.records) record.attitude_error_end = std::pow(*record.of.h, 4.2);
  EXPECT_EQ(off.row().verdict, Verdict::failed);
}

TEST(Check, AnOrderNeedsThreeStepsThatRan) {
  std::string const bound = "order = { nominal = true }";
  Row const two = Trial("select = { integrator = 'rk4', h = '0.[12]' }\n" + bound).row();
  EXPECT_THAT(two.failures, ElementsAre(HasSubstr("(2 steps, h = 0.1 to 0.2), which are too few")));
  Row const missing = Trial("select = { integrator = 'rk4' }\n" + bound).forget(1).row();
  EXPECT_THAT(missing.failures, ElementsAre(HasSubstr("order = not run")));
  Trial failed("select = { integrator = 'rk4' }\n" + bound);
  failed.change([](Record& record) { record.status = Status::diverged; });
  EXPECT_THAT(failed.row().failures, ElementsAre(HasSubstr("order = diverged")));
  Trial no_error("select = { integrator = 'rk4' }\n" + bound);
  no_error.change([](Record& record) { record.attitude_error_end.reset(); });
  EXPECT_THAT(no_error.row().failures, ElementsAre(HasSubstr("attitude_error_end is null")));
}

// --- Golden ----------------------------------------------------------------------------------------------------------

TEST(Check, GoldenComparesWithWhatWasCommitted) {
  Trial trial("select = {}\nsteps = { golden = true }");
  trial.commit();
  EXPECT_EQ(trial.row().verdict, Verdict::passed);
  trial.change([](Record& record) { record.steps = *record.steps + *record.steps / 100; });
  EXPECT_EQ(trial.row().verdict, Verdict::passed) << "1% is within 2%";
  trial.change([](Record& record) { record.steps = 2100; });  // 2000 at h = 0.025
  EXPECT_THAT(trial.row().failures, ElementsAre(HasSubstr("steps = 2100 (golden 2000), must be golden within 2%")));
}

TEST(Check, GoldenErrorsAreComparedInDigits) {
  Trial trial("select = {}\nnorm_drift = { golden = true }");
  trial.commit();
  trial.change([](Record& record) { record.norm_drift_max = 1.9e-10; });
  EXPECT_EQ(trial.row().verdict, Verdict::passed) << "log10 1.9 = 0.28";
  trial.change([](Record& record) { record.norm_drift_max = 2.1e-10; });
  EXPECT_EQ(trial.row().verdict, Verdict::failed) << "log10 2.1 = 0.32";
}

TEST(Check, GoldenTakesTheToleranceOfTheSuite) {
  Trial trial("select = {}\nsteps = { golden = true, rel = 0 }");
  trial.commit().change([](Record& record) { record.steps = 2001; });
  EXPECT_EQ(trial.row().verdict, Verdict::failed);
  EXPECT_EQ(trial.row().bound, "golden within 0%");
}

TEST(Check, GoldenWithoutALineFailsAndSaysWhatToDo) {
  Row const row = Trial("select = { integrator = 'rk4', h = 0.1 }\nsteps = { golden = true }").row();
  EXPECT_THAT(row.failures, ElementsAre(HasSubstr("without golden line (make it with --update)")));
}

TEST(Check, GoldenFailuresAgreeAndNullsShowNothing) {
  Trial trial("select = { integrator = 'rk4' }\nsteps = { golden = true }");
  trial.change([](Record& record) {
    record.status = Status::refused;
    record.steps.reset();
  });
  trial.commit();
  EXPECT_EQ(trial.row().verdict, Verdict::passed) << "it was refused then, too";
  for (Record& record : trial.records) record.steps.reset();
  EXPECT_EQ(trial.row().verdict, Verdict::failed) << "golden numbers became null";
  trial.commit();
  EXPECT_EQ(trial.row().verdict, Verdict::vacuous) << "nothing but null";
}

TEST(Check, AGoldenStatusMustStay) {
  Trial trial("select = {}\nstatus = { golden = true }");
  trial.commit();
  EXPECT_EQ(trial.row().verdict, Verdict::passed);
  trial.change([](Record& record) { record.status = Status::diverged; });
  EXPECT_THAT(trial.row().failures, ElementsAre(HasSubstr("status = diverged (golden ok), must be as golden")));
}

TEST(Check, GoldenWithAMaximumHoldsBoth) {
  Trial trial("select = {}\nsteps = { golden = true, max = 1000 }");
  trial.commit();
  EXPECT_THAT(trial.row().failures, testing::Each(HasSubstr("steps = 2000, must be <= 1000, golden within 2%")));
}

TEST(Check, GoldenOnAFieldWithoutGoldenColumnIsAMistakeInTheFile) {
  Trial const trial("select = {}\nallocations_per_step = { golden = true }");
  try {
    trial.judged();
    FAIL() << "nothing was thrown";
  } catch (SuiteError const& error) {
    EXPECT_THAT(error.what(), HasSubstr("suite.toml:9: allocations_per_step: has no golden column"));
  }
}

// --- Pairing ---------------------------------------------------------------------------------------------------------

TEST(Check, CellsArePairedWithTheRecordsOfOneBuild) {
  Suite suite;
  suite.name = "test";
  results::Cell cell;
  cell.problem = "free_body";
  cell.formulation = "quaternion";
  cell.integrator = "rk4";
  cell.h = 0.1;
  suite.cells = {{cell, {"a"}}};
  cell.t_end = 50;  // the default horizon written out: the same cell
  suite.cells.push_back({cell, {"b"}});
  Record old;
  old.of = cell;
  old.cell = results::cell_id(cell);
  old.build = "old";
  Record fresh = old;
  fresh.build = "new";
  results::Contents contents;
  contents.records = {fresh, old};

  auto const cells = pair_up(suite, contents, "new");
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells[0].record, &contents.records[0]);
  EXPECT_THAT(cells[0].wanted.tags, ElementsAre("a", "b"));
  EXPECT_EQ(pair_up(suite, contents, "other")[0].record, nullptr);
}

// --- Written down ----------------------------------------------------------------------------------------------------

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
  std::string const text = table_text(subject, rows_of_all_kinds(), false);
  EXPECT_THAT(text, HasSubstr("7 of 8 cells have records of build b1 (2024-01-01T00:00:00Z)"));
  EXPECT_THAT(text, HasSubstr("   9  {h = 0.1, tag = <a|b>}  norm_drift  <= 1e-9  1 in a//b    passed\n"));
  EXPECT_THAT(text, HasSubstr("suite.toml:9: second\n"));
  EXPECT_THAT(text, HasSubstr("5 checks: 1 passed, 3 failed, 1 expected to fail\n"));
  EXPECT_THAT(text, Not(HasSubstr("\033")));
  EXPECT_THAT(table_text(subject, rows_of_all_kinds(), true), HasSubstr("\033[31mFAILED\033[0m"));
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
  EXPECT_THAT(table_text(subject, {row}, false), AllOf(HasSubstr("number 19."), Not(HasSubstr("number 20."))));
  EXPECT_THAT(table_text(subject, {row}, false), HasSubstr("suite.toml:9: and 30 more\n"));
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

TEST(CheckReport, NoColorOutsideATerminal) {
  EXPECT_FALSE(wants_colour(-1));
}

}  // namespace
}  // namespace polhode::bench
