#pragma once
/// Runs of swarms in equal steps for tests, with events found by plain bisection: independent of
/// integrators/events.hpp.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "bench/process/allocations.hpp"
#include "integrators/gauss.hpp"
#include "problems/definition.hpp"
#include "tests/support/complaint.hpp"

namespace polhode::test {

/// Where a run ended, and the events on the way.
template <class P>
struct SwarmRun {
  Point<typename P::Space> x;
  std::vector<double> events;  ///< [s], one entry for every function that crossed
  Status status = Status::ok;
};

/// From x (by default the problem's own start) at 0 s to t_end in steps of h [s], each event ending a step; in step
/// with the grid again after it.   watch(t, x)  called at every grid point, the start included
template <class P, class Method, class Watch>
SwarmRun<P> run_swarm(P problem, Method const& method, double h, double t_end, Point<typename P::Space> x,
                      Watch const& watch) {
  SwarmRun<P> run{.x = x, .events = {}};
  auto stepper = method.bind(problem, FixedStep{h}, NormPolicy::none);
  std::vector<double> g(std::size_t(problem.state_events()));
  std::vector<bool> side(g.size());
  auto const look = [&](double t, auto const& at) { problem.event_values(t, at, std::span(g)); };
  auto const crossed = [&](std::size_t k) { return (g[k] < 0) != side[k]; };
  auto const any = [&] {
    for (std::size_t k = 0; k < g.size(); ++k)
      if (crossed(k)) return true;
    return false;
  };
  auto const take_sides = [&](double t) {
    if (g.empty()) return;
    problem.take_sides(t, run.x);
    look(t, run.x);
    for (std::size_t k = 0; k < g.size(); ++k) side[k] = g[k] < 0;
  };
  auto const settle = [&]([[maybe_unused]] double t) {
    if constexpr (Settling<typename P::Space>)
      if (P::Space::settle(run.x)) {
        stepper.restart();
        take_sides(t);
      }
  };
  take_sides(0);
  double t = 0;
  watch(t, run.x);
  for (int i = 1; i <= std::lround(t_end / h); ++i) {
    double const next = i * h;
    while (t < next) {
      auto const before = run.x;
      auto const from_t_to = [&](double end) {
        run.x = before;
        if (!g.empty()) stepper.restart();
        run.status = stepper.advance(run.x, t, end);
        look(end, run.x);
      };
      from_t_to(next);
      if (run.status != Status::ok) return run;
      if (!any()) {
        t = next;
        settle(t);
        break;
      }
      double low = t, high = next;
      while (high - low > 4e-16 * (1 + high)) {
        double const middle = (low + high) / 2;
        if (middle <= low || high <= middle) break;
        from_t_to(middle);
        (any() ? high : low) = middle;
      }
      from_t_to(high);
      for (std::size_t k = 0; k < g.size(); ++k)
        if (crossed(k) || std::fabs(g[k]) < 1e-12) {
          problem.cross(int(k));
          side[k] = !side[k];
          run.events.push_back(high);
        }
      t = high;
      settle(t);
    }
    watch(t, run.x);
  }
  return run;
}
template <class P, class Method>
SwarmRun<P> run_swarm(P const& problem, Method const& method, double h, double t_end) {
  return run_swarm(problem, method, h, t_end, problem.initial(), [](double, auto const&) {});
}

/// The columns of a run at every grid point, as `simulate` would print them.
template <class P, class Method>
History history_of(P const& problem, std::vector<Column> const& columns, Method const& method, double h, double t_end) {
  History history;
  for (Column const& column : columns) history.columns.push_back(column.name);
  run_swarm(problem, method, h, t_end, problem.initial(), [&](double t, auto const& x) {
    std::vector<double> row(columns.size(), std::nan(""));
    problem.show(x, row);
    history.times.push_back(t);
    history.rows.push_back(row);
  });
  return history;
}

template <class D>
std::map<std::string, ClaimResult> claims_of(D const& definition, History const& history) {
  std::map<std::string, ClaimResult> claims;
  for (ClaimResult const& claim : definition.claims(history)) claims[claim.name] = claim;
  return claims;
}
template <class D>
std::map<std::string, double> columns_of(D const& definition, auto const& problem, auto const& x) {
  std::vector<double> row(definition.columns().size(), std::nan(""));
  problem.show(x, row);
  std::map<std::string, double> values;
  for (std::size_t i = 0; i < row.size(); ++i) values[definition.columns()[i].name] = row[i];
  return values;
}
/// What a definition says against a choice; empty if it can be.
template <class D>
std::string complaint(Choice const& choice) {
  return complaint_of<ParameterError>([&] { D const definition(choice); });
}

/// The field of five craft, its events and its columns allocate nothing.   functions  switching functions, columns
template <int functions, int columns, class P>
void expect_no_allocations(P field) {
  auto const x = field.initial();
  Velocity<typename P::Space> v(5);
  std::array<double, functions> g{};
  std::array<double, columns> shown{};
  auto const before = bench::allocations_of_this_thread();
  field(0, x, v);
  field.take_sides(0, x);
  field.event_values(0, x, g);
  field.cross(2);
  field(0, x, v);
  field.show(x, shown);
  EXPECT_EQ(bench::allocations_of_this_thread() - before, 0);
  EXPECT_TRUE(all_finite(v));
}

}  // namespace polhode::test
