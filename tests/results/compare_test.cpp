/// Two sets of records, held against each other: what counts as a change, and for the worse.
#include "results/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/results/made_up_record.hpp"

namespace polhode::results {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Record record_of(std::string const& integrator, double h, std::string const& build = "new") {
  Record record = test::made_up_record(integrator, h, build);
  record.evaluations = 2000;
  record.norm_drift_max = 1e-9;
  record.attitude_error_max = 1e-6;
  record.reference_bar = 1e-20;
  return record;
}

Contents set_of(std::vector<Record> records, Meta meta = {{"build", "new"}, {"cpu_model", "made-up"}}) {
  Contents contents;
  contents.metas.push_back(std::move(meta));
  contents.records = std::move(records);
  return contents;
}

Comparison compared(Record const& a, Record const& b) {
  return compare(set_of({a}), set_of({b}), "A", "B");
}

/// Repetitions around a median [s].
CpuTime timed(double median, std::size_t repetitions = 5, double spread = 0.01) {
  CpuTime time{median, median, median, static_cast<int>(repetitions)};
  for (std::size_t i = 0; i < repetitions; ++i) {
    double const place = (static_cast<double>(i) + 0.5) / static_cast<double>(repetitions) - 0.5;
    time.samples.push_back(median * (1 + spread * place));
  }
  return time;
}

TEST(Compare, ASetIsTheSameAsItself) {
  Record record = record_of("rk4", 0.1);
  record.cpu_time_s = timed(1e-3);
  Comparison const result = compared(record, record);
  EXPECT_EQ(result.common, 1u);
  EXPECT_THAT(result.statuses, IsEmpty());
  EXPECT_THAT(result.claims, IsEmpty());
  EXPECT_THAT(result.columns, IsEmpty());
  ASSERT_EQ(result.times.size(), 1u);
  EXPECT_EQ(result.times[0].ratio, 1);
  EXPECT_EQ(result.times[0].superiority, 0.5);
  EXPECT_EQ(*result.times[0].p, 1);
  EXPECT_EQ(result.times[0].trend, Trend::same);
  EXPECT_FALSE(result.regressed());
}

TEST(Compare, AFailureIsWorseAndARecoveryBetter) {
  Record const good = record_of("rk4", 0.1);
  Record bad = good;
  bad.status = Status::diverged;
  bad.reason = "not finite at t = 3 s";
  bad.norm_drift_max = 1e3;
  Comparison const worse = compared(good, bad);
  ASSERT_EQ(worse.statuses.size(), 1u);
  EXPECT_EQ(worse.statuses[0].trend, Trend::worse);
  EXPECT_EQ(worse.statuses[0].name, "free_body//quaternion/rk4/none/h=0.1");
  EXPECT_EQ(worse.statuses[0].reason_b, "not finite at t = 3 s");
  EXPECT_THAT(worse.columns, IsEmpty()) << "numbers of a run that failed are no results";
  EXPECT_TRUE(worse.regressed());
  Comparison const better = compared(bad, good);
  EXPECT_EQ(better.statuses[0].trend, Trend::better);
  EXPECT_FALSE(better.regressed());
  Record other = bad;
  other.status = Status::refused;
  EXPECT_EQ(compared(bad, other).statuses[0].trend, Trend::changed);
  EXPECT_FALSE(compared(bad, other).regressed());
}

TEST(Compare, ErrorsAreComparedInDigitsAndCountsInParts) {
  Record const a = record_of("rk4", 0.1);
  Record b = a;
  b.attitude_error_max = 4e-6;
  b.evaluations = 1900;
  b.norm_drift_max = 1.9e-9;  // less than a factor of 2
  b.steps = 510;              // 2%
  Comparison const result = compared(a, b);
  ASSERT_EQ(result.columns.size(), 2u);
  EXPECT_EQ(result.columns[0].column, "attitude_error_max") << "what is worse comes first";
  EXPECT_NEAR(*result.columns[0].change, std::log10(4), 1e-12);
  EXPECT_EQ(result.columns[0].trend, Trend::worse);
  EXPECT_EQ(result.columns[1].column, "evaluations");
  EXPECT_NEAR(*result.columns[1].change, -0.05, 1e-12);
  EXPECT_EQ(result.columns[1].trend, Trend::better);
  EXPECT_TRUE(result.regressed());
  EXPECT_THAT(compare(set_of({a}), set_of({b}), "A", "B", {.digits = 1, .counts = 0.06}).columns, IsEmpty());
}

TEST(Compare, RoundOffAndTheReferencesBarAreNoChange) {
  Record a = record_of("rk4", 0.1);
  a.norm_drift_max = 2e-16;
  a.attitude_error_max = 1e-12;
  a.reference_bar = 1e-11;
  Record b = a;
  b.norm_drift_max = 9e-16;
  b.attitude_error_max = 9e-12;
  EXPECT_THAT(compared(a, b).columns, IsEmpty());
  b.norm_drift_max = 9e-15;
  b.attitude_error_max = 4e-11;
  EXPECT_EQ(compared(a, b).columns.size(), 2u);
}

TEST(Compare, ANumberThatComesOrGoesIsAChangeWithoutATrend) {
  Record const a = record_of("rk4", 0.1);
  Record b = a;
  b.evaluations.reset();
  b.rejected = 3;
  Comparison const result = compared(a, b);
  ASSERT_EQ(result.columns.size(), 2u);
  for (ColumnChange const& change : result.columns) {
    EXPECT_EQ(change.trend, Trend::changed) << change.column;
    EXPECT_FALSE(change.change) << change.column;
  }
  Record none = a, some = a;
  none.rejected = 0;
  some.rejected = 1;
  EXPECT_EQ(compared(none, some).columns.at(0).trend, Trend::worse) << "0 has no relative change, but a direction";
  none.controller_calls = 10;
  some.rejected = 0;
  some.controller_calls = 20;
  EXPECT_EQ(compared(none, some).columns.at(0).trend, Trend::changed) << "that is the problem's business";
}

TEST(Compare, AClaimThatIsNoLongerReproducedIsWorse) {
  Record a = record_of("rk4", 0.1);
  a.claims["alpha_max"] = {0.1, 0.1, "reproduced"};
  Record b = a;
  b.claims["alpha_max"] = {0.2, 0.1, "not reproduced"};
  b.claims["fresh"] = {0.2, 0.1, "not reproduced"};
  Comparison const result = compared(a, b);
  ASSERT_EQ(result.claims.size(), 1u);
  EXPECT_EQ(result.claims[0].claim, "alpha_max");
  EXPECT_EQ(result.claims[0].trend, Trend::worse);
  EXPECT_TRUE(result.regressed());
  EXPECT_EQ(compared(b, a).claims.at(0).trend, Trend::better);
}

TEST(Compare, CellsOfOneSetAreListed) {
  Comparison const result = compare(set_of({record_of("rk4", 0.1), record_of("gauss1", 0.1)}),
                                    set_of({record_of("rk4", 0.1), record_of("rk4", 0.2)}), "A", "B");
  EXPECT_EQ(result.common, 1u);
  ASSERT_EQ(result.only_a.size(), 1u);
  EXPECT_EQ(result.only_a[0].name, "free_body//quaternion/gauss1/none/h=0.1");
  ASSERT_EQ(result.only_b.size(), 1u);
  EXPECT_EQ(result.only_b[0].name, "free_body//quaternion/rk4/none/h=0.2");
  EXPECT_FALSE(result.regressed()) << "another selection is no regression";
}

TEST(Compare, ACellThatBeganAndDidNotFinishIsARegression) {
  Contents b = set_of({record_of("rk4", 0.1)});
  b.unfinished.push_back(record_of("gauss1", 0.1).cell);
  Comparison const result = compare(set_of({record_of("rk4", 0.1), record_of("gauss1", 0.1)}), b, "A", "B");
  EXPECT_THAT(result.b.unfinished, ElementsAre(record_of("gauss1", 0.1).cell));
  EXPECT_TRUE(result.regressed());
}

TEST(Compare, TheNewestBuildOfEachSetCounts) {
  Record old = record_of("rk4", 0.1, "old");
  old.attitude_error_max = 1;
  Contents b = set_of({old, record_of("rk4", 0.1)});
  b.metas.insert(b.metas.begin(), Meta{{"build", "old"}, {"cpu_model", "another"}});
  Comparison const result = compare(set_of({record_of("rk4", 0.1)}), b, "A", "B");
  EXPECT_EQ(result.b.records, 1u);
  EXPECT_EQ(result.b.of_other_builds, 1u);
  EXPECT_EQ(result.b.machine, "cpu_model made-up");
  EXPECT_THAT(result.columns, IsEmpty());
}

// ---- times ----------------------------------------------------------------------------------------------------------

/// Two sets of so many cells, the second slower by `factor`.
Comparison race(std::size_t cells, std::size_t repetitions, double factor, bool samples = true) {
  std::vector<Record> a, b;
  for (std::size_t i = 0; i < cells; ++i) {
    Record record = record_of("rk4", 0.1 * static_cast<double>(i + 1));
    record.cpu_time_s = timed(1e-3 * static_cast<double>(i + 1), repetitions);
    a.push_back(record);
    record.cpu_time_s = timed(factor * 1e-3 * static_cast<double>(i + 1), repetitions);
    b.push_back(record);
  }
  if (!samples) a[0].cpu_time_s->samples.clear();
  return compare(set_of(a), set_of(b), "A", "B");
}

TEST(CompareTimes, ASlowerCellIsFoundWithItsSize) {
  Comparison const result = race(1, 5, 1.2);
  ASSERT_EQ(result.times.size(), 1u);
  TimeChange const& time = result.times[0];
  EXPECT_NEAR(time.ratio, 1.2, 1e-3);
  EXPECT_EQ(time.superiority, 1);
  EXPECT_NEAR(*time.p, 2.0 / 252, 1e-12);
  EXPECT_EQ(time.trend, Trend::worse);
  EXPECT_EQ(race(1, 5, 1 / 1.2).times[0].trend, Trend::better);
  EXPECT_FALSE(result.regressed()) << "seconds are never gated";
}

TEST(CompareTimes, WhatIsCertainButSmallIsNoChange) {
  Comparison const result = race(1, 20, 1.02);
  EXPECT_LT(*result.times[0].adjusted, 1e-6);
  EXPECT_EQ(result.times[0].trend, Trend::same);
}

TEST(CompareTimes, FewRepetitionsOfManyCellsDecideNoCellButAGroup) {
  Comparison const result = race(20, 5, 1.2);
  EXPECT_NEAR(result.smallest_p, 20.0 / 126, 1e-12);
  for (TimeChange const& time : result.times) {
    EXPECT_NEAR(*time.adjusted, 20.0 / 126, 1e-12);
    EXPECT_EQ(time.trend, Trend::same);
  }
  ASSERT_EQ(result.groups.size(), 2u) << "all cells, and rk4";
  EXPECT_EQ(result.groups[0].integrator, "");
  EXPECT_EQ(result.groups[1].integrator, "rk4");
  EXPECT_NEAR(result.groups[1].p, 2 * std::pow(0.5, 20), 1e-15);
  EXPECT_NEAR(result.groups[1].adjusted, 4 * std::pow(0.5, 20), 1e-15) << "Holm over both";
  EXPECT_NEAR(result.groups[1].ratio, 1.2, 1e-12);
  EXPECT_EQ(result.groups[1].trend, Trend::worse);
}

TEST(CompareTimes, WithoutSamplesACellIsNotTested) {
  Comparison const result = race(1, 5, 1.2, false);
  EXPECT_FALSE(result.times[0].p);
  EXPECT_EQ(result.times[0].trend, Trend::same);
  EXPECT_NEAR(result.times[0].ratio, 1.2, 1e-12);
}

TEST(CompareTimes, OtherMachinesAreNotCompared) {
  Record record = record_of("rk4", 0.1);
  record.cpu_time_s = timed(1e-3);
  auto const why = [&](Meta const& meta) {
    Comparison const result = compare(set_of({record}), set_of({record}, meta), "A", "B");
    EXPECT_THAT(result.times, IsEmpty());
    return result.why_no_times;
  };
  EXPECT_EQ(why({{"build", "new"}, {"cpu_model", "other"}}), "the machines differ: cpu_model made-up; cpu_model other");
  EXPECT_THAT(why({{"build", "new"}, {"cpu_model", "made-up"}, {"kernel", "Linux 7"}}), HasSubstr("machines differ"));
  EXPECT_EQ(why({{"build", "new"}}), "of B it is not known that all was made on one machine");
}

TEST(CompareTimes, AFolderFromTwoMachinesIsNotCompared) {
  Record record = record_of("rk4", 0.1);
  record.cpu_time_s = timed(1e-3);
  Contents merged = set_of({record});
  merged.metas.push_back({{"build", "new"}, {"cpu_model", "other"}});
  EXPECT_THAT(compare(merged, set_of({record}), "A", "B").why_no_times, HasSubstr("of A it is not known"));
}

TEST(Compare, JsonHoldsAllOfIt) {
  Record const a = record_of("rk4", 0.1);
  Record b = a;
  b.attitude_error_max = 4e-6;
  nlohmann::ordered_json const json = to_json(compared(a, b));
  EXPECT_EQ(json.at("kind"), "comparison");
  EXPECT_EQ(json.at("schema"), schema);
  EXPECT_EQ(json.at("regressed"), true);
  EXPECT_EQ(json.at("columns").at(0).at("column"), "attitude_error_max");
  EXPECT_EQ(json.at("columns").at(0).at("trend"), "worse");
  EXPECT_EQ(json.at("times_not_compared"), "no cell was timed in both");
}

}  // namespace
}  // namespace polhode::results
