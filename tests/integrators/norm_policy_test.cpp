/// Norm policies beyond projecting: their orders, what they keep and what they cost the method.
#include <gtest/gtest.h>

#include <cmath>

#include "integrators/gauss.hpp"
#include "integrators/gauss_canonical.hpp"
#include "integrators/high_order.hpp"
#include "integrators/ode45.hpp"
#include "integrators/taylor.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

template <Scalar S>
auto slew() {
  return PdSlew(Choice{}).field<S, FlatQuaternion, true>();
}
auto free_body() {
  return FreeBody(Choice{}).field<double, FlatQuaternion, true>();
}
template <class X>
double defect_of(X const& x) {
  return double(FlatQuaternion<std::decay_t<decltype(x.first.w)>>::defect(x.first));
}
constexpr NormPolicy every_policy[] = {
    NormPolicy::none,      NormPolicy::project,   NormPolicy::project_multiplier, NormPolicy::project_symmetric,
    NormPolicy::baumgarte, NormPolicy::relaxation};
std::string_view name_of(NormPolicy policy) {
  for (PolicyName const& entry : policy_names)
    if (entry.policy == policy) return entry.name;
  return "?";
}

// ---- Orders ---------------------------------------------------------------------------------------------------------

constexpr double slew_time = 4;  // [s]

/// A run that lands on `stops` equal intervals, at once or step by step.
template <class Stepper, class X>
Status run(Stepper& stepper, int stops, X& x) {
  Status status = Status::ok;
  for (int k = 0; k < stops && status == Status::ok; ++k)
    status = stepper.advance(x, slew_time * k / stops, slew_time * (k + 1) / stops);
  return status;
}
/// The pairwise order of Method under a policy, in quadruple precision, from the errors in attitude and rate.
template <class Method>
double order_of(NormPolicy policy, int stops) {
  auto problem = slew<Quad>();
  static auto const end = test::by_gauss(problem, 1.0 / 64, slew_time);
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    double const h = std::ldexp(1, -8 - k);
    auto stepper = Method{}.bind(problem, FixedStep{h}, policy);
    auto x = problem.initial();
    int const lands = stops > 0 ? stops : int(slew_time / h);
    EXPECT_EQ(run(stepper, lands, x), Status::ok) << name_of(policy);
    errors[k] = double(angle_between(x.first, end.first)) + double(distance<Quad>(x.second, end.second));
  }
  EXPECT_GT(errors[1], 1e-25);
  return std::log2(errors[0] / errors[1]);
}

TEST(NormPolicies, LeaveTheOrderOfTheMethod) {
  for (NormPolicy const policy : every_policy) {
    EXPECT_NEAR(order_of<Rk4>(policy, 1), 4, 0.1) << name_of(policy);
    EXPECT_NEAR(order_of<Dopri5>(policy, 1), 5, 0.2) << name_of(policy);
  }
}
// Forgetting that a relaxed step ends at gamma h would leave order p with few stops and p - 1 where every step lands.
TEST(Relaxation, KeepsItsOrderHoweverManyStopsThereAre) {
  for (int stops : {7, 64, 0}) {
    EXPECT_NEAR(order_of<Rk4>(NormPolicy::relaxation, stops), 4, 0.1) << stops;
    EXPECT_NEAR(order_of<Dopri5>(NormPolicy::relaxation, stops), 5, 0.2) << stops;
  }
}

// ---- Relaxation -----------------------------------------------------------------------------------------------------

TEST(Relaxation, KeepsTheNormToRoundOffInEqualSteps) {
  auto const problem = free_body();
  auto kept = Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::relaxation);
  auto lost = Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::none);
  auto x = problem.initial(), y = x;
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(kept.advance(x, 10 * i, 10 * i + 10), Status::ok);
    ASSERT_EQ(lost.advance(y, 10 * i, 10 * i + 10), Status::ok);
    worst = std::max(worst, defect_of(x));
  }
  EXPECT_LT(worst, 1e-13) << "10^4 steps";
  EXPECT_GT(defect_of(y), 1e-9);
}
template <class Method>
void expect_norm_kept_by_adaptive(double rtol) {
  auto const problem = slew<double>();
  auto kept = Method{}.bind(problem, Adaptive{rtol, rtol / 100}, NormPolicy::relaxation);
  auto lost = Method{}.bind(problem, Adaptive{rtol, rtol / 100}, NormPolicy::none);
  auto x = problem.initial(), y = x;
  EXPECT_EQ(kept.advance(x, 0, 20), Status::ok);
  EXPECT_EQ(lost.advance(y, 0, 20), Status::ok);
  EXPECT_LT(defect_of(x), 2e-14);
  EXPECT_GT(defect_of(y), 1e-10);
  EXPECT_LT(angle_between(x.first, y.first), 100 * rtol);
  EXPECT_EQ(kept.projections().count, kept.work().steps);
  EXPECT_GT(kept.projections().raw_defect, 1e-10);
}
TEST(Relaxation, KeepsTheNormToRoundOffInStepsOfItsOwn) {
  expect_norm_kept_by_adaptive<Dopri5>(1e-5);
  expect_norm_kept_by_adaptive<Dop853>(1e-4);
}
// What a start that is off the sphere has of the norm is not its business.
TEST(Relaxation, KeepsTheNormThatTheStartHas) {
  auto const problem = free_body();
  auto stepper = Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::relaxation);
  auto x = problem.initial();
  scale(x.first, 1.001);
  double const before = dot(x.first, x.first);
  EXPECT_EQ(stepper.advance(x, 0, 50), Status::ok);
  EXPECT_NEAR(dot(x.first, x.first), before, 1e-13);
}
TEST(Relaxation, LandsOnItsStopsAndTakesTheSameStepsOneByOne) {
  auto const problem = slew<double>();
  auto whole = Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::relaxation);
  auto single = Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::relaxation);
  ASSERT_TRUE(single.moves_time());
  EXPECT_FALSE((Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::project).moves_time()));
  auto x = problem.initial(), y = x;
  EXPECT_EQ(whole.advance(x, 0, 7.25), Status::ok);
  double t = 0;
  int steps = 0;
  bool off_grid = false;
  for (; t < 7.25 && steps < 1000; ++steps) {
    double const before = t;
    ASSERT_EQ(single.relaxed_step(y, t, 7.25), Status::ok);
    off_grid = off_grid || t - before != 0.1;
  }
  EXPECT_EQ(t, 7.25);
  EXPECT_TRUE(off_grid);
  EXPECT_EQ(distance<double>(x, y), 0);
  EXPECT_EQ(whole.work().steps, steps);
  EXPECT_EQ(whole.projections().count, steps);
}
TEST(Relaxation, DoesNothingToABodyAtRest) {
  auto const problem = PdSlew({.words = {}, .set = {{"k_p", {0}}, {"k_d", {0}}, {"omega0", {0, 0, 0}}}})
                           .field<double, FlatQuaternion, true>();
  auto stepper = Rk4{}.bind(problem, FixedStep{0.1}, NormPolicy::relaxation);
  auto x = problem.initial();
  EXPECT_EQ(stepper.advance(x, 0, 5), Status::ok);
  EXPECT_EQ(stepper.work().steps, 50);
  EXPECT_LT(distance<double>(x, problem.initial()), 1e-15);
}
TEST(Relaxation, SaysThatAStepIsTooLong) {
  auto const problem = free_body();
  double const rate = length(problem.initial().second);
  auto fixed = Rk4{}.bind(problem, FixedStep{5 / rate}, NormPolicy::relaxation);
  auto x = problem.initial();
  EXPECT_EQ(fixed.advance(x, 0, 50 / rate), Status::nonlinear_fail);

  auto adaptive = Dopri5{}.bind(problem, Adaptive{1e9, 1e9}, NormPolicy::relaxation);  // any error is allowed
  auto y = problem.initial();
  EXPECT_EQ(adaptive.advance(y, 0, 500 / rate), Status::ok);
  EXPECT_GT(adaptive.work().rejected, 0);
  EXPECT_LT(defect_of(y), 1e-13);
}
TEST(Relaxation, OfGaussChangesNothingButRoundOff) {
  auto const problem = slew<double>();
  for (NormPolicy const policy : {NormPolicy::relaxation, NormPolicy::project_symmetric}) {
    auto plain = Gauss<3>{}.bind(problem, FixedStep{0.125}, NormPolicy::none);
    auto other = Gauss<3>{}.bind(problem, FixedStep{0.125}, policy);
    auto x = problem.initial(), y = x;
    EXPECT_EQ(plain.advance(x, 0, 10), Status::ok);
    EXPECT_EQ(other.advance(y, 0, 10), Status::ok);
    EXPECT_LT(distance<double>(x, y), 1e-13) << name_of(policy);
    EXPECT_EQ(other.work().steps, 80);
    EXPECT_GE(other.work().iterations, plain.work().iterations) << "what was taken again is counted";
  }
  auto plain = GaussCanonical<2>{}.bind(problem, FixedStep{0.125}, NormPolicy::none);
  auto relaxed = GaussCanonical<2>{}.bind(problem, FixedStep{0.125}, NormPolicy::relaxation);
  auto adaptive = Gauss<3>{}.bind(problem, Adaptive{1e-9, 1e-11}, NormPolicy::relaxation);
  auto x = problem.initial(), y = x, z = x;
  EXPECT_EQ(plain.advance(x, 0, 10), Status::ok);
  EXPECT_EQ(relaxed.advance(y, 0, 10), Status::ok);
  EXPECT_EQ(adaptive.advance(z, 0, 10), Status::ok);
  EXPECT_LT(distance<double>(x, y), 1e-12);
  EXPECT_LT(defect_of(z), 1e-14);
}
TEST(Relaxation, AnswersBetweenStepsWithTheNormKept) {
  constexpr double rtol = 1e-8;
  auto const problem = slew<double>();
  auto stepper = Dopri5{}.bind_dense(problem, Adaptive{rtol, rtol}, NormPolicy::relaxation);
  auto exact = Dop853{}.bind(problem, Adaptive{1e-13, 1e-15}, NormPolicy::none);
  auto x = problem.initial(), y = x, at = x;
  double reached = 0;
  for (double t = 0; t < 10;) {
    double const before = t;
    ASSERT_EQ(stepper.step(x, t, 10), Status::ok);
    for (double part : {0.25, 0.75, 1.0}) {
      double const when = before + part * (t - before);
      stepper.interpolate(when, at);
      ASSERT_EQ(exact.advance(y, reached, when), Status::ok);
      reached = when;
      EXPECT_LT(defect_of(at), 1e-14);
      EXPECT_LT(distance<double>(at, y), 100 * rtol);
    }
    EXPECT_LT(distance<double>(at, x), 1e-14) << "it ends where the relaxed step ends";
  }
}

// ---- Baumgarte ------------------------------------------------------------------------------------------------------

/// The defect after t seconds of a method that keeps the norm, from a start whose q is 1 + `off` times too long.
template <class Method, class Control>
double decayed(Control control, double off, double t) {
  auto const problem = slew<double>();
  auto stepper = Method{}.bind(problem, control, NormPolicy::baumgarte);
  auto x = problem.initial();
  scale(x.first, 1 + off);
  EXPECT_EQ(stepper.advance(x, 0, t), Status::ok);
  return std::sqrt(dot(x.first, x.first)) - 1;
}
TEST(Baumgarte, DefectsDecayByItsGainWhateverTheStep) {
  for (double off : {1e-3, -1e-3})
    for (double t : {0.5, 1.0, 2.0}) {
      double const expected = off * std::exp(-2 * feedback_gain * t);
      double const within = 1e-9;  // the field of a q that is not of length 1
      EXPECT_NEAR(decayed<Gauss<3>>(FixedStep{0.125}, off, t), expected, within);
      EXPECT_NEAR(decayed<Gauss<3>>(FixedStep{0.5}, off, t), expected, within);
      EXPECT_NEAR(decayed<Dopri5>(Adaptive{1e-11, 1e-13}, off, t), expected, within);
      EXPECT_NEAR(decayed<Gauss<3>>(Adaptive{1e-11, 1e-13}, off, t), expected, within);
    }
}
TEST(Baumgarte, ActsBetweenPowerSeries) {
  WithSeries const problem(slew<double>(), slew<Jet<double, 20>>());
  auto stepper = Taylor{}.bind(problem, Adaptive{1e-12, 1e-12}, NormPolicy::baumgarte);
  auto x = problem.initial();
  scale(x.first, 1.001);
  double t = 0;
  EXPECT_EQ(stepper.step(x, t, 100), Status::ok);
  EXPECT_NEAR(std::sqrt(dot(x.first, x.first)) - 1, 1e-3 * std::exp(-2 * feedback_gain * t), 1e-9);
}
TEST(Baumgarte, BoundsTheDriftThatOtherwiseGrows) {
  auto const problem = free_body();
  auto fed = Rk4{}.bind(problem, FixedStep{0.25}, NormPolicy::baumgarte);
  auto undisturbed = Rk4{}.bind(problem, FixedStep{0.25}, NormPolicy::none);
  auto x = problem.initial(), y = x;
  std::vector<double> drift, lost;
  for (int i = 0; i < 8; ++i) {
    double worst = 0;
    for (int k = 0; k < 100; ++k) {
      double const t = 100 * i + k;
      ASSERT_EQ(fed.advance(x, t, t + 1), Status::ok);
      ASSERT_EQ(undisturbed.advance(y, t, t + 1), Status::ok);
      worst = std::max(worst, defect_of(x));
    }
    drift.push_back(worst);
    lost.push_back(defect_of(y));
  }
  EXPECT_LT(drift.back(), 1.1 * drift.front());
  EXPECT_GT(lost.back(), 5 * lost.front());
  EXPECT_GT(lost.back(), 100 * drift.back());
  EXPECT_GT(drift.back(), 1e-12) << "it damps, it does not project";
  EXPECT_EQ(fed.projections().count, fed.work().steps);
  EXPECT_GT(fed.projections().work, 0);
  EXPECT_GE(fed.projections().raw_defect, drift.back());
}
TEST(Baumgarte, ActsOnMatricesAndOnManyBodies) {
  auto const matrices = PdSlew(Choice{}).field<double, FlatRotation, true>();
  auto stepper = Rk4{}.bind(matrices, FixedStep{0.125}, NormPolicy::baumgarte);
  auto x = matrices.initial();
  scale(x.first, 1.001);
  double const before = FlatRotation<double>::defect(x.first);
  EXPECT_EQ(stepper.advance(x, 0, 2), Status::ok);
  EXPECT_NEAR(FlatRotation<double>::defect(x.first) / before, std::exp(-4), 2e-3);

  auto const swarm = QuaternionSync(Choice{}).field<double, FlatQuaternion, true>();
  using M = typename std::decay_t<decltype(swarm)>::Space;
  auto fed = Dopri5{}.bind(swarm, Adaptive{1e-9, 1e-11}, NormPolicy::baumgarte);
  auto many = swarm.initial();
  for (int i = 0; i < many.count(); ++i) scale(many[i], 1.001);
  double const start = double(M::defect(many));
  EXPECT_EQ(fed.advance(many, 0, 1), Status::ok);
  EXPECT_LT(double(M::defect(many)), 0.2 * start);
  EXPECT_EQ(fed.projections().count, fed.work().steps);
}
TEST(Baumgarte, ActsUnderTheCustomaryStepControl) {
  auto const problem = free_body();
  auto fed = Dopri5Ode45{}.bind(problem, Adaptive{1e-4, 1e-6}, NormPolicy::baumgarte);
  auto undisturbed = Dopri5Ode45{}.bind(problem, Adaptive{1e-4, 1e-6}, NormPolicy::none);
  auto x = problem.initial(), y = x;
  EXPECT_EQ(fed.advance(x, 0, 100), Status::ok);
  EXPECT_EQ(undisturbed.advance(y, 0, 100), Status::ok);
  EXPECT_LT(defect_of(x), 0.1 * defect_of(y));
  EXPECT_GT(defect_of(x), 0);
}

// ---- Symmetric projection -------------------------------------------------------------------------------------------

/// The implicit trapezoidal rule, by fixed point to round-off: symmetric, but it does not keep the norm.
struct Trapezoidal {
  template <Space M>
  struct Frame {};
  template <Space M>
  using Memory = NoMemory;
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<Trapezoidal, P>(*this, p, control, policy);
  }
  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>&, NoMemory&) const {
    Point<M> const start = x;
    Chart<M> const here = M::rate(start, p(t, start));
    for (int sweep = 0; sweep < 60; ++sweep) {
      Chart<M> const there = M::rate(x, p(S(t + h), x));
      x = start;
      add(x, R(0.5) * h, here);
      add(x, R(0.5) * h, there);
    }
  }
};
/// How far from its start a run of 32 steps forward and 32 back ends.
double after_return(NormPolicy policy) {
  auto const problem = slew<double>();  // whose torque feels the norm; a free body's does not
  auto forth = Trapezoidal{}.bind(problem, FixedStep{0.125}, policy);
  auto back = Trapezoidal{}.bind(problem, FixedStep{-0.125}, policy);
  auto x = problem.initial();
  EXPECT_EQ(forth.advance(x, 0, 4), Status::ok);
  EXPECT_EQ(back.advance(x, 4, 0), Status::ok);
  return distance<double>(x, problem.initial());
}
TEST(SymmetricProjection, LeavesASymmetricMethodSymmetric) {
  EXPECT_LT(after_return(NormPolicy::none), 1e-13);
  EXPECT_GT(after_return(NormPolicy::project), 1e-8);
  EXPECT_LT(after_return(NormPolicy::project_symmetric), 1e-13);
}
TEST(SymmetricProjection, DeliversUnitQuaternionsAndTellsTheDriftBefore) {
  auto const problem = free_body();
  auto plain = Trapezoidal{}.bind(problem, FixedStep{0.25}, NormPolicy::none);
  auto projected = Trapezoidal{}.bind(problem, FixedStep{0.25}, NormPolicy::project_symmetric);
  auto x = problem.initial(), y = x;
  double raw = 0;
  for (int i = 0; i < 100; ++i) {
    double const t = 0.25 * i;
    y = x;
    ASSERT_EQ(projected.advance(x, t, t + 0.25), Status::ok);
    ASSERT_EQ(plain.advance(y, t, t + 0.25), Status::ok);
    raw = std::max(raw, defect_of(y));
    EXPECT_LT(defect_of(x), 3e-16);
  }
  EXPECT_NEAR(projected.projections().raw_defect, raw, 1e-15);
  EXPECT_GT(raw, 1e-8);
  EXPECT_EQ(projected.projections().count, 100);
  EXPECT_EQ(projected.work().steps, 100);
}
TEST(SymmetricProjection, TakesEachStepTwoToFiveTimes) {
  auto const counted = erase<double, FlatQuaternion>(FreeBody(Choice{}));
  auto stepper = Rk4{}.bind(*counted, FixedStep{0.5}, NormPolicy::project_symmetric);
  auto x = counted->initial();
  EXPECT_EQ(stepper.advance(x, 0, 50), Status::ok);
  EXPECT_EQ(stepper.work().steps, 100);
  EXPECT_GE(counted->evaluations(), 2 * 4 * 100);
  EXPECT_LE(counted->evaluations(), 5 * 4 * 100);
}
TEST(SymmetricProjection, SaysThatThereIsNoSuchStep) {
  auto const problem = free_body();
  double const rate = length(problem.initial().second);
  auto stepper = Rk4{}.bind(problem, FixedStep{20 / rate}, NormPolicy::project_symmetric);
  auto x = problem.initial();
  EXPECT_NE(stepper.advance(x, 0, 20 / rate), Status::ok);
}

// ---- Counts ---------------------------------------------------------------------------------------------------------

TEST(FixedWork, TellsTheJacobiansOfGaussByNewton) {
  auto const field = PdSlew({.words = {}, .set = {{"inertia", {0.5, 0.85, 1}}}}).field<double, FlatQuaternion, true>();
  auto newton = Gauss<3>{}.bind(field, FixedStep{0.125}, NormPolicy::none);
  auto calm = Gauss<3>{}.bind(free_body(), FixedStep{0.125}, NormPolicy::none);
  auto x = field.initial();
  EXPECT_EQ(newton.advance(x, 0, 2), Status::ok);
  EXPECT_GT(newton.work().jacobians.value_or(0), 0);
  EXPECT_EQ(calm.work().jacobians, 0);
  EXPECT_FALSE((Rk4{}.bind(field, FixedStep{0.125}, NormPolicy::none).work().jacobians));
}

}  // namespace
}  // namespace polhode
