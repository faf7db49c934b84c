#pragma once
/// SUNDIALS IDA behind our face, unmodified: variable-order BDF for implicit differential-algebraic equations. Memory
/// is made in bind and lives across advance calls; restart() re-initialises at the next call, from consistent values.
/// double, flat quaternions.
///
/// One body is handed over with the norm of its quaternion as a constraint, a constrained one with its own besides, in
/// the stabilised form of index 2 (ida_systems.hpp).
///
/// rtol, atol per component; multipliers are left out of the error test, as IDA's guide advises for index 2. Dense
/// Jacobian: the problem's own, from dual numbers, or difference quotients.
///
/// Source: Gear, Leimkuhler & Gupta (1985), J. Comput. Appl. Math. 12, 77 (the form); Hindmarsh et al. (2005), ACM TOMS
/// 31, 363; SUNDIALS 6.4
#include "integrators/rivals/ida_systems.hpp"
#include "integrators/rivals/sundials.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <ida/ida.h>

#include <utility>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
/// Everything that does not know the equations: IDA's objects and their lifetimes.
class IdaMemory {
 public:
  /// The first `differential` of `size` unknowns have derivatives in the equations; jacobian null: difference
  /// quotients. Throws std::bad_alloc if the library cannot make its memory.
  IdaMemory(IDAEwtFn weights, IDAResFn residual, IDALsJacFn jacobian, void* user, int size, int differential)
      : y_(make_vector(size, context_)), rate_(make_vector(size, context_)), memory_(IDACreate(context_.get())) {
    if (!memory_) throw std::bad_alloc();
    auto const kinds = make_vector(size, context_);
    std::fill_n(numbers_of(kinds), differential, 1.0);
    dense_.make(y_, context_);
    void* const ida = memory_.get();
    require_made(IDASetErrFile(ida, nullptr));  // a failure is a status, not a message
    require_made(IDAInit(ida, residual, 0, y_.get(), rate_.get()));
    require_made(IDAWFtolerances(ida, weights));
    require_made(IDASetUserData(ida, user));
    require_made(IDASetMaxNumSteps(ida, most_trials));
    require_made(IDASetId(ida, kinds.get()));
    require_made(IDASetSuppressAlg(ida, SUNTRUE));
    require_made(IDASetLinearSolver(ida, dense_.solver.get(), dense_.matrix.get()));
    require_made(IDASetJacFn(ida, jacobian));
  }

  double* state() { return numbers_of(y_); }
  double const* state() const { return numbers_of(y_); }
  double* rate() { return numbers_of(rate_); }
  /// The step that IDA is about to try [s]; 0 before the first.
  double step_size() const {
    double h = 0;
    IDAGetCurrentStep(memory_.get(), &h);
    return h;
  }
  void restart() { fresh_ = true; }
  /// state() and rate() are to be set to consistent values.
  bool fresh() const { return fresh_; }

  /// Goes on to t_end, or by one step of IDA's choice; t moves.
  Status advance(double& t, double t_end, int task) {
    if (std::exchange(fresh_, false)) {
      add_counters(before_);
      IDAReInit(memory_.get(), t, y_.get(), rate_.get());
      // IDA's own first step, half the tolerance by the rate of change, can be so short that the round-off of an
      // unknown of index 2, which grows as 1 / h, keeps Newton from resting.
      IDASetInitStep(memory_.get(), 1e-5 * (t_end - t));
    }
    IDASetStopTime(memory_.get(), t_end);
    switch (IDASolve(memory_.get(), t_end, &t, y_.get(), rate_.get(), task)) {
      case IDA_SUCCESS:
      case IDA_TSTOP_RETURN:
        return Status::ok;
      case IDA_TOO_MUCH_WORK:
        return Status::max_steps;
      case IDA_CONV_FAIL:
      case IDA_LSETUP_FAIL:
        return Status::nonlinear_fail;
      case IDA_ERR_FAIL:
      case IDA_TOO_MUCH_ACC:
        return Status::step_underflow;
      default:
        return Status::diverged;
    }
  }
  Work work() const {
    Work sum = before_;
    add_counters(sum);
    return sum;
  }

 private:
  void add_counters(Work& sum) const {
    SundialsCounters now;
    long residuals = 0;
    IDAGetNumSteps(memory_.get(), &now.steps);
    IDAGetNumErrTestFails(memory_.get(), &now.failures);
    IDAGetNumNonlinSolvIters(memory_.get(), &now.iterations.emplace());
    IDAGetNumJacEvals(memory_.get(), &now.jacobians.emplace());
    IDAGetNumResEvals(memory_.get(), &residuals);
    now.add_to(sum);
    sum.evaluations += residuals;
  }

  SundialsOwned<SUNContext> context_ = make_sundials_context();  // outlives all that is made in it
  SundialsOwned<N_Vector> y_, rate_;
  SundialsDense dense_;
  SundialsMemory<IDAFree> memory_;
  bool fresh_ = true;
  Work before_;
};

/// IDA from stop to stop, on a system of ida_systems.hpp.
///
/// fails  with the status of its error code
template <class System>
class IdaStepper {
  using X = typename System::State;
  static constexpr auto size = std::size_t(System::size), differential = std::size_t(System::differential);

 public:
  IdaStepper(System system, Adaptive control, NormPolicy) : user_(new User{std::move(system), control}) {
    memory_ = std::make_unique<IdaMemory>(weights, residual, user_->system.has_jacobian() ? jacobian : nullptr,
                                          user_.get(), System::size, System::differential);
    user_->memory = memory_.get();
  }

  /// x is read at a restart; between restarts IDA's own state and history go on.
  Status advance(X& x, double t, double t_end) { return go(x, t, t_end, IDA_NORMAL); }
  Status step(X& x, double& t, double t_end) { return go(x, t, t_end, IDA_ONE_STEP); }
  void restart() { memory_->restart(); }
  Work work() const {
    Work work = memory_->work();
    if (System::calls_field) work.evaluations = 0;
    return work;
  }
  Projections projections() const { return {}; }
  /// lambda at the end of the last step [N].
  Vec3<double> multiplier() const requires std::same_as<System, PinnedSystem> {
    return PinnedUnknowns<double>::from(memory_->state()).lambda;
  }

 private:
  /// What IDA hands back to our callbacks.
  struct User {
    System system;
    Adaptive control;
    IdaMemory const* memory = nullptr;
  };
  static User const& user(void* pointer) { return *static_cast<User const*>(pointer); }

  Status go(X& x, double& t, double t_end, int task) {
    if (memory_->fresh()) start(t, x);
    Status const status = memory_->advance(t, t_end, task);
    x = System::from(memory_->state());
    return status == Status::ok && !all_finite(x) ? Status::diverged : status;
  }
  void start(double t, X const& x) {
    double *const y = memory_->state(), *const rate = memory_->rate();
    user_->system.start(x, y);
    user_->system.residual(t, y, rate);
    for (std::size_t i = 0; i < size; ++i) rate[i] = i < differential ? -rate[i] : 0;
  }
  static int residual(double t, N_Vector y, N_Vector rate, N_Vector result, void* pointer) {
    double const* const derivative = N_VGetArrayPointer(rate);
    double* const out = N_VGetArrayPointer(result);
    user(pointer).system.residual(t, N_VGetArrayPointer(y), out);
    for (std::size_t i = 0; i < differential; ++i) out[i] += derivative[i];
    return 0;
  }
  /// 1 / (atol + rtol |y|), for the algebraic unknowns 1 / (atol + rtol |y| + 2^-40 / h): their round-off grows as 1 /
  /// h, and below 1e-10 Newton would never come to rest. (Times h, as others weigh unknowns of index 2, doubles the
  /// steps.)
  static int weights(N_Vector y, N_Vector result, void* pointer) {
    User const& u = user(pointer);
    double const h = u.memory ? u.memory->step_size() : 0, noise = h > 0 ? 0x1p-40 / h : 0;
    double const* const at = N_VGetArrayPointer(y);
    double* const out = N_VGetArrayPointer(result);
    for (std::size_t i = 0; i < size; ++i) {
      double const scale = u.control.atol + u.control.rtol * std::fabs(at[i]);
      out[i] = 1 / (i < differential ? scale : scale + noise);
    }
    return 0;
  }
  /// dF/dy + c dF/dy'.
  static int jacobian(double t, double c, N_Vector y, N_Vector, N_Vector, SUNMatrix matrix, void* pointer, N_Vector,
                      N_Vector, N_Vector) {
    double* const columns = SUNDenseMatrix_Data(matrix);
    user(pointer).system.jacobian(t, N_VGetArrayPointer(y), std::span(columns, size * size));
    for (std::size_t i = 0; i < differential; ++i) columns[i + size * i] += c;
    return 0;
  }

  std::unique_ptr<User> user_;
  std::unique_ptr<IdaMemory> memory_;
};
#endif

/// BDF of orders 1 to 5, steps and order chosen by the library.
struct Ida {
  static constexpr MethodInfo info{
      .name = "ida",
      .family = Family::library,
      .needs = Needs::constraint_on_quaternion,
      .rival = true,
      .source = "SUNDIALS 6.4 IDA; Hindmarsh et al. (2005)",
      .pitfall = "constraints are met to the tolerance of its Newton iteration, not to round-off",
      .no_projection = "projection would break the multistep history that the next step extrapolates",
      .locates_events = false,
      .not_built = sundials_not_built};
  static constexpr bool uses_jacobian = true;
#ifdef POLHODE_HAS_SUNDIALS
  template <ConstrainedProblem P>
    requires std::same_as<typename P::Space, MovingBody<FlatQuaternion<double>>>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return IdaStepper<PinnedSystem>(PinnedSystem(p), control, policy);
  }
  template <Problem P>
    requires std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return IdaStepper<UnitNormSystem<P>>(UnitNormSystem<P>(p), control, policy);
  }
#endif
};

}  // namespace polhode
