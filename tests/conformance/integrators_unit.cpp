/// The integrators that a binary adds (POLHODE_METHODS, from POLHODE_METHODS_HEADER) against what they claim: orders
/// and symmetry in time, in quadruple precision, by the walks that Polhode's own lists pass.
#include "tests/conformance/orders.hpp"
#include "tests/conformance/symmetry.hpp"

#include POLHODE_METHODS_HEADER

namespace polhode {
namespace {

/// The order problems are one body that turns: methods for other spaces have no order to be seen there.
constexpr bool has_order_to_see(MethodInfo const& info) {
  return info.order > 0 && info.needs < Needs::prescribed_rates;
}
template <class... Method>
constexpr int orders_to_see(Types<Method...>) {
  return (int(has_order_to_see(Method::info)) + ... + 0);
}

TEST(Order, OfWhatIsAdded) {
  EXPECT_GE(test::expect_orders(POLHODE_METHODS{}), orders_to_see(POLHODE_METHODS{})) << "some ran nowhere";
}

TEST(Symmetry, OfWhatIsAdded) {
  test::expect_symmetry_as_claimed(POLHODE_METHODS{});
}

}  // namespace
}  // namespace polhode
