/// The orders of rivals with fixed steps, in double precision; those of own methods: orders.hpp.
#include "tests/conformance/orders.hpp"

namespace polhode {
namespace {

using test::brisk_slew;
using test::OrderPoint;
using test::slope_of;

TEST(Order, OfEveryRivalWithFixedSteps) {
  int checked = 0;
  for (bench::IntegratorWord const& word : bench::vocabulary().integrators) {
    if (!word.rival || !word.fixed || !word.order || !word.not_built.empty()) continue;
    std::vector<OrderPoint> points;
    for (double steps_a_second : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0, 128.0}) {
      double const h = 1 / steps_a_second;
      auto cell = brisk_slew().cell;
      cell.cell.formulation = "quaternion";
      cell.cell.integrator = word.name;
      auto const run = cell.with_h(h).simulated();
      ASSERT_EQ(run.status, results::Status::ok);
      auto const& row = run.history.rows.back();
      double const error = double(angle_between(Quat<Quad>{row[0], row[1], row[2], row[3]}, brisk_slew().end.at(0).q));
      if (2e-13 < error && error < 1e-4)  // round-off is below 7e-15
        points.push_back({std::log(h), std::log(error)});
    }
    ASSERT_GE(points.size(), 3u) << word.name;
    if (points.size() > 3) points.erase(points.begin(), points.end() - 3);  // the finest are the most asymptotic
    // Between the leading term and round-off double precision leaves orders 7 and 8 less than a decade of steps.
    EXPECT_NEAR(slope_of(points), *word.order, *word.order < 7 ? 0.1 : 0.2) << word.name;
    ++checked;
  }
  EXPECT_GE(checked, 2);
}

}  // namespace
}  // namespace polhode
