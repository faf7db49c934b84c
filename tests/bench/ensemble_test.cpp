/// Ensembles: every body of one is the body run alone, whatever the registers, the neighbours and the threads.
#include "bench/ensemble/ensemble.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "bench/speed/limited_pd.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"

namespace polhode {
namespace {

using bench::LimitedPd;
using bench::SampledLimitedPd;

constexpr std::int64_t bodies = 75;  // no multiple of any lanes

/// What this machine and this build can run on.
std::vector<Registers> registers() {
  std::vector<Registers> usable{Registers::of_the_unit};
  for (Registers const wider : {Registers::avx2, Registers::avx512})
    if (chooses_registers && wider <= widest_registers()) usable.push_back(wider);
  return usable;
}

/// The fields of an ensemble by `field<S>()`, whose bodies start apart: body k turns k mrad/s faster about x.
template <class Field>
struct Apart {
  Field field;
  template <class S>
  auto operator()(BodyBlock const& block) const {
    auto p = field.template operator()<S>();
    auto const from = field.template operator()<double>().start;
    p.start = gather<decltype(p.start)>(block, [&](std::int64_t k) {
      auto x = from;
      x.second.x += 1e-3 * double(k);
      return x;
    });
    return p;
  }
};
template <class Field>
Apart(Field) -> Apart<Field>;

template <template <class> class A>
auto free_bodies() {
  return Apart{[]<class S>() { return FreeBody(Choice{}).field<S, A, true>(); }};
}
auto limited_slews() {
  return Apart{[]<class S>() { return bench::limited_slew<S>(); }};
}

template <class Make>
using StateOf = decltype(std::declval<Make const&>().template operator()<double>(BodyBlock{}).initial());

/// The ends of an ensemble in the given registers.
template <class Method, class Make>
std::vector<StateOf<Make>> ends_of(Make const& make, EnsembleRun const& run, Registers width = widest_registers()) {
  std::vector<StateOf<Make>> ends(bodies);
  run_ensemble(
      Method{}, run, {0, bodies}, make, [&](std::int64_t k, auto const& x, Status) { ends[std::size_t(k)] = x; },
      NoEnsembleWatch{}, width);
  return ends;
}
/// The end of body k alone, by the stepper of one body.
template <class Method, class Make>
StateOf<Make> end_alone(Make const& make, EnsembleRun const& run, std::int64_t k) {
  auto p = make.template operator()<double>(BodyBlock{k, k + 1});
  auto stepper = Method{}.bind(p, FixedStep{run.h}, NormPolicy::none);
  auto x = p.initial();
  std::int64_t const to_stop = run.steps_to_stop > 0 ? run.steps_to_stop : run.steps;
  for (std::int64_t i = 0; i < run.steps; i += to_stop) {
    if constexpr (requires { p.sample(0.0, x); }) p.sample(double(i) * run.h, x);
    stepper.advance(x, double(i) * run.h, double(i + to_stop) * run.h);
  }
  return x;
}
template <class X>
double farthest(std::vector<X> const& a, std::vector<X> const& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, distance<double>(a[k], b[k]));
  return most;
}
template <class Method, class Make>
void expect_each_body_as_if_alone(Make const& make, EnsembleRun const& run) {
  std::vector<StateOf<Make>> alone;
  for (std::int64_t k = 0; k < bodies; ++k) alone.push_back(end_alone<Method>(make, run, k));
  ASSERT_GT(distance<double>(alone.front(), alone.back()), 1e-3) << "the bodies are the same";
  for (Registers const width : registers())
    EXPECT_EQ(farthest(ends_of<Method>(make, run, width), alone), 0) << int(width) << " bytes";
}

// ---- One body among many --------------------------------------------------------------------------------------------

TEST(Ensemble, RungeKuttaIsThatOfOneBodyToTheLastBit) {
  expect_each_body_as_if_alone<Rk4>(free_bodies<FlatQuaternion>(), {0.01, 300});
  expect_each_body_as_if_alone<Explicit<DormandPrince5>>(free_bodies<FlatQuaternion>(), {0.05, 100});
}
TEST(Ensemble, AControlLawIsThatOfOneBodyToTheLastBit) {
  expect_each_body_as_if_alone<Rk4>(Apart{[]<class S>() { return PdSlew(Choice{}).field<S, FlatQuaternion, true>(); }},
                                    {0.05, 200});
}
TEST(Ensemble, GroupMethodsAreThoseOfOneBodyToTheLastBit) {
  expect_each_body_as_if_alone<CommutatorFree4>(free_bodies<S3>(), {0.1, 100});
  expect_each_body_as_if_alone<Explicit<Kutta4>>(free_bodies<S3>(), {0.1, 100});
}
/// Beyond the short series sine and cosine are the lanes' own, within 1 ulp of the library's, and a neighbour that is
/// far takes all of its block along.
TEST(Ensemble, GreatRotationsAgreeToRoundOff) {
  auto const make = free_bodies<S3>();
  EnsembleRun const run{4, 25};
  for (Registers const width : registers()) {
    auto const ends = ends_of<CommutatorFree4>(make, run, width), chart = ends_of<Explicit<Kutta4>>(make, run, width);
    for (std::int64_t k = 0; k < bodies; ++k) {
      EXPECT_LT(distance<double>(ends[std::size_t(k)], end_alone<CommutatorFree4>(make, run, k)), 1e-11);
      EXPECT_LT(distance<double>(chart[std::size_t(k)], end_alone<Explicit<Kutta4>>(make, run, k)), 1e-11);
    }
  }
}
TEST(Ensemble, SaturationInLanesIsThatOfScalars) {
  expect_each_body_as_if_alone<Rk4>(limited_slews(), {0.02, 500});
  // Both sides of the limit are met, by different bodies at the same time.
  std::int64_t limited = 0, free = 0;
  run_ensemble(
      Rk4{}, {0.02, 500, 100}, {0, bodies}, limited_slews(), [](auto const&...) {},
      [&](BodyBlock const&, double, auto const& p, auto const& x) {
        auto const u = p.control.torque(decltype(x.second.x)(0.0), x.first, x.second);
        for (int lane = 0; lane < lanes_of<std::decay_t<decltype(u.x)>>; ++lane)
          ++(std::fabs(double(u.x[lane])) == 3.0 ? limited : free);
      },
      Registers::of_the_unit);
  EXPECT_GT(limited, 50);
  EXPECT_GT(free, 50);
}
TEST(Ensemble, SampledControlIsAskedAtStopsAndHeld) {
  auto const make = Apart{[]<class S>() { return bench::limited_slew<S, FlatQuaternion, SampledLimitedPd<S>>(); }};
  expect_each_body_as_if_alone<Rk4>(make, {0.02, 300, 5});
  EXPECT_GT(farthest(ends_of<Rk4>(make, {0.02, 300, 5}), ends_of<Rk4>(make, {0.02, 300, 10})), 1e-6);
}
TEST(Ensemble, EveryBodyMayHaveParametersOfItsOwn) {
  auto const make = []<class S>(BodyBlock const& block) {
    BodyParameters const body;
    auto const J_y = gather<S>(block, [](std::int64_t k) { return 115 + 0.1 * double(k); });
    PrincipalInertia<S> const inertia({S(100.0), J_y, S(110.0)}, S(1.0));
    return ControlledBody<S, FlatQuaternion, PrincipalInertia<S>, NoTorque<S>>{
        inertia, {}, {body.attitude<S>(), body.rate<S>()}};
  };
  auto const ends = ends_of<Rk4>(make, {0.01, 300});
  for (std::int64_t const k : {0, 1, 40, 74}) {
    FreeBody const own(Choice{.words = {}, .set = {{"inertia", {100, 115 + 0.1 * double(k), 110}}}});
    auto const p = own.field<double, FlatQuaternion, true>();
    auto x = p.initial();
    Rk4{}.bind(p, FixedStep{0.01}, NormPolicy::none).advance(x, 0, 3);
    EXPECT_EQ(distance<double>(ends[std::size_t(k)], x), 0) << "body " << k;
  }
}
TEST(Ensemble, SinglePrecisionKeepsSixDigitsOfAShortRun) {
  auto const ends = ends_of<Rk4>(free_bodies<FlatQuaternion>(), {0.05, 100});
  double worst = 0;
  run_ensemble<float>(Rk4{}, {0.05, 100}, {0, bodies}, free_bodies<FlatQuaternion>(),
                      [&](std::int64_t k, auto const& x, Status status) {
                        EXPECT_EQ(status, Status::ok);
                        worst = std::max(worst, std::fabs(double(x.first.x) - ends[std::size_t(k)].first.x));
                      });
  EXPECT_LT(worst, 1e-5);
  EXPECT_GT(worst, 1e-9) << "this was not single precision";
}

// ---- Who is delivered, and what is seen -----------------------------------------------------------------------------

TEST(Ensemble, DeliversEachBodyOnceInOrder) {
  for (Registers const width : registers())
    for (Bodies const part : {Bodies{0, 1}, {3, 3}, {5, 38}, {0, 64}, {64, 75}}) {
      std::vector<std::int64_t> seen;
      run_ensemble(
          Rk4{}, {0.01, 1}, part, free_bodies<FlatQuaternion>(),
          [&](std::int64_t k, auto const&, Status) { seen.push_back(k); }, NoEnsembleWatch{}, width);
      ASSERT_EQ(std::int64_t(seen.size()), part.last - part.first);
      for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], part.first + std::int64_t(i));
    }
}
TEST(Ensemble, TheWatchSeesStopsAndTheEnd) {
  std::vector<double> times;
  run_ensemble(
      Rk4{}, {0.5, 7, 3}, {0, 1}, free_bodies<FlatQuaternion>(), [](auto const&...) {},
      [&](BodyBlock const&, double t, auto const&, auto const&) { times.push_back(t); });
  EXPECT_EQ(times, (std::vector<double>{0, 1.5, 3, 3.5}));
}
TEST(Ensemble, WhatDivergesDisturbsNobody) {
  auto const healthy = free_bodies<FlatQuaternion>();
  auto const ill = [&]<class S>(BodyBlock const& block) {
    auto p = healthy.operator()<S>(block);
    p.start.second.y = gather<S>(block, [](std::int64_t k) {
      constexpr double degree = BodyParameters::degree;
      return k == 13 ? std::numeric_limits<double>::quiet_NaN() : k == 20 ? 1e200 : 10 * degree;
    });
    return p;
  };
  for (Registers const width : registers()) {
    auto const ends = ends_of<Rk4>(healthy, {0.01, 100}, width);
    run_ensemble(
        Rk4{}, {0.01, 100}, {0, bodies}, ill,
        [&](std::int64_t k, auto const& x, Status status) {
          bool const lost = k == 13 || k == 20;
          EXPECT_EQ(status, lost ? Status::diverged : Status::ok) << "body " << k;
          if (lost) return;
          EXPECT_EQ(distance<double>(x, ends[std::size_t(k)]), 0) << "body " << k;
        },
        NoEnsembleWatch{}, width);
  }
}

// ---- Threads --------------------------------------------------------------------------------------------------------

/// 3 chunks and a bit.
constexpr std::int64_t many = 3 * bench::bodies_in_chunk + 5;

TEST(EnsembleThreads, GiveTheSameBitsForAnyNumberOfThem) {
  auto const ends_by = [](int threads) {
    std::vector<Pair<Quat<double>, Vec3<double>>> ends(many);
    bench::run_ensemble_on_threads(threads, Rk4{}, {0.01, 20}, many, limited_slews(),
                                   [&](std::int64_t k, auto const& x, Status) { ends[std::size_t(k)] = x; });
    return ends;
  };
  auto const one = ends_by(1);
  for (int const threads : {2, 3, 7}) EXPECT_EQ(farthest(ends_by(threads), one), 0) << threads;
}
TEST(EnsembleThreads, HandOnTheFirstFailure) {
  auto const fail = [](std::int64_t k) {
    if (k == 3 || k == 8) throw std::runtime_error("part " + std::to_string(k));
  };
  for (int const threads : {1, 2, 10, 50}) {
    try {
      bench::on_threads(threads, 10, fail);
      FAIL() << "nothing was thrown";
    } catch (std::runtime_error const& failure) {
      EXPECT_STREQ(failure.what(), "part 3") << threads;
    }
  }
}

}  // namespace
}  // namespace polhode
