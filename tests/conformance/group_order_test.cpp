#include "integrators/catalog/group.hpp"
#include "tests/conformance/orders.hpp"
#include "tests/conformance/symmetry.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheGroupMethods) {
  EXPECT_GE(test::expect_orders(GroupMethods{}), 20);
}

TEST(Symmetry, OfTheGroupMethods) {
  EXPECT_GE(test::expect_symmetry_as_claimed(GroupMethods{}), 20);
}

}  // namespace
}  // namespace polhode
