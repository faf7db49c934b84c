// Limits of wall time.
#include "bench/process/clock.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace polhode::bench {
namespace {

TEST(TimeLimit, PassesWhenItsTimeIsOver) {
  TimeLimit const limit(1e-3);
  EXPECT_TRUE((std::this_thread::sleep_for(std::chrono::milliseconds(2)), limit.passed()));
  EXPECT_FALSE(TimeLimit(60).passed());
}

// More nanoseconds than 64 bits hold once were a time in the past.
TEST(TimeLimit, WhatIsTooLongToCountNeverPasses) {
  for (double const seconds : {0.0, 1e9, 1e10, 1e300, std::numeric_limits<double>::max()})
    EXPECT_FALSE(TimeLimit(seconds).passed()) << seconds;
}

}  // namespace
}  // namespace polhode::bench
