/// Expectations against made-up records: what passes, and what fails with which words.
#include "bench/score/check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <functional>

#include "tests/bench/suite_file.hpp"

namespace polhode::bench {
namespace {

using results::Record;
using results::Status;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

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
  EXPECT_EQ(cells[0].record, contents.records.data());
  EXPECT_THAT(cells[0].wanted.tags, ElementsAre("a", "b"));
  EXPECT_EQ(pair_up(suite, contents, "other")[0].record, nullptr);
}

}  // namespace
}  // namespace polhode::bench
