#include "tests/orders.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheExplicitMethods) {
  EXPECT_GE(test::expect_orders(ExplicitMethods{}), 25);
}

}  // namespace
}  // namespace polhode
