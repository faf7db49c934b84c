/// Several result folders as one.
#include "results/merge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "results/store.hpp"
#include "tests/results/made_up_record.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using test::text_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Record record_of(std::string const& integrator, double h, std::string const& build = "b") {
  return test::made_up_record(integrator, h, build);
}

class Merge : public testing::Test {
 protected:
  /// A folder with one file of these records, each with a begin and a history.
  fs::path folder(std::string const& name, std::vector<Record> const& records, std::string const& build = "b") {
    fs::create_directories(root / name);
    Writer writer(root / name / "run-1.jsonl", {{"build", build}, {"host", name}});
    for (Record const& record : records) {
      writer.begin(record.cell, record.build);
      writer.series({record.cell, "drift", {"t"}, {"s"}, {{double(*record.steps)}}});
      writer.run(record);
    }
    return root / name;
  }
  std::string error_of(std::vector<fs::path> const& folders) {
    return test::complaint_of<StoreError>([&] { merge(root / "out", folders); });
  }

  test::TemporaryFolder const temporary;
  fs::path const root = temporary.path;
};

TEST_F(Merge, ShardsBecomeOneFolder) {
  auto const a = folder("a", {record_of("rk4", 0.1), record_of("rk4", 0.2)});
  auto const b = folder("b", {record_of("gauss2", 0.1)});
  std::ofstream(a / "suite.toml") << "name = 'x'\n";
  std::ofstream(b / "suite.toml") << "name = 'x'\n";
  MergeSummary const summary = merge(root / "out", {a, b});
  EXPECT_EQ(summary.folders, 2u);
  EXPECT_EQ(summary.files, 2u);
  EXPECT_EQ(summary.records, 3u);
  EXPECT_EQ(summary.repeated, 0u);
  Contents const contents = read(root / "out");
  EXPECT_EQ(contents.records.size(), 3u);
  EXPECT_EQ(contents.series.size(), 3u);
  ASSERT_EQ(contents.metas.size(), 2u) << "provenance stays with its records";
  EXPECT_EQ(contents.metas[0].at("host"), "a");
  EXPECT_EQ(contents.metas[1].at("host"), "b");
  EXPECT_EQ(text_of(root / "out" / "suite.toml"), "name = 'x'\n");
}

TEST_F(Merge, OfEqualRunsTheLastIsKeptAndTheOthersCounted) {
  Record const first = record_of("rk4", 0.1);
  Record second = first;
  second.steps = 501;
  Record third = first;
  third.steps = 502;
  auto const a = folder("a", {first, second});  // twice in one file
  auto const b = folder("b", {third, record_of("rk4", 0.2)});
  MergeSummary const summary = merge(root / "out", {a, b});
  EXPECT_EQ(summary.repeated, 2u);
  EXPECT_EQ(summary.records, 2u);
  Contents const contents = read(root / "out");
  ASSERT_EQ(contents.records.size(), 2u);
  EXPECT_EQ(contents.repeated, 0u);
  EXPECT_EQ(contents.records[0].steps, 502);
  EXPECT_EQ(contents.series[0].rows[0][0], 502) << "its history, too";
  // In the other order, the last is another.
  merge(root / "other", {b, a});
  for (Record const& record : read(root / "other").records) EXPECT_EQ(record.steps, record.of.h == 0.1 ? 501 : 500);
}

TEST_F(Merge, RunsOfTwoBuildsAreTwoRuns) {
  auto const a = folder("a", {record_of("rk4", 0.1, "b")}, "b");
  auto const b = folder("b", {record_of("rk4", 0.1, "c")}, "c");
  EXPECT_EQ(merge(root / "out", {a, b}).records, 2u);
  EXPECT_EQ(read(root / "out").records.size(), 2u);
}

TEST_F(Merge, ABeginWithoutRunIsKeptUnlessItRanElsewhere) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  Record const crashed = record_of("rk4", 0.2);
  Record const elsewhere = record_of("rk4", 0.4);
  {
    Writer writer(a / "run-2.jsonl", {{"build", "b"}});
    writer.begin(crashed.cell, "b");
    writer.begin(elsewhere.cell, "b");
  }
  merge(root / "out", {a, folder("b", {elsewhere})});
  EXPECT_THAT(read(root / "out").unfinished, ElementsAre(crashed.cell));
}

TEST_F(Merge, DamageIsRefusedWithItsLineAndNothingIsWritten) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  auto const b = folder("b", {record_of("rk4", 0.2)});
  std::ofstream(b / "run-1.jsonl", std::ios::app) << "{\"schema\":1}\n";
  EXPECT_THAT(error_of({a, b}), HasSubstr("b/run-1.jsonl:5: kind: missing"));
  EXPECT_FALSE(fs::exists(root / "out"));
}

TEST_F(Merge, ATornLineAndAFileWithoutMetaAreForgiven) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  std::ofstream(a / "run-1.jsonl", std::ios::app) << "{\"schema\":1,";
  std::ofstream(a / "run-2.jsonl") << "";
  EXPECT_EQ(merge(root / "out", {a}).records, 1u);
}

TEST_F(Merge, WhatDoesNotFitIsRefused) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  auto const b = folder("b", {record_of("rk4", 0.2)});
  std::ofstream(a / "suite.toml") << "name = 'x'\n";
  std::ofstream(b / "suite.toml") << "name = 'y'\n";
  EXPECT_THAT(error_of({a, b}), HasSubstr("merge results of one suite"));
  EXPECT_THAT(error_of({a, root / "nowhere"}), HasSubstr("nowhere: no such folder"));
  merge(root / "out", {a});
  EXPECT_THAT(error_of({b}), HasSubstr("out: holds records already"));
}

// ---- Beside the records ---------------------------------------------------------------------------------------------

Benchmarks benchmarks_of(std::string const& host) {
  return {.meta = {{"host", host}},
          .all = {{.name = "step", .wall = false, .time = {1, 0.5, 2, 3, {}}, .counters = {}}}};
}

TEST_F(Merge, BenchmarksAreCarried) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  auto const b = folder("b", {record_of("rk4", 0.2)});
  write_benchmarks(b, benchmarks_of("b"));
  EXPECT_THAT(merge(root / "out", {a, b}).left, IsEmpty());
  EXPECT_EQ(text_of(root / "out/benchmarks.json"), text_of(b / "benchmarks.json"));
  EXPECT_EQ(read(root / "out").benchmarks.meta.at("host"), "b");
}

TEST_F(Merge, OfTwoMeasurementsTheLastIsCarriedAndTheOtherIsNamed) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  auto const b = folder("b", {record_of("rk4", 0.2)});
  for (auto const& one : {a, b}) write_benchmarks(one, benchmarks_of(one.filename()));
  EXPECT_THAT(merge(root / "out", {a, b}).left, ElementsAre(a / "benchmarks.json"));
  EXPECT_EQ(read(root / "out").benchmarks.meta.at("host"), "b");
  write_benchmarks(a, benchmarks_of("b"));
  EXPECT_THAT(merge(root / "same", {a, b}).left, IsEmpty());
}

TEST_F(Merge, DamagedMeasurementsAreRefused) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  for (std::string const name : {"benchmarks.json", "ensemble.json", "catalogue.json"}) {
    std::ofstream(a / name) << "{";
    EXPECT_THAT(error_of({a}), HasSubstr("a/" + name + ": ")) << name;
    EXPECT_FALSE(fs::exists(root / "out"));
    fs::remove(a / name);
  }
}

TEST_F(Merge, WhatIsNotCarriedIsNamed) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  fs::create_directory(a / "report");
  for (char const* name : {"notes.txt", ".lock-1-of-2", "catalogue.json.17"}) std::ofstream(a / name) << "x";
  EXPECT_THAT(merge(root / "out", {a}).left, ElementsAre(a / "notes.txt", a / "report"));
  EXPECT_FALSE(fs::exists(root / "out/notes.txt"));
}

TEST_F(Merge, TheGraphsThatTheSuiteNamesAreOneForAll) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  auto const b = folder("b", {record_of("rk4", 0.2)});
  for (auto const& one : {a, b}) {
    std::ofstream(one / "suite.toml") << "# a graph\nset = { graph = '../swarm.txt' }\n";
    std::ofstream(one / "swarm.txt") << "1 2 1\n";
    std::ofstream(one / "graph") << one;  // a word of the suite, but no file that it names
  }
  EXPECT_THAT(merge(root / "first", {a, b}).left, ElementsAre(a / "graph", b / "graph"));
  EXPECT_EQ(text_of(root / "first/swarm.txt"), "1 2 1\n");
  std::ofstream(b / "swarm.txt") << "1 2 5\n";
  EXPECT_EQ(error_of({a, b}), (b / "swarm.txt").string() + ": another graph than " + (a / "swarm.txt").string() +
                                  "; merge results of one suite");
}

TEST_F(Merge, NothingIsWrittenOver) {
  auto const a = folder("a", {record_of("rk4", 0.1)});
  write_benchmarks(a, benchmarks_of("a"));
  write_benchmarks(root / "out", benchmarks_of("out"));
  EXPECT_THAT(error_of({a}), HasSubstr("out/benchmarks.json: is there already, and another; give a new folder"));
  EXPECT_EQ(read_benchmarks(root / "out").meta.at("host"), "out");
  EXPECT_TRUE(record_files(root / "out").empty());
}

}  // namespace
}  // namespace polhode::results
