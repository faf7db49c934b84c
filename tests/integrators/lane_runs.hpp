#pragma once
/// Runs of Gauss with its stages in lanes for tests: one body, its reference, what a run took.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>

#include "integrators/gauss.hpp"
#include "integrators/gauss_lanes.hpp"
#include "problems/erased.hpp"
#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"

namespace polhode::test {

/// The field of a definition on flat quaternions, in double.
template <class D>
auto field_of(D const& definition) {
  return definition.template field<double, FlatQuaternion, true>();
}
/// The attitude at t_end by Gauss in quadruple precision.
template <class D>
Quat<Quad> exact_attitude(D const& definition, double t_end) {
  auto const field = definition.template field<Quad, S3, true>();
  auto x = field.initial();
  EXPECT_EQ(Gauss<8>{}.bind(field, FixedStep{0.25}, NormPolicy::none).advance(x, 0, Quad(t_end)), Status::ok);
  return x.first;
}
/// [rad]
inline double error_of(BodyPoint const& x, Quat<Quad> const& exact) {
  return double(angle_between(Quat<Quad>{x.first.x, x.first.y, x.first.z, x.first.w}, exact));
}
/// The state at t_end by a run that must go well.
template <class Method, class Control, class P>
BodyPoint solve(Method const& method, Control control, P& problem, double t_end) {
  BodyPoint x = problem.initial();
  auto stepper = method.bind(std::as_const(problem), control, NormPolicy::none);
  EXPECT_EQ(stepper.advance(x, 0, t_end), Status::ok);
  return x;
}
inline bool same_bits(BodyPoint const& a, BodyPoint const& b) {
  using Bits = std::array<std::uint64_t, sizeof(BodyPoint) / sizeof(double)>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

/// A run with its control: what expect_same_bits compares.
template <class Method, class Control>
struct RunWith {
  Method method;
  Control control;
};
template <class Method, class Control>
RunWith(Method, Control) -> RunWith<Method, Control>;  // clang 16 does not deduce it
/// The measured run goes through virtual calls, a lane at a time; the timed one through the widest registers.
template <class D, class... Run>
void expect_same_bits(D const& definition, double t_end, Run const&... runs) {
  auto const typed = field_of(definition);
  auto const erased = erase_type(typed);
  auto const compare = [&](auto const& run) {
    EXPECT_TRUE(
        same_bits(solve(run.method, run.control, typed, t_end), solve(run.method, run.control, *erased, t_end)));
  };
  (compare(runs), ...);
}

/// Sweeps a step.
template <class Method, class Control, class P>
double sweeps_a_step(Method const& method, Control control, P const& problem, double t_end) {
  auto stepper = method.bind(problem, control, NormPolicy::none);
  BodyPoint x = problem.initial();
  EXPECT_EQ(stepper.advance(x, 0, t_end), Status::ok);
  Work const work = stepper.work();
  return double(work.iterations.value_or(0)) / double(work.steps + work.rejected);
}
/// The state after `samples` samples of a controller, the torque held between them.
template <class P, class Method, class Control>
BodyPoint sampled_run(P problem, Method const& method, Control control, double period, int samples) {
  BodyPoint x = problem.initial();
  auto stepper = method.bind(std::as_const(problem), control, NormPolicy::none);
  for (int i = 0; i < samples; ++i) {
    problem.sample(i * period, x);
    stepper.restart();
    EXPECT_EQ(stepper.advance(x, i * period, (i + 1) * period), Status::ok);
  }
  return x;
}
/// Calls f(field) with problems whose torque is held between samples: one that saturates, one that is quantised.
template <class F>
void for_each_sampled(F f) {
  f(field_of(TetherCapture(Choice{})));
  Choice quantized;
  quantized.words = {"quantized"};
  PdSlew(quantized).with_field<double, FlatQuaternion, true>([&](auto const& field) {
    if constexpr (SampledProblem<std::remove_cvref_t<decltype(field)>>) f(field);
  });
}

}  // namespace polhode::test
