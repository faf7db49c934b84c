#pragma once
/// SUNDIALS ARKODE's explicit Runge-Kutta module (ERKStep) behind our face, unmodified, at its default controller.
/// Memory is made in bind and lives across advance calls; restart() re-initialises at the next call. double, flat
/// coordinates.   Source: Reynolds et al. (2023), ACM TOMS 49, 16; SUNDIALS 6.4
#include "integrators/rivals/library_field.hpp"
#include "integrators/rivals/sundials.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <arkode/arkode_erkstep.h>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
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
    if (code == ARK_SUCCESS || code == ARK_TSTOP_RETURN) return all_finite(x) ? Status::ok : Status::diverged;
    if (code == ARK_TOO_MUCH_WORK) return Status::max_steps;
    if (code == ARK_ERR_FAILURE || code == ARK_TOO_MUCH_ACC) return Status::step_underflow;
    return Status::diverged;
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
                       "first-same-as-last (its issue 311): order 7 instead of 8"
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

}  // namespace polhode
