#pragma once
/// Orders of own methods, measured in quadruple precision against certified references. Walks the catalogue's lists: a
/// new method is tested by being listed. One test file a list, so that no unit is slow.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "integrators/gauss.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"
#include "tests/conformance/slopes.hpp"
#include "tests/support/runs.hpp"

namespace polhode::test {

/// What an order is measured on: the stops of its runs and the attitude where they end.
struct OrderRun {
  std::string name;
  std::vector<bench::Stop> stops;
  Quat<Quad> end;
};

/// An order problem: non-principal rates, a torque that depends on the attitude, steps that divide exactly.
struct OrderProblem {
  CellUnderTest cell;
  bench::PreparedCell prepared;
  bench::QuadState end;

  explicit OrderProblem(CellUnderTest const& c, double t_end = 4)  // [s]
      : cell(c.until(t_end)),
        prepared(bench::prepare(cell.with_h(t_end / 8).cell)),
        end(bench::Reference::solve(*prepared.problem, prepared.schedule).at(t_end)) {}

  OrderRun run() const { return {cell.cell.problem, prepared.plan.stops, end.at(0).q}; }
};
/// Sampled every 2 s, so that there is room for steps.
inline OrderProblem const& tether() {
  static OrderProblem const problem(
      a_cell("tether_capture", "s3", "cf4").of_variant("case1").set("sample_period", {2}));
  return problem;
}

/// For methods that know nothing of torques: three unequal moments, rates about all axes.
inline OrderProblem const& free_body() {
  static OrderProblem const problem(a_cell("free_body", "s3", "cf4"));
  return problem;
}
/// Stiffer and faster than by default, with the scalar part above .7 throughout: there methods of high order show it.
/// On the default slew some errors fall faster, by a symmetry of the motion.
inline OrderProblem const& brisk_slew() {
  static OrderProblem const problem(a_cell("pd_slew", "s3", "cf4").set("k_p", {100}).set("omega0", {-0.6, -0.9, 0.3}));
  return problem;
}

/// Torques by the time, beside the brisk slew's: nodes that are wrong do not show where time does not. With these even
/// verner65, whose leading error is small, is near its order at 1/512 s.
template <Scalar S>
struct ShakenLaw {
  using Scalar = S;
  static constexpr bool sampled = false;
  PdController<S> law{Real<S>(100.0), Real<S>(20.0)};
  Vec3<S> torque(S const& t, Quat<S> const& q, Vec3<S> const& omega) const {
    S const phase(1.5), x(60.0), y(-40.0), z(30.0);
    return law.torque(t, q, omega) + Vec3<S>{x * sin(S(t + phase)), y * cos(t), z * sin(t)};
  }
};
struct ShakenSlew : PdSlew {
  using PdSlew::PdSlew;
  template <Scalar S, template <class> class A, bool>
  auto field() const {
    return controlled_body<S, A, true>(BodyParameters{.omega0 = {-0.6, -0.9, 0.3}}, ShakenLaw<S>{});
  }
  template <Scalar S, template <class> class A, bool fast, class F>
  void with_field(F f) const {
    f(field<S, A, fast>());
  }
};
/// What its order is measured against: by Gauss of order 16, steps so short that 30 digits are right (a test compares
/// them with a power series).
inline OrderRun const& shaken_slew() {
  static OrderRun const run = [] {
    auto const problem = erase<Quad, FlatQuaternion>(ShakenSlew(Choice{}));
    auto x = problem->initial();
    EXPECT_EQ(Gauss<8>{}.bind(*problem, FixedStep{1. / 64}, NormPolicy::none).advance(x, 0, 4), Status::ok);
    return OrderRun{.name = "shaken slew", .stops = {{.time = 0}, {.time = 4}}, .end = x.first};
  }();
  return run;
}

/// Steps [s] from coarse to fine, as far as a method of this order needs them to be asymptotic; all divide 2 s.
inline std::vector<double> order_steps(int order) {
  std::vector<double> steps;
  if (order >= 12)  // in quadruple precision there is room for few
    for (double const m : {1., 2., 3., 4., 5., 6., 8., 10., 12., 16.}) steps.push_back(2 / m);
  else
    for (int k = order <= 5 ? -7 : -1, last = order == 1   ? -11
                                              : order <= 4 ? -9
                                              : order <= 7 ? -10
                                                           : -8;
         k >= last; --k)
      steps.push_back(std::ldexp(1, k));
  return steps;
}

/// The attitude of the one body of a state.
template <class A, class X>
Quat<Quad> attitude_of(X const& x) {
  if constexpr (requires { x.first.first; })
    return A::attitude(x.first.first);
  else
    return A::attitude(x.first);
}

/// The order of Method on the field of `definition`, from the three finest steps whose error is far above round-off;
/// null if there are fewer. Asserts nothing of the order: see expect_order().
template <class Method, template <class> class A, Definition D>
std::optional<double> measured_order(D const& definition, OrderRun const& run) {
  std::vector<OrderPoint> points;
  with_field<Quad, A>(definition, [&](auto typed) {
    using M = typename decltype(typed)::Space;
    auto const field = erase_type(std::move(typed));
    if constexpr (RunsFixed<Method, Erased<M>>)
      for (double const h : order_steps(Method::info.order)) {
        auto stepper = Method{}.bind(*field, FixedStep{h}, NormPolicy::none);
        auto x = field->initial();
        if (bench::RunLoop(*field, stepper, h, true).go(x, run.stops, bench::NoWatch{}) != Status::ok) {
          ADD_FAILURE() << Method::info.name << " fails at h = " << h;
          return;
        }
        double const error = double(angle_between(attitude_of<A<Quad>>(x), run.end));
        if (error < 1e-29) break;
        points.push_back({std::log(h), std::log(error)});
      }
  });
  if (points.size() < 3) return {};
  points.erase(points.begin(), points.end() - 3);
  return slope_of(points);
}
/// How far a measured order may be from the claim. Above 12 quadruple precision ends after less than a decade of steps.
constexpr double order_tolerance(int order) {
  return order <= 5 ? 0.1 : order <= 12 ? 0.2 : 0.5;
}
template <class Method, template <class> class A, Definition D>
void expect_order(D const& definition, OrderRun const& run, std::string_view formulation) {
  auto const& info = Method::info;
  auto const order = measured_order<Method, A>(definition, run);
  ASSERT_TRUE(order) << info.name << " as " << formulation << ": no order to see";
  EXPECT_NEAR(*order, info.order, order_tolerance(info.order))
      << info.name << " on " << run.name << " as " << formulation;
}

/// Calls f(method, formulation) for each method with an order and each formulation of one body that it suits.
template <class F, class... Method>
void for_each_order(F f, Types<Method...>) {
  auto const on_formulation = [&]<class Formulation>(Formulation formulation) {
    auto const one = [&]<class M>(M method) {
      using Space = RigidBody<typename Formulation::template On<Quad>>;
      // Angles end where a brisk motion takes them; taylor has no series of series.
      constexpr bool calm = M::info.order <= 5 || !std::same_as<Formulation, polhode::Formulation<EulerAngles>>;
      if constexpr (calm && M::info.order > 0 && refusal<Space>(M::info.needs).empty() && RunsFixed<M, Erased<Space>>)
        f(method, formulation);
    };
    (one(Method{}), ...);
  };
  [&]<class... Formulation>(Types<Formulation...>) { (on_formulation(Formulation{}), ...); }(Formulations{});
}

/// The orders of a list on the shaken slew and on the tether; how many were measured.
template <class List>
int expect_orders(List list) {
  Choice choice;
  choice.set["sample_period"] = {2};
  int checked = 0;
  for_each_order(
      [&]<class Method, class F>(Method, F) {
        ++checked;
        if (Method::info.needs == Needs::free_body)
          return expect_order<Method, F::template On>(FreeBody(Choice{}), free_body().run(), F::name);
        expect_order<Method, F::template On>(ShakenSlew(Choice{}), shaken_slew(), F::name);
        expect_order<Method, F::template On>(TetherCapture(choice), tether().run(), F::name);
      },
      list);
  return checked;
}

}  // namespace polhode::test
