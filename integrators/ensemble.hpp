#pragma once
/// Ensembles: many independent copies of one problem by an explicit method of equal steps, lanes over bodies. The
/// sources of the problem and of the method are those of one body, over Lanes for a scalar; a group of blocks is
/// stepped from its initial states to its end before the next begins, so that nothing but the results goes through
/// memory.
///
/// Every lane computes what one body alone would, to the last bit in units compiled with -ffp-contract=off (as ours
/// are): a result depends neither on the registers nor on who the neighbours are, and what diverges disturbs nobody.
/// To round-off only where lanes have functions of their own: sine and cosine, so on groups when a step turns by more
/// than 0.4 rad, which then takes the neighbours in its block to the longer way, too.
///
/// Use for Monte Carlo and sweeps over initial states or parameters. Not for methods that iterate or choose their
/// steps: bodies in lockstep all wait for the slowest. No norm policy acts.
#include <array>
#include <cstdint>
#include <span>

#include "integrators/integrator.hpp"
#include "integrators/registers.hpp"
#include "problems/lanes.hpp"

namespace polhode {

/// Equal steps from 0 s, with stops every so many: there sampled controllers are asked and the watch sees the states.
struct EnsembleRun {
  double h = 0.01;                 ///< [s]
  std::int64_t steps = 0;          ///< of every body
  std::int64_t steps_to_stop = 0;  ///< from stop to stop; 0: the beginning is the only one
};

/// The bodies first <= k < last of an ensemble.
struct Bodies {
  std::int64_t first = 0, last = 0;
};

/// The bodies in the lanes of one block; lanes behind the last body repeat it.
struct BodyBlock {
  std::int64_t first = 0, last = 0;
  std::int64_t index(int lane) const { return first + lane < last ? first + lane : last - 1; }
};

template <class S>
inline constexpr int lanes_of = 1;
template <int n, class T, int bytes>
inline constexpr int lanes_of<Lanes<n, T, bytes>> = n;

/// The vector X over lanes whose lane i is of(index of its body), a vector of scalars or a scalar.
template <class X, class F>
X gather(BodyBlock const& block, F const& of) {
  if constexpr (requires { X::count; }) {
    return X::of([&](int lane) { return Real<X>(of(block.index(lane))); });
  } else if constexpr (requires { X::size; }) {
    X x;
    for (int lane = 0;; ++lane) {
      auto const single = of(block.index(lane));
      bool more = false;
      X::each(
          [&]<class S>(S& to, auto const& from) {
            if (lane == 0) to = S(Real<S>(from));
            if constexpr (1 < lanes_of<S>) to.set(lane, Real<S>(from));
            more = lane + 1 < lanes_of<S>;
          },
          x, single);
      if (!more) return x;
    }
  } else {
    return of(block.first);
  }
}
/// What lies in one lane of x, in double.
template <class Single, class X>
Single in_lane(X const& x, int lane) {
  Single single;
  Single::each(
      [&]<class S>(auto& to, S const& from) {
        if constexpr (lanes_of<S> == 1)
          to = from;
        else
          to = double(from[lane]);
      },
      single, x);
  return single;
}

/// Sees nothing at stops.
struct NoEnsembleWatch {
  void operator()(auto const&...) const {}
};

/// Methods that make a step from a point alone.
template <class Method, class P>
concept StepsFromPoint = Problem<P> && std::same_as<typename Method::template Memory<typename P::Space>, NoMemory>;

namespace detail {

/// Blocks that take turns: the latency of one hides behind the others. Their states stay in the first-level cache.
inline constexpr int blocks_in_turn = 4;

template <class Method, class S, class Make, class Deliver, class Watch>
struct EnsembleKernel {
  using T = Real<S>;
  using P = decltype(std::declval<Make const&>().template operator()<S>(BodyBlock{}));
  using Single = Point<typename decltype(std::declval<Make const&>().template operator()<double>(BodyBlock{}))::Space>;
  using M = typename P::Space;
  static_assert(StepsFromPoint<Method, P>, "needs a method that makes a step from a point alone");
  static constexpr int lanes = lanes_of<S>;

  Method const& method;
  EnsembleRun const& run;
  Make const& make;
  Deliver const& deliver;
  Watch const& watch;

  struct Block {
    BodyBlock bodies;
    P problem;
    Point<M> x;
  };
  Block block_at(BodyBlock const& bodies) const {
    P const problem = make.template operator()<S>(bodies);
    return {bodies, problem, problem.initial()};
  }
  template <int... g>
  std::array<Block, sizeof...(g)> group_at(Bodies const& bodies, std::integer_sequence<int, g...>) const {
    return {block_at(BodyBlock{BodyBlock{bodies.first, bodies.last}.index(g * lanes), bodies.last})...};
  }

  /// What is made and handed over is code of all kinds; the steps alone are for chosen registers.
  template <class Steps>
  void go(Bodies const& bodies, Steps const& steps) const {
    constexpr std::int64_t in_group = std::int64_t{blocks_in_turn} * lanes;
    for (std::int64_t first = bodies.first; first < bodies.last; first += in_group) {
      Bodies const rest{first, bodies.last};
      auto group = group_at(rest, std::make_integer_sequence<int, blocks_in_turn>{});
      std::int64_t const needed = (rest.last - first + lanes - 1) / lanes;
      std::span const used(group.data(), std::size_t(needed < blocks_in_turn ? needed : blocks_in_turn));
      steps(*this, used);
      for (Block const& block : used) hand_over(block);
    }
  }
  POLHODE_INLINE void step(std::span<Block> const& group) const {
    auto const h = T(run.h);
    std::int64_t const to_stop = run.steps_to_stop > 0 ? run.steps_to_stop : run.steps;
    for (std::int64_t i = 0; i < run.steps;) {
      for (Block& block : group) stop(block, T(double(i)) * h);
      std::int64_t const end = i + to_stop < run.steps ? i + to_stop : run.steps;
      for (; i < end; ++i)
        for (Block& block : group) {
          typename Method::template Frame<M> frame;
          NoMemory none;
          Point<M> x = block.x;  // nobody points at it: it lives in registers
          method.step(block.problem, S(T(double(i)) * h), h, x, frame, none);
          block.x = x;
        }
    }
    for (Block& block : group) watch(block.bodies, T(double(run.steps)) * h, block.problem, block.x);
  }
  void stop(Block& block, T const& t) const {
    if constexpr (SampledProblem<P>) block.problem.sample(t, block.x);
    watch(block.bodies, t, block.problem, block.x);
  }
  void hand_over(Block const& block) const {
    for (int lane = 0; lane < lanes && block.bodies.first + lane < block.bodies.last; ++lane) {
      Single const x = in_lane<Single>(block.x, lane);
      deliver(block.bodies.first + lane, x, all_finite(x) ? Status::ok : Status::diverged);
    }
  }
};

// One function for each register set, with all that it calls inlined.
template <class Kernel, class Group>
[[gnu::flatten, gnu::noinline]] void step_in_unit(Kernel const& kernel, Group const& group) {
  kernel.step(group);
}
template <class Kernel, class Group>
[[gnu::flatten, gnu::noinline]] POLHODE_TARGET("arch=x86-64-v3") void step_in_avx2(Kernel const& kernel,
                                                                                   Group const& group) {
  kernel.step(group);
  POLHODE_LEAVE_TARGET();
}
template <class Kernel, class Group>
[[gnu::flatten, gnu::noinline]] POLHODE_TARGET("arch=x86-64-v4") void step_in_avx512(Kernel const& kernel,
                                                                                     Group const& group) {
  kernel.step(group);
  POLHODE_LEAVE_TARGET();
}

}  // namespace detail

/// Runs `bodies`, on this thread.
///   T                              the number in a lane: double, or float for twice the lanes and 7 digits
///   make(block), templated on S    the problem over S for the bodies of a block, with its parameters; initial() is
///                                  where they start. `gather` makes lanes of functions of a body's index. S is double,
///                                  too: what is delivered.
///   deliver(index, x, status)      the end of each body, in order of index; Status::diverged if it is not finite
///   watch(block, t, problem, x)    each block at every stop, after its sample, and at the end
/// Throws what these throw.
template <class T = double, class Method, class Make, class Deliver, class Watch = NoEnsembleWatch>
void run_ensemble(Method const& method, EnsembleRun const& run, Bodies const& bodies, Make const& make,
                  Deliver const& deliver, Watch const& watch = {},
                  [[maybe_unused]] Registers registers = widest_registers()) {
  auto const over = [&]<int bytes>() {
    using S = Lanes<bytes / int(sizeof(T)), T, bytes>;
    return detail::EnsembleKernel<Method, S, Make, Deliver, Watch>{method, run, make, deliver, watch};
  };
  if constexpr (chooses_registers) {
    if (registers == Registers::avx512)
      return over.template operator()<64>().go(
          bodies, [](auto const& kernel, auto const& group) { detail::step_in_avx512(kernel, group); });
    if (registers == Registers::avx2)
      return over.template operator()<32>().go(
          bodies, [](auto const& kernel, auto const& group) { detail::step_in_avx2(kernel, group); });
  }
  over.template operator()<register_bytes>().go(
      bodies, [](auto const& kernel, auto const& group) { detail::step_in_unit(kernel, group); });
}

}  // namespace polhode
