#pragma once
/// Runs of library methods for tests: a definition, a control, an end; and references in quadruple precision.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench/solve/run_loop.hpp"
#include "integrators/gauss.hpp"
#include "problems/definition.hpp"
#include "problems/pd_slew.hpp"

namespace polhode::test {

/// From 0 s to t_end, with the definition's samples.
template <class D>
std::vector<bench::Stop> stops_until(D const& definition, double t_end) {
  if (!(definition.sample_period > 0)) return {bench::Stop{.time = 0}, bench::Stop{.time = t_end}};
  std::vector<bench::Stop> stops;
  for (int i = 0; i * definition.sample_period < t_end * (1 + 1e-9); ++i)
    stops.push_back({.time = i * definition.sample_period, .sample = true});
  return stops;
}

/// How a run ended and what it took.
template <Space M>
struct RivalRun {
  Point<M> x;
  Status status = Status::ok;
  Work work{};
  std::int64_t evaluations = 0;
  bench::Located located{};
  Projections projections{};
};

template <class Method, Problem P, class Control>
RivalRun<typename P::Space> run_rival(P& problem, std::vector<bench::Stop> const& stops, Control control,
                                      NormPolicy policy = NormPolicy::none) {
  auto stepper = Method{}.bind(problem, control, policy);
  double h = 0;
  if constexpr (std::same_as<Control, FixedStep>) h = control.h;
  bool locate = true;
  if constexpr (requires { Method::info; }) locate = Method::info.locates_events;
  bench::RunLoop loop(problem, stepper, h, locate);
  RivalRun<typename P::Space> run{.x = problem.initial()};
  run.status = loop.go(run.x, stops, bench::NoWatch{});
  run.work = stepper.work();
  run.located = loop.located();
  run.projections = stepper.projections();
  if constexpr (requires { problem.evaluations(); }) run.evaluations = problem.evaluations();
  return run;
}
/// The same of a definition on quaternions, its type forgotten.
template <class Method, Definition D, class Control>
auto run_rival(D const& definition, double t_end, Control control, NormPolicy policy = NormPolicy::none) {
  auto const problem = erase<double, FlatQuaternion>(definition);
  return run_rival<Method>(*problem, stops_until(definition, t_end), control, policy);
}
/// The state at t_end by 8-stage Gauss in steps of h [s].
template <Definition D>
auto reference_state(D const& definition, double h, double t_end) {
  auto const problem = erase<Quad, FlatQuaternion>(definition);
  auto const run = run_rival<Gauss<8>>(*problem, stops_until(definition, t_end), FixedStep{h});
  EXPECT_EQ(run.status, Status::ok);
  return run.x;
}
/// The greatest angle between attitudes [rad] and difference of rates [rad/s].
template <class S, class T>
double error_of(Pair<Quat<S>, Vec3<S>> const& x, Pair<Quat<T>, Vec3<T>> const& reference) {
  auto const quad = [](auto const& a) { return Quat<Quad>{Quad(a.x), Quad(a.y), Quad(a.z), Quad(a.w)}; };
  Vec3<Quad> const rate{Quad(x.second.x), Quad(x.second.y), Quad(x.second.z)};
  Quad const angle = angle_between(quad(x.first), quad(reference.first));
  return double(max_of(angle, distance<Quad>(rate, reference.second)));
}

/// What 60 s of the slew take in pieces of half a second, restarted at each or not.
struct InPieces {
  Work work;
  std::int64_t evaluations;
};
template <class Method>
InPieces slew_in_pieces(bool restart_at_each) {
  auto const problem = erase<double, FlatQuaternion>(PdSlew(Choice{}));
  auto stepper = Method{}.bind(*problem, Adaptive{1e-8, 1e-10}, NormPolicy::none);
  auto x = problem->initial();
  for (int i = 0; i < 120; ++i) {
    if (restart_at_each) stepper.restart();
    EXPECT_EQ(stepper.advance(x, 0.5 * i, 0.5 * (i + 1)), Status::ok);
  }
  EXPECT_LT(double(angle_between(x.first, Quat<double>{0, 0, 0, 1})), 0.0065) << "at the target";
  return {stepper.work(), problem->evaluations()};
}

/// Stiffer and faster than by default, the scalar part above .7 for 4 s: the order of a high-order method shows before
/// double precision ends.
inline Choice brisk() {
  Choice choice;
  choice.set["k_p"] = {100};
  choice.set["omega0"] = {-0.6, -0.9, 0.3};
  return choice;
}

/// x' = 1 / (1 s - t) [1/s]: no steps lead to 1 s.
struct Pole {
  using Space = Euclidean3<double>;
  Vec3<double> initial() const { return {0, 0, 0}; }
  Vec3<double> operator()(double t, Vec3<double> const&) const { return {1 / (1 - t), 1 / (1 - t), 1 / (1 - t)}; }
};
/// The field is a number until 1 s.
struct EndsInNaN {
  using Space = Euclidean3<double>;
  Vec3<double> initial() const { return {0, 0, 0}; }
  Vec3<double> operator()(double t, Vec3<double> const& x) const {
    double const value = t < 1 ? 1 - x.x : std::nan("");
    return {value, value, value};
  }
};

}  // namespace polhode::test
