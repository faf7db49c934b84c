/// Jacobians from dual numbers against formulas and differences, through samples, phases and sides; and what implicit
/// libraries do with them.
#include <gtest/gtest.h>

#include "bench/process/allocations.hpp"
#include "integrators/rivals/arkode.hpp"
#include "integrators/rivals/cvode.hpp"
#include "problems/dead_zone.hpp"
#include "problems/dual_field.hpp"
#include "problems/group_consensus.hpp"
#include "problems/krogh_b5.hpp"
#include "problems/pd_slew.hpp"
#include "problems/quaternion_sync.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rival_runs.hpp"

namespace polhode {
namespace {

/// A typed field that knows its Jacobian.
template <template <class> class A, Definition D>
auto differentiable(D const& definition) {
  auto field = definition.template field<double, A, true>();
  auto duals = definition.template field<JacobianScalar, A, true>();
  return WithJacobian<decltype(field), decltype(duals)>(field, duals);
}
template <Problem P>
std::vector<double> jacobian_of(P const& problem, double t, Point<typename P::Space> const& x) {
  static_assert(DifferentiableProblem<P>);
  auto const n = std::size_t(size_of(x));
  std::vector<double> J(n * n, std::nan(""));
  problem.jacobian(t, x, J);
  return J;
}
/// Every coordinate moved by up to .1.
template <class X>
X near(X x, std::uint64_t seed) {
  test::Random random(seed);
  X::each([&](double& a) { a += random.uniform(-0.1, 0.1); }, x);
  return x;
}
/// The greatest difference between the Jacobian and central differences, relative to the greatest element.
template <Problem P>
double difference_error(P const& problem, double t, Point<typename P::Space> const& x) {
  constexpr double h = 1e-5;
  std::vector<double> const J = jacobian_of(problem, t, x);
  auto const n = std::size_t(size_of(x));
  LibraryField<P> const field(problem);
  std::vector<double> y(n), ahead(n), behind(n);
  store(x, y.data());
  double most = 0, greatest = 0;
  for (std::size_t j = 0; j < n; ++j) {
    double const here = y[j];
    y[j] = here + h;
    field(t, y.data(), ahead.data());
    y[j] = here - h;
    field(t, y.data(), behind.data());
    y[j] = here;
    for (std::size_t i = 0; i < n; ++i) {
      most = std::max(most, std::fabs((ahead[i] - behind[i]) / (2 * h) - J[i + n * j]));
      greatest = std::max(greatest, std::fabs(J[i + n * j]));
    }
  }
  return most / greatest;
}
constexpr double differences = 2e-9;  ///< what central differences of 1e-5 can show

// ---- Against formulas -----------------------------------------------------------------------------------------------

TEST(Jacobian, OfKroghsProblem) {
  KroghB5 const krogh(Choice{});
  auto const problem = differentiable<FlatQuaternion>(krogh);
  Vec3<double> const y{0.3, -0.7, 1.1};
  double const m = 0.51;
  std::vector<double> const by_hand{0, -y.z, -m * y.y, y.z, 0, -m * y.x, y.y, -y.x, 0};
  EXPECT_EQ(jacobian_of(problem, 0, y), by_hand);
}

TEST(Jacobian, OfASampledLoopIsThatOfTheFreeBodyAfterASample) {
  auto problem = differentiable<FlatQuaternion>(TetherCapture(Choice{}));
  auto x = problem.initial();
  problem.sample(0, x);
  Quat<double> const q = x.first;
  Vec3<double> const w{0.1, 0.2, -0.3};
  x.second = w;
  std::vector<double> by_hand(49);
  auto const at = [&](int i, int j) -> double& { return by_hand[std::size_t(i) + 7 * std::size_t(j)]; };
  double const turning[4][4] = {{0, w.z, -w.y, w.x}, {-w.z, 0, w.x, w.y}, {w.y, -w.x, 0, w.z}, {-w.x, -w.y, -w.z, 0}};
  double const turned[4][3] = {{q.w, -q.z, q.y}, {q.z, q.w, -q.x}, {-q.y, q.x, q.w}, {-q.x, -q.y, -q.z}};
  double const J[3] = {100, 120, 110};
  double const rates[3] = {w.x, w.y, w.z};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) at(i, j) = turning[i][j] / 2;
    for (int j = 0; j < 3; ++j) at(i, 4 + j) = turned[i][j] / 2;
  }
  for (int i = 0; i < 3; ++i) {
    int const a = (i + 1) % 3, b = (i + 2) % 3;
    at(4 + i, 4 + a) = (J[a] - J[b]) / J[i] * rates[b];
    at(4 + i, 4 + b) = (J[a] - J[b]) / J[i] * rates[a];
  }
  std::vector<double> const got = jacobian_of(problem, 0.05, x);
  for (std::size_t k = 0; k < got.size(); ++k) EXPECT_NEAR(got[k], by_hand[k], 1e-16) << k;
}

// ---- Against differences --------------------------------------------------------------------------------------------

TEST(Jacobian, OfTheSlewInEveryFlatFormulation) {
  PdSlew const slew(Choice{});
  auto const check = [](auto const& problem) {
    EXPECT_LT(difference_error(problem, 1, near(problem.initial(), 1)), differences);
  };
  check(differentiable<FlatQuaternion>(slew));
  check(differentiable<FlatRotation>(slew));
  check(differentiable<Mrp>(slew));
  check(differentiable<EulerAngles>(slew));
}

/// Calls f with the field as a run has it: its type forgotten on the side of the dual numbers.
template <Definition D, class F>
void on_quaternions(D const& definition, F f) {
  with_differentiable_field<FlatQuaternion>(definition, [&](auto field) { f(field); });
}

TEST(Jacobian, OfManyBodies) {
  on_quaternions(GroupConsensus(Choice{}), [](auto const& five) {
    EXPECT_EQ(size_of(five.initial()), 35);
    EXPECT_LT(difference_error(five, 0, near(five.initial(), 2)), differences);
  });
  on_quaternions(QuaternionSync(Choice{}), [](auto const& five) {
    EXPECT_EQ(size_of(five.initial()), 20);
    EXPECT_LT(difference_error(five, 0, near(five.initial(), 3)), differences);
  });
}

TEST(Jacobian, CrossesWithItsProblem) {
  on_quaternions(GroupConsensus(Choice{.words = {"shadow"}, .set = {}}), [](auto& five) {
    auto const x = near(five.initial(), 4);
    five.take_sides(0, x);
    auto const before = jacobian_of(five, 0, x);
    EXPECT_LT(difference_error(five, 0, x), differences);
    five.cross(2);
    EXPECT_LT(difference_error(five, 0, x), differences);
    EXPECT_NE(jacobian_of(five, 0, x), before);
    five.begin();
    five.take_sides(0, x);
    EXPECT_EQ(jacobian_of(five, 0, x), before) << "a new run has forgotten the crossing";
  });
}

TEST(Jacobian, EntersPhasesWithItsProblem) {
  on_quaternions(DeadZone(Choice{.words = {"smooth", "n4"}, .set = {}}), [](auto& body) {
    auto const x = near(body.initial(), 5);
    double const t = body.time_events().front();
    auto const before = jacobian_of(body, t + 1, x);
    EXPECT_LT(difference_error(body, 1, x), differences);
    body.enter_phase(t);
    EXPECT_LT(difference_error(body, t + 1, x), differences);
    EXPECT_NE(jacobian_of(body, t + 1, x), before) << "the path has ended";
    body.begin();
    EXPECT_EQ(jacobian_of(body, t + 1, x), before);
  });
}

TEST(Jacobian, IsTheSameTypedAndErased) {
  TetherCapture const tether(Choice{});
  auto typed = differentiable<FlatQuaternion>(tether);
  on_quaternions(tether, [&](auto& erased) {
    auto x = near(erased.initial(), 6);
    EXPECT_EQ(jacobian_of(erased, 0, x), jacobian_of(typed, 0, x));
    erased.sample(0, x);
    typed.sample(0, x);
    x = near(x, 7);
    EXPECT_EQ(jacobian_of(erased, 0, x), jacobian_of(typed, 0, x));
  });
}

TEST(Jacobian, AllocatesNothing) {
  on_quaternions(GroupConsensus(Choice{}), [](auto const& five) {
    auto const x = five.initial();
    std::vector<double> J(35 * 35);
    auto const before = bench::allocations_of_this_thread();
    five.jacobian(0, x, J);
    EXPECT_EQ(bench::allocations_of_this_thread() - before, 0);
  });
}

// ---- What implicit libraries do with it -----------------------------------------------------------------------------
#ifdef POLHODE_HAS_SUNDIALS

/// Counts the evaluations of a field.
template <Problem P>
struct Counted : P {
  using Space = typename P::Space;
  std::int64_t* count;
  Counted(P const& problem, std::int64_t& counter) : P(problem), count(&counter) {}
  Velocity<Space> operator()(double t, Point<Space> const& x) const requires SmallSpace<Space> {
    ++*count;
    return P::operator()(t, x);
  }
  void operator()(double t, Point<Space> const& x, Velocity<Space>& v) const requires PowerSpace<Space> {
    ++*count;
    P::operator()(t, x, v);
  }
};
/// Knows its Jacobian, and does not tell.
template <Problem P>
struct Reticent : P {
  using Space = typename P::Space;
  explicit Reticent(P const& problem) : P(problem) {}
  bool has_jacobian() const { return false; }
  void jacobian(double, Point<Space> const&, std::span<double>) const { ADD_FAILURE() << "it was not offered"; }
};

/// Work, evaluations and the end of one run by difference quotients, and by the problem's own Jacobian.
template <class Method, Definition D, class Check>
void compare(D const& definition, double t_end, double rtol, Check check) {
  auto const run = [&](auto field, std::int64_t const& evaluations) {
    auto result = test::run_rival<Method>(field, test::stops_until(definition, t_end), Adaptive{rtol, 1e-2 * rtol});
    EXPECT_EQ(result.status, Status::ok);
    result.evaluations = evaluations;
    return result;
  };
  std::int64_t by_quotients = 0, by_duals = 0;
  auto const field = definition.template field<double, FlatQuaternion, true>();
  auto const duals = definition.template field<JacobianScalar, FlatQuaternion, true>();
  using F = std::decay_t<decltype(field)>;
  auto const quotients = run(Reticent<Counted<F>>(Counted<F>(field, by_quotients)), by_quotients);
  auto const own =
      run(WithJacobian<Counted<F>, std::decay_t<decltype(duals)>>(Counted<F>(field, by_duals), duals), by_duals);
  check(quotients, own);
}

/// On one body quotients are good enough: the same steps, an evaluation a column and Jacobian less.
template <class Method>
void expect_evaluations_saved() {
  for (double rtol : {1e-5, 1e-9})
    compare<Method>(PdSlew(Choice{}), 20, rtol, [](auto const& quotients, auto const& own) {
      EXPECT_EQ(own.work.steps, quotients.work.steps);
      EXPECT_EQ(own.work.jacobians, quotients.work.jacobians);
      EXPECT_GT(own.work.jacobians, 0);
      EXPECT_EQ(quotients.evaluations - own.evaluations, 7 * *own.work.jacobians);
      EXPECT_LT(distance<double>(own.x, quotients.x), 1e-8);
    });
}
TEST(CvodeBdf, TakesTheProblemsOwnJacobian) {
  expect_evaluations_saved<Cvode<true>>();
}
TEST(Dirk, TakesTheProblemsOwnJacobian) {
  expect_evaluations_saved<ArkodeDirk>();
}
TEST(CvodeBdf, SavesAThirdOfTheEvaluationsOfFiveBodies) {
  compare<Cvode<true>>(GroupConsensus(Choice{}), 10, 1e-9, [](auto const& quotients, auto const& own) {
    EXPECT_LT(own.evaluations, 0.7 * double(quotients.evaluations));
    EXPECT_LE(own.work.steps, 1.02 * double(quotients.work.steps));
    EXPECT_LT(distance<double>(own.x, quotients.x), 1e-6);
  });
}
TEST(CvodeBdf, TakesTheJacobianOfASampledLoop) {
  compare<Cvode<true>>(TetherCapture(Choice{}), 5, 1e-8, [](auto const& quotients, auto const& own) {
    EXPECT_LT(own.evaluations, quotients.evaluations);
    EXPECT_GE(own.work.jacobians, 50) << "one a sample";
    EXPECT_LT(distance<double>(own.x, quotients.x), 1e-6);
  });
}
#endif

}  // namespace
}  // namespace polhode
