// What polhode-bench leaves in a result folder: written, read back, and refused when it is damaged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "results/store.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

using Folder = polhode::test::TemporaryFolder;

Benchmarks two() {
  Benchmarks benchmarks;
  benchmarks.meta = {{"cpu_model", "made-up"}, {"git_commit", "abc"}};
  benchmarks.all.push_back({"step/free_body/quaternion/rk4",
                            false,
                            {1.25e-4, 1.2e-4, 1.3e-4, 3, {1.2e-4, 1.25e-4, 1.3e-4}},
                            {{"per_step", 2.5e-8}}});
  benchmarks.all.push_back({"ensemble/free_body/rk4_threads_2", true, {2e-3, 2e-3, 2e-3, 1, {}}, {}});
  return benchmarks;
}

std::string complaint(std::string const& text) {
  return polhode::test::complaint_of<std::invalid_argument>([&] { benchmarks_from(text); });
}

/// A file of one benchmark, with its parts as told.
std::string file_of(std::string const& time = R"({"median": 2, "low": 1, "high": 3, "repetitions": 5})",
                    std::string const& clock = "\"cpu\"", std::string const& counters = "{}",
                    std::string const& more = "") {
  return R"({"schema": 1, "kind": "benchmarks", "meta": {"schema": 1, "kind": "meta"}, "benchmarks": )"
         R"([{"name": "a", "clock": )" +
         clock + R"(, "time_s": )" + time + R"(, "counters": )" + counters + more + "}]}";
}

TEST(Benchmarks, ReadAsTheyWereWritten) {
  Folder const folder;
  write_benchmarks(folder.path / "deep", two());
  Benchmarks const read = read_benchmarks(folder.path / "deep");
  EXPECT_EQ(read.meta, two().meta);
  ASSERT_EQ(read.all.size(), 2U);
  Benchmark const* step = read.find("step/free_body/quaternion/rk4");
  ASSERT_NE(step, nullptr);
  EXPECT_FALSE(step->wall);
  EXPECT_EQ(step->time.median, 1.25e-4);
  EXPECT_EQ(step->time.low, 1.2e-4);
  EXPECT_EQ(step->time.high, 1.3e-4);
  EXPECT_EQ(step->time.samples, two().all[0].time.samples);
  EXPECT_EQ(step->counters.at("per_step"), 2.5e-8);
  EXPECT_TRUE(read.all[1].wall);
  EXPECT_EQ(read.find("step/free_body"), nullptr);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path / "deep"), {}), 1) << "no draft is left";
}

TEST(Benchmarks, AFolderMayHaveNone) {
  Folder const folder;
  EXPECT_TRUE(read_benchmarks(folder.path).all.empty());
  EXPECT_TRUE(read(folder.path).benchmarks.all.empty());
}

TEST(Benchmarks, DamageIsNamed) {
  EXPECT_EQ(complaint(file_of()), "");
  EXPECT_THAT(complaint(file_of().substr(0, 100)), HasSubstr("is not JSON"));
  EXPECT_THAT(complaint("[]"), HasSubstr("must be an object"));
  EXPECT_THAT(complaint("{}"), HasSubstr("is missing"));
  EXPECT_THAT(complaint(file_of("{}")), HasSubstr("benchmarks[0].time_s"));
  EXPECT_THAT(complaint(file_of(R"({"median": null, "low": 1, "high": 3, "repetitions": 5})")),
              HasSubstr("0 < low <= median <= high"));
  EXPECT_THAT(complaint(file_of(R"({"median": 4, "low": 1, "high": 3, "repetitions": 5})")),
              HasSubstr("0 < low <= median <= high"));
  EXPECT_THAT(complaint(file_of(R"({"median": 0, "low": 0, "high": 3, "repetitions": 5})")),
              HasSubstr("0 < low <= median <= high"));
  std::string const good = R"({"median": 2, "low": 1, "high": 3, "repetitions": 5})";
  EXPECT_THAT(complaint(file_of(good, "\"sun\"")), HasSubstr("benchmarks[0].clock"));
  EXPECT_THAT(complaint(file_of(good, "\"cpu\"", R"({"per_step": "fast"})")),
              HasSubstr("benchmarks[0].counters.per_step: must be a number"));
  EXPECT_THAT(complaint(file_of(good, "\"cpu\"", "{}", R"(, "extra": 1)")), HasSubstr("unknown field \"extra\""));
}

TEST(Benchmarks, ADamagedFileStopsTheReaderWithItsName) {
  Folder const folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / benchmarks_file) << "{";
  try {
    read(folder.path);
    FAIL() << "was read";
  } catch (StoreError const& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder.path / benchmarks_file).string() + ": is not JSON"));
  }
}

}  // namespace
}  // namespace polhode::results
