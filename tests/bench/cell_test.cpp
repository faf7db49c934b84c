// How a cell that reached its end is judged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/runs.hpp"

namespace polhode {
namespace {

// Two steps of 30 s with six sweeps each: numbers of 1e138, in a direction that happens to be near.
TEST(Cell, AStateThatIsNoAttitudeIsInaccurate) {
  results::Record const record =
      test::a_cell("pd_slew", "quaternion", "gauss8_lawson_sweeps6").with_h(30).measured().record;
  EXPECT_LT(record.attitude_error_max.value_or(9), 1);
  EXPECT_EQ(record.status, results::Status::inaccurate);
  EXPECT_THAT(record.reason, testing::HasSubstr("the state is no attitude"));
}

}  // namespace
}  // namespace polhode
