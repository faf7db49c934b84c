#pragma once
/// What a method is to the rest of the project: facts, and steppers. integrator.hpp has the driver of equal steps.
///
/// An integrator is a type with the facts `info` and `bind(problem, control, policy)`, which returns a stepper:
///   advance(x, t, t_end) -> Status   moves the state from t to t_end [s]; allocates nothing
///   restart()                        the field has jumped or x was changed from outside: forget history
///   begin()                          if there: a new run, forget the step size, too; otherwise restart() says it all
///   work()                           counts since bind
/// Methods of equal steps have one_step(x, t, t_end), too: a step of any length, to events and from them. Where the
/// norm policy is relaxation, moves_time() is true, and steps are not equal in time: relaxed_step(x, t, t_end) takes
/// one, t moves.
/// Methods that choose their own steps also have step(x, t, t_end): one accepted step, t moves.
/// Those whose steps depend on where it all ends have set_horizon(t, t_end): a smooth arc begins.
/// Libraries that find the zeros of switching functions themselves have find_roots() (do, from now on) and roots(): the
/// functions on whose zero the last step ended.
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "integrators/norm_policy.hpp"
#include "problems/problem.hpp"

namespace polhode {

/// How an advance ended.
enum class Status { ok, diverged, step_underflow, max_steps, nonlinear_fail };

/// Equal steps of h seconds; the last one before t_end is shortened if h does not divide.
struct FixedStep {
  double h;
};
/// Steps chosen by the method so that the local error stays below atol + rtol |y|, by component.
struct Adaptive {
  double rtol, atol;
};

/// Deterministic counts: equal on every machine.
struct Work {
  std::int64_t steps = 0;  ///< accepted
  std::int64_t rejected = 0;
  std::optional<std::int64_t> iterations;  ///< sweeps of a fixed point, or nonlinear iterations; null if explicit
  std::optional<std::int64_t> jacobians;   ///< null for methods that use none
  std::int64_t evaluations = 0;            ///< of forces, by methods that do not call the field
};

/// What kind of method it is: how lists and the report group them.
enum class Family { explicit_rk, gauss, lie_group, rigid_body, splitting, exact, taylor, library };

/// What a method asks of a problem or its space. Refusals are rows, with this as their reason.
enum class Needs {
  none,
  flat,
  quaternion,  ///< one body on flat quaternions
  group,
  free_body,         ///< a rigid body without torque
  rigid_body,        ///< a rigid body whose inertia is known
  prescribed_rates,  ///< an attitude whose rate depends on time alone
  constraint,
  constraint_on_group,
  constraint_on_quaternion  ///< one body on flat quaternions, whose norm is a constraint, alone or with others
};

/// What a method keeps to round-off or boundedly; a claim that the tests measure. Combine with |.
enum Preserves : unsigned {
  keeps_nothing = 0,
  keeps_norm = 1,
  keeps_energy = 2,
  keeps_momentum = 4,            ///< the length of the angular momentum
  keeps_momentum_direction = 8,  ///< its direction in space
  is_symplectic = 16,
  is_symmetric = 32
};

/// The facts of a method. `order` is that of fixed steps, 0 if there is none.
struct MethodInfo {
  std::string_view name;
  Family family;
  int order = 0;
  Needs needs = Needs::none;
  unsigned preserves = keeps_nothing;
  bool rival = false;
  std::string_view source;
  std::string_view pitfall = "";
  std::string_view no_projection = "";  ///< why policies `project` and `project_multiplier` are refused
  std::string_view no_feedback = "";    ///< why policy `baumgarte` is refused, of own methods
  std::string_view no_relaxation = "";  ///< why `relaxation` and `project_symmetric`, which change steps, are refused
  bool projects_natively = false;       ///< knows policy `native`
  bool locates_events = true;           ///< by taking a step again, shorter, or by root finding of its own
  std::string_view not_built = "";      ///< why this binary refuses it
};

/// What bind() returns, bound to problem P: see the top of this file. work() and projections() count since bind.
template <class T, class P>
concept StepperFor = requires(T s, T const c, Point<typename P::Space> x, Real<typename P::Space::Scalar> t) {
  { s.advance(x, t, t) } -> std::same_as<Status>;
  { c.work() } -> std::same_as<Work>;
  { c.projections() } -> std::same_as<Projections>;
  s.restart();
};
/// A method that takes equal steps on problem P.
template <class I, class P>
concept RunsFixed = Problem<P> && requires(I method, P const& p) {
  { method.bind(p, FixedStep{}, NormPolicy::none) } -> StepperFor<P>;
};
/// A method that chooses its steps on problem P.
template <class I, class P>
concept RunsAdaptive = Problem<P> && requires(I method, P const& p) {
  { method.bind(p, Adaptive{}, NormPolicy::none) } -> StepperFor<P>;
};
/// A method for problem P: `info` and bind(), for equal steps, its own, or both. A complete one, by its tableau and
/// with a step of its own, is tests/consumer/heun.hpp; integrators/README.md goes through it.
template <class I, class P>
concept IntegratorFor = RunsFixed<I, P> || RunsAdaptive<I, P>;

/// The attitude, body rate, position and velocity of one body: where constrained problems live.
template <class M>
inline constexpr bool is_moving_body = false;
template <Attitude A>
inline constexpr bool is_moving_body<MovingBody<A>> = true;

/// One rigid body whose attitude is a quaternion or a matrix, held by nobody or by the group.
template <class M>
concept TurningBody = SmallSpace<M> &&
    (std::same_as<Point<M>, Pair<Quat<typename M::Scalar>, Vec3<typename M::Scalar>>> ||
     std::same_as<Point<M>, Pair<Mat3<typename M::Scalar>, Vec3<typename M::Scalar>>>);

/// Attitudes alone, of one body or many.
template <class M>
inline constexpr bool is_attitudes = false;
template <Attitude A, int n>
inline constexpr bool is_attitudes<Power<A, n>> = true;

/// Why a method cannot run on a space; empty if it can.
template <class M>
constexpr std::string_view refusal(Needs needs) {
  if (needs == Needs::constraint || needs == Needs::constraint_on_group) {
    if (!is_moving_body<M>) return "needs a constrained problem (heavy_top, variant dae)";
    return needs == Needs::constraint ? "" : refusal<M>(Needs::group);
  }
  if (needs == Needs::constraint_on_quaternion && std::same_as<M, MovingBody<FlatQuaternion<typename M::Scalar>>>)
    return "";
  if ((needs == Needs::free_body || needs == Needs::rigid_body) && !TurningBody<M>)
    return "needs one rigid body on quaternions or matrices";
  if (needs == Needs::prescribed_rates) {
    if (!is_attitudes<M>) return "needs an attitude under prescribed rates (problem coning)";
    return refusal<M>(Needs::group);
  }
  if ((needs == Needs::quaternion || needs == Needs::constraint_on_quaternion) &&
      !std::same_as<M, RigidBody<FlatQuaternion<typename M::Scalar>>>)
    return "needs one body on flat quaternions (formulation quaternion)";
  if (needs == Needs::flat && !M::flat) return "needs flat coordinates";
  if (needs == Needs::group && M::flat) return "needs a rotation group (formulation s3 or so3)";
  return "";
}

/// From t to t_end by equal steps of h: calls run(t, h, n) for n of them, and again for what is left if h does not
/// divide. In double h itself, so that one long advance and many short ones take the same steps to the last bit; a
/// longer float gets the exact quotient: there a step given as a double is not exact.
template <class R, class Run>
POLHODE_INLINE void in_equal_steps(R const& t, R const& t_end, R const& h, Run const& run) {
  R const span = t_end - t;
  auto const whole = std::int64_t(std::floor(double(span / h) + 1e-9));
  R const rest = span - R(double(whole)) * h;
  bool const divides = double(rest / h) < 1e-9, is_exact = std::same_as<R, double> || whole == 0;
  run(t, divides && !is_exact ? R(span / R(double(whole))) : h, whole);
  if (!divides) run(R(t + R(double(whole)) * h), rest, std::int64_t(1));
}

/// More trial steps than this, between two stops, are no solve: Status::max_steps.
inline constexpr std::int64_t most_trials = 10'000'000;

/// From t to t_end by steps of the method's own choosing.
///   step(t)   one accepted step, or its failure; t moves
///   trials()  how many it has tried so far
template <class R, class Step, class Trials>
POLHODE_INLINE Status in_own_steps(R t, R const& t_end, Step&& step, Trials&& trials) {
  for (std::int64_t const before = trials(); t < t_end;) {
    if (Status const status = step(t); status != Status::ok) return status;
    if (trials() - before > most_trials) return Status::max_steps;
  }
  return Status::ok;
}

}  // namespace polhode
