#include "tests/orders.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheGaussMethods) {
  EXPECT_GE(test::expect_orders(GaussMethods{}), 28);
}

}  // namespace
}  // namespace polhode
