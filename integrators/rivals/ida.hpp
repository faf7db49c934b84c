#pragma once
/// SUNDIALS IDA behind our face, unmodified: variable-order BDF for implicit differential-algebraic equations. Memory
/// is made in bind and lives across advance calls; restart() re-initialises at the next call. double, flat quaternions.
///
/// A constrained body is handed over in the stabilised form of index 2, with the norm as one more constraint:
///   q' = q (omega + d_omega) / 2 + nu q,  x' = v + d_v       (d_omega, d_v) = -M^-1 G^T mu
///   M u' = f - G^T lambda,  0 = Phi,  0 = G u,  0 = q.q - 1
///
/// rtol, atol per component; lambda, mu, nu are left out of the error test, as IDA's guide advises for index 2. Dense
/// Jacobian, from dual numbers.
///
/// Source: Gear, Leimkuhler & Gupta (1985), J. Comput. Appl. Math. 12, 77 (the form); Hindmarsh et al. (2005), ACM TOMS
/// 31, 363; SUNDIALS 6.4
#include "integrators/integrator.hpp"
#include "integrators/rivals/sundials.hpp"
#include "problems/dual.hpp"
#include "problems/pinned_body.hpp"

#ifdef POLHODE_HAS_SUNDIALS
#include <ida/ida.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#endif

namespace polhode {

#ifdef POLHODE_HAS_SUNDIALS
/// Everything that does not know the equations: IDA's objects and their lifetimes.
class IdaMemory {
 public:
  /// The first `differential` of `size` unknowns have derivatives in the equations. Throws std::bad_alloc if the
  /// library cannot make its memory.
  IdaMemory(IDAEwtFn weights, IDAResFn residual, IDALsJacFn jacobian, void* user, int size, int differential) {
    y_.reset(N_VNew_Serial(size, context_.get()));
    rate_.reset(N_VNew_Serial(size, context_.get()));
    SundialsOwned<N_Vector> kinds(N_VNew_Serial(size, context_.get()));
    matrix_.reset(SUNDenseMatrix(size, size, context_.get()));
    memory_.reset(IDACreate(context_.get()));
    if (!y_ || !rate_ || !kinds || !matrix_ || !memory_) throw std::bad_alloc();
    linear_.reset(SUNLinSol_Dense(y_.get(), matrix_.get(), context_.get()));
    N_VConst(0, y_.get());
    N_VConst(0, rate_.get());
    N_VConst(0, kinds.get());
    std::fill_n(N_VGetArrayPointer(kinds.get()), differential, 1.0);
    void* const ida = memory_.get();
    require(IDASetErrFile(ida, nullptr));  // a failure is a status, not a message
    require(IDAInit(ida, residual, 0, y_.get(), rate_.get()));
    require(IDAWFtolerances(ida, weights));
    require(IDASetUserData(ida, user));
    require(IDASetMaxNumSteps(ida, most_steps));
    require(IDASetId(ida, kinds.get()));
    require(IDASetSuppressAlg(ida, SUNTRUE));
    require(IDASetLinearSolver(ida, linear_.get(), matrix_.get()));
    require(IDASetJacFn(ida, jacobian));
  }

  double* state() { return N_VGetArrayPointer(y_.get()); }
  double const* state() const { return N_VGetArrayPointer(y_.get()); }
  double* rate() { return N_VGetArrayPointer(rate_.get()); }
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
  /// IDA's counters start anew at each re-initialisation; we keep the sum.
  Work work() const {
    Work sum = before_;
    add_counters(sum);
    return sum;
  }

 private:
  static constexpr long most_steps = 10'000'000;

  static void require(int code) {
    if (code != IDA_SUCCESS) throw std::bad_alloc();
  }
  void add_counters(Work& sum) const {
    long steps = 0, failures = 0, iterations = 0, jacobians = 0, residuals = 0;
    IDAGetNumSteps(memory_.get(), &steps);
    IDAGetNumErrTestFails(memory_.get(), &failures);
    IDAGetNumNonlinSolvIters(memory_.get(), &iterations);
    IDAGetNumJacEvals(memory_.get(), &jacobians);
    IDAGetNumResEvals(memory_.get(), &residuals);
    sum.steps += steps;
    sum.rejected += failures;
    sum.iterations = sum.iterations.value_or(0) + iterations;
    sum.jacobians = sum.jacobians.value_or(0) + jacobians;
    sum.evaluations += residuals;
  }

  SundialsOwned<SUNContext> context_ = make_sundials_context();  // outlives all that is made in it
  SundialsOwned<N_Vector> y_, rate_;
  SundialsOwned<SUNMatrix> matrix_;
  SundialsOwned<SUNLinearSolver> linear_;
  SundialsMemory<IDAFree> memory_;
  bool fresh_ = true;
  Work before_;
};

/// The unknowns of a pinned body in storage order.
template <class S>
struct PinnedUnknowns {
  Point<MovingBody<FlatQuaternion<S>>> x;
  Vec3<S> lambda, mu;  ///< [N], [N s]
  S nu;                ///< [1/s]
  static constexpr int differential = 13, size = 20;

  static PinnedUnknowns from(S const* y) {
    PinnedUnknowns u;
    load(u.x, y);
    load(u.lambda, y + differential);
    load(u.mu, y + differential + 3);
    u.nu = y[size - 1];
    return u;
  }
};

/// The residual less the derivatives in it: r = F(y, y') - y' of the differential unknowns, F of the algebraic ones.
template <class S>
std::array<S, PinnedUnknowns<S>::size> pinned_residual(PinnedBody<S> const& body, S const* y) {
  auto const u = PinnedUnknowns<S>::from(y);
  Quat<S> const& q = u.x.first.first;
  Vec3<S> const &omega = u.x.first.second, &position = u.x.second.first, &v = u.x.second.second;
  Mat3<S> const R = matrix(q);
  auto const shift = body.impulse(R, u.mu);
  auto const a = body.accelerations(R, omega, u.lambda);
  Point<MovingBody<FlatQuaternion<S>>> rate{{quaternion_rate(q, omega + shift.first), a.first},
                                            {v + shift.second, a.second}};
  add(rate.first.first, u.nu, q);
  scale(rate, S(-1.0));
  std::array<S, PinnedUnknowns<S>::size> r;
  S* const algebraic = r.data() + PinnedUnknowns<S>::differential;
  store(rate, r.data());
  store(body.constraint(R, position), algebraic);
  store(body.constraint_rate(R, omega, v), algebraic + 3);
  r.back() = dot(q, q) - S(1.0);
  return r;
}

template <ConstrainedProblem P>
class IdaStepper {
  using M = typename P::Space;
  static constexpr int size = PinnedUnknowns<double>::size, differential = PinnedUnknowns<double>::differential;

 public:
  IdaStepper(P const& problem, Adaptive control, NormPolicy)
      : user_(new User(problem.mechanics(), control)),
        memory_(new IdaMemory(weights, residual, jacobian, user_.get(), size, differential)) {
    user_->memory = memory_.get();
  }

  /// x is read at a restart; between restarts IDA's own state and history go on.
  Status advance(Point<M>& x, double t, double t_end) { return go(x, t, t_end, IDA_NORMAL); }
  Status step(Point<M>& x, double& t, double t_end) { return go(x, t, t_end, IDA_ONE_STEP); }
  void restart() { memory_->restart(); }
  Work work() const { return memory_->work(); }
  Projections projections() const { return {}; }
  /// lambda at the end of the last step [N].
  Vec3<double> multiplier() const { return PinnedUnknowns<double>::from(memory_->state()).lambda; }

 private:
  using Slopes = Dual<size>;
  /// What IDA hands back to our callbacks.
  struct User {
    PinnedBody<double> body;
    PinnedBody<Slopes> slopes;
    Adaptive control;
    IdaMemory const* memory = nullptr;
    User(PinnedBody<double> const& b, Adaptive const& c)
        : body(b), slopes(b.mass(), b.inertia().J, b.arm(), b.gravity()), control(c) {}
  };

  Status go(Point<M>& x, double& t, double t_end, int task) {
    if (memory_->fresh()) start(x);
    Status const status = memory_->advance(t, t_end, task);
    load(x, memory_->state());
    return status == Status::ok && !all_finite(x) ? Status::diverged : status;
  }
  /// Consistent values: IDA finds none for index 2. The state is put on its constraints, to which it held within the
  /// tolerance; lambda is that of index 1, mu and nu are 0.
  void start(Point<M> x) {
    auto& [q, omega] = x.first;
    auto& [position, v] = x.second;
    PinnedBody<double> const& body = user_->body;
    FlatQuaternion<double>::project(q);
    put_on_constraint<FlatQuaternion<double>>(body, q, position);
    Mat3<double> const R = matrix(q);
    auto const change = body.impulse(R, body.impulse_against(R, R, body.constraint_rate(R, omega, v)));
    add(omega, change.first);
    add(v, change.second);
    double* const y = memory_->state();
    std::fill_n(y, size, 0.0);
    store(x, y);
    store(body.multiplier(R, omega), y + differential);
    double* const rate = memory_->rate();
    std::fill_n(rate, size, 0.0);
    auto const r = pinned_residual(body, y);
    std::transform(r.begin(), r.begin() + differential, rate, [](double value) { return -value; });
  }
  static int residual(double, N_Vector y, N_Vector rate, N_Vector result, void* user) {
    auto const r = pinned_residual(static_cast<User const*>(user)->body, N_VGetArrayPointer(y));
    double const* const derivative = N_VGetArrayPointer(rate);
    double* const out = N_VGetArrayPointer(result);
    for (std::size_t i = 0; i < size; ++i) out[i] = i < differential ? r[i] + derivative[i] : r[i];
    return 0;
  }
  /// 1 / (atol + rtol |y|), for the algebraic unknowns 1 / (atol + rtol |y| + 2^-40 / h): their round-off grows as 1 /
  /// h, and below 1e-10 Newton would never come to rest. (Times h, as others weigh unknowns of index 2, doubles the
  /// steps.)
  static int weights(N_Vector y, N_Vector result, void* user) {
    User const& u = *static_cast<User const*>(user);
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
  static int jacobian(double, double c, N_Vector y, N_Vector, N_Vector, SUNMatrix matrix, void* user, N_Vector,
                      N_Vector, N_Vector) {
    double const* const at = N_VGetArrayPointer(y);
    std::array<Slopes, size> point;
    for (std::size_t i = 0; i < size; ++i) {
      point[i] = at[i];
      point[i].slope[i] = 1;
    }
    auto const r = pinned_residual(static_cast<User const*>(user)->slopes, point.data());
    for (std::size_t column = 0; column < size; ++column) {
      double* const out = SUNDenseMatrix_Column(matrix, sunindextype(column));
      for (std::size_t row = 0; row < size; ++row) out[row] = r[row].slope[column];
      if (column < differential) out[column] += c;
    }
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
#ifdef POLHODE_HAS_SUNDIALS
  template <ConstrainedProblem P>
    requires std::same_as<typename P::Space, MovingBody<FlatQuaternion<double>>>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return IdaStepper<P>(p, control, policy);
  }
#endif
};

}  // namespace polhode
