#pragma once
/// SUNDIALS CVODE behind our face, unmodified. Memory is made in bind and lives across advance calls; restart()
/// re-initialises at the next call. double, flat coordinates; rtol, atol per component.
/// Adams runs with fixed-point iteration, BDF with Newton and a dense Jacobian, the problem's own or difference
/// quotients: CVODE's guide, ch. 4. Source: Hindmarsh et al. (2005), ACM TOMS 31, 363; SUNDIALS 6.4
#include "integrators/rivals/sundials.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <cvode/cvode.h>
#include <cvode/cvode_proj.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <span>
#include <vector>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
/// Everything that does not know the problem: CVODE's objects and their lifetimes.
class CvodeMemory {
 public:
  /// multistep is CV_ADAMS or CV_BDF; the Jacobian is for Newton's iteration of BDF, null: difference quotients. Throws
  /// std::bad_alloc if the library cannot make its memory.
  CvodeMemory(int multistep, Adaptive control, CVRhsFn field, CVLsJacFn jacobian, void* user, int size)
      : y_(make_vector(size, context_)), memory_(CVodeCreate(multistep, context_.get())) {
    if (!memory_) throw std::bad_alloc();
    void* const cvode = memory_.get();
    require_made(CVodeInit(cvode, field, 0, y_.get()));
    require_made(CVodeSStolerances(cvode, control.rtol, control.atol));
    require_made(CVodeSetUserData(cvode, user));
    require_made(CVodeSetMaxNumSteps(cvode, most_trials));
    require_made(CVodeSetErrFile(cvode, nullptr));  // a failure is a status, not a message
    if (multistep == CV_ADAMS) {
      fixed_point_.reset(SUNNonlinSol_FixedPoint(y_.get(), 0, context_.get()));
      require_made(CVodeSetNonlinearSolver(cvode, fixed_point_.get()));
    } else {
      dense_.make(y_, context_);
      require_made(CVodeSetLinearSolver(cvode, dense_.solver.get(), dense_.matrix.get()));
      require_made(CVodeSetJacFn(cvode, jacobian));
    }
  }

  /// From now on steps end on the zeros of `count` functions. Throws std::bad_alloc.
  void find_roots(int count, CVRootFn functions) {
    found_.assign(std::size_t(count), 0);
    roots_.reserve(std::size_t(count));
    require_made(CVodeRootInit(memory_.get(), count, functions));
    CVodeSetNoInactiveRootWarn(memory_.get());
  }
  std::vector<int> const& roots() const { return roots_; }

  /// CVODE's own projection, for BDF: called after every step. Throws std::bad_alloc.
  void project_with(CVProjFn project) { require_made(CVodeSetProjFn(memory_.get(), project)); }
  double* state() { return numbers_of(y_); }
  void restart() { fresh_ = true; }

  /// Goes on to t_end, or by one step of CVODE's choice; t moves.
  Status advance(double& t, double t_end, int task) {
    if (std::exchange(fresh_, false)) {
      counters().add_to(before_);
      CVodeReInit(memory_.get(), t, y_.get());
    }
    CVodeSetStopTime(memory_.get(), t_end);
    roots_.clear();
    switch (CVode(memory_.get(), t_end, y_.get(), &t, task)) {
      case CV_SUCCESS:
      case CV_TSTOP_RETURN:
        return Status::ok;
      case CV_ROOT_RETURN:
        CVodeGetRootInfo(memory_.get(), found_.data());
        for (std::size_t k = 0; k < found_.size(); ++k)
          if (found_[k] != 0) roots_.push_back(int(k));
        return Status::ok;
      case CV_TOO_MUCH_WORK:
        return Status::max_steps;
      case CV_CONV_FAILURE:
        return Status::nonlinear_fail;
      case CV_ERR_FAILURE:
      case CV_TOO_MUCH_ACC:
        return Status::step_underflow;
      default:
        return Status::diverged;
    }
  }
  Work work() const {
    Work sum = before_;
    counters().add_to(sum);
    return sum;
  }

 private:
  SundialsCounters counters() const {
    SundialsCounters now;
    CVodeGetNumSteps(memory_.get(), &now.steps);
    CVodeGetNumErrTestFails(memory_.get(), &now.failures);
    CVodeGetNumNonlinSolvIters(memory_.get(), &now.iterations.emplace());
    if (dense_.solver) CVodeGetNumJacEvals(memory_.get(), &now.jacobians.emplace());
    return now;
  }

  SundialsOwned<SUNContext> context_ = make_sundials_context();  // outlives all that is made in it
  SundialsOwned<N_Vector> y_;
  SundialsDense dense_;                            ///< of BDF
  SundialsOwned<SUNNonlinearSolver> fixed_point_;  ///< of Adams
  SundialsMemory<CVodeFree> memory_;
  bool fresh_ = true;
  std::vector<int> found_, roots_;  ///< CVODE's flags; the functions that are zero now
  Work before_;
};

/// CVODE from stop to stop, on any problem of flat coordinates.
///
/// fails  with the status of its error code
template <Problem P>
class CvodeStepper {
  using M = typename P::Space;

 public:
  CvodeStepper(int multistep, P const& problem, Adaptive control, NormPolicy policy)
      : user_(new SundialsUser<P>{LibraryField<P>(problem)}),
        memory_(multistep, control, sundials_field<P>, sundials_jacobian(problem), user_.get(), user_->field.size()) {
    if (policy == NormPolicy::native) memory_.project_with(project);
  }

  /// x is read at a restart; between restarts CVODE's own state and history go on.
  Status advance(Point<M>& x, double t, double t_end) { return go(x, t, t_end, CV_NORMAL); }
  Status step(Point<M>& x, double& t, double t_end) { return go(x, t, t_end, CV_ONE_STEP); }
  void restart() { memory_.restart(); }
  Work work() const { return memory_.work(); }
  Projections projections() const { return user_->projections; }

  /// CVODE's own root finding: a step ends on the zero of a switching function.
  void find_roots() requires SwitchingProblem<P> {
    memory_.find_roots(user_->field.problem().state_events(), switching_functions);
  }
  std::vector<int> const& roots() const requires SwitchingProblem<P> { return memory_.roots(); }

 private:
  Status go(Point<M>& x, double& t, double t_end, int task) {
    store(x, memory_.state());
    Status const status = memory_.advance(t, t_end, task);
    load(x, memory_.state());
    return status == Status::ok && !all_finite(x) ? Status::diverged : status;
  }
  static int switching_functions(double t, N_Vector y, double* values, void* user) requires SwitchingProblem<P> {
    static_cast<SundialsUser<P> const*>(user)->field.event_values(t, N_VGetArrayPointer(y), values);
    return 0;
  }
  /// correction = projected y - y. The error estimate is left as it is: projecting it, too, made the attitude error up
  /// to 14 times worse at equal tolerance.
  static int project(double, N_Vector y, N_Vector correction, double, N_Vector, void* user) {
    auto& u = *static_cast<SundialsUser<P>*>(user);
    N_VScale(1, y, correction);
    u.field.change(N_VGetArrayPointer(correction), [&](Point<M>& x) {
      double const defect = M::defect(x);
      u.projections.note(defect, M::project(x));
    });
    N_VLinearSum(1, correction, -1, y, correction);
    return 0;
  }

  std::unique_ptr<SundialsUser<P>> user_;
  CvodeMemory memory_;
};
#endif

/// The two multistep families differ in one number.
template <bool stiff>
struct Cvode {
  static constexpr MethodInfo info{
      .name = stiff ? "cvode_bdf" : "cvode_adams",
      .family = Family::library,
      .needs = Needs::flat,
      .rival = true,
      .source = "SUNDIALS 6.4 CVODE; Hindmarsh et al. (2005)",
      .pitfall = "a multistep history is lost at every sample: each restarts at order 1",
      .no_projection = "projection would break the multistep history that the next step extrapolates",
      .projects_natively = stiff,  // CVodeSetProjFn knows BDF alone
      .not_built = sundials_not_built};
  static constexpr bool uses_jacobian = stiff;
#ifdef POLHODE_HAS_SUNDIALS
  template <LibraryProblem P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return CvodeStepper<P>(stiff ? CV_BDF : CV_ADAMS, p, control, policy);
  }
#endif
};

}  // namespace polhode
