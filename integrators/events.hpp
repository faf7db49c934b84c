#pragma once
/// Zeros of a problem's switching functions, found between two accepted points by taking the step once more, shorter.
/// No dense output is needed, so the event is as accurate as the method itself; methods with a history cannot do it.
/// Blind spot: two zeros of the same function within one step are not seen.
/// Source: Hairer, Norsett & Wanner, Solving ODEs I, II.6 (switching functions, "Event location")
#include <limits>
#include <vector>

#include "integrators/integrator.hpp"

namespace polhode {

/// The right end of a bracket of width `tolerance` around a zero of f in (a, b], f(a) > 0 >= f(b).
/// Illinois rule: Dowell & Jarratt (1971), BIT 11, 168. (Boost's toms748 does not know quadruple precision.)
template <class R, class F>
R zero_between(R a, R b, R fa, R fb, R const& tolerance, F f) {
  R before_last = R(4.0) * (b - a), last = R(2.0) * (b - a);
  int kept = 0;  // the end that the last trial left where it was: -1 for a, 1 for b
  for (int trial = 0; trial < 300 && tolerance < b - a; ++trial) {
    // Secants shrink a bracket from one side; where two in a row have not halved it, halving is better.
    bool const slow = R(0.5) * before_last < b - a;
    before_last = last;
    last = b - a;
    R const c = slow ? (a + b) / R(2.0) : b - fb * (b - a) / (fb - fa);
    // Away from the ends, so that the last secants land on the zero's other side.
    R const inside = R(0.4) * tolerance;
    R const at = clamp(c, R(a + inside), R(b - inside));
    R const value = f(at);
    if (R(0.0) < value) {
      a = at;
      fa = value;
      if (kept == 1) fb = fb / R(2.0);
      kept = 1;
    } else {
      b = at;
      fb = value;
      if (kept == -1) fa = fa / R(2.0);
      kept = -1;
    }
  }
  return b;
}

/// From t to t_end: for equal steps in one, whatever its length; advance() takes lengths that differ by round-off alone
/// for equal.
template <class Stepper, class X, class R>
Status advance_exactly(Stepper& stepper, X& x, R const& t, R const& t_end) {
  if constexpr (requires { stepper.one_step(x, t, t_end); })
    return stepper.one_step(x, t, t_end);
  else
    return stepper.advance(x, t, t_end);
}

/// Watches the switching functions of one problem on space M. Storage is made once.
template <Space M>
class EventLocator {
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  /// For runs that begin like x.
  template <class P>
  EventLocator(P const& problem, Point<M> const& x)
      : before_(x), end_(x), values_(std::size_t(problem.state_events())), sides_(values_.size()) {
    changed_.reserve(values_.size());
    times_.reserve(most_times);
  }

  bool watching() const { return !values_.empty(); }
  std::int64_t found() const { return found_; }
  /// When the first of them were [s].
  std::vector<double> const& times() const { return times_; }
  /// Steps that were taken and given up to find events.
  std::int64_t trials() const { return trials_; }

  /// A new arc begins at (t, x): the problem holds the sides of this state.
  template <class P>
  void take_sides(P& problem, R const& t, Point<M> const& x) {
    problem.take_sides(t, x);
    problem.event_values(S(t), x, std::span(values_));
    for (std::size_t k = 0; k < values_.size(); ++k) sides_[k] = values_[k] < S(0.0) ? -1 : 1;
  }
  /// Remembers where the next step starts.
  void before_step(R const& t, Point<M> const& x) {
    t_before_ = t;
    before_ = x;
  }
  /// After a step to (t, x). If a function has changed sides, goes back to the first change: t and x are there, the
  /// problem has crossed, the stepper is restarted, and `crossed` is true. Functions that reach zero together cross
  /// together.
  template <class P, class Stepper>
  Status after_step(P& problem, Stepper& stepper, R& t, Point<M>& x, bool& crossed) {
    crossed = false;
    problem.event_values(S(t), x, std::span(values_));
    changed_.clear();
    for (std::size_t k = 0; k < values_.size(); ++k)
      if (values_[k] * S(double(sides_[k])) < S(0.0)) changed_.push_back(k);
    if (changed_.empty()) return Status::ok;

    R const at_end = least(problem, S(t), x), at_start = least(problem, S(t_before_), before_);
    R const t_end = t;
    Status status = Status::ok;
    end_ = x;
    auto const try_until = [&](R const& time) {
      x = before_;
      stepper.restart();
      Status const now = advance_exactly(stepper, x, t_before_, time);
      if (now != Status::ok) status = now;
      ++trials_;
      return least(problem, S(time), x);
    };
    if (R(0.0) < at_start) {
      R const tolerance = R(8.0) * rounding * max_of(abs_of(t_end), R(t_end - t_before_));
      t = zero_between(t_before_, t_end, at_start, at_end, tolerance, try_until);
      if (t < t_end)
        try_until(t);
      else
        x = end_;
    } else {  // zero at the very start
      t = t_before_;
      x = before_;
    }
    stepper.restart();
    problem.event_values(S(t), x, std::span(values_));
    for (std::size_t const k : changed_) {
      if (S(together) < values_[k] * S(double(sides_[k]))) continue;
      cross(problem, t, int(k));
    }
    crossed = true;
    return status;
  }
  /// The run stands at time t on the zero of function k: its side turns over.
  template <class P>
  void cross(P& problem, R const& t, int k) {
    problem.cross(k);
    sides_[std::size_t(k)] = -sides_[std::size_t(k)];
    ++found_;
    if (times_.size() < most_times) times_.push_back(double(t));
  }

 private:
  static constexpr std::size_t most_times = 256;  ///< nothing is allocated within a run
  static constexpr double together = 1e-12;       ///< values this near to zero are zero, too
  static constexpr R rounding = std::same_as<R, double> ? R(0x1p-53) : R(0x1p-112);

  /// The least of the changed functions, each positive on the side that is held.
  template <class P>
  R least(P const& problem, S const& t, Point<M> const& x) {
    problem.event_values(t, x, std::span(values_));
    R low(1e300);
    for (std::size_t const k : changed_) low = min_of(low, R(values_[k] * R(double(sides_[k]))));
    return low;
  }
  static R min_of(R const& a, R const& b) { return b < a ? b : a; }

  Point<M> before_, end_;
  R t_before_ = R(0.0);
  std::vector<S> values_;
  std::vector<int> sides_;
  std::vector<std::size_t> changed_;
  std::vector<double> times_;
  std::int64_t found_ = 0, trials_ = 0;
};

}  // namespace polhode
