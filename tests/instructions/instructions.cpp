/// Kernels whose instructions are counted by tests/instructions/instructions.sh: each is warmed, then counted for so
/// many steps between two requests to callgrind. Without valgrind it does nothing.
#include <cstdio>
#include <cstring>

#include "bench/speed/limited_pd.hpp"
#include "bench/speed/twins.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/ensemble.hpp"
#include "integrators/gauss.hpp"
#include "integrators/high_order.hpp"

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION void()
#define CALLGRIND_STOP_INSTRUMENTATION void()
#define CALLGRIND_ZERO_STATS void()
#define CALLGRIND_DUMP_STATS_AT(name) void(name)
#define RUNNING_ON_VALGRIND 0
#endif

namespace polhode {
namespace {

constexpr long steps = 1000;

/// The dump carries the name and the count of steps.
template <class F>
void count(char const* name, long counted, F const& run) {
  run();
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  run();
  CALLGRIND_DUMP_STATS_AT(name);
  CALLGRIND_STOP_INSTRUMENTATION;
  std::printf("%s %ld\n", name, counted);
}
template <class Method, class P>
void count_method(char const* name, P const& problem, double h) {
  auto stepper = Method{}.bind(problem, FixedStep{h}, NormPolicy::none);
  auto x = problem.initial();
  count(name, steps, [&] {
    stepper.restart();
    x = problem.initial();
    stepper.advance(x, 0, double(steps) * h);
    asm volatile("" ::"r"(&x) : "memory");
  });
}
void count_ensemble(char const* name) {
  constexpr std::int64_t bodies = 16;  // one group of blocks at 32 bytes
  FreeBody const body(Choice{});
  double sum = 0;
  count(name, steps, [&] {
    run_ensemble(
        Rk4{}, {0.01, steps}, {0, bodies},
        [&]<class S>(BodyBlock const&) { return body.field<S, FlatQuaternion, true>(); },
        [&](std::int64_t, auto const& x, Status) { sum += x.first.x; });
  });
}

int count_all() {
  if (!RUNNING_ON_VALGRIND) {
    std::puts("run me by tests/instructions/instructions.sh");
    return 1;
  }
  auto const free = FreeBody(Choice{}).field<double, FlatQuaternion, true>();
  auto const free_on_s3 = FreeBody(Choice{}).field<double, S3, true>();
  auto const body = bench::plain_body();
  count("free_body/rk4/by_hand", steps, [&] {
    bench::PlainState s = bench::plain_start();
    bench::run_by_hand(s, body, 0.01, steps);
    asm volatile("" ::"r"(&s) : "memory");  // somebody wants the result
  });
  count_method<Rk4>("free_body/rk4", free, 0.01);
  count_method<Dopri5>("free_body/dopri5", free, 0.01);
  count_method<Explicit<Kutta4>>("free_body/s3/rkmk4", free_on_s3, 0.01);
  count_method<CommutatorFree4>("free_body/s3/cf4", free_on_s3, 0.01);
  count_method<Gauss<2>>("free_body/gauss2", free, 0.05);
  count_method<Rk4>("limited_slew/rk4", bench::limited_slew<double>(), 0.01);
  count_ensemble("free_body/rk4/ensemble_of_16");
  return 0;
}

}  // namespace
}  // namespace polhode

int main() {
  return polhode::count_all();
}
