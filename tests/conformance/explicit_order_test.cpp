#include "integrators/catalog/explicit.hpp"
#include "tests/conformance/orders.hpp"
#include "tests/conformance/symmetry.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheExplicitMethods) {
  EXPECT_GE(test::expect_orders(ExplicitMethods{}), 25);
}

TEST(Symmetry, OfTheExplicitMethods) {
  EXPECT_GE(test::expect_symmetry_as_claimed(ExplicitMethods{}), 20);
}

}  // namespace
}  // namespace polhode
