#pragma once
/// The driver of equal steps, which turns a method's step into a stepper, and what steps are made in. What a method is:
/// method.hpp; the driver of steps that a method chooses: step_control.hpp.
#include "integrators/method.hpp"
#include "integrators/norm_steps.hpp"

namespace polhode {

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
class EqualSteps {
 public:
  using Space = typename P::Space;

 private:
  using M = Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  EqualSteps(Method method, P const& problem, FixedStep control, NormPolicy policy)
      : policy_(policy), method_(std::move(method)), problem_(&problem), h_(control.h), frame_(shape_of(problem)) {
    memory_.fit(shape_of(problem));
  }

  /// Fails with Status::diverged if the state is no longer finite at t_end.
  Status advance(Point<M>& x, R t, R t_end) {
    bool finite = true;
    divide(t, t_end, [&](R const& from, R const& h, std::int64_t n) { finite = take(x, from, h, n); });
    return health(finite);
  }
  /// One step to t_end, however long.
  Status one_step(Point<M>& x, R t, R t_end) { return health(take(x, t, t_end - t, 1)); }
  void restart() { memory_.restart(); }
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

 protected:
  /// Calls f(t, h, n): from t on n steps of h, and what is left as another if h does not divide.
  template <class F>
  POLHODE_INLINE void divide(R const& t, R const& t_end, F const& f) const {
    R const span = t_end - t;
    if (abs_of(span - h_) <= slack_)  // from sample to sample
      f(t, std::same_as<R, double> ? h_ : span, 1);
    else
      in_equal_steps(t, t_end, h_, f);
  }
  /// n steps of h under no policy but projection; false if the state is no longer finite. Asked outside of what is
  /// flattened: within it g++ 12 spills more, and RK4 takes 1.05 of the time.
  bool run(Point<M>& x, R const& t, R const& h, std::int64_t n) {
    if constexpr (ScalarTraits<S>::flattened && !PowerSpace<M>)
      run_flattened(x, t, h, n);
    else
      loop(x, t, h, n);  // many bodies, long floats, series: inlining everything costs compile time and gains nothing
    return all_finite(x);
  }
  /// The last step never was: memory is again as before it, but for what it counted.
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
  auto const& memory() const { return memory_; }
  R const& step() const { return h_; }
  Status health(bool finite) const {
    if (!finite) return Status::diverged;
    if constexpr (requires { memory_.unconverged; })
      if (memory_.unconverged) return Status::nonlinear_fail;
    return Status::ok;
  }

  NormPolicy policy_;
  Projections projections_;

 private:
  /// A plain problem is copied for the length of an advance: g++ 12 then keeps its numbers in registers (RK4: 0.92 of
  /// the time). It is a pure function of (t, x), so nothing that it does to itself could be lost.
  using Field = std::conditional_t<std::is_trivially_copyable_v<P>, P const, P const&>;

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
  /// n steps under the policy. Feedback is done here, a step at a time: one more branch in run_steps, and g++ 12 spills
  /// so much that RK4 without any policy takes 1.06 to 1.2 times as long.
  bool take(Point<M>& x, R const& t, R const& h, std::int64_t n) {
    if (policy_ != NormPolicy::baumgarte) [[likely]]
      return run(x, t, h, n);
    double const part = feedback_part(double(h));
    for (std::int64_t i = 0; i < n; ++i) {
      run(x, t + R(double(i)) * h, h, 1);
      projections_.template feed_back<M>(x, part);
    }
    return all_finite(x);
  }

  Method method_;
  P const* problem_;
  R h_;
  R slack_ = R(1e-9) * abs_of(h_);  ///< a span that is nearer to h is one step
  /// What is done after every step within run_steps.
  NormPolicy at_border_ = is_projection(policy_) ? policy_ : NormPolicy::none;
  Workspace<M, typename Method::template Frame<M>> frame_;
  typename Method::template Memory<M> memory_{};
  std::int64_t steps_ = 0;
};

/// The stepper of equal steps under every norm policy that the space knows.
template <class Method, Problem P>
using Fixed =
    std::conditional_t<OneFlatQuaternion<typename P::Space>, NormSteps<EqualSteps<Method, P>>, EqualSteps<Method, P>>;

}  // namespace polhode
