#pragma once
/// Continuous problems in quadruple precision by two unlike methods, for numbers that no method alone should vouch for.
#include <gtest/gtest.h>

#include <array>

#include "integrators/gauss.hpp"
#include "integrators/taylor.hpp"
#include "problems/space.hpp"

namespace polhode::test {

/// The series of Taylor's method: enough terms for 33 digits.
using Series = Jet<Quad, 32>;

/// The state at t_end [s], in equal steps of 8-stage Gauss near h [s].   P over Quad
template <class P>
Point<typename P::Space> by_gauss(P const& problem, double h, double t_end) {
  auto stepper = Gauss<8>{}.bind(problem, FixedStep{h}, NormPolicy::none);
  auto x = problem.initial();
  EXPECT_EQ(stepper.advance(x, 0, t_end), Status::ok);
  return x;
}
/// The components of the state at t_end [s], by power series whose terms fall to 1e-34.   P over Series, one body
template <class P>
auto by_taylor(P const& problem, double t_end) {
  constexpr auto size = std::size_t(Point<typename P::Space>::size);
  std::array<Series, size> start;
  store(problem.initial(), start.data());
  std::vector<Quad> x;
  for (Series const& component : start) x.push_back(component[0]);
  for (Quad t = 0; t < Quad(t_end);) {
    auto const segment = expand<Quad, 32>(problem, x, t, Quad(t_end - t), 1e-34);
    EXPECT_GT(segment.h, 0);
    if (!(segment.h > 0)) break;
    for (std::size_t i = 0; i < size; ++i) x[i] = segment.component[i].at(segment.h);
    t += segment.h;
  }
  return x;
}

}  // namespace polhode::test
