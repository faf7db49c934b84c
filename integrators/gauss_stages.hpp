#pragma once
/// One step of Gauss collocation in the chart around x: starting values, fixed point or Newton, compensated sums. The
/// number of stages is chosen at run time: unrolled for each number, steps on flat coordinates took 1.1 to 2 times as
/// long (g++ 12), on groups as long, and every problem was compiled eight times.
#include <vector>

#include "integrators/gauss_newton.hpp"
#include "integrators/integrator.hpp"

namespace polhode {

/// What one step leaves for the next, beside its increments L_j = h b_j f_j.
///   carry      what rounding took from the state, in chart coordinates; belongs to x + carry
///   last_step  the step that the increments belong to [s]; 0: there is none
///   before     where it began, on a group
///   stiff      so many steps more are left to Newton
template <Space M>
struct GaussMemory {
  using R = Real<typename M::Scalar>;
  static constexpr bool needs_start = !BodyOf<M>::type::flat;

  Chart<M> carry;
  std::conditional_t<needs_start, Point<M>, NoMemory> before;
  R last_step;
  std::int64_t iterations = 0, jacobians = 0;
  int stiff;
  bool unconverged;  ///< a step's iteration came to rest far from a solution

  GaussMemory() { restart(); }
  void fit(Point<M> const& x) {
    carry = shaped_like<Chart<M>>(x);
    if constexpr (needs_start) before = x;
    restart();
  }
  void restart() {
    fill(carry, 0.0);
    last_step = R(0.0);
    stiff = 0;
    unconverged = false;
  }
};

/// Storage of one step beside increments and stages.
template <Space M>
struct GaussRoom {
  Chart<M> place, start_slope, change, least, sum, rest;
  Point<M> y;
  Velocity<M> v;

  void fit(Point<M> const& x) {
    place = start_slope = change = least = sum = rest = shaped_like<Chart<M>>(x);
    y = x;
    v = shaped_like<Velocity<M>>(x);
  }
};

/// Any number of stages on one space, with storage made when it is bound.
template <Space M>
class GaussMethod {
  using S = typename M::Scalar;
  using R = Real<S>;
  using Body = typename BodyOf<M>::type;
  using Table = GaussMu<R>;

 public:
  GaussMethod(int stages, Point<M> const& shape)
      : stages_(std::size_t(stages)),
        table_(stages),
        L_(stages_, shaped_like<Chart<M>>(shape)),
        Y_(L_),
        newton_(stages) {
    if constexpr (PowerSpace<M>) room_.fit(shape);
  }

  template <Space>
  using Memory = GaussMemory<M>;
  template <Space>
  struct Frame {
    void fit(Point<M> const&) {}
  };

  template <Problem P>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) {
    step(p, t, h, x, memory, false);
  }
  /// knows_slope: start_slope() is the slope at x.
  template <Problem P>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Memory<M>& memory, bool knows_slope) {
    Weights hb, hc;
    for (std::size_t i = 0; i < stages_; ++i) {
      hb[i] = h * table_.b[i];
      hc[i] = h * table_.c[i];
    }
    bool guessed = false, solved = false;
    if constexpr (StageNewton<M>::possible)
      if (memory.stiff > 0) [[unlikely]]
        solved = by_newton(p, t, h, x, memory);
    if (!solved) guessed = extrapolate(h, x, memory);
    for (bool last_resort = !StageNewton<M>::possible; !solved; last_resort = true) {
      if (!guessed) start_from_slope(p, t, hb, x, knows_slope);
      solved = by_fixed_point(p, t, hb, hc, x, memory, guessed, !last_resort);
      guessed = false;
      if (solved || last_resort) break;
      if constexpr (StageNewton<M>::possible) {
        solved = by_newton(p, t, h, x, memory);
        if (solved) memory.stiff = steps_between_trials;
      }
    }
    if (!solved) [[unlikely]]
      memory.unconverged = true;
    memory.last_step = solved ? h : R(0.0);
    if constexpr (GaussMemory<M>::needs_start) memory.before = x;
    update(x, memory);
  }

  Chart<M>& start_slope() { return room_.start_slope; }
  Velocity<M>& velocity() { return room_.v; }
  /// h times the slope that the stages say the step began with: their polynomial at its beginning.
  void slope_by_stages(Chart<M>& k) const {
    fill(k, 0.0);
    for (std::size_t j = 0; j < stages_; ++j) add(k, table_.at_start[j], L_[j]);
  }

 private:
  using Weights = std::array<R, most_gauss_stages>;
  static constexpr int most_sweeps = 200;
  static constexpr int steps_between_trials = 16;  ///< of the fixed point, where Newton was needed

  /// Starting values from the slope at x.
  template <Problem P>
  POLHODE_INLINE void start_from_slope(P const& p, S const& t, Weights const& hb, Point<M> const& x, bool known) {
    if (!known) slope(p, t, x, room_.v, room_.start_slope);
    for (std::size_t i = 0; i < stages_; ++i) {
      assign_scaled(L_[i], hb[i], room_.start_slope);
      fill(Y_[i], 0.0);
    }
  }

  /// Starting values from the last step's collocation polynomial, continued: HLW VIII.6.1. False if there is none, or
  /// it is too short to be continued that far.
  POLHODE_INLINE bool extrapolate(R const& h, Point<M> const& x, GaussMemory<M> const& memory) {
    if (memory.last_step == R(0.0)) return false;
    R const ratio = h / memory.last_step;
    if (!(R(0.0) < ratio && ratio < R(3.0))) [[unlikely]]
      return false;
    typename Table::Matrix rescaled;
    bool const equal = abs_of(R(ratio - R(1.0))) < R(1e-9);
    if (!equal) [[unlikely]]
      table_.ahead_of(ratio, stages_, rescaled);
    auto const& ahead = equal ? table_.ahead : rescaled;
    for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA {
      for (std::size_t i = 0; i < stages_; ++i) {
        Chart<Body> u;
        if constexpr (Body::flat) {
          u = at(memory.carry);
          for (std::size_t j = 0; j < stages_; ++j) add(u, ahead[i][j], at(L_[j]));
        } else {
          u = Body::centre(at(memory.before));
          for (std::size_t j = 0; j < stages_; ++j) add(u, R(R(1.0) + ahead[i][j]), at(L_[j]));
          u = Body::local(at(x), Body::retract(at(memory.before), u));
          add(u, R(-1.0), Body::centre(at(x)));
        }
        at(Y_[i]) = u;
      }
    });
    return true;
  }

  /// One sweep evaluates each stage once, from the newest values of the others; the first one from the guess alone.
  /// Ends where no component of the stages sets a new minimum of its change, twice running: there is nothing more to
  /// gain in this arithmetic. Gives up early, if it may, where a dozen sweeps show that it crawls.
  template <Problem P>
  POLHODE_INLINE bool by_fixed_point(P const& p, S const& t, Weights const& hb, Weights const& hc, Point<M> const& x,
                                     GaussMemory<M>& memory, bool guessed, bool may_give_up) {
    auto& [place, start_slope, change, least, sum, rest, y, v] = room_;
    S early(0.0);
    AtRestByComponent at_rest(least);
    for (int sweep = 0; sweep < most_sweeps && !at_rest; ++sweep) {
      fill(change, 0.0);
      for (std::size_t i = 0; i < stages_; ++i) {
        for_each_body<M>(x, [&](auto const& at) POLHODE_LAMBDA {
          Chart<Body> u = at(Y_[i]);
          if (!guessed) {
            u = at(memory.carry);
            for (std::size_t j = 0; j < stages_; ++j) add(u, table_.mu[i][j], at(L_[j]));
            Chart<Body>::each([](S& most, S const& now, S const& before)
                                  POLHODE_LAMBDA { most = max_of(most, abs_of(S(now - before))); },
                              at(change), u, at(Y_[i]));
            at(Y_[i]) = u;
          }
          Chart<Body> here = Body::centre(at(x));
          add(here, u);
          at(y) = Body::retract(at(x), here);
          if constexpr (!PowerSpace<M> || !M::flat) at(place) = here;  // many bodies on a flat space: y is it
        });
        chart_slope(p, S(t + hc[i]), x, place, y, v, L_[i]);
        scale(L_[i], hb[i]);
      }
      ++memory.iterations;
      if (!guessed) at_rest.see(change);
      guessed = false;
      if (sweep == 8) early = largest<S>(change);
      if (sweep == 12 && may_give_up && crawls(early, largest<S>(change))) [[unlikely]]
        return false;
    }
    return is_solved(largest<S>(change), largest<S>(Y_[0]));
  }

  /// Four sweeps, from `early` to `late`, brought less than a factor of 2.5 each, and it is not that of rounding
  /// errors: Newton is cheaper.
  [[gnu::noinline, gnu::cold]] bool crawls(S const& early, S const& late) const {
    S const rounding(std::same_as<R, double> ? 0x1p-52 : 0x1p-112);
    return S(0.0256) * early < late && S(1e3) * rounding * largest<S>(room_.place) < late;
  }

  template <Problem P>
  [[gnu::noinline, gnu::cold]] bool by_newton(P const& p, S const& t, R const& h, Point<M> const& x,
                                              GaussMemory<M>& memory) {
    if (memory.stiff > 0) --memory.stiff;
    ++memory.jacobians;
    return newton_.solve(p, t, h, x, StageEquations<M>{L_, Y_, table_, memory.carry}, memory.iterations);
  }

  /// x' = x + carry + sum_j L_j, what rounding takes going into the carry.
  POLHODE_INLINE void update(Point<M>& x, GaussMemory<M>& memory) {
    room_.sum = L_[0];
    room_.rest = memory.carry;
    for (std::size_t j = 1; j < stages_; ++j)
      Chart<M>::each(
          [](S& total, S& lost, S const& term) POLHODE_LAMBDA {
            auto const exact = two_sum(total, term);
            total = exact.sum;
            lost += exact.rest;
          },
          room_.sum, room_.rest, L_[j]);
    retract_exactly<M>(x, room_.sum, room_.rest, memory.carry);
  }

  std::size_t stages_;
  Table table_;
  std::vector<Chart<M>> L_, Y_;  ///< increments h b_j f_j; stages, counted from x
  GaussRoom<M> room_;
  StageNewton<M> newton_;
};

}  // namespace polhode
