#include "tests/orders.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheGroupMethods) {
  EXPECT_GE(test::expect_orders(GroupMethods{}), 20);
}

}  // namespace
}  // namespace polhode
