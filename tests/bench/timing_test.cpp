// The timing pass: repetitions of different cells in random order, and what is made of them.
#include "bench/cell/timing.hpp"

#include <gtest/gtest.h>

namespace polhode::bench {
namespace {

/// Does nothing but note whose turn it is.
class Turn final : public TimedSolve {
 public:
  Turn(char name, std::string& turns) : name_(name), turns_(turns) {}
  Status solve() override {
    if (turns_.empty() || turns_.back() != name_) turns_ += name_;
    return Status::ok;
  }
  std::vector<double> end_state() const override { return {}; }

 private:
  char name_;
  std::string& turns_;
};

constexpr int repetitions = 20;
constexpr Timing quick{.min_time = 1e-5, .repetitions = repetitions};

std::vector<TimedCell> two_cells(std::string& turns) {
  std::vector<TimedCell> cells;
  for (char const name : {'a', 'b'}) cells.push_back({std::string(1, name), std::make_unique<Turn>(name, turns)});
  return cells;
}

// One cell after the other they would take four turns: to warm up, and for all their repetitions.
TEST(Timing, RepetitionsAreInterleavedAtRandom) {
  std::string turns;
  time_cells(two_cells(turns), quick, false, [] {});
  EXPECT_GT(turns.size(), 10U) << turns;
}

TEST(Timing, EachCellHasItsRepetitions) {
  std::string turns;
  int progress = 0;
  auto const results = time_cells(two_cells(turns), quick, false, [&] { ++progress; });
  ASSERT_EQ(results.size(), 2U);
  for (TimedResult const& result : results) {
    ASSERT_TRUE(result.cpu_time);
    EXPECT_EQ(result.cpu_time->repetitions, repetitions);
    EXPECT_EQ(result.cpu_time->samples.size(), std::size_t(repetitions));
    EXPECT_EQ(result.allocations, 0);
  }
  EXPECT_EQ(progress, 2 * repetitions);
}

TEST(Timing, NothingIsTimedOnceStopped) {
  std::string turns;
  testing::internal::CaptureStderr();
  auto const results = time_cells(two_cells(turns), quick, true, [] {});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_FALSE(results.at(0).cpu_time || results.at(1).cpu_time);
  EXPECT_EQ(turns, "");
}

// A problem all of whose cells are refused or failed.
TEST(Timing, NothingToTimeIsNoComplaint) {
  testing::internal::CaptureStderr();
  EXPECT_TRUE(time_cells({}, quick, false, [] {}).empty());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Timing, TheBootstrapIsDeterministicAndHoldsTheMedian) {
  std::vector<double> const values{5, 1, 4, 2, 3};
  results::CpuTime const time = bootstrap(values), again = bootstrap(values);
  EXPECT_EQ(time.median, 3);
  EXPECT_LT(time.low, 3);
  EXPECT_GT(time.high, 3);
  EXPECT_EQ(time.samples, values);  // as they came
  EXPECT_EQ(std::pair(time.low, time.high), std::pair(again.low, again.high));
  EXPECT_EQ(bootstrap({1, 2}).median, 1.5);
  results::CpuTime const one = bootstrap({7});
  EXPECT_TRUE(one.low == 7 && one.median == 7 && one.high == 7);
}

}  // namespace
}  // namespace polhode::bench
