/// What an Odeint user would write for one body and for many: a plain array, a lambda, a loop over bodies outside that
/// over steps (inside it takes longer); nothing of ours. For every machine, and with all of it inlined for x86-64-v3:
/// what is faster depends on the machine.
#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4_classic.hpp>

#include "bench/speed/ensemble_size.hpp"
#include "bench/speed/speed.hpp"
#include "integrators/registers.hpp"
#include "problems/rigid_body.hpp"

namespace polhode::bench {
namespace {

using State = std::array<double, 7>;

struct Body {
  BodyParameters parameters;
  double Jx = parameters.inertia[0], Jy = parameters.inertia[1], Jz = parameters.inertia[2];
  double kx = (Jy - Jz) / Jx, ky = (Jz - Jx) / Jy, kz = (Jx - Jy) / Jz;
  double ix = 1 / Jx, iy = 1 / Jy, iz = 1 / Jz;
};

/// No torque, or the torque of limited_slew.
template <bool limited>
auto field_of(Body const& body) {
  return [kx = body.kx, ky = body.ky, kz = body.kz, ix = body.ix, iy = body.iy, iz = body.iz](State const& y, State& dy,
                                                                                              double) {
    double const p = .5 * y[4], q = .5 * y[5], r = .5 * y[6];
    dy[0] = y[3] * p + y[1] * r - y[2] * q;
    dy[1] = y[3] * q + y[2] * p - y[0] * r;
    dy[2] = y[3] * r + y[0] * q - y[1] * p;
    dy[3] = -(y[0] * p) - y[1] * q - y[2] * r;
    dy[4] = kx * (y[5] * y[6]);
    dy[5] = ky * (y[6] * y[4]);
    dy[6] = kz * (y[4] * y[5]);
    if constexpr (limited) {
      constexpr double k_d = limited_k_d, most = limited_torque_max;
      double const k = y[3] < 0 ? limited_k_p : -limited_k_p;
      dy[4] += ix * std::clamp(k * y[0] - k_d * y[4], -most, most);
      dy[5] += iy * std::clamp(k * y[1] - k_d * y[5], -most, most);
      dy[6] += iz * std::clamp(k * y[2] - k_d * y[6], -most, most);
    }
  };
}

template <class Field>
__attribute__((always_inline)) inline void solve_all(Field const& field, std::vector<State>& states, long steps) {
  boost::numeric::odeint::runge_kutta4_classic<State> stepper;
  for (State& state : states) {
    State y = state;
    for (long i = 0; i < steps; ++i) stepper.do_step(field, y, double(i) * ensemble_h, ensemble_h);
    state = y;
  }
}
template <class Field>
[[gnu::noinline]] void solve_anywhere(Field const& field, std::vector<State>& states, long steps) {
  solve_all(field, states, steps);
}
#if defined(__x86_64__) && !defined(__SSE3__)
template <class Field>
[[gnu::noinline, gnu::flatten, gnu::target("arch=x86-64-v3")]] void solve_avx2(Field const& field,
                                                                               std::vector<State>& states, long steps) {
  solve_all(field, states, steps);
}
#endif

template <bool limited>
void odeint_loop(benchmark::State& state, bool avx2, long bodies, long steps) {
  Body const body;
  auto const field = field_of<limited>(body);
  auto const q = body.parameters.attitude<double>();
  std::vector<State> states;
  for (auto _ : state) {
    states.clear();
    for (long k = 0; k < bodies; ++k)
      states.push_back({q.x, q.y, q.z, q.w, ensemble_rate(k), body.parameters.omega0[1], body.parameters.omega0[2]});
#if defined(__x86_64__) && !defined(__SSE3__)
    if (avx2)
      solve_avx2(field, states, steps);
    else
#endif
      solve_anywhere(field, states, steps);
    benchmark::DoNotOptimize(states.data());
    benchmark::ClobberMemory();
  }
  (void)avx2;
  count_steps(state, double(bodies) * double(steps));
}

}  // namespace

void add_odeint_loops() {
  bool const avx2 = widest_registers() != Registers::of_the_unit;
  constexpr long steps_of_one = 5000;
  benchmark::RegisterBenchmark("plain/free_body/odeint_rk4", odeint_loop<false>, false, 1, steps_of_one)
      ->Unit(benchmark::kMicrosecond);
  for (bool const wide : {false, true}) {
    if (wide && !avx2) continue;
    std::string const end = wide ? "_avx2" : "";
    benchmark::RegisterBenchmark(("ensemble/free_body/odeint_rk4" + end).c_str(), odeint_loop<false>, wide,
                                 ensemble_bodies, ensemble_steps)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("ensemble/limited_slew/odeint_rk4" + end).c_str(), odeint_loop<true>, wide,
                                 ensemble_bodies, ensemble_steps)
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace polhode::bench
