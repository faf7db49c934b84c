#pragma once
/// The integrators on every space, behind function pointers: the type of a method is forgotten here, once per solve.
#include <cstdint>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "bench/solve/run_loop.hpp"
#include "integrators/catalog/lists.hpp"
#include "integrators/integrator.hpp"
#include "problems/erased.hpp"

namespace polhode::bench {

namespace detail {
template <class... F>
Types<RigidBody<typename F::template On<double>>...> one_body(Types<F...>);
template <class... F>
Types<Attitudes<typename F::template On<double>>...> attitudes(Types<F...>);
template <class... F>
Types<RigidBodies<typename F::template On<double>>...> bodies(Types<F...>);
template <class... F>
Types<Euclidean3<double>, MovingBody<typename F::template On<double>>...> positions(Types<F...>);
}  // namespace detail
/// The spaces that runs live on: one rigid body, many attitudes, many rigid bodies, in their formulations; three
/// numbers alone, and a body that moves in space.
using OneBodySpaces = decltype(detail::one_body(Formulations{}));
using AttitudesSpaces = decltype(detail::attitudes(AttitudesFormulations{}));
using BodiesSpaces = decltype(detail::bodies(BodiesFormulations{}));
using PositionSpaces = decltype(detail::positions(TimedFormulations{}));

/// How a method is driven.
using Control = std::variant<FixedStep, Adaptive>;

/// One run: its stops, its control, its norm policy.
struct Plan {
  std::vector<Stop> stops;
  Control control;
  NormPolicy policy = NormPolicy::none;
  bool locate = false;  ///< steps end on the zeros of the problem's switching functions

  double h() const { return std::holds_alternative<FixedStep>(control) ? std::get<FixedStep>(control).h : 0; }
};

/// What a run did.
struct Outcome {
  Status status = Status::ok;
  std::exception_ptr ended{};  ///< what a watch threw to end it early; the counts are those so far
  Work work;
  Projections projections;
  std::int64_t evaluations = 0;
  Located located;
};

/// Sees every stop and every accepted step of a run on space M. `projections` is what projection has done so far.
template <Space M>
class Watch {
 public:
  static constexpr bool each_step = true;
  virtual ~Watch() = default;
  virtual void at_stop(Stop const& stop, Point<M> const& x) = 0;
  virtual void after_step(double t, Point<M> const& x, Projections const& projections) = 0;
  /// Before after_step, from methods that carry the multiplier of a constraint: its value at the end of the step.
  virtual void multiplier(Vec3<double> const&) {}
};

/// One method bound to one problem: what is timed. Everything is made beforehand; solve() starts anew each time.
class TimedSolve {
 public:
  virtual ~TimedSolve() = default;
  virtual Status solve() = 0;
  /// The state where the last solve ended, components in storage order.
  virtual std::vector<double> end_state() const = 0;
};

/// One integrator on one space.
template <Space M>
struct MethodOn {
  using Solve = Outcome (*)(Erased<M>& problem, Plan const& plan, Watch<M>& watch);
  MethodInfo const* info = nullptr;
  bool fixed = false, adaptive = false;  ///< which controls the method knows, on any space
  std::string_view refusal;              ///< why it does not run on this space; empty if it does
  Solve solve = nullptr;                 ///< null if refused
  using Timed = std::unique_ptr<TimedSolve> (*)(std::unique_ptr<Erased<M>> problem, Plan const& plan);
  Timed timed = nullptr;  ///< null if refused
};

/// One list of the catalogue on space M, in catalogue order.
template <Space M, class Methods>
std::vector<MethodOn<M>> methods_on();

/// The whole catalogue on space M, and behind it what this binary adds: from its catalogue_unit.cpp.
template <Space M>
std::vector<MethodOn<M>> const& all_methods_on();

/// The one of that name. Throws std::out_of_range.
template <Space M>
MethodOn<M> const& method_named(std::string_view name) {
  for (MethodOn<M> const& entry : all_methods_on<M>())
    if (entry.info->name == name) return entry;
  throw std::out_of_range("no integrator " + std::string(name));
}

}  // namespace polhode::bench
