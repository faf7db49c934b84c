#include "integrators/catalog/gauss.hpp"
#include "tests/orders.hpp"
#include "tests/symmetry.hpp"

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
