/// Continuous extensions: their order, their ends, what they cost, what projection makes of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "integrators/high_order.hpp"
#include "integrators/ode45.hpp"
#include "integrators/taylor.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "tests/integrators/rooted_trees.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

template <class M, class T>
struct Extended {
  using Method = M;
  using Tableau = T;
};
template <class E>
class DenseOutput : public testing::Test {};
using Methods = testing::Types<Extended<Dopri5, DormandPrince5>, Extended<Dop853, DormandPrince853>,
                               Extended<Verner65, Verner6>, Extended<Verner76, Verner7>, Extended<Verner98, Verner9>>;
TYPED_TEST_SUITE(DenseOutput, Methods);

template <Scalar S>
auto slew() {
  return PdSlew(Choice{}).field<S, FlatQuaternion, true>();
}
auto counted_slew() {
  return erase<double, FlatQuaternion>(PdSlew(Choice{}));
}
/// The method's stepper with interpolate().
template <class Method, class P>
auto dense(P const& problem, double rtol, NormPolicy policy = NormPolicy::none) {
  return Method{}.bind_dense(problem, Adaptive{rtol, rtol / 100}, policy);
}

// ---- Order ----------------------------------------------------------------------------------------------------------

/// The weights of the slopes at the part s of a step.
template <class T>
test::Row weights_at(Quad s) {
  Quad const rest = 1 - s;
  test::Row weights;
  for (test::Row d : test::in_quad(T::dense)) {
    d.resize(5);
    weights.push_back(s * s * rest * rest * (d[0] + s * (d[1] + rest * (d[2] + s * (d[3] + rest * d[4])))));
  }
  test::Row const b = test::in_quad(T::b);
  for (std::size_t i = 0; i < b.size(); ++i) weights[i] += s * s * (3 - 2 * s) * b[i];
  weights[0] += s * rest * rest;
  weights[T::pair_stages] -= s * s * rest;
  return weights;
}

TYPED_TEST(DenseOutput, MeetsEveryConditionOfItsOrderAllAlongTheStep) {
  using T = typename TypeParam::Tableau;
  test::OrderConditions const conditions(test::all_stages<T>(), T::dense_order + 1);
  for (double part : {0.0, 0.1, 0.37, 0.5, 0.75, 1.0}) {
    test::Row const weights = weights_at<T>(part);
    EXPECT_LT(conditions.defect_up_to(weights, T::dense_order, part), 5e-29) << part;
    if (part == 0.5) {
      EXPECT_GT(conditions.defect(weights, T::dense_order + 1, part), 1e-6) << "the order is higher than stated";
    }
  }
}

TYPED_TEST(DenseOutput, ItsErrorWithinOneStepFallsByOneOrderMore) {
  using T = typename TypeParam::Tableau;
  using Pair = EmbeddedPair<T>;
  auto const field = slew<Quad>();
  using M = typename decltype(field)::Space;
  std::vector<double> errors;
  for (double h : {0.25, 0.125, 0.0625}) {
    typename Pair::template Frame<M> frame;
    typename Pair::template Inside<M> inside;
    Chart<M> last, error;
    inside.x = field.initial();
    slope(field, Quad(0), inside.x, frame.v, frame.k[0]);
    Pair{}.attempt(field, Quad(0), Quad(h), inside.x, frame, inside.y, last, error);
    std::copy(frame.k.begin(), frame.k.end(), inside.made.k.begin());
    inside.made.k[T::pair_stages] = last;
    Pair{}.complete(field, Quad(0), Quad(h), inside);
    double worst = 0;
    for (double part : {0.25, 0.5, 0.75}) {
      Point<M> got;
      Pair{}.template interpolate<M>(Quad(part), Quad(h), inside, got);
      worst = std::max(worst, double(distance<Quad>(got, test::by_gauss(field, h / 16, part * h))));
    }
    errors.push_back(worst);
  }
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), T::dense_order + 1, 0.15);
}

// ---- The stepper ----------------------------------------------------------------------------------------------------

TYPED_TEST(DenseOutput, IsAsAccurateAsTheStepsItIsMadeOf) {
  auto const field = slew<double>();
  double const rtol = 1e-8;
  auto stepper = dense<typename TypeParam::Method>(field, rtol);
  auto x = field.initial();
  double worst = 0;
  for (double t = 0, from = 0; t < 20; from = t) {
    ASSERT_EQ(stepper.step(x, t, 20.), Status::ok);
    auto inside = x;
    double const at = from + 0.6 * (t - from);
    stepper.interpolate(at, inside);
    auto exact = field.initial();
    Dop853{}.bind(field, Adaptive{1e-13, 1e-15}, NormPolicy::none).advance(exact, 0, at);
    worst = std::max(worst, distance<double>(inside, exact));
  }
  EXPECT_LT(worst, 10 * rtol);
  EXPECT_GT(worst, 1e-13) << "errors to be seen";
}

TYPED_TEST(DenseOutput, BeginsAndEndsWhereTheStepDoes) {
  auto const field = slew<double>();
  auto stepper = dense<typename TypeParam::Method>(field, 1e-9);
  auto x = field.initial(), before = x, inside = x;
  for (double t = 0, from = 0; t < 20; from = t, before = x) {
    ASSERT_EQ(stepper.step(x, t, 20.), Status::ok);
    stepper.interpolate(from, inside);
    EXPECT_EQ(distance<double>(inside, before), 0);
    stepper.interpolate(t, inside);
    EXPECT_EQ(distance<double>(inside, x), 0);
  }
}

TYPED_TEST(DenseOutput, IsProjectedWithTheSteps) {
  auto const field = slew<double>();
  auto stepper = dense<typename TypeParam::Method>(field, 1e-6, NormPolicy::project);
  auto x = field.initial(), before = x, inside = x;
  for (double t = 0, from = 0; t < 20; from = t, before = x) {
    ASSERT_EQ(stepper.step(x, t, 20.), Status::ok);
    std::int64_t const projections = stepper.projections().count;
    for (double part : {0.1, 0.5, 0.8}) {
      stepper.interpolate(from + part * (t - from), inside);
      EXPECT_LE(FlatQuaternion<double>::defect(inside.first), 4.4e-16);
    }
    stepper.interpolate(from, inside);
    EXPECT_LT(distance<double>(inside, before), 3e-16);
    stepper.interpolate(t, inside);
    EXPECT_LT(distance<double>(inside, x), 3e-16);
    EXPECT_EQ(stepper.projections().count, projections) << "looking is no projection of the run";
  }
}

/// Evaluations of one run to 20 s, looked into `looks` times a step.
template <class Method>
std::array<std::int64_t, 2> cost(int looks, NormPolicy policy) {
  auto const problem = counted_slew();
  auto stepper = dense<Method>(*problem, 1e-8, policy);
  auto x = problem->initial(), inside = x;
  for (double t = 0, from = 0; t < 20; from = t) {
    EXPECT_EQ(stepper.step(x, t, 20.), Status::ok);
    for (int k = 0; k < looks; ++k) stepper.interpolate(from + (t - from) * (k + 1) / (looks + 1), inside);
  }
  return {problem->evaluations(), stepper.work().steps};
}

TYPED_TEST(DenseOutput, CostsNothingUntilAskedAndThenOnce) {
  using Method = typename TypeParam::Method;
  using T = typename TypeParam::Tableau;
  std::int64_t own = 0;
  if constexpr (requires { T::dense_a; }) own = std::int64_t(std::size(T::dense_a));
  for (NormPolicy policy : {NormPolicy::none, NormPolicy::project}) {
    auto const problem = counted_slew();
    auto stepper = Method{}.bind(*problem, Adaptive{1e-8, 1e-8 / 100}, policy);
    auto x = problem->initial();
    for (double t = 0; t < 20;) ASSERT_EQ(stepper.step(x, t, 20.), Status::ok);
    auto const [unasked, steps] = cost<Method>(0, policy);
    EXPECT_EQ(unasked, problem->evaluations());
    auto const [once, same_steps] = cost<Method>(1, policy);
    EXPECT_EQ(steps, same_steps);
    // The slope at the step's end, if the step does not leave it: the next step's first, but for the last, whose end
    // is not gone on from. Projected, the next step begins elsewhere.
    std::int64_t const ends = T::first_same_as_last ? 0 : policy == NormPolicy::none ? 1 : steps;
    EXPECT_EQ(once - unasked, own * steps + ends);
    EXPECT_EQ((cost<Method>(5, policy)[0]), once);
  }
}

TYPED_TEST(DenseOutput, DoesNotChangeTheRun) {
  using Method = typename TypeParam::Method;
  auto const field = slew<double>();
  auto x = field.initial(), y = x, inside = x;
  auto plain = Method{}.bind(field, Adaptive{1e-7, 1e-7 / 100}, NormPolicy::none);
  auto looked_into = dense<Method>(field, 1e-7);
  for (double t = 0, u = 0; t < 20;) {
    ASSERT_EQ(plain.step(x, t, 20.), Status::ok);
    ASSERT_EQ(looked_into.step(y, u, 20.), Status::ok);
    EXPECT_EQ(t, u);
    EXPECT_EQ(distance<double>(x, y), 0);
    looked_into.interpolate(t, inside);
  }
}

TEST(DenseOutputOfManyBodies, IsAsAccurateAsTheSteps) {
  auto const swarm = QuaternionSync(Choice{}).field<double, FlatQuaternion, true>();
  auto stepper = dense<Dop853>(swarm, 1e-9);
  auto x = swarm.initial(), inside = x, exact = x;
  double t = 0, from = 0;
  while (t < 1) {
    from = t;
    ASSERT_EQ(stepper.step(x, t, 1.), Status::ok);
  }
  stepper.interpolate((from + t) / 2, inside);
  Dop853{}.bind(swarm, Adaptive{1e-13, 1e-15}, NormPolicy::none).advance(exact, 0, (from + t) / 2);
  EXPECT_LT(distance<double>(inside, exact), 1e-8);
}

// ---- Methods with steps that outputs do not shorten -----------------------------------------------------------------

/// The greatest defect at outputs every 0.05 s of methods whose steps they do not shorten.
template <class Method, class P>
double defect_at_outputs(P const& problem, NormPolicy policy) {
  auto stepper = Method{}.bind(problem, Adaptive{1e-4, 1e-6}, policy);
  if constexpr (requires { stepper.set_horizon(0, 5); }) stepper.set_horizon(0, 5);
  auto x = problem.initial();
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(stepper.advance(x, 0.05 * i, 0.05 * (i + 1)), Status::ok);
    worst = std::max(worst, FlatQuaternion<double>::defect(x.first));
  }
  EXPECT_LT(stepper.work().steps, 50);
  if (policy == NormPolicy::project) {
    EXPECT_EQ(stepper.projections().count, stepper.work().steps) << "outputs are no steps";
  }
  return worst;
}
TEST(OutputsWithinSteps, AreProjectedAsTheirEndsAre) {
  WithSeries const problem(slew<double>(), slew<Jet<double, 20>>());
  EXPECT_GT(defect_at_outputs<Dopri5Ode45>(problem, NormPolicy::none), 1e-10) << "the test can tell";
  EXPECT_LT(defect_at_outputs<Dopri5Ode45>(problem, NormPolicy::project), 1e-15);
  EXPECT_GT(defect_at_outputs<Taylor>(problem, NormPolicy::none), 1e-10);
  EXPECT_LT(defect_at_outputs<Taylor>(problem, NormPolicy::project), 1e-15);
}
TEST(OutputsWithinSteps, OfTheCustomaryStepControlGoOnBehindItsHorizon) {
  auto const problem = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto stepper = Dopri5Ode45{}.bind(problem, Adaptive{1e-4, 1e-6}, NormPolicy::none);
  auto x = problem.initial();
  EXPECT_EQ(stepper.advance(x, 0, 1), Status::ok);
  EXPECT_EQ(stepper.advance(x, 1, 2), Status::ok) << "nobody said that the first second was not all";
}

}  // namespace
}  // namespace polhode
