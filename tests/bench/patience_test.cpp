// What takes long says so: once where nobody watches.
#include "bench/process/patience.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

namespace polhode::bench {
namespace {

using std::chrono::milliseconds;

/// What stderr, which is no terminal here, hears of work that lasts so long.
std::string heard(milliseconds duration, milliseconds patience) {
  testing::internal::CaptureStderr();
  int const answer = patiently(
      "thinking", [&] { return std::this_thread::sleep_for(duration), 42; }, patience);
  EXPECT_EQ(answer, 42);
  return testing::internal::GetCapturedStderr();
}

TEST(Patience, QuickWorkIsSilent) {
  EXPECT_EQ(heard(milliseconds(0), std::chrono::minutes(1)), "");
}

TEST(Patience, LongWorkIsOneLine) {
  EXPECT_EQ(heard(milliseconds(1300), milliseconds(10)), "polhode: thinking; this can take minutes\n");
}

TEST(Patience, WhatWorkThrowsIsPassedOn) {
  EXPECT_THROW(patiently("thinking", []() -> int { throw std::runtime_error("no"); }), std::runtime_error);
}

}  // namespace
}  // namespace polhode::bench
