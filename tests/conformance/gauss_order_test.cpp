#include "integrators/catalog/gauss.hpp"
#include "tests/conformance/orders.hpp"
#include "tests/conformance/symmetry.hpp"

namespace polhode {
namespace {

TEST(Order, OfTheGaussMethods) {
  EXPECT_GE(test::expect_orders(GaussMethods{}), 28);
}

TEST(Symmetry, OfTheGaussMethods) {
  EXPECT_GE(test::expect_symmetry_as_claimed(GaussMethods{}), 40);
}

}  // namespace
}  // namespace polhode
