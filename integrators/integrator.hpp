#pragma once
/// What a method is to the rest of the project, and the two drivers that turn a step into a stepper.
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

template <class T, class P>
concept StepperFor = requires(T s, T const c, Point<typename P::Space> x, Real<typename P::Space::Scalar> t) {
  { s.advance(x, t, t) } -> std::same_as<Status>;
  { c.work() } -> std::same_as<Work>;
  { c.projections() } -> std::same_as<Projections>;
  s.restart();
};
template <class I, class P>
concept RunsFixed = Problem<P> && requires(I method, P const& p) {
  { method.bind(p, FixedStep{}, NormPolicy::none) } -> StepperFor<P>;
};
template <class I, class P>
concept RunsAdaptive = Problem<P> && requires(I method, P const& p) {
  { method.bind(p, Adaptive{}, NormPolicy::none) } -> StepperFor<P>;
};
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

/// For methods that remember nothing from step to step.
struct NoMemory {
  void restart() {}
  void fit(auto const&) {}
};

/// The storage F of a step on M: made anew on the stack for a small space, so that it lives in registers; made once, to
/// the length of x, for many bodies.
template <Space M, class F>
struct Workspace {
  explicit Workspace(Point<M> const&) {}
  POLHODE_INLINE F open() {
    F storage;
    return storage;
  }
};
template <PowerSpace M, class F>
struct Workspace<M, F> {
  explicit Workspace(Point<M> const& x) { storage.fit(x); }
  F& open() { return storage; }
  F storage;
};

/// What storage is fitted to: the initial state of many bodies; of one body nothing is asked.
template <Problem P>
Point<typename P::Space> shape_of(P const& problem) {
  if constexpr (PowerSpace<typename P::Space>)
    return problem.initial();
  else
    return {};
}

/// Equal steps. A method supplies, for each space M:
///   Frame<M>                   the storage of one step; fit(x) gives it the length of x (many bodies)
///   Memory<M>                  what survives from step to step, with restart() and fit(x); NoMemory for most
///   step(p, t, h, x, frame, memory)
template <class Method, Problem P>
class Fixed {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  Fixed(Method method, P const& problem, FixedStep control, NormPolicy policy)
      : method_(std::move(method)), problem_(&problem), h_(control.h), policy_(policy), frame_(shape_of(problem)) {
    memory_.fit(shape_of(problem));
  }

  /// Fails with Status::diverged if the state is no longer finite at t_end.
  Status advance(Point<M>& x, R t, R t_end) {
    if (moves_time()) [[unlikely]] {
      Status status = Status::ok;
      while (status == Status::ok && t != t_end) status = relaxed_step(x, t, t_end);
      return status;
    }
    auto const whole = std::int64_t(std::floor(double((t_end - t) / h_) + 1e-9));
    R const rest = t_end - t - R(double(whole)) * h_;
    bool const divides = double(rest / h_) < 1e-9;
    take(x, t, divides ? equal_step(t_end - t, whole) : h_, whole);
    if (!divides) take(x, t + R(double(whole)) * h_, rest, 1);
    return health_of(x);
  }
  /// One step to t_end, however long.
  Status one_step(Point<M>& x, R t, R t_end) {
    if (moves_time()) [[unlikely]]
      take_relaxed(x, t, t_end - t, true);
    else
      take(x, t, t_end - t, 1);
    return health_of(x);
  }
  /// The policy is relaxation: a step of h ends gamma h later.
  bool moves_time() const { return OneFlatQuaternion<M> && policy_ == NormPolicy::relaxation; }
  /// If moves_time(): one step in relaxed time, not beyond t_end. The last before t_end is up to a tenth longer, or
  /// shorter: none is left that is tiny.
  Status relaxed_step(Point<M>& x, R& t, R t_end) {
    R const left = t_end - t;
    bool const lands = double(left / h_) <= relaxed_reach;
    R const moved = take_relaxed(x, t, lands ? left : h_, lands);
    t = lands ? t_end : R(t + moved);
    return health_of(x);
  }
  void restart() {
    memory_.restart();
    unprojected_ = false;
  }
  Work work() const {
    Work work;
    work.steps = steps_;
    if constexpr (requires { memory_.iterations; }) work.iterations = memory_.iterations;
    if constexpr (requires { memory_.jacobians; }) work.jacobians = memory_.jacobians;
    if constexpr (requires { memory_.evaluations; }) work.evaluations = memory_.evaluations;
    return work;
  }
  /// The constraint's multiplier at the end of the last step.
  auto const& multiplier() const requires requires(typename Method::template Memory<M> const& m) { m.multiplier; }
  { return memory_.multiplier; }
  Projections projections() const { return projections_; }

 private:
  /// A plain problem is copied for the length of an advance: g++ 12 then keeps its numbers in registers (RK4: 0.92 of
  /// the time). It is a pure function of (t, x), so nothing that it does to itself could be lost.
  using Field = std::conditional_t<std::is_trivially_copyable_v<P>, P const, P const&>;

  Status health_of(Point<M> const& x) const {
    if (!all_finite(x)) return Status::diverged;
    if constexpr (requires { memory_.unconverged; })
      if (memory_.unconverged) return Status::nonlinear_fail;
    if (unprojected_) return Status::nonlinear_fail;
    return Status::ok;
  }
  /// In double h itself, so that one long advance and many short ones take the same steps to the last bit. A longer
  /// float gets the exact quotient: there a step given as a double is not exact.
  R equal_step(R const& span, std::int64_t n) const {
    if constexpr (std::same_as<R, double>)
      return h_;
    else
      return n > 0 ? span / R(double(n)) : h_;
  }
  POLHODE_INLINE void loop(Point<M>& x, R t, R h, std::int64_t n) {
    steps_ += n;
    if constexpr (PowerSpace<M>) {
      run_steps(*problem_, x, t, h, n, frame_.open(), memory_);
    } else {
      auto frame = frame_.open();
      Point<M> y = x;  // nobody points at y: it lives in registers
      auto memory = memory_;
      Field p = *problem_;
      run_steps(p, y, t, h, n, frame, memory);
      x = y;
      memory_ = memory;
    }
  }
  POLHODE_INLINE void run_steps(P const& p, Point<M>& x, R t, R h, std::int64_t n, auto& frame, auto& memory) {
    for (std::int64_t i = 0; i < n; ++i) {
      method_.step(p, S(t + R(double(i)) * h), h, x, frame, memory);
      if (at_border_ != NormPolicy::none) [[unlikely]]
        projections_.template apply<M>(x, at_border_);
    }
  }
  /// One copy, whatever g++ would make of n = 1.
  [[gnu::flatten, gnu::noinline, gnu::noclone]] void run_flattened(Point<M>& x, R t, R h, std::int64_t n) {
    loop(x, t, h, n);
  }
  void run(Point<M>& x, R t, R h, std::int64_t n) {
    if constexpr (ScalarTraits<S>::flattened && !PowerSpace<M>)
      run_flattened(x, t, h, n);
    else
      loop(x, t, h, n);  // many bodies, long floats, series: inlining everything costs compile time and gains nothing
  }
  /// n steps under every policy but relaxation. What is done beyond projecting is done here, a step at a time: one more
  /// branch in run_steps, and g++ 12 spills so much that RK4 without any policy takes 1.06 to 1.2 times as long.
  void take(Point<M>& x, R t, R h, std::int64_t n) {
    if (at_border_ == policy_) [[likely]]
      return run(x, t, h, n);
    double const part = feedback_part(double(h));
    for (std::int64_t i = 0; i < n; ++i) {
      R const now = t + R(double(i)) * h;
      if constexpr (OneFlatQuaternion<M>)
        if (policy_ == NormPolicy::project_symmetric) {
          take_symmetric(x, now, h);
          continue;
        }
      run(x, now, h, 1);
      if (policy_ == NormPolicy::baumgarte) projections_.template feed_back<M>(x, part);
    }
  }

  // ---- Policies that change the step itself ----

  /// One step from (t, x) in relaxed time: of length h, or ending h later. Returns gamma h. A step that lands is taken
  /// again with the length that ends there but for O(h^(2p-1)): merely forgetting that its time is gamma h, as
  /// Ketcheson's IDT does, would cost an order where every step lands.
  R take_relaxed(Point<M>& x, R const& t, R h, bool lands) {
    if constexpr (OneFlatQuaternion<M>) {
      Point<M> const before = x;
      auto const memory = memory_;
      run(x, t, h, 1);
      R excess = relaxation_less_one<M>(before, x);
      if (lands && excess != R(0.0) && can_relax(excess)) {
        take_back(memory);
        x = before;
        h = h / (R(1.0) + excess);
        run(x, t, h, 1);
        excess = relaxation_less_one<M>(before, x);
      }
      if (!can_relax(excess)) unprojected_ = true;
      projections_.template relax<M>(before, x, excess);
      return h + excess * h;
    } else {
      return h;
    }
  }
  /// One step of project_symmetric: (1 + mu) q is where it begins, q' / (1 - mu) where it ends, |q'| = 1 - mu.
  /// Simplified Newton for mu, whose matrix is 2, until round-off.
  void take_symmetric(Point<M>& x, R const& t, R const& h) {
    Point<M> const before = x;
    auto const memory = memory_;
    S mu(0.0), least(1e300);
    S const rounding(std::same_as<S, double> ? 0x1p-52 : 0x1p-111);
    double raw = 0;
    for (int pass = 0;; ++pass) {
      if (pass > 0) {
        take_back(memory);
        x = before;
        add(x.first, mu, before.first);
      }
      run(x, t, h, 1);
      if (pass == 0) raw = double(M::defect(x));
      S const residual = norm_less_one(x.first) + mu, size = abs_of(residual);
      if (!(rounding < size && size < S(0.5) * least) || pass == 20) {
        if (!(size < S(1e-9))) unprojected_ = true;
        break;
      }
      least = size;
      mu -= S(0.5) * residual;
    }
    UnitQuaternion<S>::project(x.first);  // q' / (1 - mu), to the last bit
    projections_.note(raw, 2 * std::fabs(double(mu)));
  }
  /// The last step never was; what it counted stays counted.
  void take_back(auto const& memory) {
    auto const after = memory_;
    memory_ = memory;
    if constexpr (requires { after.iterations; }) memory_.iterations = after.iterations;
    if constexpr (requires { after.jacobians; }) memory_.jacobians = after.jacobians;
    if constexpr (requires { after.evaluations; }) memory_.evaluations = after.evaluations;
    // Increments that the method itself keeps are those of the step that is taken back.
    if constexpr (requires { after.last_step; }) memory_.last_step = R(0.0);
    --steps_;
  }

  Method method_;
  P const* problem_;
  R h_;
  NormPolicy policy_;
  /// What is done after every step within run_steps.
  NormPolicy at_border_ =
      policy_ == NormPolicy::project || policy_ == NormPolicy::project_multiplier ? policy_ : NormPolicy::none;
  bool unprojected_ = false;  ///< there was no gamma or mu
  Workspace<M, typename Method::template Frame<M>> frame_;
  typename Method::template Memory<M> memory_{};
  Projections projections_;
  std::int64_t steps_ = 0;
};

}  // namespace polhode
