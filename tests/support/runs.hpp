#pragma once
/// Runs of cells for tests: a cell in one line, its record, its history.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bench/cell/cell.hpp"
#include "bench/process/additions.hpp"

namespace polhode::test {

/// One cell; chain what differs:  a_cell("free_body", "s3", "cf4").with_h(0.1).of_variant("free").
struct CellUnderTest {
  results::Cell cell;

  CellUnderTest with_h(double h) const {
    return changed([&](results::Cell& c) { c.h = h; });
  }
  CellUnderTest with_rtol(double rtol) const {
    return changed([&](results::Cell& c) { c.rtol = rtol; });
  }
  CellUnderTest of_variant(std::string const& v) const {
    return changed([&](results::Cell& c) { c.variant = v; });
  }
  CellUnderTest until(double t_end) const {
    return changed([&](results::Cell& c) { c.t_end = t_end; });
  }
  CellUnderTest projected() const {
    return changed([&](results::Cell& c) { c.policy = "project"; });
  }
  CellUnderTest set(std::string const& name, std::vector<double> const& value) const {
    return changed([&](results::Cell& c) { c.set[name] = value; });
  }

  /// Its history at samples, outputs (`every` seconds) and the end, and how it ended.
  bench::Trajectory simulated(double every = 0) const { return bench::simulate(bench::prepare(cell, every)); }
  /// Everything that the harness measures; references are made once per test program.
  bench::Measured measured() const {
    static bench::References references{"no committed references: every one is certified here"};
    return bench::measure(bench::prepare(cell), references, "test", {});
  }

 private:
  template <class Change>
  CellUnderTest changed(Change change) const {
    CellUnderTest copy = *this;
    change(copy.cell);
    return copy;
  }
};

/// A choice on which every method of the catalogue gets through at the problem's `step`. The default of dead_zone jumps
/// and slides: implicit stages have no solution there, and multistep methods no room; that of heavy_top spins through
/// where Euler angles end.
inline std::string calm_variant(std::string_view problem) {
  return problem == "dead_zone" ? "smooth,n4" : problem == "heavy_top" ? "potential" : "";
}

/// The choices on which every method is tried: the problem's calm one, and those under a constraint.
inline std::vector<std::string> calm_choices(bench::ProblemWord const& problem) {
  std::vector<std::string> choices{calm_variant(problem.name)};
  for (auto const& group : problem.variants)
    for (std::string const& word : group)
      if (!word.empty() &&
          bench::problem_named(problem.name).choose({.words = {word}, .set = {}, .step = problem.step})->pinned())
        choices.push_back(word);
  return choices;
}

/// A walk over the catalogues is for this pair: in Polhode's own tests for every one, in those of a binary that adds to
/// the catalogues for pairs with something added. "" stands for any.
inline bool is_walked(std::string_view problem, std::string_view integrator) {
  bench::Additions const& added = bench::additions();
  if (added.integrators.empty() && added.problems.empty()) return true;
  return std::count(added.problems.begin(), added.problems.end(), problem) > 0 ||
         std::count(added.integrators.begin(), added.integrators.end(), integrator) > 0;
}
/// How many of something a walk over the whole catalogue meets at least; nothing is known of what a binary adds.
inline int at_least(int of_all) {
  return is_walked("", "") ? of_all : 0;
}

inline CellUnderTest a_cell(std::string_view problem, std::string_view formulation, std::string_view integrator) {
  CellUnderTest it;
  it.cell.problem = problem;
  it.cell.formulation = formulation;
  it.cell.integrator = integrator;
  return it;
}

/// How long methods on groups are watched, what rounding may do to the norm meanwhile, and the watch.
inline bench::Plan ten_thousand_steps() {
  bench::Schedule schedule;
  schedule.t_end = 1000;
  return {.stops = bench::stops_of(schedule), .control = FixedStep{0.1}};
}
inline constexpr double round_off_of_norm = 1e-13;
/// Greatest defect of the constraint over a run.
template <Space M>
class DefectWatch final : public bench::Watch<M> {
 public:
  double worst = 0;
  std::int64_t steps = 0;
  void at_stop(bench::Stop const&, Point<M> const&) override {}
  void after_step(double, Point<M> const& x, Projections const&) override {
    worst = std::max(worst, double(M::defect(x)));
    ++steps;
  }
};

}  // namespace polhode::test
