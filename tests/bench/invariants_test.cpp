// Energy and momentum of runs that can be computed by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/cell/measure.hpp"
#include "tests/bench/turning_ball.hpp"

namespace polhode::bench {
namespace {

using namespace test;

TEST(Invariants, AFasterBodyHasMoreEnergyAndMomentumInTheSameDirection) {
  double const more = 1e-6;
  auto const record =
      record_of([&](double t) { return sight(t, exact(t), scaled(Quad(1 + (t == t_end / 2 ? more : 0)), omega)); });
  EXPECT_NEAR(*record.energy_drift_max, 2 * more + more * more, 1e-15) << "it is quadratic in the rate";
  EXPECT_NEAR(*record.momentum_drift_max, more, 1e-15);
  EXPECT_LT(*record.momentum_direction_max, 1e-32);
}

TEST(Invariants, ATurnedBodyTurnsTheMomentumAlone) {
  auto const record = record_of([](double t) { return sight(t, turned(t, t == t_end / 2 ? small : 0)); });
  EXPECT_NEAR(*record.momentum_direction_max / small, 1, 1e-13);
  EXPECT_LT(*record.energy_drift_max, 1e-32);
  EXPECT_LT(*record.momentum_drift_max, 1e-32);
}

TEST(Invariants, AgainstTimeKeepTheirSigns) {
  double const less = -1e-6;
  Metrics metrics = metrics_of_the_ball();
  for (int k = 0; k <= steps; ++k) {
    double const t = t_end * k / steps;
    bool const late = t > t_end / 2;
    metrics.see(sight(t, late ? turned(t, small) : exact(t), scaled(Quad(late ? 1 + less : 1), omega)));
  }
  auto const series = metrics.invariant_series("a cell");
  EXPECT_EQ(series.name, "invariants");
  EXPECT_EQ(series.columns, (std::vector<std::string>{"t", "energy", "momentum", "momentum_direction"}));
  ASSERT_GE(series.rows.size(), std::min<std::size_t>(steps, 500));
  ASSERT_LE(series.rows.size(), 502u);
  EXPECT_EQ(series.rows.front(), (std::vector<double>{0, 0, 0, 0}));
  auto const& end = series.rows.back();
  EXPECT_EQ(end[0], t_end);
  EXPECT_NEAR(end[1], 2 * less + less * less, 1e-15);
  EXPECT_NEAR(end[2], less, 1e-15);
  EXPECT_NEAR(end[3] / small, 1, 1e-13);
}

TEST(Invariants, AnUnnormalisedQuaternionDoesNotChangeThem) {
  Quat<Quad> const tilt = turned(0, 1);  // so that the momentum is along no axis
  auto const record = record_of([&](double t) { return sight(t, scaled(Quad(1 + 0.01 * t), tilt * exact(t))); });
  EXPECT_GT(*record.norm_drift_max, 1);
  EXPECT_LT(*record.momentum_direction_max, 1e-30);
}

TEST(Invariants, UseTheWholeInertiaMatrix) {
  // J omega = (xy, yy, yz) of the matrix for a unit rate about y.
  BodyParameters body;
  body.inertia = {3, 4, 5, 0.1, 0.2, 0.3};
  auto const found = invariants_of(body.matrix<Quad>(), exact(0), Vec3<Quad>{0, 1, 0});
  EXPECT_NEAR(double(found.energy), 2, 1e-15);
  EXPECT_NEAR(double(found.momentum), std::sqrt(0.01 + 16 + 0.09), 1e-15);
  EXPECT_NEAR(double(found.direction.x), 0.1, 1e-16);
  EXPECT_NEAR(double(found.direction.z), 0.3, 1e-16);
}

TEST(Invariants, OfAControlledBodyAreNull) {
  bool const controlled = !problem_named("pd_slew").choose({})->torque_free();
  EXPECT_TRUE(controlled);
  auto const record = record_of([](double t) { return sight(t, exact(t)); }, evenly, !controlled);
  EXPECT_FALSE(record.energy_drift_max);
  EXPECT_FALSE(record.momentum_drift_max);
  EXPECT_FALSE(record.momentum_direction_max);
  EXPECT_TRUE(record.attitude_error_max);
}

}  // namespace
}  // namespace polhode::bench
