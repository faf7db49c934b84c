/// Golden columns: what is committed, when it agrees, what a difference looks like, damage.
#include "results/golden.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "results/store.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Record record_at(double h) {
  Record record;
  record.of.problem = "free_body";
  record.of.formulation = "s3";
  record.of.integrator = "cf4";
  record.of.h = h;
  record.of.t_end = 50;
  record.cell = cell_id(record.of);
  record.steps = std::llround(50 / h);
  record.norm_drift_max = 1.23456789e-15;
  record.norm_drift_final = -1e-13;
  record.cpu_time_s = CpuTime{1, 1, 1, 5};
  record.allocations_per_step = 0.5;
  return record;
}

double apart(Tolerance const& tolerance, std::optional<double> golden, std::optional<double> value) {
  return deviation(tolerance, golden, value);
}

TEST(Golden, HoldsDeterministicColumnsAlone) {
  GoldenLine const line = golden_of(record_at(0.1));
  EXPECT_EQ(line.name, "free_body//s3/cf4/none/h=0.1");
  EXPECT_EQ(line.status, "ok");
  std::map<std::string, double> const columns{
      {"steps", 500}, {"norm_drift_max", 1.23457e-15}, {"norm_drift_final", -1e-13}};
  EXPECT_EQ(line.columns, columns) << "no nulls, no times, 6 digits";
  EXPECT_THAT(golden_columns(), Not(testing::Contains(HasSubstr("time"))));
}

TEST(Golden, CountsAgreeWithinTwoPercent) {
  Tolerance const tolerance = default_tolerance("evaluations");
  EXPECT_LE(apart(tolerance, 1000, 1019), 1);
  EXPECT_GT(apart(tolerance, 1000, 1021), 1);
  EXPECT_GT(apart(tolerance, 1000, 979), 1);
  EXPECT_EQ(apart(tolerance, 0, 0), 0);
  EXPECT_GT(apart(tolerance, 0, 1), 1);
}

TEST(Golden, ErrorsAgreeInDigitsAboveAFloor) {
  Tolerance const tolerance = default_tolerance("attitude_error_max");
  EXPECT_LE(apart(tolerance, 1e-6, 1.99e-6), 1);
  EXPECT_GT(apart(tolerance, 1e-6, 2.01e-6), 1);
  EXPECT_LE(apart(tolerance, 1e-6, 5.02e-7), 1);
  EXPECT_EQ(apart(tolerance, 1e-17, 9e-16), 0) << "both below 1e-15";
  EXPECT_EQ(apart(tolerance, 0, 1e-15), 0);
  EXPECT_GT(apart(tolerance, 0, 1e-14), 1);
}

TEST(Golden, OppositeSignsAgreeInRoundOffAlone) {
  Tolerance const tolerance = default_tolerance("norm_drift_final");
  EXPECT_LE(apart(tolerance, -1e-10, -1.5e-10), 1);
  EXPECT_GT(apart(tolerance, -1e-10, 1e-10), 1);
  EXPECT_EQ(apart(tolerance, -4e-16, 2e-16), 0);
}

TEST(Golden, NullAgreesWithNullAlone) {
  Tolerance const tolerance = default_tolerance("steps");
  EXPECT_EQ(apart(tolerance, {}, {}), 0);
  EXPECT_GT(apart(tolerance, 1, {}), 1);
  EXPECT_GT(apart(tolerance, {}, 1), 1);
}

TEST(Golden, TheWidestToleranceCounts) {
  EXPECT_LE(apart({.rel = 0.01, .abs = 5, .digits = {}}, 100, 104), 1);
  EXPECT_GT(apart({.rel = 0.01, .abs = 3, .digits = {}}, 100, 104), 1);
  EXPECT_EQ(apart({.rel = 0, .abs = {}, .digits = {}}, 100, 100), 0);
  EXPECT_EQ(text_of({.rel = 0.02, .abs = 3, .digits = 0.5}), "golden within 2% or 3 or 0.5 digits");
}

TEST(Golden, ADifferenceSaysWhatChanges) {
  GoldenLine const a = golden_of(record_at(0.1));
  GoldenLine const b = golden_of(record_at(0.2));
  GoldenLine const c = golden_of(record_at(0.4));
  GoldenLine changed = a;
  changed.status = "diverged";
  changed.columns["steps"] = 7;
  changed.columns.erase("norm_drift_max");
  EXPECT_THAT(difference({a, b}, {changed, c}),
              ElementsAre("~ free_body//s3/cf4/none/h=0.1: status ok -> diverged, steps 500 -> 7, norm_drift_max "
                          "1.23457e-15 -> null",
                          "+ free_body//s3/cf4/none/h=0.4", "- free_body//s3/cf4/none/h=0.2"));
  EXPECT_THAT(difference({a, b}, {a, b}), IsEmpty());
}

TEST(Golden, WhatAgreesStaysAsItWasCommitted) {
  GoldenLine const before = golden_of(record_at(0.1));
  GoldenLine now = before;
  now.columns["norm_drift_max"] = 2e-15;  // round-off
  now.columns["norm_drift_final"] = -1e-9;
  GoldenLine const line = settled(before, now);
  EXPECT_EQ(line.columns.at("norm_drift_max"), before.columns.at("norm_drift_max"));
  EXPECT_EQ(line.columns.at("norm_drift_final"), -1e-9);
}

/// Each test has a folder of its own.
class GoldenFile : public testing::Test {
 protected:
  std::string text() const { return polhode::test::text_of(file); }
  /// The message that reading this text gives.
  std::string complaint(std::string const& damaged) const {
    top.write("inner/test.jsonl", damaged);
    std::string const what = polhode::test::complaint_of<StoreError>([&] { read_golden(file); });
    return what.substr(what.find(".jsonl") + 6);
  }

  polhode::test::TemporaryFolder top;
  fs::path const folder = top.path, file = folder / "inner" / "test.jsonl";
};

TEST_F(GoldenFile, ReadsBackWhatWasWritten) {
  std::vector<GoldenLine> const lines{golden_of(record_at(0.1)), golden_of(record_at(0.2))};
  write_golden(file, "test", lines);
  auto const back = read_golden(file);
  ASSERT_EQ(back.size(), 2u);
  EXPECT_THAT(difference(lines, back), IsEmpty());
  EXPECT_EQ(back[1].cell, lines[1].cell);
  EXPECT_EQ(back[1].name, lines[1].name);
  EXPECT_THAT(text(), testing::StartsWith("{\"schema\":1,\"kind\":\"golden\",\"suite\":\"test\"}\n"));
  EXPECT_THAT(text(), HasSubstr("\"status\":\"ok\",\"steps\":500,\"norm_drift_max\":1.23457e-15,"));
  write_golden(file, "test", back);
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1) << "nothing is left behind";
}

TEST_F(GoldenFile, NoFileIsOneWithoutLines) {
  EXPECT_THAT(read_golden(file), IsEmpty());
}

TEST_F(GoldenFile, DamageIsNamedWithItsLine) {
  std::string const head = "{\"schema\":1,\"kind\":\"golden\",\"suite\":\"test\"}\n";
  std::string const line = "{\"cell\":\"a\",\"name\":\"b\",\"status\":\"ok\"}\n";
  EXPECT_EQ(complaint(line), ":1: must begin with {\"schema\":1,\"kind\":\"golden\",\"suite\":...}");
  EXPECT_EQ(complaint(head + "{\n"), ":2: must be one JSON object");
  EXPECT_EQ(complaint(head + "[]\n"), ":2: must be one JSON object");
  EXPECT_EQ(complaint(head + line + "{\"cell\":\"c\",\"name\":1,\"status\":\"ok\"}\n"), ":3: name: must be a string");
  EXPECT_EQ(complaint(head + "{\"cell\":\"c\"}\n"), ":2: name: must be a string");
  EXPECT_EQ(complaint(head + line + line), ":3: cell: stands on an earlier line, too");
  EXPECT_EQ(complaint(head + "{\"cell\":\"a\",\"name\":\"b\",\"status\":\"ok\",\"step\":1}\n"),
            ":2: step: no golden column");
  EXPECT_EQ(complaint(head + "{\"cell\":\"a\",\"name\":\"b\",\"status\":\"ok\",\"steps\":null}\n"),
            ":2: steps: must be a number");
}

TEST_F(GoldenFile, AFolderThatCannotBeMadeIsAnError) {
  std::ofstream(folder / "inner") << "a file";
  EXPECT_THROW(write_golden(file, "test", {}), StoreError);
}

}  // namespace
}  // namespace polhode::results
