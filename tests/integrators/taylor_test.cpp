/// Taylor's method: order in equal steps, tolerances in its own, agreement with everything else, held torques,
/// restarts.
#include "integrators/taylor.hpp"

#include <gtest/gtest.h>

#include "integrators/gauss.hpp"
#include "problems/krogh_b5.hpp"
#include "tests/integrators/free_body_runs.hpp"
#include "tests/support/lie_group_runs.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using test::FreeCase;

constexpr double eps = 0x1p-52;

template <int degree>
using DoubleSeries = Jet<double, degree>;

/// A free body in double that knows its series.
template <template <class> class A>
auto free_body() {
  return WithSeries(FreeCase{}.field<double, A>(), FreeCase{}.field<DoubleSeries<20>, A>());
}
/// A shaken body in quadruple precision that does.
template <int degree>
auto shaken() {
  return WithSeries(test::shaken_body<Quad, FlatQuaternion>(), test::shaken_body<Jet<Quad, degree>, FlatQuaternion>());
}

// ---- Equal steps ----------------------------------------------------------------------------------------------------

template <int degree>
void expect_order(double h, double within) {
  auto const problem = shaken<degree>();
  auto const exact = test::by_gauss(problem, 0.0625, 2);
  auto const error = [&](double step) {
    return test::angle_apart<FlatQuaternion<Quad>>(test::state_at(TaylorOfDegree<degree>{}, problem, step, 2), exact);
  };
  double const coarse = error(h), fine = error(h / 2);
  EXPECT_GT(fine, 1e-30) << "round-off: no order to see";
  EXPECT_NEAR(test::order_of(coarse, fine), degree, within) << "h = " << h;
}
// From degree 16 on quadruple precision ends before the next term is out of sight.
TEST(Taylor, HasTheOrderOfItsDegree) {
  expect_order<4>(1. / 256, 0.1);
  expect_order<8>(1. / 64, 0.1);
  expect_order<12>(1. / 16, 0.1);
  expect_order<16>(1. / 8, 0.25);
  expect_order<20>(1. / 4, 0.5);
}
TEST(Taylor, IsExactToRoundOffInEqualSteps) {
  auto const expected = FreeCase{}.exact<double>().at(50);
  auto const quaternion = test::state_at(Taylor{}, free_body<FlatQuaternion>(), 0.5, 50);
  EXPECT_LT(distance<double>(quaternion.first, expected.first), 5e-15);
  EXPECT_LT(distance<double>(quaternion.second, expected.second), 1e-15);
  auto const matrix = test::state_at(Taylor{}, free_body<FlatRotation>(), 0.5, 50);
  EXPECT_LT(angle_between(FlatRotation<double>::attitude(matrix.first), expected.first), 1e-14);
}
TEST(Taylor, HardlyDriftsForTenThousandSteps) {
  auto const problem = free_body<FlatQuaternion>();
  auto stepper = Taylor{}.bind(problem, FixedStep{0.5}, NormPolicy::none);
  auto x = problem.initial();
  EXPECT_EQ(stepper.advance(x, 0, 5000), Status::ok);
  EXPECT_EQ(stepper.work().steps, 10000);
  EXPECT_LT(test::drift_of(FreeCase{}.field<double, FlatQuaternion>(), x).worst(), 64 * eps);
}
TEST(Taylor, ReturnsToTheStart) {
  EXPECT_LT(test::forth_and_back(Taylor{}, free_body<FlatQuaternion>(), 0.5, 100), 1e-13);
}
// Krogh's problem, B5 of the test set DETEST.
TEST(Taylor, MeetsKroghsNumbers) {
  WithSeries const problem(KroghField<double>{0.51, {0.0, 1.0, 1.0}},
                           KroghField<DoubleSeries<20>>{0.51, {0.0, 1.0, 1.0}});
  Vec3<double> const y = test::state_at(Taylor{}, problem, 0.25, 20);
  EXPECT_NEAR(y.x, -0.93965707987292035, 4e-15);
  EXPECT_NEAR(y.y, -0.34211777540007493, 4e-15);
  EXPECT_NEAR(y.z, 0.74141265961999525, 4e-15);
}

// ---- Steps of its own -----------------------------------------------------------------------------------------------

/// Where steps of the method's own lead, with outputs `every` seconds.
template <class P>
auto adaptively(P const& problem, double tolerance, double t_end, double every, std::int64_t& steps) {
  auto stepper = Taylor{}.bind(problem, Adaptive{tolerance, tolerance}, NormPolicy::none);
  auto x = problem.initial();
  for (int i = 0; i < std::lround(t_end / every); ++i)
    EXPECT_EQ(stepper.advance(x, i * every, (i + 1) * every), Status::ok);
  steps = stepper.work().steps;
  EXPECT_EQ(stepper.work().rejected, 0);
  return x;
}
TEST(Taylor, MeetsTolerances) {
  auto const expected = FreeCase{}.exact<double>().at(50);
  std::int64_t last = 0;
  for (double tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
    std::int64_t steps = 0;
    auto const x = adaptively(free_body<FlatQuaternion>(), tolerance, 50, 50, steps);
    EXPECT_LT(distance<double>(x.first, expected.first), 10 * tolerance + 5e-15) << tolerance;
    EXPECT_LT(distance<double>(x.second, expected.second), 10 * tolerance + 5e-15) << tolerance;
    EXPECT_LT(steps, 80) << "the order grows with the tolerance, not the number of steps";
    last = std::max(last, steps);
  }
  EXPECT_GT(last, 5);
}
TEST(Taylor, IsNotSlowedByOutputs) {
  auto const problem = free_body<FlatQuaternion>();
  std::int64_t at_once = 0, often = 0;
  auto const x = adaptively(problem, 1e-12, 50, 50, at_once), y = adaptively(problem, 1e-12, 50, 0.03125, often);
  EXPECT_EQ(at_once, often);
  EXPECT_EQ(distance<double>(x, y), 0);
  std::int64_t steps = 0;
  auto const between = adaptively(problem, 1e-12, 20.34375, 0.03125, steps);
  EXPECT_LT(distance<double>(between.first, FreeCase{}.exact<double>().at(20.34375).first), 1e-11);
}
TEST(Taylor, ProjectsAtTheEndsOfItsSteps) {
  auto const problem = free_body<FlatQuaternion>();
  auto stepper = Taylor{}.bind(problem, Adaptive{1e-4, 1e-4}, NormPolicy::project);
  auto x = problem.initial();
  double t = 0;
  while (t < 50) {
    EXPECT_EQ(stepper.step(x, t, 1e3), Status::ok);
    EXPECT_LT(std::fabs(dot(x.first, x.first) - 1), 2 * eps);
  }
  EXPECT_EQ(stepper.projections().count, stepper.work().steps);
  EXPECT_GT(stepper.projections().raw_defect, 1e-10);
}

// ---- Control by a computer, restarts, ends --------------------------------------------------------------------------

TEST(Taylor, SeesTheTorqueThatIsHeld) {
  auto const make = []<class S>(S) {
    return controlled_body<S, FlatQuaternion, true>(
        BodyParameters{}, SampledPd<S>(PdController<S>{Real<S>(4), Real<S>(20)}, 0, Real<S>(0)));
  };
  WithSeries problem(make(0.0), make(DoubleSeries<20>{}));
  auto plain = make(0.0);
  auto own = Taylor{}.bind(problem, Adaptive{1e-13, 1e-13}, NormPolicy::none);
  auto equal = Taylor{}.bind(problem, FixedStep{0.5}, NormPolicy::none);
  auto gauss = Gauss<4>{}.bind(plain, FixedStep{0.125}, NormPolicy::none);
  auto x = problem.initial(), y = x, z = x;
  for (int i = 0; i < 20; ++i) {
    problem.sample(i, x);
    plain.sample(i, z);
    own.restart();
    equal.restart();
    gauss.restart();
    EXPECT_EQ(own.advance(x, i, i + 1), Status::ok);
    EXPECT_EQ(equal.advance(y, i, i + 1), Status::ok);
    EXPECT_EQ(gauss.advance(z, i, i + 1), Status::ok);
  }
  EXPECT_GT(distance<double>(z, problem.initial()), 0.1);
  EXPECT_LT(distance<double>(x, z), 1e-12);
  EXPECT_LT(distance<double>(y, z), 1e-12);
}
TEST(Taylor, RestartsFromAStateThatWasChanged) {
  auto const problem = free_body<FlatQuaternion>();
  auto stepper = Taylor{}.bind(problem, Adaptive{1e-13, 1e-13}, NormPolicy::none);
  auto x = problem.initial();
  stepper.advance(x, 0, 7);
  x = problem.initial();
  stepper.restart();
  stepper.advance(x, 7, 9);
  EXPECT_LT(distance<double>(x.first, FreeCase{}.exact<double>().at(2).first), 1e-13);
}
TEST(Taylor, LeavesRestAtRestInOneStep) {
  FreeCase still;
  still.omega0 = {0, 0, 0};
  WithSeries const problem(still.field<double, FlatQuaternion>(), still.field<DoubleSeries<20>, FlatQuaternion>());
  std::int64_t steps = 0;
  auto const x = adaptively(problem, 1e-10, 1e5, 1e5, steps);
  EXPECT_EQ(distance<double>(x, problem.initial()), 0);
  EXPECT_EQ(steps, 1);
}
TEST(Taylor, SaysWhenThereIsNoSeries) {
  auto const problem = free_body<FlatQuaternion>();
  auto x = problem.initial();
  x.second.x = std::nan("");
  EXPECT_EQ(Taylor{}.bind(problem, Adaptive{1e-10, 1e-10}, NormPolicy::none).advance(x, 0, 1), Status::diverged);
  EXPECT_EQ(Taylor{}.bind(problem, FixedStep{0.5}, NormPolicy::none).advance(x, 0, 1), Status::diverged);
}
TEST(Taylor, WantsAProblemThatKnowsItsSeries) {
  using Known = decltype(free_body<FlatQuaternion>());
  using Unknown = decltype(FreeCase{}.field<double, FlatQuaternion>());
  EXPECT_TRUE((RunsFixed<Taylor, Known>));
  EXPECT_TRUE((RunsAdaptive<Taylor, Known>));
  EXPECT_FALSE((IntegratorFor<Taylor, Unknown>));
}

}  // namespace
}  // namespace polhode
