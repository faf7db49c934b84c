#include "integrators/catalog/body.hpp"
#include "tests/conformance/orders.hpp"
#include "tests/conformance/symmetry.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheBodyMethods) {
  EXPECT_GE(test::expect_orders(BodyMethods{}), 40);
}

TEST(Symmetry, OfTheBodyMethods) {
  EXPECT_GE(test::expect_symmetry_as_claimed(BodyMethods{}), 40);
}

}  // namespace
}  // namespace polhode
