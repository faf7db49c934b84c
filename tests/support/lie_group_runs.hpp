#pragma once
/// Problems and runs for tests of methods on groups.
#include <gtest/gtest.h>

#include "integrators/integrator.hpp"
#include "problems/controllers/pd.hpp"
#include "problems/rigid_body.hpp"

namespace polhode::test {

/// Proportional-derivative control under a torque that depends on time: nothing about it is degenerate.
template <Scalar S>
struct ShakenPd {
  using Scalar = S;
  static constexpr bool sampled = false;
  PdController<S> law{Real<S>(4.0), Real<S>(20.0)};
  Vec3<S> torque(S const& t, Quat<S> const& q, Vec3<S> const& omega) const {
    S const two(2.0), ten(10.0), six(6.0);
    return law.torque(t, q, omega) + Vec3<S>{ten * sin(two * t), six * cos(t), six * sin(t)};
  }
};
/// A tumbling tri-axial body under it.
template <Scalar S, template <class> class A>
auto shaken_body() {
  return controlled_body<S, A, true>(BodyParameters{}, ShakenPd<S>{});
}

/// n copies of a body that do not know of each other, each from an attitude and a rate of its own.
template <class P>
struct Swarm {
  using Space = Power<typename P::Space, dynamic>;
  P body;
  int n;

  Point<Space> initial() const {
    Point<Space> x(n);
    for (int i = 0; i < n; ++i) x[i] = start(i);
    return x;
  }
  Point<typename P::Space> start(int i) const {
    auto x = body.initial();
    x.second = (1 + 0.25 * i) * x.second;
    return x;
  }
  template <class S>
  void operator()(S const& t, Point<Space> const& x, Velocity<Space>& v) const {
    for (int i = 0; i < n; ++i) v[i] = body(t, x[i]);
  }
};

/// Where equal steps of h lead from the problem's start at 0 s [s].
template <class Method, class P>
auto state_at(Method const& method, P const& problem, double h, double t_end) {
  auto x = problem.initial();
  EXPECT_EQ(method.bind(problem, FixedStep{h}, NormPolicy::none).advance(x, 0, t_end), Status::ok);
  return x;
}
/// The angle between the attitudes of two states of one body [rad].   A  attitude
template <class A, class X>
double angle_apart(X const& x, X const& y) {
  return double(angle_between(A::attitude(x.first), A::attitude(y.first)));
}
/// The observed order from the errors with h and h / 2.
inline double order_of(double with_h, double with_half) {
  return std::log2(with_h / with_half);
}

/// The tether's control, sampled every 2 s and held, over three samples.
template <class P>
auto tether_after_6_s(auto const& method, P& problem, double h) {
  auto x = problem.initial();
  auto stepper = method.bind(problem, FixedStep{h}, NormPolicy::none);
  for (double t : {0., 2., 4.}) {
    problem.sample(t, x);
    stepper.restart();
    EXPECT_EQ(stepper.advance(x, t, t + 2), Status::ok);
  }
  return x;
}

/// Goes n steps of h forth and back; returns how far from the start it ends.
template <class Method, class P>
double forth_and_back(Method const& method, P const& problem, double h, int n) {
  auto const start = problem.initial();
  auto x = start;
  EXPECT_EQ(method.bind(problem, FixedStep{h}, NormPolicy::none).advance(x, 0, n * h), Status::ok);
  EXPECT_GT(distance<double>(x, start), 0.1);
  EXPECT_EQ(method.bind(problem, FixedStep{-h}, NormPolicy::none).advance(x, n * h, 0), Status::ok);
  return distance<double>(x, start);
}

}  // namespace polhode::test
