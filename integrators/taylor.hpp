#pragma once
/// Taylor series of the solution of any problem, by evaluating its own source on power series (Jet).
///
/// expand() is for references: any precision, and values between steps to that same precision. Taylor is the method, in
/// steps of its own or equal ones. Use it for tight tolerances on smooth fields; not where the field has kinks.
///
/// Source: Jorba & Zou (2005), Experimental Mathematics 14, 99 (coefficients, order and step size)
#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "integrators/integrator.hpp"
#include "problems/jet.hpp"

namespace polhode {

/// A problem on power series in time, in flat coordinates.
template <class Q>
concept SeriesProblem = Problem<Q> && FlatSpace<typename Q::Space> && requires {
  typename Q::Space::Scalar::Memory;
};

/// The power series of the solution of p through a state, one order after the other, components in storage order.
template <SeriesProblem Q>
class SolutionSeries {
  using M = typename Q::Space;

 public:
  using Series = typename M::Scalar;
  using R = Real<Series>;

  explicit SolutionSeries(Q const& p)
      : problem_(&p),
        point_(p.initial()),
        v_(shaped_like<Velocity<M>>(point_)),
        k_(shaped_like<Chart<M>>(point_)),
        x_(std::size_t(size_of(point_))),
        rate_(x_.size()),
        memory_(std::make_unique<typename Series::Memory>()) {
    memory_->pause();
  }
  /// Makes the room that grow() needs, so that it allocates nothing.
  void prepare() {
    store(point_, x_.data());
    std::vector<R> start;
    for (Series const& component : x_) start.push_back(component[0]);
    grow(start.begin(), R(0.0), 2, [] { return false; });
  }

  /// From the state at time t [s]; begin yields its components. Ends at `most` or when enough() says so, which is asked
  /// after each order.
  template <class Iterator, class Enough>
  [[gnu::noinline]] void grow(Iterator begin, R const& t, int most, Enough const& enough) {
    for (Series& component : x_) component = Series(*begin++);
    Series time(t);
    for (degree_ = 0; degree_ < most;) {
      if (degree_ == 1) memory_->resume();  // from the first order on: constants are constants until then
      memory_->rewind();
      load(point_, x_.data());
      slope(*problem_, time, point_, v_, k_);
      store(k_, rate_.data());
      for (std::size_t i = 0; i < x_.size(); ++i) {
        x_[i].degree = degree_ + 1;
        x_[i][degree_ + 1] = (rate_[i].degree >= degree_ ? rate_[i][degree_] : R(0.0)) / R(double(degree_ + 1));
      }
      ++degree_;
      time.degree = degree_;
      time[1] = R(1.0);
      if (enough()) break;
    }
    memory_->pause();
  }
  int degree() const { return degree_; }
  /// Greatest coefficient of order k, over the components; not a number if one is.
  double largest(int k) const {
    double most = 0;
    for (Series const& component : x_) {
      double const size = std::fabs(double(component[k]));
      if (!(size <= most)) most = size;
    }
    return most;
  }
  /// x(t + s) - x(t) of each component.
  void increments(R const& s, R* out) const {
    for (Series const& component : x_) {
      R sum(0.0);
      for (int k = component.degree; k > 0; --k) sum = (sum + component[k]) * s;
      *out++ = sum;
    }
  }
  std::vector<Series>& components() { return x_; }

 private:
  Q const* problem_;
  Point<M> point_;
  Velocity<M> v_;
  Chart<M> k_;
  std::vector<Series> x_, rate_;
  std::unique_ptr<typename Series::Memory> memory_;
  int degree_ = 0;
};

/// The solution from t on: x(t + s) = sum_k x_k s^k for 0 <= s <= h, components in storage order.
template <class R, int degree>
struct TaylorSegment {
  R t, h;
  std::vector<Jet<R, degree>> component;
};

/// Expands the solution of p through the state x at time t, in flat coordinates, to `degree` or until the terms at
/// `longest` [s] fall below `tolerance` relative to the state. The step h keeps the last terms below that, too.
/// fails   h = 0 if the series has no radius of convergence to speak of or is not finite
template <class R, int degree, SeriesProblem P>
  requires(std::same_as<typename P::Space::Scalar, Jet<R, degree>>)
TaylorSegment<R, degree> expand(P const& p, std::vector<R> const& state, R const& t, R const& longest,
                                double tolerance) {
  SolutionSeries<P> series(p);
  double size = 1;
  for (R const& component : state) size = std::max(size, std::fabs(double(component)));
  double const span = double(longest);
  int small = 0;
  series.grow(state.begin(), t, degree, [&] {
    int const top = series.degree();
    small = series.largest(top) * std::pow(span, top) < tolerance * size ? small + 1 : 0;
    return small == 2;
  });
  int const top = series.degree();
  double h = span;
  for (int term : {top - 1, top}) {
    double const last = series.largest(term);
    if (!std::isfinite(last)) h = 0;
    if (last > 0) h = std::min(h, std::pow(tolerance * size / last, 1.0 / term));
  }
  bool const reaches = h >= span * (1 - 1e-12);
  return {t, reaches ? longest : R(h), std::move(series.components())};
}

// ---- The method -----------------------------------------------------------------------------------------------------

/// A problem that knows itself on power series: in_series() is the same problem, in the same phase and with the same
/// torque held, its state's components in the same order.
template <class P>
concept KnowsItsSeries = Problem<P> && SmallSpace<typename P::Space> && P::Space::flat && requires(P const& p) {
  requires SeriesProblem<std::decay_t<decltype(p.in_series())>>;
};
template <KnowsItsSeries P>
using SeriesOf = SolutionSeries<std::decay_t<decltype(std::declval<P const&>().in_series())>>;

/// Time events at which the field changes over to its next phase.
template <class P>
concept HasPhases = requires(P p, Real<typename P::Space::Scalar> t) {
  p.time_events();
  p.enter_phase(t);
};
/// A problem and its twin on power series, which is told what the problem is told.
template <Problem P, SeriesProblem Q>
class WithSeries {
 public:
  using Space = typename P::Space;
  using R = Real<typename Space::Scalar>;

  WithSeries(P problem, Q twin) : problem_(std::move(problem)), twin_(std::move(twin)) {}

  auto operator()(typename Space::Scalar const& t, Point<Space> const& x) const { return problem_(t, x); }
  Point<Space> initial() const { return problem_.initial(); }
  Q const& in_series() const { return twin_; }

  void sample(R const& t, Point<Space> const& x) requires SampledProblem<P> {
    problem_.sample(t, x);
    twin_.sample(t, twin_point(x));
  }
  auto time_events() const requires HasPhases<P> { return problem_.time_events(); }
  void enter_phase(R const& t) requires HasPhases<P> {
    problem_.enter_phase(t);
    twin_.enter_phase(t);
  }

 private:
  static Point<typename Q::Space> twin_point(Point<Space> const& x) {
    std::array<typename Space::Scalar, std::size_t(Point<Space>::size)> flat;
    store(x, flat.data());
    Point<typename Q::Space> y;
    load(y, flat.data());
    return y;
  }

  P problem_;
  Q twin_;
};

/// The stepper of adaptive steps. Outputs do not shorten steps: between them the series answers.
/// fails   Status::step_underflow below 16 ulp of t, Status::diverged if the series is not finite
template <KnowsItsSeries P>
class TaylorStepper {
  using M = typename P::Space;
  using R = Real<typename M::Scalar>;

 public:
  TaylorStepper(P const& problem, Adaptive control, NormPolicy policy, int most)
      : series_(problem.in_series()), control_(control), policy_(policy), most_(most) {
    series_.prepare();
  }

  Status advance(Point<M>& x, R t, R t_end) {
    return in_own_steps(
        t, t_end, [&](R& now) { return step(x, now, t_end); }, [&] { return work_.steps + work_.rejected; });
  }
  /// To the end of the next step, or to t_end if that comes first.
  Status step(Point<M>& x, R& t, R t_end) {
    if (!known_) {
      y_ = x;
      reached_ = t;
      fill(carry_, 0.0);
      known_ = true;
    }
    if (!(t < reached_))
      if (Status const status = go_on(); status != Status::ok) return status;
    bool const between = t_end < reached_;
    x = between ? at(t_end) : y_;
    t = between ? t_end : reached_;
    return Status::ok;
  }
  void restart() { known_ = false; }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  /// One step of the method's own, from reached_.   Jorba & Zou (2005), sec. 3.2.1
  Status go_on() {
    std::array<R, std::size_t(Point<M>::size)> components;
    store(y_, components.data());
    double const size = double(largest<R>(y_));
    bool const absolute = control_.rtol * size <= control_.atol;
    double const tolerance = absolute ? control_.atol : control_.rtol;
    int const order = std::clamp(int(std::ceil(1 - 0.5 * std::log(tolerance))), 2, most_);
    series_.grow(components.begin(), reached_, order, [] { return false; });
    double radius = std::numeric_limits<double>::infinity();
    for (int term : {order - 1, order}) {
      double const last = series_.largest(term);
      if (!std::isfinite(last)) return Status::diverged;
      if (last > 0) radius = std::min(radius, std::pow((absolute ? 1 : size) / last, 1.0 / term));
    }
    double const h = std::min(radius * std::exp(-2 - 0.7 / (order - 1)), longest);
    if (!(h > 16 * std::numeric_limits<double>::epsilon() * std::fabs(double(reached_)))) return Status::step_underflow;
    begun_ = reached_;
    start_ = y_;
    reached_ = begun_ + R(h);
    Chart<M> change;
    series_.increments(reached_ - begun_, components.data());
    load(change, components.data());
    M::retract_exactly(y_, change, carry_, carry_);
    ++work_.steps;
    if (policy_ != NormPolicy::none) projections_.template apply<M>(y_, policy_, h);
    return Status::ok;
  }
  /// The state at time t [s] within the last step, under the norm policy as its end is.
  Point<M> at(R const& t) const {
    std::array<R, std::size_t(Point<M>::size)> components;
    series_.increments(t - begun_, components.data());
    Point<M> change;
    load(change, components.data());
    Point<M> x = start_;
    add(x, change);
    if (policy_ != NormPolicy::none) Projections::apply_inside<M>(start_, x, policy_, double(t - begun_), R(0.0));
    return x;
  }

  static constexpr double longest = 1e6;  ///< [s] of a solution that is a polynomial

  SeriesOf<P> series_;
  Adaptive control_;
  NormPolicy policy_;
  int most_;
  Point<M> start_, y_;  ///< where the last step began and ended
  Chart<M> carry_;      ///< what rounding took: belongs to y_
  R begun_ = R(0.0), reached_ = R(0.0);
  bool known_ = false;
  Work work_;
  Projections projections_;
};

/// order `degree` in equal steps; in steps of its own the order follows from the tolerance, and is at most that.
/// `degree` evaluations on power series per step; sums are compensated; keeps nothing but to its accuracy
template <int degree>
struct TaylorOfDegree {
  static_assert(degree >= 2);
  static constexpr int most = degree;

  template <KnowsItsSeries P>
  struct Method {
    using R = Real<typename P::Space::Scalar>;
    mutable SeriesOf<P> series;  ///< room to work in

    template <Space M>
    struct Frame {};
    template <Space M>
    struct Memory {
      Chart<M> carry;
      Memory() { restart(); }
      void fit(Point<M> const&) {}
      void restart() { fill(carry, 0.0); }
    };
    template <Space M, class S = typename M::Scalar>
    [[gnu::noinline]] void step(P const&, S const& t, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) const {
      std::array<R, std::size_t(Point<M>::size)> components;
      store(x, components.data());
      series.grow(components.begin(), t, degree, [] { return false; });
      series.increments(h, components.data());
      Chart<M> change;
      load(change, components.data());
      M::retract_exactly(x, change, memory.carry, memory.carry);
    }
  };

  template <KnowsItsSeries P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    SeriesOf<P> series(p.in_series());
    series.prepare();
    return Fixed<Method<P>, P>(Method<P>{std::move(series)}, p, control, policy);
  }
  template <KnowsItsSeries P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return TaylorStepper<P>(p, control, policy, degree);
  }
};
/// Power series of degree 20 about every step, with equal or its own steps. Source: Jorba & Zou (2005)
struct Taylor : TaylorOfDegree<20> {
  static constexpr MethodInfo info{.name = "taylor",
                                   .family = Family::taylor,
                                   .order = 20,
                                   .needs = Needs::quaternion,
                                   .source = "Jorba & Zou (2005), Experimental Mathematics 14, 99",
                                   .pitfall = "a kink of the field within a step is not seen",
                                   .no_relaxation = "its series answer between steps, in time that is not relaxed"};
};

}  // namespace polhode
