#pragma once
/// The parts of polhode-bench that need no catalogue. Each registers its benchmarks and says which of them to compare.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace polhode::bench {

/// Two benchmarks whose times are divided; names without the flags that Google Benchmark appends.
struct Comparison {
  std::string what, ours, rival;
};

/// The rate of the run so far is in steps; shown as seconds per step.
inline void count_steps(benchmark::State& state, double steps_an_iteration) {
  state.counters["per_step"] = benchmark::Counter(steps_an_iteration * double(state.iterations()),
                                                  benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// Ensembles against a loop over Odeint, in double and float, by threads, and against the machine's arithmetic.
void add_ensembles(std::vector<Comparison>& pairs);
/// Odeint's loops, which are compiled as suits them.
void add_odeint_loops();
/// The generic source against the same step written by hand.
void add_twins(std::vector<Comparison>& pairs);
/// The longest periods of a sampled loop.
void add_worst_cases();

}  // namespace polhode::bench
