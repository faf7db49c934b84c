/// That the walks over the catalogue can fail: methods with one coefficient changed, or a step changed, and what the
/// walks' own measurements make of them.
#include "integrators/catalog.hpp"
#include "tests/conformance/orders.hpp"
#include "tests/conformance/symmetry.hpp"
#include "tests/support/quad_runs.hpp"

namespace polhode {
namespace {

using test::measured_order;
using test::ShakenSlew;

/// A coefficient as it is, or a little more of it: (1 + 1 / parts) of the value.
template <class C>
struct Wrong {
  C value;
  long parts = 0;
  template <class R>
  constexpr R as() const {
    R const right = value.template as<R>();
    return parts == 0 ? right : R(right + right / R(double(parts)));
  }
  constexpr bool is_zero() const { return value.is_zero(); }
};
template <class C, std::size_t rows, std::size_t columns>
constexpr auto changed(C const (&a)[rows][columns], std::size_t i, std::size_t j, long parts) {
  std::array<std::array<Wrong<C>, columns>, rows> copy{};
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) copy[r][c] = {a[r][c], r == i && c == j ? parts : 0};
  return copy;
}

/// Tableau T with a[i][j] wrong.
template <class T, int i, int j, long parts>
struct WrongTableau : T {
  static constexpr auto a = changed(T::a, i, j, parts);
};
/// Method, an explicit Runge-Kutta one of tableau T, so changed; c stays, as a misprint leaves it.
template <class Method, class T, int i, int j, long parts>
struct WrongExplicit : Explicit<WrongTableau<T, i, j, parts>> {
  static constexpr MethodInfo info = Method::info;
};
/// RK4 that looks at its third stage's time too late.
template <long parts>
struct LateTableau : Kutta4 {
  static constexpr Wrong<Ratio> c[4] = {{Kutta4::c[0]}, {Kutta4::c[1]}, {Kutta4::c[2], parts}, {Kutta4::c[3]}};
};
template <long parts>
struct LateRk4 : Explicit<LateTableau<parts>> {
  static constexpr MethodInfo info = Rk4::info;
};
using WrongRk4 = WrongExplicit<Rk4, Kutta4, 2, 1, 1000>;
using SubtleRk4 = WrongExplicit<Rk4, Kutta4, 2, 1, 1'000'000>;
using WrongDopri5 = WrongExplicit<Dopri5, DormandPrince5, 4, 2, 1000>;
using SubtleDopri5 = WrongExplicit<Dopri5, DormandPrince5, 4, 2, 1'000'000>;
using WrongVerner = WrongExplicit<Verner65, Verner6, 5, 3, 1000>;
using SubtleVerner = WrongExplicit<Verner65, Verner6, 5, 3, 1'000'000>;

/// Exponentials of T with the coefficient of one slope in one of them wrong.
template <class T, std::size_t product_index, std::size_t exponential, std::size_t slope, long parts>
struct WrongProduct : T {
  static constexpr auto product = [] {
    std::array<std::decay_t<decltype(T::product[0])>, std::size(T::product)> copy{};
    for (std::size_t i = 0; i < copy.size(); ++i) copy[i] = T::product[i];
    Quad& entry = copy[product_index].factor[exponential][slope];
    entry += entry / parts;
    return copy;
  }();
};
/// In the point of the third stage.
template <class Method, class T, std::size_t exponential, std::size_t slope, long parts>
struct WrongGroup : Exponentials<WrongProduct<T, 1, exponential, slope, parts>> {
  static constexpr MethodInfo info = Method::info;
};
using WrongCf4 = WrongGroup<CommutatorFree4, Cf4Tableau, 0, 1, 1000>;
using SubtleCf4 = WrongGroup<CommutatorFree4, Cf4Tableau, 0, 1, 1'000'000>;
using WrongCg4 = WrongGroup<CrouchGrossman4, Cg4Tableau, 1, 1, 1000>;
using SubtleCg4 = WrongGroup<CrouchGrossman4, Cg4Tableau, 1, 1, 1'000'000>;

/// Gauss of two stages on a group: `node` moves its first node, else its matrix is no longer that of a symmetric
/// method.
template <bool node, long parts>
struct WrongGauss2 {
  static constexpr MethodInfo info = LieGaussEntry<2>::info;
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    using Method = LieGauss<2>::Method<R>;
    Method method;
    R& wrong = node ? method.table.c[0] : method.table.middle[0][1];
    wrong += wrong / R(double(parts));
    return Fixed<Method, P>(method, p, control, policy);
  }
};

/// Blanes and Moan's composition with a wrong coefficient: steps still add up to h, and forth and back are still alike
/// if it is wrong on both sides.
template <bool both_sides, long parts>
struct WrongComposition : BlanesMoan4 {
  template <class R>
  static auto coefficients() {
    auto alpha = BlanesMoan4::coefficients<R>();
    R const change = alpha[2] / R(double(parts));
    alpha[2] += change;
    alpha[3] -= change;
    if (both_sides) {
      alpha[8] -= change;
      alpha[9] += change;
    }
    return alpha;
  }
};
template <bool both_sides, long parts>
struct WrongSplitting : Splitting<ThreeRotations, WrongComposition<both_sides, parts>> {
  static constexpr MethodInfo info = SplitBm4::info;
};

// ---- Orders ---------------------------------------------------------------------------------------------------------

/// The order that the walk finds.
template <class Method, template <class> class A>
double order_found() {
  auto const order = measured_order<Method, A>(ShakenSlew(Choice{}), test::shaken_slew());
  EXPECT_TRUE(order) << Method::info.name;
  return order.value_or(0);
}
/// The method passes the walk, and neither mutant does.
template <template <class> class A, class Right, class Wrong, class Subtle>
void expect_seen() {
  constexpr double claim = Right::info.order, within = test::order_tolerance(Right::info.order);
  EXPECT_NEAR((order_found<Right, A>()), claim, within) << Right::info.name;
  EXPECT_LT((order_found<Wrong, A>()), claim - 0.2 - within) << Right::info.name << ", wrong by a thousandth";
  EXPECT_LT((order_found<Subtle, A>()), claim - 0.2 - within) << Right::info.name << ", wrong by a millionth";
}

TEST(OrderProblem, OfTheShakenSlewHasTheEndThatAPowerSeriesHas) {
  auto const end = test::by_taylor(ShakenSlew(Choice{}).field<test::Series, FlatQuaternion, true>(), 4);
  Quat<Quad> q;
  load(q, end.data());
  EXPECT_LT(double(angle_between(q, test::shaken_slew().end)), 1e-30);
  EXPECT_GT(double(q.w), 0.5) << "the law is not smooth where the scalar part is 0";
}

TEST(Mutants, OfExplicitTableausLoseTheirOrder) {
  expect_seen<FlatQuaternion, Rk4, WrongRk4, SubtleRk4>();
  expect_seen<FlatQuaternion, Rk4, LateRk4<1000>, LateRk4<1'000'000>>();
  expect_seen<FlatQuaternion, Dopri5, WrongDopri5, SubtleDopri5>();
  expect_seen<FlatQuaternion, Verner65, WrongVerner, SubtleVerner>();
}
TEST(Mutants, OfMethodsOnGroupsLoseTheirOrder) {
  expect_seen<S3, CommutatorFree4, WrongCf4, SubtleCf4>();
  expect_seen<S3, CrouchGrossman4, WrongCg4, SubtleCg4>();
  expect_seen<S3, LieGaussEntry<2>, WrongGauss2<true, 1000>, WrongGauss2<true, 1'000'000>>();
}
TEST(Mutants, OfCompositionsLoseTheirOrder) {
  expect_seen<S3, SplitBm4, WrongSplitting<true, 1000>, WrongSplitting<true, 1'000'000>>();
}

// ---- What is kept ---------------------------------------------------------------------------------------------------

template <class Method>
double miss_on_the_top() {
  auto const problem = erase_type(test::top_under<Quad, S3>({.shaken = true}));
  return test::miss_of_return<Method>(*problem, 0x1p-3, 16).value_or(0);
}
TEST(Mutants, OfSymmetricMethodsDoNotReturn) {
  EXPECT_LT(miss_on_the_top<LieGaussEntry<2>>(), test::round_off_of_return);
  EXPECT_GT((miss_on_the_top<WrongGauss2<true, 1'000'000>>()), test::least_asymmetry);
  EXPECT_GT((miss_on_the_top<WrongGauss2<false, 1'000'000>>()), test::least_asymmetry);
  EXPECT_LT((miss_on_the_top<WrongSplitting<true, 1000>>()), test::round_off_of_return) << "it is still symmetric";
  EXPECT_GT((miss_on_the_top<WrongSplitting<false, 1'000'000>>()), test::least_asymmetry);
}

/// Leaves the group by a few units in the last place a step.
struct LeakyCf4 : CommutatorFree4 {
  template <Problem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<LeakyCf4, P>(*this, p, control, policy);
  }
  template <class P, class S, class R, class X>
  void step(P const& p, S const& t, R const& h, X& x, auto& frame, NoMemory& memory) const {
    CommutatorFree4::step(p, t, h, x, frame, memory);
    scale(x.first, R(1 + 4 * std::numeric_limits<double>::epsilon()));
  }
};
template <class Method>
double greatest_defect() {
  auto const problem = erase<double, S3>(FreeBody(Choice{}));
  bench::Plan const plan = test::ten_thousand_steps();
  auto stepper = Method{}.bind(*problem, FixedStep{plan.h()}, NormPolicy::none);
  auto x = problem->initial();
  test::DefectWatch<RigidBody<S3<double>>> watch;
  EXPECT_EQ(bench::RunLoop(*problem, stepper, plan.h(), false).go(x, plan.stops, watch), Status::ok);
  return watch.worst;
}
TEST(Mutants, OfNormKeepersLoseTheNorm) {
  EXPECT_LT(greatest_defect<CommutatorFree4>(), test::round_off_of_norm);
  EXPECT_GT(greatest_defect<LeakyCf4>(), test::round_off_of_norm);
}

}  // namespace
}  // namespace polhode
