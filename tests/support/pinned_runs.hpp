#pragma once
/// Runs of the heavy top for tests, as one body and as a constrained system, and how far they are from a reference.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "integrators/gauss.hpp"
#include "problems/heavy_top.hpp"

namespace polhode::test {

inline HeavyTop heavy_top(std::string const& variant, std::map<std::string, std::vector<double>> const& set = {}) {
  return HeavyTop(Choice{.words = {variant}, .set = set, .step = 0});
}
/// Variant dae in scalar S and attitude space A.
template <class S, template <class> class A>
PinnedField<S, A> pinned_top() {
  return heavy_top("dae").pinned_field<S, A>();
}

/// Steps of h [s] from the problem's start to t_end; watch(t, x, stepper) is called after each.
template <class P, class Method, class Watch>
Status run_pinned(P const& problem, Method const& method, double h, double t_end, Watch const& watch) {
  using R = Real<typename P::Space::Scalar>;
  auto stepper = method.bind(problem, FixedStep{h}, NormPolicy::none);
  auto x = problem.initial();
  for (long i = 0, n = std::lround(t_end / h); i < n; ++i) {
    R const t = R(double(i)) * R(h);
    if (Status const status = stepper.advance(x, t, t + R(h)); status != Status::ok) return status;
    watch(double(t) + h, x, stepper);
  }
  return Status::ok;
}

/// |Phi| [m] and |G u| [m/s].
struct PinnedDefects {
  double position = 0, velocity = 0;
};
template <class P>
PinnedDefects defects_of(P const& problem, Point<typename P::Space> const& x) {
  using S = typename P::Space::Scalar;
  Mat3<S> const R = rotation_of<typename P::Space::Factor::Factor>(x.first.first);
  auto const& body = problem.mechanics();
  return {double(length(body.constraint(R, x.second.first))),
          double(length(body.constraint_rate(R, x.first.second, x.second.second)))};
}
template <class P, class Method>
PinnedDefects greatest_defects(P const& problem, Method const& method, double h, double t_end) {
  PinnedDefects most;
  EXPECT_EQ(run_pinned(problem, method, h, t_end,
                       [&](double, auto const& x, auto const&) {
                         PinnedDefects const now = defects_of(problem, x);
                         most.position = std::max(most.position, now.position);
                         most.velocity = std::max(most.velocity, now.velocity);
                       }),
            Status::ok);
  return most;
}

/// Errors of attitude [rad], rate [rad/s], position [m], velocity [m/s], multiplier [N].
using PinnedErrors = std::array<double, 5>;
inline constexpr std::array pinned_names{"attitude", "rate", "position", "velocity", "multiplier"};

template <class P>
PinnedErrors errors_of(P const& problem, Point<typename P::Space> const& x,
                       Vec3<typename P::Space::Scalar> const& lambda, Point<typename P::Space> const& exact) {
  using S = typename P::Space::Scalar;
  using A = typename P::Space::Factor::Factor;
  Vec3<S> const right = problem.mechanics().multiplier(rotation_of<A>(exact.first.first), exact.first.second);
  return {double(angle_between(A::attitude(x.first.first), A::attitude(exact.first.first))),
          double(length(x.first.second - exact.first.second)), double(length(x.second.first - exact.second.first)),
          double(length(x.second.second - exact.second.second)), double(length(lambda - right))};
}
/// The state at t_end [s] by Gauss collocation of order 8 on the field of index 1, in steps of about 1/4096 s.
template <class P>
Point<typename P::Space> pinned_reference(P const& problem, double t_end) {
  Point<typename P::Space> end = problem.initial();
  double const h = t_end / std::ceil(4096 * t_end);
  EXPECT_EQ(run_pinned(problem, GaussEntry<4>{}, h, t_end, [&](double, auto const& x, auto const&) { end = x; }),
            Status::ok);
  return end;
}

}  // namespace polhode::test
