#include "tests/orders.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheBodyMethods) {
  EXPECT_GE(test::expect_orders(BodyMethods{}), 40);
}

}  // namespace
}  // namespace polhode
