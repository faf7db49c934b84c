/// Events that a problem announces: runs stop there, and methods keep their order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/solve/run_loop.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/erased.hpp"
#include "problems/space.hpp"

namespace polhode {
namespace {

constexpr double event = 0.3;

/// A turn in the plane at a speed with a kink: 1 before the event, 1 + 3 (t - event) after it.
struct KinkedTurn {
  using Space = Euclidean3<double>;
  static constexpr double angle = event + (1 - event) * (1 + 1.5 * (1 - event));
  static double speed(double t) { return 1 + 3 * std::max(0.0, t - event); }

  Vec3<double> operator()(double t, Vec3<double> const& x) const { return {-speed(t) * x.y, speed(t) * x.x, 0}; }
  Vec3<double> initial() const { return {1, 0, 0}; }
  std::vector<double> time_events() const { return {event}; }
};

/// The same at a speed with a jump: 1 before the event, 3 from then on. `phases`: it switches when it is told;
/// otherwise by comparing the time, which the last stage of the step before the event gets wrong.
template <bool phases>
struct JumpingTurn : KinkedTurn {
  static constexpr double angle = event + (1 - event) * 3;
  bool after = false;
  void enter_phase(double t) { after = t >= event; }
  Vec3<double> operator()(double t, Vec3<double> const& x) const {
    double const speed = (phases ? after : t >= event) ? 3 : 1;
    return {-speed * x.y, speed * x.x, 0};
  }
};

/// Notes the times of the stops.
struct Times : bench::NoWatch {
  std::vector<double> times;
  void at_stop(bench::Stop const& stop, Vec3<double> const&) { times.push_back(stop.time); }
};

/// The error at 1 s with n steps a second.
template <class Turn>
double error_of(bool announced, int n) {
  Turn turn;
  auto const problem = erase_type(turn);
  bench::Schedule schedule;
  schedule.t_end = 1;
  if (announced) schedule.jumps = problem->time_events();
  auto stepper = Rk4{}.bind(*problem, FixedStep{1.0 / n}, NormPolicy::none);
  Vec3<double> x = turn.initial();
  Times seen;
  auto const stops = bench::stops_of(schedule);
  EXPECT_EQ(bench::RunLoop(*problem, stepper, 1.0 / n, true).go(x, stops, seen), Status::ok);
  EXPECT_EQ(seen.times, announced ? (std::vector<double>{0, event, 1}) : (std::vector<double>{0, 1}));
  EXPECT_EQ(stepper.work().steps, announced ? n + 1 : n) << "each piece ends with a step of its own";
  return std::hypot(x.x - std::cos(Turn::angle), x.y - std::sin(Turn::angle));
}
/// The order that 32 and 256 steps a second show.
template <class Turn>
double order_of(bool announced) {
  return std::log(error_of<Turn>(announced, 32) / error_of<Turn>(announced, 256)) / std::log(8);
}

TEST(TimeEvents, AKinkCostsOrderUnlessItIsAnnounced) {
  EXPECT_NEAR(order_of<KinkedTurn>(true), 4, 0.15);
  EXPECT_LT(order_of<KinkedTurn>(false), 2.5);
}

// Explicit methods evaluate the field at the very end of the step before the event: a field that compares the time has
// jumped there already, one that waits for its phase has not.
TEST(TimeEvents, AJumpCostsOrderUnlessItIsAnnouncedAndAPhase) {
  EXPECT_NEAR(order_of<JumpingTurn<true>>(true), 4, 0.15);
  EXPECT_LT(order_of<JumpingTurn<false>>(true), 2.5);
  EXPECT_LT(order_of<JumpingTurn<false>>(false), 2.5);
}

}  // namespace
}  // namespace polhode
