// What a run is held against, or why it is held against nothing.
#include "bench/references.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace polhode::bench {
namespace {

// Its segments, of seconds, are nothing beside the horizon. It once ended the whole run.
TEST(References, AProblemWhoseSeriesDoesNotArriveHasNone) {
  results::Cell cell;
  cell.problem = "free_body";
  cell.formulation = "quaternion";
  cell.integrator = "rk4";
  cell.h = 1e9;
  cell.t_end = 1e12;
  References references("no committed ones");
  auto const [reference, why_none] = references.of(prepare(cell));
  EXPECT_EQ(reference, nullptr);
  EXPECT_THAT(why_none, testing::HasSubstr("no useful radius of convergence"));
}

}  // namespace
}  // namespace polhode::bench
