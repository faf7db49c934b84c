#pragma once
/// Ensembles on several threads. Bodies are dealt out in chunks, in equal shares that are fixed beforehand; what chunks
/// give is joined in order of body. So results are the same bits for any number of threads.
#include <algorithm>
#include <cstdint>
#include <functional>

#include "integrators/ensemble.hpp"

namespace polhode::bench {

/// Bodies that are run, and joined, as one: so many that threads are not worth a thought, so few that shares are even.
inline constexpr std::int64_t bodies_in_chunk = 1024;

/// The k-th chunk of an ensemble of `count` bodies, and how many there are.
inline Bodies chunk_of(std::int64_t count, std::int64_t k) {
  return {k * bodies_in_chunk, std::min((k + 1) * bodies_in_chunk, count)};
}
inline std::int64_t chunks_in(std::int64_t count) {
  return (count + bodies_in_chunk - 1) / bodies_in_chunk;
}

/// Calls work(k) for 0 <= k < parts, thread i for the i-th of equal shares, in order. Returns when all are done; throws
/// what the first of the shares that failed threw.
void on_threads(int threads, std::int64_t parts, std::function<void(std::int64_t)> const& work);

/// run_ensemble for bodies 0 <= k < count. Its functions are called by several threads at once, for different bodies.
template <class T = double, class Method, class Make, class Deliver, class Watch = NoEnsembleWatch>
void run_ensemble_on_threads(int threads, Method const& method, EnsembleRun const& run, std::int64_t count,
                             Make const& make, Deliver const& deliver, Watch const& watch = {},
                             Registers registers = widest_registers()) {
  on_threads(threads, chunks_in(count), [&](std::int64_t k) {
    run_ensemble<T>(method, run, chunk_of(count, k), make, deliver, watch, registers);
  });
}

}  // namespace polhode::bench
