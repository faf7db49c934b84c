/// Explicit pairs of high order: step control, what they evaluate, other scalars, many bodies.
#include <gtest/gtest.h>

#include "problems/dual.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "tests/integrators/high_order_pairs.hpp"

namespace polhode {
namespace {

template <class E>
class HighOrderPair : public testing::Test {};
TYPED_TEST_SUITE(HighOrderPair, test::HighOrderPairs);

template <Scalar S>
auto slew() {
  return PdSlew(Choice{}).field<S, FlatQuaternion, true>();
}
auto counted_slew() {
  return erase<double, FlatQuaternion>(PdSlew(Choice{}));
}

// ---- Step control ---------------------------------------------------------------------------------------------------

/// x' = 1: every method is exact.
struct Straight {
  using Space = Euclidean3<double>;
  Vec3<double> operator()(double, Vec3<double> const&) const { return {1, 1, 1}; }
  Vec3<double> initial() const { return {1, 1, 1}; }
};

TYPED_TEST(HighOrderPair, ExactStepsGrowByTheLimitOfItsRule) {
  Straight const problem;
  auto stepper = typename TypeParam::Method{}.bind(problem, Adaptive{1e-2, 1e-4}, NormPolicy::none);
  auto x = problem.initial();
  double t = 0, before = 0, last = 0;
  for (int i = 0; i < 4; ++i) {
    before = last;
    double const from = t;
    ASSERT_EQ(stepper.step(x, t, 1e6), Status::ok);
    last = t - from;
  }
  EXPECT_NEAR(last / before, (std::same_as<typename TypeParam::Method, Dop853>) ? 6 : 10, 1e-6);
}

TEST(Dop853, ItsEstimateIsThatOfOrderFiveDampedByThatOfOrderThree) {
  using T = DormandPrince853;
  auto const field = slew<double>();
  using M = decltype(field)::Space;
  EmbeddedPair<T> const pair;
  EmbeddedPair<T>::Frame<M> frame;
  auto const x = field.initial();
  auto y = x;
  Chart<M> last, fifth, third;
  slope(field, 0., x, frame.v, frame.k[0]);
  double const h = 0.4;
  pair.attempt(field, 0., h, x, frame, y, last, fifth);
  pair.estimate_third<M>(h, frame, third);
  // Both by the sum over the stages, in another order.
  auto const sum = [&](auto const& row) {
    Chart<M> total = zero<Chart<M>>();
    for (std::size_t i = 12; i-- > 0;) add(total, h * row[i].template as<double>(), frame.k[i]);
    return total;
  };
  EXPECT_LT(distance<double>(fifth, sum(T::e)), 1e-16);
  EXPECT_LT(distance<double>(third, sum(T::third)), 1e-16);
  EXPECT_GT(largest<double>(third), 10 * largest<double>(fifth));
}

// ---- Evaluations ----------------------------------------------------------------------------------------------------

TYPED_TEST(HighOrderPair, EvaluatesItsStagesInEqualSteps) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  ASSERT_EQ((typename TypeParam::Method{}.bind(*problem, FixedStep{0.1}, NormPolicy::none).advance(x, 0, 10)),
            Status::ok);
  EXPECT_EQ(problem->evaluations(), 100 * TypeParam::Tableau::stages);
}

TYPED_TEST(HighOrderPair, KeepsTheFirstSlopeOfAStepThatIsRejected) {
  using T = typename TypeParam::Tableau;
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = typename TypeParam::Method{}.bind(*problem, Adaptive{1e-9, 1e-11}, NormPolicy::none);
  ASSERT_EQ(stepper.advance(x, 0, 60), Status::ok);
  Work const work = stepper.work();
  EXPECT_GT(work.steps, 10);
  // One to choose the first step; then the first slope, and the other stages of every trial.
  std::int64_t const firsts = T::first_same_as_last ? 1 : work.steps, others = T::pair_stages - !T::first_same_as_last;
  EXPECT_EQ(problem->evaluations(), 1 + firsts + others * (work.steps + work.rejected));
}

TYPED_TEST(HighOrderPair, HoldsTheNormByProjection) {
  auto const problem = counted_slew();
  auto x = problem->initial();
  auto stepper = typename TypeParam::Method{}.bind(*problem, Adaptive{1e-6, 1e-8}, NormPolicy::project);
  ASSERT_EQ(stepper.advance(x, 0, 60), Status::ok);
  EXPECT_EQ(stepper.projections().count, stepper.work().steps);
  EXPECT_LE(FlatQuaternion<double>::defect(x.first), 4.4e-16);
}

// ---- Other scalars and many bodies ----------------------------------------------------------------------------------

TYPED_TEST(HighOrderPair, CarriesDerivatives) {
  using D = Dual<1>;
  using Method = typename TypeParam::Method;
  auto const end_of = []<class P>(P const& field, Point<typename P::Space> x) {
    using S = typename P::Space::Scalar;
    typename Explicit<typename TypeParam::Tableau>::template Frame<typename P::Space> frame;
    NoMemory memory;
    for (int i = 0; i < 4; ++i) Method{}.step(field, S(i * 0.25), 0.25, x, frame, memory);
    return x;
  };
  auto const field = slew<double>();
  auto const field_of_duals = slew<D>();
  auto seeded = field_of_duals.initial();
  seeded.second.x.slope[0] = 1;
  auto const got = end_of(field_of_duals, seeded);
  auto up = field.initial(), down = up;
  double const step = 1e-5;
  up.second.x += step;
  down.second.x -= step;
  EXPECT_NEAR(got.first.y.slope[0], (end_of(field, up).first.y - end_of(field, down).first.y) / (2 * step), 1e-9);
}

TYPED_TEST(HighOrderPair, RunsOnManyBodies) {
  using Method = typename TypeParam::Method;
  auto const swarm = QuaternionSync(Choice{}).field<double, FlatQuaternion, true>();
  auto x = swarm.initial(), y = x;
  ASSERT_EQ(Method{}.bind(swarm, FixedStep{0.02}, NormPolicy::none).advance(x, 0, 1), Status::ok);
  ASSERT_EQ(Method{}.bind(swarm, Adaptive{1e-11, 1e-13}, NormPolicy::none).advance(y, 0, 1), Status::ok);
  EXPECT_LT(distance<double>(x, y), 1e-9);
}

}  // namespace
}  // namespace polhode
