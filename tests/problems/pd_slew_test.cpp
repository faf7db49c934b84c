/// The slew's variants by hand and by their invariants: gyrostat, delay, quantisation, samples; the choices that cannot
/// be.
#include "problems/pd_slew.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/dual.hpp"
#include "problems/formulations.hpp"
#include "tests/problems/swarm_runs.hpp"
#include "tests/support/quad_runs.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

using test::in;
using test::Random;
using Real3 = Vec3<double>;
using Words = std::set<std::string>;
using Numbers = std::map<std::string, std::vector<double>>;
using Series = test::Series;

static_assert(Definition<PdSlew>);
static_assert(Controller<GyrostatPd<double>> && Controller<SampledPd<Quad>> && Controller<SampledPd<Series>>);

PdSlew chosen(Words const& words, Numbers const& set = {}) {
  return PdSlew(Choice{.words = words, .set = set});
}
std::string complaint(Words const& words, Numbers const& set) {
  return test::complaint<PdSlew>(Choice{.words = words, .set = set});
}

/// The fields of the variants that can be spelt out.
template <class S, template <class> class A = FlatQuaternion>
using Gyrostat = ControlledBody<S, A, PrincipalInertia<Real<S>>, GyrostatPd<S>>;
template <class S, template <class> class A = FlatQuaternion>
using Sampled = ControlledBody<S, A, PrincipalInertia<Real<S>>, SampledPd<S>>;
static_assert(std::is_trivially_copyable_v<Gyrostat<double>>, "or a step cannot keep it in registers");

/// The field of a choice, whose type must be Field.
template <class Field, class S, template <class> class A = FlatQuaternion>
Field field_of(PdSlew const& problem) {
  std::optional<Field> found;
  with_field<S, A>(problem, [&](auto const& field) {
    if constexpr (std::same_as<std::decay_t<decltype(field)>, Field>) found = field;
  });
  EXPECT_TRUE(found) << "the choice makes another field";
  return found.value();
}

// ---- Gyrostat -------------------------------------------------------------------------------------------------------

TEST(Gyrostat, EulersEquationOfBodyAndWheel) {
  Random random(1);
  Real3 const J{100, 120, 110}, h{1, -2, 5};
  auto const field = field_of<Gyrostat<double>, double>(chosen({"gyrostat"}, {{"wheel_momentum", {1, -2, 5}}}));
  PdController<double> const law{4, 20};
  for (int i = 0; i < 50; ++i) {
    Pair<Quat<double>, Real3> const x{random.attitude(), random.vector(0.5)};
    auto const v = field(0.0, x);
    Real3 const L{J.x * x.second.x, J.y * x.second.y, J.z * x.second.z};
    Real3 const moved{J.x * v.second.x, J.y * v.second.y, J.z * v.second.z};
    EXPECT_LT(distance<double>(moved, cross(L + h, x.second) + law.torque(0, x.first, x.second)), 1e-13);
    EXPECT_EQ(distance<double>(v.first, x.second), 0);
  }
}

TEST(Gyrostat, WithoutControlEnergyAndTotalMomentumAreInvariant) {
  Numbers const free{{"k_p", {0}}, {"k_d", {0}}};
  Vec3<Quad> const J{100, 120, 110}, h{0, 0, 5};
  auto const energy = [&](Vec3<Quad> const& w) { return (J.x * w.x * w.x + J.y * w.y * w.y + J.z * w.z * w.z) / 2; };
  auto const momentum = [&](auto const& x) {
    return to_inertial(x.first, Vec3<Quad>{J.x * x.second.x, J.y * x.second.y, J.z * x.second.z} + h);
  };
  auto const field = field_of<Gyrostat<Quad, S3>, Quad, S3>(chosen({"gyrostat"}, free));
  auto const start = field.initial(), end = test::by_gauss(field, 0.25, 60);
  EXPECT_GT(double(angle_between(start.first, end.first)), 0.1);
  EXPECT_LT(std::fabs(double(energy(end.second) - energy(start.second))), 1e-28);
  EXPECT_LT(double(distance<Quad>(momentum(end), momentum(start))), 1e-27) << "size and direction, in space";

  auto const bare = field_of<Gyrostat<Quad, S3>, Quad, S3>(
      chosen({"gyrostat"}, {{"k_p", {0}}, {"k_d", {0}}, {"wheel_momentum", {0, 0, 0}}}));
  EXPECT_GT(double(angle_between(end.first, test::by_gauss(bare, 0.25, 60).first)), 0.01) << "the wheel matters";
}

TEST(Gyrostat, TwoMethodsInQuadruplePrecisionAgreeAndItComesToRest) {
  PdSlew const problem = chosen({"gyrostat"});
  auto const gauss = test::by_gauss(field_of<Gyrostat<Quad, S3>, Quad, S3>(problem), 0.125, 60);
  auto const x = test::by_taylor(field_of<Gyrostat<Series>, Series>(problem), 60);
  EXPECT_LT(double(angle_between(gauss.first, {x[0], x[1], x[2], x[3]})), 1e-29);
  EXPECT_LT(double(distance<Quad>(gauss.second, {x[4], x[5], x[6]})), 1e-30);
  // The wheel slows the loop: J s^2 + (k_d + i h) s + k_p / 2 = 0 has its slowest root at -.071 1/s, not -.091 (J =
  // 110).
  EXPECT_LT(double(angle_between(gauss.first, Quat<Quad>{0, 0, 0, 1})), 2 * BodyParameters::degree);
}

template <template <class> class A, class Method>
double order_on_gyrostat(Method const& method) {
  static Quat<Quad> const reference =
      test::by_gauss(field_of<Gyrostat<Quad, S3>, Quad, S3>(chosen({"gyrostat"})), 0.25, 16).first;
  auto const error = [&](double h) {
    auto const field = field_of<Gyrostat<Quad, A>, Quad, A>(chosen({"gyrostat"}));
    auto x = field.initial();
    EXPECT_EQ(method.bind(field, FixedStep{h}, NormPolicy::none).advance(x, 0, 16), Status::ok);
    return double(angle_between(A<Quad>::attitude(x.first), reference));
  };
  return std::log2(error(0.125) / error(0.0625));
}
TEST(Gyrostat, MethodsOfOrder4HaveIt) {
  EXPECT_NEAR(order_on_gyrostat<FlatQuaternion>(Rk4{}), 4, 0.15);
  EXPECT_NEAR(order_on_gyrostat<S3>(CommutatorFree4{}), 4, 0.15);
  EXPECT_NEAR(order_on_gyrostat<SO3>(CommutatorFree4{}), 4, 0.15);
}

TEST(Gyrostat, DualNumbersGiveTheJacobianOfTheRates) {
  using D = Dual<3>;
  auto const field = field_of<Gyrostat<D>, D>(chosen({"gyrostat"}, {{"k_p", {0}}, {"k_d", {20}}}));
  Pair<Quat<D>, Vec3<D>> x{{0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}};  // at rest: J omega' = h x omega - k_d omega
  x.second.x.slope[0] = x.second.y.slope[1] = x.second.z.slope[2] = 1;
  auto const v = field(0.0, x);
  EXPECT_EQ(v.second.x.slope, (std::array{-20 * (1 / 100.), -5 * (1 / 100.), 0.0}));
  EXPECT_EQ(v.second.y.slope, (std::array{5 * (1 / 120.), -20 * (1 / 120.), 0.0}));
  EXPECT_EQ(v.second.z.slope, (std::array{0.0, 0.0, -20 * (1 / 110.)}));
}

// ---- The computer ---------------------------------------------------------------------------------------------------

Quat<double> const identity{0, 0, 0, 1};

TEST(SampledPd, WithoutDelayOrStepsIsTheLaw) {
  Random random(2);
  PdController<double> const law{4, 20};
  SampledPd<double> computer(law, 0, 0);
  for (int i = 0; i < 20; ++i) {
    Quat<double> const q = random.attitude();
    Real3 const w = random.vector(1);
    EXPECT_EQ(distance<double>(computer.torque(0, q, w), law.torque(0, q, w)), 0);
  }
}

TEST(SampledPd, AnswersComeLateAndNoneComeBefore) {
  for (std::size_t delay : {1u, 2u, 5u}) {
    SampledPd<double> computer({0, 2}, delay, 0);
    for (int k = 0; k < 20; ++k) {
      double const due = k < int(delay) ? 0 : -2 * double(k - int(delay) + 1);
      EXPECT_EQ(computer.torque(0, identity, {double(k + 1), 0, 0}).x, due) << delay << ", sample " << k;
    }
  }
}

// k_d = 1: torque = -omega, in steps of 1/4.
template <class S>
void expect_steps() {
  SampledPd<S> computer({Real<S>(0.0), Real<S>(1.0)}, 0, Real<S>(0.25));
  Quat<S> const q{S(0.0), S(0.0), S(0.0), S(1.0)};
  double const pairs[][2] = {{0, 0},       {0.1, 0},    {0.13, -0.25}, {0.3, -0.25},   {0.38, -0.5},     {-0.12, 0},
                             {-0.2, 0.25}, {-7.6, 7.5}, {0.125, 0},    {-0.125, 0.25}, {1e6 + 0.1, -1e6}};
  for (auto const& [omega, torque] : pairs) {
    Vec3<S> const u = computer.torque(Real<S>(0.0), q, {S(0.0), S(omega), S(-0.0)});
    EXPECT_TRUE(u.y == S(torque)) << omega;
    EXPECT_TRUE(u.x == S(0.0) && u.z == S(0.0));
  }
}
TEST(SampledPd, RoundsToTheNearestStepForEveryScalar) {
  expect_steps<double>();
  expect_steps<Quad>();
  expect_steps<Dual<2>>();
  expect_steps<Series>();
}

TEST(SampledPd, StepsAreConstantsOfSeriesAndDualNumbers) {
  Dual<1> d(0.7);
  d.slope[0] = 3;
  EXPECT_EQ(nearest_whole(d).value, 1);
  EXPECT_EQ(nearest_whole(d).slope[0], 0);
  Series s(-0.7);
  s.degree = 1;
  s[1] = 3;
  EXPECT_EQ(double(nearest_whole(s)[0]), -1);
  EXPECT_EQ(nearest_whole(s).degree, 0);
}

/// A run with samples at 0, T, 2 T ..; look(t, held) after each sample. State after `samples` periods.
template <class Field, class Method, class Look>
auto run(Field field, Method const& method, double period, int steps, int samples, Look look) {
  using R = Real<typename Field::Space::Scalar>;
  auto stepper = method.bind(field, FixedStep{period / steps}, NormPolicy::none);
  auto x = field.initial();
  for (int k = 0; k < samples; ++k) {
    R const t = R(period) * R(k), next = R(period) * R(k + 1);
    field.sample(t, x);
    stepper.restart();
    look(field.control, field.held, x);
    EXPECT_EQ(stepper.advance(x, t, next), Status::ok);
  }
  return x;
}

TEST(Delayed, TheTorqueAnswersTheStateOneSampleBefore) {
  PdController<double> const law{4, 20};
  Real3 expected{0, 0, 0};
  auto const field = field_of<Sampled<double>, double>(chosen({"delayed"}));
  run(field, Rk4{}, 0.1, 2, 50, [&](auto const&, Real3 const& held, auto const& x) {
    EXPECT_EQ(distance<double>(held, expected), 0);
    expected = law.torque(0, x.first, x.second);
  });
}

TEST(Quantized, TheTorqueIsTheLawToHalfAStep) {
  PdController<double> const law{4, 20};
  auto const field = field_of<Sampled<double>, double>(chosen({"quantized"}));
  int changed = 0;
  run(field, Rk4{}, 0.1, 1, 600, [&](auto const&, Real3 const& held, auto const& x) {
    Real3 const wanted = law.torque(0, x.first, x.second);
    EXPECT_LE(distance<double>(held, wanted), 0.005 * (1 + 1e-9));
    changed += distance<double>(held, wanted) > 1e-4;
    Real3::each([](double u) { EXPECT_NEAR(u / 0.01, std::round(u / 0.01), 1e-9); }, held);
  });
  EXPECT_GT(changed, 500);
}

/// The state after 3 s by Gauss in quadruple precision, and by the method in hand.
template <class S, template <class> class A = FlatQuaternion, class Method>
Point<RigidBody<A<S>>> after_3s(PdSlew const& problem, Method const& method, int steps) {
  return run(field_of<Sampled<S, A>, S, A>(problem), method, 0.1, steps, 30, [](auto&&...) {});
}
TEST(SampledVariants, MethodsOfOrder4HaveItBetweenSamples) {
  for (char const* variant : {"delayed", "quantized"}) {
    PdSlew const problem = chosen({variant});
    EXPECT_EQ(problem.sample_period, 0.1);
    Quat<Quad> const exact = after_3s<Quad, S3>(problem, Gauss<8>{}, 1).first;
    auto const order = [&]<template <class> class A>(auto const& method) {
      auto const error = [&](int steps) {
        return double(angle_between(A<Quad>::attitude(after_3s<Quad, A>(problem, method, steps).first), exact));
      };
      return std::log2(error(1) / error(2));
    };
    EXPECT_NEAR(order.template operator()<FlatQuaternion>(Rk4{}), 4, 0.15) << variant;
    EXPECT_NEAR(order.template operator()<S3>(CommutatorFree4{}), 4, 0.15) << variant;
  }
}

/// Series from sample to sample: what a reference does.
TEST(SampledVariants, TwoMethodsInQuadruplePrecisionAgree) {
  for (char const* variant : {"delayed", "quantized"}) {
    PdSlew const problem = chosen({variant});
    auto const gauss = after_3s<Quad, S3>(problem, Gauss<8>{}, 2);
    auto field = field_of<Sampled<Series>, Series>(problem);
    std::array<Series, 7> components;
    store(field.initial(), components.data());
    std::vector<Quad> x;
    for (Series const& component : components) x.push_back(component[0]);
    for (int k = 0; k < 30; ++k) {
      auto point = field.initial();
      std::vector<Series> const now(x.begin(), x.end());
      load(point, now.data());
      Quad const period(0.1), t = period * k;
      field.sample(t, point);
      auto const segment = expand<Quad, 32>(field, x, t, period, 1e-34);
      ASSERT_EQ(double(segment.h), 0.1);
      for (std::size_t i = 0; i < 7; ++i) x[i] = segment.component[i].at(segment.h);
    }
    EXPECT_LT(double(angle_between(gauss.first, {x[0], x[1], x[2], x[3]})), 1e-30) << variant;
    EXPECT_LT(double(distance<Quad>(gauss.second, {x[4], x[5], x[6]})), 1e-30) << variant;
  }
}

TEST(SampledVariants, ComeToRestAndTheDelayCosts) {
  auto const end = [](char const* variant, Numbers const& set = {}) {
    PdSlew const problem = chosen({variant}, set);
    auto const field = field_of<Sampled<double, S3>, double, S3>(problem);
    auto const samples = int(std::lround(60 / problem.sample_period));
    return run(field, CommutatorFree4{}, problem.sample_period, 1, samples, [](auto&&...) {}).first;
  };
  double const degree = BodyParameters::degree;
  auto const smooth = PdSlew(Choice{}).field<double, S3, true>();
  auto x = smooth.initial();
  ASSERT_EQ(CommutatorFree4{}.bind(smooth, FixedStep{0.1}, NormPolicy::none).advance(x, 0.0, 60.0), Status::ok);
  EXPECT_LT(angle_between(end("delayed"), identity), 1 * degree);
  EXPECT_LT(angle_between(end("quantized"), identity), 1 * degree);
  EXPECT_GT(angle_between(end("delayed"), x.first), 1e-4);
  EXPECT_GT(angle_between(end("quantized"), x.first), 1e-4);
  Numbers const fine{{"sample_period", {0.001}}, {"delay", {0}}};
  EXPECT_LT(angle_between(end("delayed", fine), x.first), 1e-4) << "it tends to the continuous loop";
}

// ---- Choices --------------------------------------------------------------------------------------------------------

TEST(PdSlewChoice, VariantsDecideTheFieldAndTheSamples) {
  EXPECT_TRUE(chosen({}).plain());
  EXPECT_TRUE(chosen({"plain"}).plain());
  for (char const* variant : {"gyrostat", "delayed", "quantized"}) EXPECT_FALSE(chosen({variant}).plain()) << variant;
  EXPECT_EQ(chosen({}).sample_period, 0);
  EXPECT_EQ(chosen({"gyrostat"}).sample_period, 0);
  Numbers const slow{{"sample_period", {0.2}}, {"delay", {0.6}}};
  EXPECT_EQ(chosen({"delayed"}, slow).sample_period, 0.2);
  EXPECT_EQ(chosen({"quantized"}, slow).sample_period, 0.2);
  EXPECT_EQ(chosen({}, slow).sample_period, 0) << "without effect on this variant";
}

TEST(PdSlewChoice, TheFieldOfPlainIsField) {
  PdSlew const problem = chosen({});
  bool called = false;
  with_field<double, S3>(problem, [&](auto const& field) {
    called = std::same_as<std::decay_t<decltype(field)>, decltype(problem.field<double, S3, true>())>;
  });
  EXPECT_TRUE(called);
  for (char const* variant : {"plain", "gyrostat", "delayed", "quantized"}) {
    EXPECT_TRUE((erase<double, FlatQuaternion>(chosen({variant})))) << variant;
    EXPECT_TRUE((erase<double, Mrp>(chosen({variant}, {{"inertia", {100, 120, 110, 1, 2, 3}}})))) << variant;
  }
}

TEST(PdSlewChoice, DelaysAreWholeNumbersOfSamples) {
  EXPECT_EQ(complaint({"delayed"}, {{"delay", {0.3}}}), "");
  EXPECT_EQ(complaint({"delayed"}, {{"delay", {0}}}), "");
  EXPECT_EQ(complaint({"delayed"}, {{"delay", {0.15}}}),
            "parameter delay: must be a whole number of sample periods, not 1.500000");
  EXPECT_EQ(complaint({"delayed"}, {{"sample_period", {0.2}}}),
            "parameter delay: must be a whole number of sample periods, not 0.500000");
  EXPECT_NE(complaint({"delayed"}, {{"delay", {1e300}}}), "");
  EXPECT_NE(complaint({"delayed"}, {{"delay", {-0.1}}}), "");
  EXPECT_NE(complaint({"quantized"}, {{"torque_step", {0}}}), "");
  EXPECT_NE(complaint({"quantized"}, {{"sample_period", {0}}}), "");
  EXPECT_EQ(complaint({"quantized"}, {{"delay", {0.15}}}), "") << "without effect on this variant";
  EXPECT_NE(complaint({"gyrostat"}, {{"wheel_momentum", {5}}}), "");
}

}  // namespace
}  // namespace polhode
