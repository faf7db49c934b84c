#pragma once
/// SUNDIALS ARKODE's Runge-Kutta modules behind our face, unmodified, at their default controller: the explicit one
/// (ERKStep), and the additive one (ARKStep) as a diagonally implicit method. Memory is made in bind and lives across
/// advance calls. double, flat coordinates.   Source: Reynolds et al. (2023), ACM TOMS 49, 16; SUNDIALS 6.4
#include "integrators/rivals/jacobian.hpp"
#include "integrators/rivals/sundials.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
/// What ARKODE's return code means.
inline Status arkode_status(int code) {
  switch (code) {
    case ARK_SUCCESS:
    case ARK_TSTOP_RETURN:
      return Status::ok;
    case ARK_TOO_MUCH_WORK:
      return Status::max_steps;
    case ARK_ERR_FAILURE:
    case ARK_TOO_MUCH_ACC:
      return Status::step_underflow;
    case ARK_CONV_FAILURE:
    case ARK_LSETUP_FAIL:
      return Status::nonlinear_fail;
    default:
      return Status::diverged;
  }
}

/// Explicit; restart() re-initialises at the next call.
template <Problem P>
class ErkStepper {
  using M = typename P::Space;

 public:
  ErkStepper(int order, P const& problem, Adaptive control, NormPolicy) : ErkStepper(order, problem) {
    require(ERKStepSStolerances(memory_.get(), control.rtol, control.atol));
  }
  ErkStepper(int order, P const& problem, FixedStep control, NormPolicy) : ErkStepper(order, problem) {
    require(ERKStepSetFixedStep(memory_.get(), control.h));
    fixed_ = control.h;
  }

  /// x is read at a restart; between restarts ARKODE's own state goes on.
  Status advance(Point<M>& x, double t, double t_end) { return go(x, t, t_end, ARK_NORMAL); }
  Status step(Point<M>& x, double& t, double t_end) { return go(x, t, t_end, ARK_ONE_STEP); }
  void restart() { fresh_ = true; }
  Work work() const {
    Work sum = before_;
    add_counters(sum);
    return sum;
  }
  Projections projections() const { return {}; }

 private:
  ErkStepper(int order, P const& problem) : field_(new LibraryField<P>(problem)) {
    y_.reset(N_VNew_Serial(field_->size(), context_.get()));
    if (!y_) throw std::bad_alloc();
    N_VConst(0, y_.get());
    memory_.reset(ERKStepCreate(field, 0, y_.get(), context_.get()));
    if (!memory_) throw std::bad_alloc();
    require(ERKStepSetUserData(memory_.get(), field_.get()));
    require(ERKStepSetOrder(memory_.get(), order));
    require(ERKStepSetMaxNumSteps(memory_.get(), most_steps));
    require(ERKStepSetErrFile(memory_.get(), nullptr));  // a failure is a status, not a message
  }
  static void require(int code) {
    if (code != ARK_SUCCESS) throw std::bad_alloc();
  }
  Status go(Point<M>& x, double& t, double t_end, int task) {
    store(x, N_VGetArrayPointer(y_.get()));
    if (std::exchange(fresh_, false)) {
      add_counters(before_);
      ERKStepReInit(memory_.get(), field, t, y_.get());
      // A re-initialised fixed step was shortened by the last stop time.
      if (fixed_ > 0) ERKStepSetFixedStep(memory_.get(), fixed_);
    }
    ERKStepSetStopTime(memory_.get(), t_end);
    int const code = ERKStepEvolve(memory_.get(), t_end, y_.get(), &t, task);
    load(x, N_VGetArrayPointer(y_.get()));
    Status const status = arkode_status(code);
    return status == Status::ok && !all_finite(x) ? Status::diverged : status;
  }
  void add_counters(Work& sum) const {
    long steps = 0, failures = 0;
    ERKStepGetNumSteps(memory_.get(), &steps);
    ERKStepGetNumErrTestFails(memory_.get(), &failures);
    sum.steps += steps;
    sum.rejected += failures;
  }
  static int field(double t, N_Vector y, N_Vector dydt, void* field) {
    (*static_cast<LibraryField<P> const*>(field))(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
    return 0;
  }

  static constexpr long most_steps = 10'000'000;
  std::unique_ptr<LibraryField<P>> field_;
  SundialsOwned<SUNContext> context_ = make_sundials_context();
  SundialsOwned<N_Vector> y_;
  SundialsMemory<ERKStepFree> memory_;
  double fixed_ = 0;
  bool fresh_ = true;
  Work before_;
};

/// Diagonally implicit, by Newton with a dense Jacobian: the problem's own, or difference quotients. A restart takes x
/// over and keeps the step size.
template <Problem P>
class DirkStepper {
  using M = typename P::Space;

 public:
  DirkStepper(ARKODE_DIRKTableID table, P const& problem, Adaptive control, NormPolicy) : DirkStepper(table, problem) {
    require(ARKStepSStolerances(memory_.get(), control.rtol, control.atol));
  }
  /// Stage equations are solved to round-off: they have no other tolerance to go by.
  DirkStepper(ARKODE_DIRKTableID table, P const& problem, FixedStep control, NormPolicy) : DirkStepper(table, problem) {
    constexpr double round_off = 1e-14;
    constexpr int most_iterations = 20;
    require(ARKStepSStolerances(memory_.get(), round_off, round_off));
    require(ARKStepSetMaxNonlinIters(memory_.get(), most_iterations));
    require(ARKStepSetFixedStep(memory_.get(), control.h));
    fixed_ = control.h;
  }

  /// x is read at a restart; between restarts ARKODE's own state goes on.
  Status advance(Point<M>& x, double t, double t_end) { return go(x, t, t_end, most_steps); }
  Status step(Point<M>& x, double& t, double t_end) { return go(x, t, t_end, 1); }
  void restart() {
    if (start_ == Start::none) start_ = Start::here;
  }
  /// A new run: the step size is forgotten, too.
  void begin() { start_ = Start::anew; }
  Work work() const {
    Work sum = before_;
    add_counters(sum);
    return sum;
  }
  Projections projections() const { return {}; }

 private:
  enum class Start { none, here, anew };

  DirkStepper(ARKODE_DIRKTableID table, P const& problem) : field_(new LibraryField<P>(problem)) {
    int const size = field_->size();
    y_.reset(N_VNew_Serial(size, context_.get()));
    matrix_.reset(SUNDenseMatrix(size, size, context_.get()));
    if (!y_ || !matrix_) throw std::bad_alloc();
    N_VConst(0, y_.get());
    linear_.reset(SUNLinSol_Dense(y_.get(), matrix_.get(), context_.get()));
    memory_.reset(ARKStepCreate(nullptr, field, 0, y_.get(), context_.get()));
    if (!linear_ || !memory_) throw std::bad_alloc();
    void* const ark = memory_.get();
    require(ARKStepSetErrFile(ark, nullptr));  // a failure is a status, not a message
    require(ARKStepSetUserData(ark, field_.get()));
    require(ARKStepSetTableNum(ark, table, ARKODE_ERK_NONE));
    require(ARKStepSetLinearSolver(ark, linear_.get(), matrix_.get()));
    if constexpr (DifferentiableProblem<P>)
      if (problem.has_jacobian()) require(ARKStepSetJacFn(ark, jacobian));
  }
  static void require(int code) {
    if (code != ARK_SUCCESS) throw std::bad_alloc();
  }
  /// At most `steps` towards t_end. ARKODE would go on where a step no longer moves t.
  Status go(Point<M>& x, double& t, double t_end, std::int64_t steps) {
    store(x, N_VGetArrayPointer(y_.get()));
    start(t);
    ARKStepSetStopTime(memory_.get(), t_end);
    Status status = Status::ok;
    for (std::int64_t i = 0; i < steps && t < t_end && status == Status::ok; ++i) {
      double const before = t;
      status = arkode_status(ARKStepEvolve(memory_.get(), t_end, y_.get(), &t, ARK_ONE_STEP));
      if (status == Status::ok && t == before) status = Status::step_underflow;
    }
    load(x, N_VGetArrayPointer(y_.get()));
    if (status != Status::ok) return status;
    if (!all_finite(x)) return Status::diverged;
    return t < t_end && steps > 1 ? Status::max_steps : Status::ok;
  }
  void start(double t) {
    Start const how = std::exchange(start_, Start::none);
    if (how == Start::none) return;
    void* const ark = memory_.get();
    if (how == Start::here) {
      ARKStepReset(ark, t, y_.get());
    } else {
      add_counters(before_);
      ARKStepReInit(ark, nullptr, field, t, y_.get());
    }
    if (fixed_ > 0) ARKStepSetFixedStep(ark, fixed_);  // the last stop time shortened it
  }
  void add_counters(Work& sum) const {
    long steps = 0, failures = 0, iterations = 0, jacobians = 0;
    ARKStepGetNumSteps(memory_.get(), &steps);
    ARKStepGetNumErrTestFails(memory_.get(), &failures);
    ARKStepGetNumNonlinSolvIters(memory_.get(), &iterations);
    ARKStepGetNumJacEvals(memory_.get(), &jacobians);
    sum.steps += steps;
    sum.rejected += failures;
    sum.iterations = sum.iterations.value_or(0) + iterations;
    sum.jacobians = sum.jacobians.value_or(0) + jacobians;
  }
  static int field(double t, N_Vector y, N_Vector dydt, void* field) {
    (*static_cast<LibraryField<P> const*>(field))(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
    return 0;
  }
  static int jacobian(double t, N_Vector y, N_Vector, SUNMatrix matrix, void* field, N_Vector, N_Vector,
                      N_Vector) requires DifferentiableProblem<P> {
    write_jacobian(*static_cast<LibraryField<P> const*>(field), t, N_VGetArrayPointer(y), SUNDenseMatrix_Data(matrix));
    return 0;
  }

  static constexpr std::int64_t most_steps = 10'000'000;
  std::unique_ptr<LibraryField<P>> field_;
  SundialsOwned<SUNContext> context_ = make_sundials_context();
  SundialsOwned<N_Vector> y_;
  SundialsOwned<SUNMatrix> matrix_;
  SundialsOwned<SUNLinearSolver> linear_;
  SundialsMemory<ARKStepFree> memory_;
  double fixed_ = 0;
  Start start_ = Start::anew;
  Work before_;
};
#endif

/// ARKODE's default explicit table of each order: Zonneveld 5(3)4, Cash-Karp 6(4)5, Fehlberg 13(7)8.
template <int order>
struct ArkodeErk {
  static_assert(order == 4 || order == 5 || order == 8);
  static constexpr MethodInfo info{
      .name = order == 4   ? "arkode_erk4"
              : order == 5 ? "arkode_erk5"
                           : "arkode_erk8",
      .family = Family::library,
      .order = order == 8 ? 7 : order,  // as measured with 6.4: see the pitfall
      .needs = Needs::flat,
      .rival = true,
      .source = "SUNDIALS 6.4 ARKODE, ERKStep; Reynolds et al. (2023)",
      .pitfall = order == 8
                     ? "SUNDIALS 6.4 takes the last stage for the next step's first though Fehlberg's table is not "
                       "first-same-as-last (its issue 311): order 7 instead of 8, and an estimate that falls slower "
                       "than the error, which goes as the tolerance to the power 1.1 to 1.5"
                     : "its default safety factors are cautious",
      .no_projection = "ARKODE keeps its own state: projecting it between steps means starting anew",
      .locates_events = false,  // ERKStep finds roots, too, but a new start costs its step control the step size
      .not_built = sundials_not_built};
#ifdef POLHODE_HAS_SUNDIALS
  template <Problem P>
    requires FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, double>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return ErkStepper<P>(order, p, control, policy);
  }
  template <Problem P>
    requires FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, double>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return ErkStepper<P>(order, p, control, policy);
  }
#endif
};

/// ESDIRK5(4)7L[2]SA2, of ARKODE's 12 tables of orders 4 and 5 the one that took fewest evaluations for an error on the
/// slew: its defaults took 1.5 (order 5) and 2.3 times (order 4) as many; on a stiff slew 0.7 and 2.6 times.
struct ArkodeDirk {
  static constexpr MethodInfo info{
      .name = "arkode_dirk",
      .family = Family::library,
      .order = 5,
      .needs = Needs::flat,
      .rival = true,
      .source = "SUNDIALS 6.4 ARKODE, ARKStep, ESDIRK547L2SA2; Kennedy & Carpenter (2019), Appl. Numer. Math. 136, 183",
      .pitfall = "Newton in every stage: pays on stiff problems alone",
      .no_projection = "ARKODE keeps its own state: projecting it between steps means starting anew",
      .not_built = sundials_not_built};
  static constexpr bool uses_jacobian = true;
#ifdef POLHODE_HAS_SUNDIALS
  template <Problem P>
    requires FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, double>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return DirkStepper<P>(ARKODE_ESDIRK547L2SA2_7_4_5, p, control, policy);
  }
  template <Problem P>
    requires FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, double>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return DirkStepper<P>(ARKODE_ESDIRK547L2SA2_7_4_5, p, control, policy);
  }
#endif
};

}  // namespace polhode
