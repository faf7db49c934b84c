#pragma once
/// The free body's RK4 step as it would be written by hand for this one case, in plain doubles: what the generic source
/// is held against, in time and in instructions.
#include "integrators/runge_kutta.hpp"
#include "problems/free_body.hpp"

namespace polhode::bench {

/// q, scalar last, and omega [rad/s].
struct PlainState {
  double qx, qy, qz, qw, wx, wy, wz;
};
/// (J_y - J_z) / J_x, ...
struct PlainBody {
  double x, y, z;
};

__attribute__((always_inline)) inline PlainState plain_rate(PlainState const& s, PlainBody const& k) {
  double const p = 0.5 * s.wx, q = 0.5 * s.wy, r = 0.5 * s.wz;
  return {s.qw * p + s.qy * r - s.qz * q,
          s.qw * q + s.qz * p - s.qx * r,
          s.qw * r + s.qx * q - s.qy * p,
          -(s.qx * p) - s.qy * q - s.qz * r,
          k.x * (s.wy * s.wz),
          k.y * (s.wz * s.wx),
          k.z * (s.wx * s.wy)};
}
/// a + c b.
__attribute__((always_inline)) inline PlainState plain_sum(PlainState const& a, double c, PlainState const& b) {
  return {a.qx + c * b.qx, a.qy + c * b.qy, a.qz + c * b.qz, a.qw + c * b.qw,
          a.wx + c * b.wx, a.wy + c * b.wy, a.wz + c * b.wz};
}
[[gnu::noinline]] inline void run_by_hand(PlainState& state, PlainBody const& body, double h, long steps) {
  PlainState s = state;
  PlainBody const k = body;
  for (long i = 0; i < steps; ++i) {
    PlainState const k1 = plain_rate(s, k);
    PlainState next = plain_sum(s, h / 6, k1);
    PlainState const k2 = plain_rate(plain_sum(s, h / 2, k1), k);
    next = plain_sum(next, h / 3, k2);
    PlainState const k3 = plain_rate(plain_sum(s, h / 2, k2), k);
    next = plain_sum(next, h / 3, k3);
    PlainState const k4 = plain_rate(plain_sum(s, h, k3), k);
    s = plain_sum(next, h / 6, k4);
  }
  state = s;
}

/// The default free body, for both.
inline PlainState plain_start() {
  BodyParameters const body;
  auto const q = body.attitude<double>();
  return {q.x, q.y, q.z, q.w, body.omega0[0], body.omega0[1], body.omega0[2]};
}
inline PlainBody plain_body() {
  BodyParameters const body;
  auto const& J = body.inertia;
  return {(J[1] - J[2]) / J[0], (J[2] - J[0]) / J[1], (J[0] - J[1]) / J[2]};
}

}  // namespace polhode::bench
