#pragma once
/// SUNDIALS ARKODE's Runge-Kutta modules behind our face, unmodified, at their default controller: the explicit one
/// (ERKStep), and the additive one (ARKStep) as a diagonally implicit method. Memory is made in bind and lives across
/// advance calls. double, flat coordinates.   Source: Reynolds et al. (2023), ACM TOMS 49, 16; SUNDIALS 6.4
#include "integrators/rivals/sundials.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>

#include <utility>
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

/// ERKStep's objects and their lifetimes: explicit, the default table of an order.
class ErkMemory {
 public:
  /// Throws std::bad_alloc if the library cannot make its memory.
  ErkMemory(int order, Adaptive control, ARKRhsFn field, SundialsJacobian, void* user, int size)
      : ErkMemory(order, field, user, size) {
    require_made(ERKStepSStolerances(memory_.get(), control.rtol, control.atol));
  }
  ErkMemory(int order, FixedStep control, ARKRhsFn field, SundialsJacobian, void* user, int size)
      : ErkMemory(order, field, user, size) {
    require_made(ERKStepSetFixedStep(memory_.get(), control.h));
    fixed_ = control.h;
  }

  double* state() { return numbers_of(y_); }
  void restart() { fresh_ = true; }

  /// Goes on to t_end, or by one step of ARKODE's choice; t moves.
  Status advance(double& t, double t_end, bool one_step) {
    if (std::exchange(fresh_, false)) {
      counters().add_to(before_);
      ERKStepReInit(memory_.get(), field_, t, y_.get());
      if (fixed_ > 0) ERKStepSetFixedStep(memory_.get(), fixed_);  // the last stop time shortened it
    }
    ERKStepSetStopTime(memory_.get(), t_end);
    return arkode_status(ERKStepEvolve(memory_.get(), t_end, y_.get(), &t, one_step ? ARK_ONE_STEP : ARK_NORMAL));
  }
  Work work() const {
    Work sum = before_;
    counters().add_to(sum);
    return sum;
  }

 private:
  ErkMemory(int order, ARKRhsFn field, void* user, int size)
      : field_(field), y_(make_vector(size, context_)), memory_(ERKStepCreate(field, 0, y_.get(), context_.get())) {
    if (!memory_) throw std::bad_alloc();
    void* const ark = memory_.get();
    require_made(ERKStepSetUserData(ark, user));
    require_made(ERKStepSetOrder(ark, order));
    require_made(ERKStepSetMaxNumSteps(ark, most_trials));
    require_made(ERKStepSetErrFile(ark, nullptr));  // a failure is a status, not a message
  }
  SundialsCounters counters() const {
    SundialsCounters now;
    ERKStepGetNumSteps(memory_.get(), &now.steps);
    ERKStepGetNumErrTestFails(memory_.get(), &now.failures);
    return now;
  }

  ARKRhsFn field_;
  SundialsOwned<SUNContext> context_ = make_sundials_context();  // outlives all that is made in it
  SundialsOwned<N_Vector> y_;
  SundialsMemory<ERKStepFree> memory_;
  double fixed_ = 0;  ///< equal steps of [s]; 0: steps of ARKODE's choice
  bool fresh_ = true;
  Work before_;
};

/// ARKStep's: diagonally implicit, by Newton with a dense Jacobian, null: difference quotients. A restart takes the
/// state over and keeps the step size.
class DirkMemory {
 public:
  /// Throws std::bad_alloc if the library cannot make its memory.
  DirkMemory(ARKODE_DIRKTableID table, Adaptive control, ARKRhsFn field, SundialsJacobian jacobian, void* user,
             int size)
      : DirkMemory(table, field, jacobian, user, size) {
    require_made(ARKStepSStolerances(memory_.get(), control.rtol, control.atol));
  }
  /// Stage equations are solved to round-off: they have no other tolerance to go by.
  DirkMemory(ARKODE_DIRKTableID table, FixedStep control, ARKRhsFn field, SundialsJacobian jacobian, void* user,
             int size)
      : DirkMemory(table, field, jacobian, user, size) {
    constexpr double round_off = 1e-14;
    constexpr int most_iterations = 20;
    require_made(ARKStepSStolerances(memory_.get(), round_off, round_off));
    require_made(ARKStepSetMaxNonlinIters(memory_.get(), most_iterations));
    require_made(ARKStepSetFixedStep(memory_.get(), control.h));
    fixed_ = control.h;
  }

  double* state() { return numbers_of(y_); }
  void restart() {
    if (start_ == Start::none) start_ = Start::here;
  }
  /// A new run: the step size is forgotten, too.
  void begin() { start_ = Start::anew; }

  /// Goes on to t_end, or by one step of ARKODE's choice, which moves t. ARKODE would go on where it no longer does.
  Status advance(double& t, double t_end, bool one_step) {
    start(t);
    ARKStepSetStopTime(memory_.get(), t_end);
    auto const step = [&](double& now) {
      double const before = now;
      Status const status = arkode_status(ARKStepEvolve(memory_.get(), t_end, y_.get(), &now, ARK_ONE_STEP));
      ++tried_;
      return status == Status::ok && now == before ? Status::step_underflow : status;
    };
    return one_step ? step(t) : in_own_steps(t, t_end, step, [&] { return tried_; });
  }
  Work work() const {
    Work sum = before_;
    counters().add_to(sum);
    return sum;
  }

 private:
  enum class Start { none, here, anew };

  DirkMemory(ARKODE_DIRKTableID table, ARKRhsFn field, SundialsJacobian jacobian, void* user, int size)
      : field_(field),
        y_(make_vector(size, context_)),
        memory_(ARKStepCreate(nullptr, field, 0, y_.get(), context_.get())) {
    if (!memory_) throw std::bad_alloc();
    dense_.make(y_, context_);
    void* const ark = memory_.get();
    require_made(ARKStepSetErrFile(ark, nullptr));  // a failure is a status, not a message
    require_made(ARKStepSetUserData(ark, user));
    require_made(ARKStepSetTableNum(ark, table, ARKODE_ERK_NONE));
    require_made(ARKStepSetLinearSolver(ark, dense_.solver.get(), dense_.matrix.get()));
    require_made(ARKStepSetJacFn(ark, jacobian));
  }
  void start(double t) {
    Start const how = std::exchange(start_, Start::none);
    if (how == Start::none) return;
    void* const ark = memory_.get();
    if (how == Start::here) {
      ARKStepReset(ark, t, y_.get());
    } else {
      counters().add_to(before_);
      ARKStepReInit(ark, nullptr, field_, t, y_.get());
    }
    if (fixed_ > 0) ARKStepSetFixedStep(ark, fixed_);  // the last stop time shortened it
  }
  SundialsCounters counters() const {
    SundialsCounters now;
    ARKStepGetNumSteps(memory_.get(), &now.steps);
    ARKStepGetNumErrTestFails(memory_.get(), &now.failures);
    ARKStepGetNumNonlinSolvIters(memory_.get(), &now.iterations.emplace());
    ARKStepGetNumJacEvals(memory_.get(), &now.jacobians.emplace());
    return now;
  }

  ARKRhsFn field_;
  SundialsOwned<SUNContext> context_ = make_sundials_context();  // outlives all that is made in it
  SundialsOwned<N_Vector> y_;
  SundialsDense dense_;
  SundialsMemory<ARKStepFree> memory_;
  double fixed_ = 0;  ///< equal steps of [s]; 0: steps of ARKODE's choice
  Start start_ = Start::anew;
  std::int64_t tried_ = 0;
  Work before_;
};

/// ARKODE from stop to stop; Memory is ErkMemory or DirkMemory.
///
/// fails  with the status of its error code
template <class Memory, Problem P>
class ArkodeStepper {
  using M = typename P::Space;

 public:
  /// kind: the order, or the table.
  template <class Kind, class Control>
  ArkodeStepper(Kind kind, P const& problem, Control control)
      : user_(new SundialsUser<P>{LibraryField<P>(problem)}),
        memory_(kind, control, sundials_field<P>, sundials_jacobian(problem), user_.get(), user_->field.size()) {}

  /// x is read at a restart; between restarts ARKODE's own state goes on.
  Status advance(Point<M>& x, double t, double t_end) { return go(x, t, t_end, false); }
  Status step(Point<M>& x, double& t, double t_end) { return go(x, t, t_end, true); }
  void restart() { memory_.restart(); }
  void begin() requires requires(Memory& memory) { memory.begin(); }
  { memory_.begin(); }
  Work work() const { return memory_.work(); }
  Projections projections() const { return {}; }

 private:
  Status go(Point<M>& x, double& t, double t_end, bool one_step) {
    store(x, memory_.state());
    Status const status = memory_.advance(t, t_end, one_step);
    load(x, memory_.state());
    return status == Status::ok && !all_finite(x) ? Status::diverged : status;
  }

  std::unique_ptr<SundialsUser<P>> user_;
  Memory memory_;
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
  template <LibraryProblem P, class Control>
  auto bind(P const& p, Control control, NormPolicy) const {
    return ArkodeStepper<ErkMemory, P>(order, p, control);
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
  template <LibraryProblem P, class Control>
  auto bind(P const& p, Control control, NormPolicy) const {
    return ArkodeStepper<DirkMemory, P>(ARKODE_ESDIRK547L2SA2_7_4_5, p, control);
  }
#endif
};

}  // namespace polhode
