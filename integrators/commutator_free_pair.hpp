#pragma once
/// Adaptive steps on a group: the commutator-free pair of orders 4 and 3, its error measured in the chart around the
/// new point. Use where the attitude must remain an attitude and the time scale changes; it keeps the norm, not the
/// energy. Sources: Curry & Owren (2019), Numerical Algorithms 82, 1359 (variable steps); the pair as in Celledoni,
/// Cokaj, Leone, Murari & Owren (2022), Int. J. Comput. Math. 99, 58; step control: Hairer, Norsett & Wanner I, II.4
#include <algorithm>
#include <limits>

#include "integrators/commutator_free.hpp"
#include "integrators/step_size.hpp"

namespace polhode {

///   0   |
///   1/2 |  1/2
///   1/2 |   0    1/2
///   1   |  1/2                        from the start, which is the second point
///       | -1/2    0     1
///   3/4 |   0    3/4
///       |  1/4   1/6   1/6 -1/12      order 4: cf4
///       | -1/12  1/6   1/6  1/4
///       |  1/3                        order 3
///       | -1/9   1/3    0     0   4/9
struct Cf43Tableau {
  static constexpr int stages = 5, order = 4;
  static constexpr bool keeps_second = true, one_slope_each = false;
  static constexpr Quad c[5] = {0, Quad(1) / 2, Quad(1) / 2, 1, Quad(3) / 4};
  static constexpr ExponentialProduct<5, 2> product[6] = {
      {false, 1, {{{Quad(1) / 2}}}},
      {false, 1, {{{0, Quad(1) / 2}}}},
      {true, 1, {{{Quad(-1) / 2, 0, 1}}}},
      {false, 1, {{{0, Quad(3) / 4}}}},
      {false,
       2,
       {{{Quad(1) / 4, Quad(1) / 6, Quad(1) / 6, Quad(-1) / 12},
         {Quad(-1) / 12, Quad(1) / 6, Quad(1) / 6, Quad(1) / 4}}}},
      {false, 2, {{{Quad(1) / 3}, {Quad(-1) / 9, Quad(1) / 3, 0, 0, Quad(4) / 9}}}}};
};

/// The two factors of a product.
template <class M>
struct FactorsOf {};
template <SmallSpace A, SmallSpace B>
struct FactorsOf<Product<A, B>> {
  using First = A;
  using Second = B;
};

/// f(e, size) for every coordinate of e in a chart, size being what a relative tolerance refers to: the greater
/// magnitude at a and b on a flat space, 1 rad on a group.
template <Space M, class F>
void each_with_size(F const& f, Chart<M> const& e, Point<M> const& a, Point<M> const& b) {
  using S = typename M::Scalar;
  if constexpr (PowerSpace<M>) {
    for (int i = 0; i < e.count(); ++i) each_with_size<typename M::Factor>(f, e[i], a[i], b[i]);
  } else if constexpr (M::flat) {
    Chart<M>::each([&](S const& part, S const& p, S const& q) { f(part, max_of(abs_of(p), abs_of(q))); }, e, a, b);
  } else if constexpr (requires { typename FactorsOf<M>::First; }) {
    each_with_size<typename FactorsOf<M>::First>(f, e.first, a.first, b.first);
    each_with_size<typename FactorsOf<M>::Second>(f, e.second, a.second, b.second);
  } else {
    Chart<M>::each([&](S const& part) { f(part, S(1.0)); }, e);
  }
}

/// Drives a pair that needs no flat coordinates, with error control per coordinate, RMS:
///
///   |e| <= atol + rtol 1 rad               for a rotation vector e between the two solutions
///   |e| <= atol + rtol max(|y|, |y_new|)   for body rates and all that is flat
///
/// Steps change as in DOPRI5: step_size.hpp.
///
/// fails  Status::step_underflow if the step falls below 10 ulp of t, Status::max_steps after `most_trials` trial steps
/// in one
///        advance, Status::diverged if the state or its slope is not finite
template <class Pair, Problem P>
class ControlledInCharts {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  ControlledInCharts(Pair pair, P const& problem, Adaptive control, NormPolicy policy)
      : pair_(std::move(pair)),
        problem_(&problem),
        control_(control),
        policy_(policy),
        size_(Pair::rule, Pair::order),
        frame_(shape_of(problem)) {
    if constexpr (PowerSpace<M>) {
      slope_ = error_ = shaped_like<Chart<M>>(problem.initial());
      y_ = problem.initial();
    }
  }

  Status advance(Point<M>& x, R t, R t_end) {
    return in_own_steps(
        t, t_end, [&](R& now) { return step(x, now, t_end); }, [&] { return work_.steps + work_.rejected; });
  }
  /// One accepted step, not beyond t_end; t moves.
  Status step(Point<M>& x, R& t, R t_end) {
    slope_at(t, x, slope_);
    if (!all_finite(slope_)) return Status::diverged;
    if (!size_.known()) start(x, t, t_end - t);
    for (std::int64_t trials = 0; trials < most_trials; ++trials) {
      auto const trial = size_.trial(t, t_end);
      if (size_.underflows(trial, t)) return Status::step_underflow;
      auto&& frame = frame_.open();
      frame.k[0] = slope_;
      pair_.attempt(*problem_, t, trial.h, x, frame, y_, error_);
      double const square = mean_square(error_, x, y_);
      if (!size_.accepts(square)) {
        ++work_.rejected;
        if (!std::isfinite(square) && !all_finite(x)) return Status::diverged;
        size_.reject(trial, square);
        continue;
      }
      size_.accept(trial, square);
      x = y_;
      t = trial.last ? t_end : R(t + trial.h);
      ++work_.steps;
      if (policy_ != NormPolicy::none) projections_.template apply<M>(x, policy_);
      return Status::ok;
    }
    return Status::max_steps;
  }
  /// The error's memory is forgotten, the step size is kept.
  void restart() { size_.restart(); }
  /// A new run: the step size is forgotten, too.
  void begin() { size_.forget(); }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  /// Of an error in units of what is allowed at x and y.
  double mean_square(Chart<M> const& error, Point<M> const& x, Point<M> const& y) const {
    double sum = 0;
    each_with_size<M>(
        [&](S const& e, S const& size) {
          double const part = double(e) / (control_.atol + control_.rtol * double(size));
          sum += part * part;
        },
        error, x, y);
    return sum / size_of(error);
  }
  /// The first step from x, in the chart around it.
  void start(Point<M> const& x, R const& t, R const& longest) {
    double squares = 0;
    each_with_size<M>(
        [&](S const&, S const& size) {
          double const part = double(size) / (control_.atol + control_.rtol * double(size));
          squares += part * part;
        },
        slope_, x, x);
    double const speed = std::sqrt(mean_square(slope_, x, x));
    double const euler = size_.euler_step(std::sqrt(squares / size_of(slope_)), speed, longest);
    auto&& frame = frame_.open();
    displace<M>(
        x, [&](auto& u, auto const& at) { add(u, R(euler), at(slope_)); }, frame.k[0], y_);
    slope_at(R(t + R(euler)), y_, error_);
    add(error_, R(-1.0), slope_);
    size_.start(euler, std::max(speed, std::sqrt(mean_square(error_, x, x)) / euler), longest);
  }
  void slope_at(R const& t, Point<M> const& x, Chart<M>& k) {
    auto&& frame = frame_.open();
    slope(*problem_, S(t), x, frame.v, k);
  }

  Pair pair_;
  P const* problem_;
  Adaptive control_;
  NormPolicy policy_;
  StepSize<R> size_;
  Workspace<M, typename Pair::template Frame<M>> frame_;
  Chart<M> slope_, error_;
  Point<M> y_;
  Work work_;
  Projections projections_;
};

/// order 4, error estimate of order 3; 5 evaluations, 8 exponentials an accepted step, an evaluation less if rejected
struct CommutatorFreeAdaptive {
  static constexpr MethodInfo info{
      .name = "cf_adaptive",
      .family = Family::lie_group,
      .needs = Needs::group,
      .preserves = keeps_norm,
      .source =
          "Curry & Owren (2019), Numer. Algorithms 82, 1359; Celledoni et al. (2022), Int. J. Comput. Math. 99, 58",
      .pitfall = "a tolerance bounds the local error, not the attitude error; relative to 1 rad of rotation"};
  static constexpr int order = 4;
  static constexpr StepRule rule{.memory = 0.04};

  template <Problem P>
    requires(!P::Space::flat)
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return ControlledInCharts<CommutatorFreeAdaptive, P>(*this, p, control, policy);
  }

  template <Space M>
  using Frame = typename Exponentials<Cf43Tableau>::template Frame<M>;

  /// One trial step from x, whose slope is frame.k[0]; writes the new point and, in the chart around it, how far the
  /// solution of order 3 is from it.
  template <Problem P, class M = typename P::Space, class R = Real<typename M::Scalar>>
  void attempt(P const& p, R const& t, R const& h, Point<M> const& x, Frame<M>& frame, Point<M>& y,
               Chart<M>& error) const {
    using Method = Exponentials<Cf43Tableau>;
    using Body = typename BodyOf<M>::type;
    Method::stages(p, typename M::Scalar(t), h, x, frame);
    Method::template move<M, 4>(x, h, frame, y);
    Method::template move<M, 5>(x, h, frame, frame.y);
    for_each_body<M>(x, [&](auto const& at) {
      Chart<Body> const centre = Body::centre(at(y));
      at(error) = Body::local(at(y), at(frame.y));
      add(at(error), R(-1.0), centre);
    });
  }
};

}  // namespace polhode
