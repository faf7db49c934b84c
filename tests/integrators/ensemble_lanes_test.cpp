/// Sampled control in lanes: every body of a block, with parameters of its own, is the body run alone.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "integrators/ensemble.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/lanes.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

// ---- The angle of a point -------------------------------------------------------------------------------------------

double ulp_of(double x) {
  return std::nextafter(std::fabs(x), std::numeric_limits<double>::infinity()) - std::fabs(x);
}

TEST(Arctangent, IsWithinTwoUlp) {
  test::Random random(3);
  double most = 0;
  auto const check = [&](double y, double x) {
    Quad const error = Quad(arctangent(y, x)) - atan2q(Quad(y), Quad(x));
    most = std::max(most, std::fabs(double(error)) / ulp_of(arctangent(y, x)));
  };
  for (int i = 0; i < 50'000; ++i) {
    check(random.uniform(-1, 1), random.uniform(-1, 1));
    check(std::ldexp(random.uniform(-1, 1), int(60 * random.uniform(-1, 1))), random.uniform(-1, 1));
    double const turn = 0.25 * 3.14159265358979 * std::floor(8 * random.uniform(0, 1));  // where formulas join
    check(std::sin(turn + 1e-8 * random.uniform(-1, 1)), std::cos(turn));
    check(random.uniform(0, 1) * 0.4142135 + 1e-7, 1);
  }
  EXPECT_LE(most, 2);
}
TEST(Arctangent, KnowsWhatTheLibraryKnows) {
  double const infinity = std::numeric_limits<double>::infinity();
  for (double const y : {0.0, -0.0, 1.0, -1.0, infinity, -infinity, 1e-310, 1e300})
    for (double const x : {0.0, -0.0, 1.0, -1.0, infinity, -infinity, 1e-310, 1e300}) {
      double const angle = arctangent(y, x), expected = std::atan2(y, x);
      EXPECT_NEAR(angle, expected, 1e-15) << y << " " << x;
      EXPECT_EQ(std::signbit(angle), std::signbit(expected)) << y << " " << x;
    }
  EXPECT_TRUE(std::isnan(arctangent(std::nan(""), 1.0)));
}
TEST(Arctangent, InLanesIsThatOfDoubles) {
  using L = Lanes<8>;
  test::Random random(5);
  for (int repeat = 0; repeat < 1000; ++repeat) {
    auto const some = [&](int) {
      double const u = random.uniform(-1, 1);
      return std::fabs(u) < 0.05 ? 0.0 : u;
    };
    L const y = L::of(some), x = L::of(some), angle = arctangent(y, x);
    for (int i = 0; i < L::count; ++i) ASSERT_EQ(angle[i], arctangent(y[i], x[i])) << y[i] << " " << x[i];
  }
}

// ---- Captures -------------------------------------------------------------------------------------------------------

constexpr std::int64_t bodies = 37;  // no multiple of any lanes

template <class D>
auto field_of(D const& definition) {
  return definition.template field<double, FlatQuaternion, true>();
}
/// Body k of a fleet: everything differs.
TetherCapture capture(std::string const& word, std::int64_t k) {
  Choice choice{.words = {word}, .set = {}};
  double const u = double(k) / double(bodies);
  choice.set["omega0"] = {0.17 + 0.1 * u, 0.17 - 0.2 * u, 0.17};
  choice.set["inertia"] = {100 + 10 * u, 120, 110 - 5 * u};
  choice.set["k_pe"] = {40 + 20 * u};
  choice.set["u_max"] = {5 - 3 * u};
  choice.set["f_max"] = {30 - 20 * u};
  choice.set["k_du"] = {80 + 40 * u};
  return TetherCapture(choice);
}
PdSlew slew(std::int64_t k) {
  Choice choice;
  choice.set["k_p"] = {4 + 0.1 * double(k)};
  choice.set["k_d"] = {20 - 0.1 * double(k)};
  return PdSlew(choice);
}

template <class Definition>
void expect_as_if_alone(Definition const& definition, EnsembleRun const& run) {
  using Field = decltype(field_of(definition(0)));
  std::vector<Field> fields;
  for (std::int64_t k = 0; k < bodies; ++k) fields.push_back(field_of(definition(k)));
  auto const make = [&]<class S>(BodyBlock const& block) {
    auto const of = [&](int lane) -> Field const& { return fields[std::size_t(block.index(lane))]; };
    if constexpr (std::same_as<S, double>)
      return of(0);
    else
      return Field::template gathered<S>(of);
  };
  std::vector<Registers> widths{Registers::of_the_unit};
  for (Registers const wider : {Registers::avx2, Registers::avx512})
    if (chooses_registers && wider <= widest_registers()) widths.push_back(wider);
  for (Registers const width : widths)
    run_ensemble(
        Rk4{}, run, {0, bodies}, make,
        [&](std::int64_t k, auto const& end, Status status) {
          Field p = fields[std::size_t(k)];
          auto stepper = Rk4{}.bind(p, FixedStep{run.h}, NormPolicy::none);
          auto x = p.initial();
          for (std::int64_t i = 0; i < run.steps; i += run.steps_to_stop) {
            double const t = double(i) * run.h;
            if constexpr (SampledProblem<Field>) p.sample(t, x);
            stepper.advance(x, t, double(i + run.steps_to_stop) * run.h);
          }
          EXPECT_EQ(status, Status::ok);
          EXPECT_EQ(distance<double>(x, end), 0) << "body " << k << ", " << int(width) << " bytes";
        },
        NoEnsembleWatch{}, width);
}

TEST(EnsembleLanes, CapturesAreThoseOfBodiesAlone) {
  for (std::string const word : {"case1", "case2", "case3", "free"})
    expect_as_if_alone([&](std::int64_t k) { return capture(word, k); }, {0.05, 1000, 2});
}
TEST(EnsembleLanes, SlewsWithGainsOfTheirOwnAreThoseOfBodiesAlone) {
  expect_as_if_alone(slew, {0.05, 400, 10});
}

}  // namespace
}  // namespace polhode
