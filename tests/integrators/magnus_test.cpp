/// Magnus methods under prescribed rates, and coning in closed form.
#include "integrators/magnus.hpp"

#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "problems/coning.hpp"
#include "problems/dual.hpp"
#include "problems/jet.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using namespace test;

// ---- Coning ---------------------------------------------------------------------------------------------------------

template <class S, template <class> class A>
auto coning(double angle = 0.1, double rate = 10) {
  Choice choice;
  choice.set["cone_angle"] = {angle};
  choice.set["cone_rate"] = {rate};
  return Coning(choice).field<S, A, true>();
}

static_assert(Definition<Coning>);
static_assert(Problem<decltype(coning<Series, FlatQuaternion>())> && Problem<decltype(coning<Dual<2>, Mrp>())>);

TEST(Coning, TheClosedFormMovesWithItsRates) {
  ConingMotion<double> const motion(0.3, 7);
  for (double at : {0.0, 0.4, 1.7}) {
    Dual<1> t(at);
    t.slope[0] = 1;
    Quat<Dual<1>> const q = motion.attitude(t);
    Quat<double> const rate = quaternion_rate(motion.attitude(at), motion.body_rate(at));
    EXPECT_LT(distance<double>({q.x.slope[0], q.y.slope[0], q.z.slope[0], q.w.slope[0]}, rate), 1e-15);
    EXPECT_NEAR(dot(motion.attitude(at), motion.attitude(at)), 1, 1e-15);
  }
}

TEST(Coning, IsWhatGaussAndPowerSeriesFind) {
  auto const problem = coning<Quad, S3>();
  auto const exact = problem.motion.attitude(Quad(1));
  EXPECT_LT(double(distance<Quad>(by_gauss(problem, 0.03125, 1)[0], exact)), 1e-27);
  auto const series = coning<Series, S3>().motion.attitude(Series::of(32, [](int k) { return Quad(k == 1 ? 1 : 0); }));
  Quat<Quad> const summed{series.x.at(0.25), series.y.at(0.25), series.z.at(0.25), series.w.at(0.25)};
  EXPECT_LT(double(distance<Quad>(summed, problem.motion.attitude(Quad(0.25)))), 1e-24);
}

TEST(Coning, ShowsItsDistanceFromTheClosedForm) {
  auto const problem = coning<double, S3>();
  auto x = problem.initial();
  double error = -1;
  problem.show(0, x, std::span(&error, 1));
  EXPECT_EQ(error, 0);
  x[0] = x[0] * exp_quaternion(Vec3<double>{1e-3, 0, 0});
  problem.show(0, x, std::span(&error, 1));
  EXPECT_NEAR(error, 1e-3, 1e-15);
  History history;
  history.columns = {"coning_error"};
  history.times = {0, 1, 2};
  history.rows = {{0}, {3e-6}, {2e-6}};
  EXPECT_EQ(*Coning(Choice{}).claims(history)[0].value, 3e-6);
}

// ---- Order ----------------------------------------------------------------------------------------------------------

/// Rates without any symmetry.
template <class S, template <class> class A>
struct Gyros {
  using Space = A<S>;
  static constexpr bool prescribed_rates() { return true; }
  Vec3<S> operator()(S const& t, Point<Space> const&) const {
    S const two(2.0), three(3.0);
    return {S(0.7) + sin(two * t), cos(three * t) - t, sin(t) + S(0.3) * t * t};
  }
  Point<Space> initial() const { return Space::from_attitude(normalised(Quat<S>{S(0.1), S(0.2), S(-0.3), S(0.9)})); }
};

template <template <class> class A>
double error_of(auto const& method, double h) {
  Gyros<Quad, A> const problem;
  static auto const exact = by_gauss(problem, 0.03125, 1);
  return double(angle_between(A<Quad>::attitude(state_at(method, problem, h, 1)), A<Quad>::attitude(exact)));
}

TEST(Magnus, HasItsOrder) {
  EXPECT_NEAR(order_of(error_of<S3>(Magnus4{}, 1. / 32), error_of<S3>(Magnus4{}, 1. / 64)), 4, 0.05);
  EXPECT_NEAR(order_of(error_of<SO3>(Magnus4{}, 1. / 32), error_of<SO3>(Magnus4{}, 1. / 64)), 4, 0.05);
  EXPECT_NEAR(order_of(error_of<S3>(Magnus6{}, 1. / 32), error_of<S3>(Magnus6{}, 1. / 64)), 6, 0.05);
  EXPECT_NEAR(order_of(error_of<SO3>(Magnus6{}, 1. / 32), error_of<SO3>(Magnus6{}, 1. / 64)), 6, 0.05);
}

TEST(Magnus, HasItsOrderOnConing) {
  auto const error = [](auto const& method, double h) {
    auto const problem = coning<Quad, S3>();
    return double(angle_between(state_at(method, problem, h, 2)[0], problem.motion.attitude(Quad(2))));
  };
  EXPECT_NEAR(order_of(error(Magnus4{}, 1. / 64), error(Magnus4{}, 1. / 128)), 4, 0.05);
  EXPECT_NEAR(order_of(error(Magnus6{}, 1. / 64), error(Magnus6{}, 1. / 128)), 6, 0.05);
  EXPECT_GT(error(Magnus4{}, 1. / 64), 1e-10) << "an error above round-off, or there is no order to see";
}

/// The coefficients of magnus6, in the order of its formula.
using Coefficients = std::array<Quad, 6>;
constexpr Coefficients magnus6{Quad(1) / 12, Quad(1) / 60, 2, Quad(1) / 240, 20, 1};

/// Magnus of order 6 as printed for Y' = A Y, with given coefficients; slow and obvious. For body rates the inverse
/// turns with A = -omega, so its rotation vector is minus that of -omega.
double error_by_hand(Coefficients const& c, double h) {
  Gyros<Quad, S3> const problem;
  static auto const exact = by_gauss(problem, 0.03125, 1);
  auto x = problem.initial();
  Quad const apart = h * sqrtq(15) / 10, H = h;
  for (int i = 0; i < std::lround(1 / h); ++i) {
    auto const A = [&](Quad offset) { return Quad(-1) * problem(i * H + H / 2 + offset, x); };
    Vec3<Quad> const a1 = H * A(0), a2 = (H * sqrtq(15) / 3) * (A(apart) - A(-apart));
    Vec3<Quad> const a3 = (10 * H / 3) * (A(apart) - Quad(2) * A(0) + A(-apart));
    Vec3<Quad> const c1 = cross(a1, a2), c2 = -c[1] * cross(a1, c[2] * a3 + c1);
    Vec3<Quad> const sum = a1 + c[0] * a3 + c[3] * cross(-c[4] * a1 - c[5] * a3 + c1, a2 + c2);
    x = S3<Quad>::retract(x, Quad(-1) * sum);
  }
  return double(angle_between(x, exact));
}

TEST(Magnus, OfOrder6IsThePrintedFormulaMirroredAndEveryCoefficientMatters) {
  EXPECT_NEAR(error_by_hand(magnus6, 1. / 16) / error_of<S3>(Magnus6{}, 1. / 16), 1, 1e-12);
  for (std::size_t k = 0; k < magnus6.size(); ++k) {
    Coefficients wrong = magnus6;
    wrong[k] += wrong[k] / 2;
    EXPECT_LT(order_of(error_by_hand(wrong, 1. / 64), error_by_hand(wrong, 1. / 128)), 5) << "coefficient " << k;
  }
}

TEST(Magnus, OfOrder4ByHand) {
  Gyros<double, S3> const problem;
  double const h = 0.25, root = std::sqrt(3.) / 6;
  Vec3<double> const w1 = problem((0.5 - root) * h, {}), w2 = problem((0.5 + root) * h, {});
  Vec3<double> const turn = (h / 2) * (w1 + w2) + (h * h * root / 2) * cross(w1, w2);
  EXPECT_LT(distance<double>(state_at(Magnus4{}, problem, h, h), S3<double>::retract(problem.initial(), turn)), 1e-15);
}

/// A steady turn.
struct Steady {
  using Space = S3<double>;
  static constexpr bool prescribed_rates() { return true; }
  Vec3<double> operator()(double, Quat<double> const&) const { return {0.3, -0.5, 0.2}; }
  Quat<double> initial() const { return {0, 0, 0, 1}; }
};

TEST(Magnus, OfAConstantRateIsExact) {
  Vec3<double> const turn = 10 * Steady{}(0, {});
  EXPECT_LT(distance<double>(state_at(Magnus4{}, Steady{}, 2.5, 10), exp_quaternion(turn)), 1e-15);
  EXPECT_LT(distance<double>(state_at(Magnus6{}, Steady{}, 2.5, 10), exp_quaternion(turn)), 1e-15);
}

// ---- What it keeps, and whom it refuses -----------------------------------------------------------------------------

template <class Method>
void expect_symmetric() {
  Gyros<double, S3> const problem;
  EXPECT_LT(forth_and_back(Method{}, problem, 0.0625, 40), 1e-13) << Method::info.name;
}

TEST(Magnus, IsSymmetricInTime) {
  expect_symmetric<Magnus4>();
  expect_symmetric<Magnus6>();
}

TEST(Magnus, KeepsTheConstraintOverTenThousandSteps) {
  Gyros<double, SO3> const matrix;
  Gyros<double, S3> const quaternion;
  EXPECT_LT(SO3<double>::defect(state_at(Magnus6{}, matrix, 1e-3, 10)), 1e-13);
  EXPECT_LT(S3<double>::defect(state_at(Magnus6{}, quaternion, 1e-3, 10)), 1e-13);
}

/// The same gyros on three bodies.
struct ThreeGyros {
  using Space = Attitudes<S3<double>>;
  static constexpr bool prescribed_rates() { return true; }
  void operator()(double t, Point<Space> const& x, Velocity<Space>& v) const {
    for (int i = 0; i < 3; ++i) v[i] = (1. + i) * Gyros<double, S3>{}(t, x[i]);
  }
  Point<Space> initial() const {
    Point<Space> x(3);
    for (int i = 0; i < 3; ++i) x[i] = Gyros<double, S3>{}.initial();
    return x;
  }
};

TEST(Magnus, ManyBodiesAreOneBodyOftenAndNothingIsAllocated) {
  ThreeGyros const three;
  auto const one = state_at(Magnus6{}, Gyros<double, S3>{}, 0.125, 2);
  EXPECT_LT(distance<double>(state_at(Magnus6{}, three, 0.125, 2)[0], one), 1e-15);
  auto x = three.initial();
  auto stepper = Magnus4{}.bind(three, FixedStep{0.125}, NormPolicy::none);
  auto const before = bench::allocations_of_this_thread();
  Status const status = stepper.advance(x, 0, 2);
  EXPECT_EQ(bench::allocations_of_this_thread(), before);
  EXPECT_EQ(status, Status::ok);
}

using Torqued = decltype(shaken_body<double, S3>());
static_assert(RunsFixed<Magnus4, Gyros<double, S3>>);
static_assert(RunsFixed<Magnus4, ThreeGyros>);
static_assert(!RunsFixed<Magnus4, Torqued>, "its rates depend on the state");
static_assert(!RunsFixed<Magnus4, Gyros<double, FlatQuaternion>>, "not a group");

}  // namespace
}  // namespace polhode
