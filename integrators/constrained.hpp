#pragma once
/// Methods of equal steps for constrained systems M u' = f - G^T lambda, Phi = 0, in maximal coordinates.
///
///   half_explicit4     order 4; lambda of each stage from the next stage's velocity constraint, then one projection
///   rattle             order 2, symmetric, symplectic; position and velocity constraint at every step
///   generalized_alpha  order 2, damps high frequencies; position constraint at every step (index 3)
///
/// All step the attitude by exponentials on a group; the first also runs on flat coordinates. They look at the
/// mechanics of the problem (problems/pinned_body.hpp) instead of calling its field. Solvers end at round-off.
/// fails   Status::nonlinear_fail if Newton does not converge: the step turns the body too far
#include <array>
#include <cstdint>

#include "integrators/step_rotation.hpp"
#include "problems/pinned_body.hpp"

namespace polhode {

/// The attitude space of a moving body.
template <class M>
using AttitudeOf = typename M::Factor::Factor;

/// What every method for constrained systems keeps.
template <Space M>
struct ConstrainedMemory {
  Vec3<typename M::Scalar> multiplier = zero<Vec3<typename M::Scalar>>();  ///< lambda at the end of the last step [N]
  std::int64_t evaluations = 0;                                            ///< of forces
  bool unconverged = false;
  void restart() {}
  void fit(Point<M> const&) {}
};

// ---- Half-explicit Runge-Kutta --------------------------------------------------------------------------------------

/// HEM4: a[i] is the row of stage i + 1, a[4] the weights.
///       0   |
///      3/10 | 3/10
///  (4-r)/10 | (1+r)/30        (11-4r)/30
///  (4+r)/10 | (-79-31r)/150   (-1-4r)/30   (24+11r)/25                      r = sqrt(6)
///       1   | (14+5r)/6       (-8+7r)/6    (-9-7r)/4    (9-r)/4
///           | 0               0            (16-r)/36    (16+r)/36   1/9
/// Source: Brasey & Hairer (1993), SIAM J. Numer. Anal. 30, 538
template <class R>
struct HalfExplicitTableau {
  static constexpr int stages = 5;
  std::array<std::array<R, 5>, 5> a{};

  HalfExplicitTableau() {
    R const r = sqrt(R(6.0));
    auto const over = [&](double whole, double root, double below) { return (R(whole) + R(root) * r) / R(below); };
    a[0] = {over(3, 0, 10)};
    a[1] = {over(1, 1, 30), over(11, -4, 30)};
    a[2] = {over(-79, -31, 150), over(-1, -4, 30), over(24, 11, 25)};
    a[3] = {over(14, 5, 6), over(-8, 7, 6), over(-9, -7, 4), over(9, -1, 4)};
    a[4] = {R(0.0), R(0.0), over(16, -1, 36), over(16, 1, 36), over(1, 0, 9)};
  }
};

/// Half-explicit Runge-Kutta in the chart around the step's start (Munthe-Kaas on a group): the velocity constraint
/// holds at every stage, which is linear in the multiplier of the stage before; at the end the position is projected
/// in the metric of M, before the last multiplier is found.
/// order 4, 5 stages, 5 evaluations per step.   The multiplier at the step's end is that of Phi'' = 0 there.
struct HalfExplicit4 {
  static constexpr MethodInfo info{.name = "half_explicit4",
                                   .family = Family::explicit_rk,
                                   .order = 4,
                                   .needs = Needs::constraint,
                                   .source = "Brasey & Hairer (1993), SIAM J. Numer. Anal. 30, 538",
                                   .pitfall = "the position constraint is not part of it: projected after each step"};
  template <class R>
  struct Method {
    HalfExplicitTableau<R> table;

    template <Space M>
    struct Frame {};
    template <Space M>
    using Memory = ConstrainedMemory<M>;

    template <ConstrainedProblem P, class M = typename P::Space, class S = typename M::Scalar>
    void step(P const& p, S const&, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) const {
      using A = AttitudeOf<M>;
      constexpr int stages = HalfExplicitTableau<R>::stages;
      auto const& body = p.mechanics();
      std::array<Chart<A>, stages> turned;
      std::array<Vec3<S>, stages> moved;
      std::array<typename PinnedBody<S>::Accelerations, stages> pushed;
      Chart<A> u = A::centre(x.first.first);
      Point<M> y = x;
      auto& [attitude, omega] = y.first;
      auto& [position, v] = y.second;
      Mat3<S> rotation = rotation_of<A>(attitude);
      for (std::size_t i = 0; i < stages; ++i) {
        turned[i] = A::chart_rate(x.first.first, u, omega);
        moved[i] = v;
        pushed[i] = body.free_accelerations(omega);
        u = A::centre(x.first.first);
        position = x.second.first;
        omega = x.first.second;
        v = x.second.second;
        for (std::size_t j = 0; j <= i; ++j) {
          R const weight = h * table.a[i][j];
          add(u, weight, turned[j]);
          add(position, weight, moved[j]);
          add(omega, weight, pushed[j].first);
          add(v, weight, pushed[j].second);
        }
        attitude = A::retract(x.first.first, u);
        if (i + 1 == stages) memory.unconverged |= !put_on_constraint<A>(body, attitude, position);
        Mat3<S> const before = rotation;
        rotation = rotation_of<A>(attitude);
        Vec3<S> const impulse = body.impulse_against(rotation, before, body.constraint_rate(rotation, omega, v));
        auto const change = body.impulse(before, impulse);
        add(pushed[i], R(R(1.0) / (h * table.a[i][i])), change);
        add(omega, change.first);
        add(v, change.second);
      }
      memory.evaluations += stages;
      memory.multiplier = body.multiplier(rotation, omega);
      x = y;
    }
  };

  template <ConstrainedProblem P>
    requires is_moving_body<typename P::Space>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    return Fixed<Method<R>, P>(Method<R>{}, p, control, policy);
  }
};

// ---- RATTLE ---------------------------------------------------------------------------------------------------------

/// RATTLE on the rotation group, that is the discrete Moser-Veselov step with forces in both half steps.
///   J omega_1/2 = J omega_0 + h/2 r x R_0^T lambda_+      h J omega_1/2 = vee(F J_d - J_d F^T),  R_1 = R_0 F
///   v_1/2 = v_0 + h/2 (g - lambda_+ / m)                  x_1 = x_0 + h v_1/2,  Phi(x_1, R_1) = 0
///   J omega_1 = F^T J omega_1/2 + h/2 r x R_1^T lambda_-,  v_1 = v_1/2 + h/2 (g - lambda_- / m),  G_1 u_1 = 0
/// lambda_+ is eliminated, x being linear in it: three equations for F.
/// order 2; symmetric, symplectic.   lambda_+ and lambda_- are of order 1, their mean at a point of order 2; the
/// multiplier reported at the step's end is that of Phi'' = 0 there, of order 2.
/// Source: Lee, Leok & McClamroch (2007), Comput. Methods Appl. Mech. Engrg. 196, 2907; Hairer, Lubich & Wanner,
/// VII.1.4
struct Rattle {
  static constexpr MethodInfo info{
      .name = "rattle",
      .family = Family::lie_group,
      .order = 2,
      .needs = Needs::constraint_on_group,
      .preserves = keeps_norm | is_symplectic | is_symmetric,
      .source = "Lee, Leok & McClamroch (2007), Comput. Methods Appl. Mech. Engrg. 196, 2907",
      .pitfall = "its own multipliers, before and after a point, are of order 1"};

  template <ConstrainedProblem P>
    requires(is_moving_body<typename P::Space> && !P::Space::flat)
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<Rattle, P>(*this, p, control, policy);
  }
  template <Space M>
  struct Frame {};
  template <Space M>
  struct Memory : ConstrainedMemory<M> {
    Vec3<typename M::Scalar> before = this->multiplier, after = this->multiplier;  ///< lambda_-, lambda_+ of the step
    std::int64_t iterations = 0;
  };

  template <ConstrainedProblem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  void step(P const& p, S const&, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) const {
    using A = AttitudeOf<M>;
    auto const& body = p.mechanics();
    auto& [attitude, omega] = x.first;
    auto& [position, v] = x.second;
    Vec3<S> const r = body.lifted(body.arm()), g = body.lifted(body.gravity());
    Mat3<S> const J = body.lifted(body.inertia().J), start = rotation_of<A>(attitude);
    R const half = R(0.5) * h;
    auto const spin = [&](Vec3<S> const& f) POLHODE_LAMBDA { return J * f; };
    auto const swing = StepRotation<S>::by(r);

    // The arm's end moves by (F - 1) r: differences of positions would lose digits.
    Vec3<S> const reach = h * transposed_times(start, v + half * g);
    Vec3<S> const wanted = h * (J * omega) + body.mass() * cross(r, reach);
    Vec3<S> f = h * omega;
    std::int64_t const sweeps_before = memory.iterations;
    bool const converged = newton(f, memory.iterations, [&](Vec3<S> const& at) POLHODE_LAMBDA {
      StepRotation<S> const F(at);
      auto const slope = [&](Vec3<S> const& d)
                             POLHODE_LAMBDA { return F.slope(spin, d) + body.mass() * cross(r, F.slope(swing, d)); };
      return solve(jacobian<S>(slope), wanted - F.of(spin) - body.mass() * cross(r, F.of(swing)));
    });
    memory.unconverged |= !converged;
    memory.evaluations += memory.iterations - sweeps_before + 1;

    StepRotation<S> const F(f);
    Vec3<S> const reached = F.of(swing), momentum = (R(1.0) / h) * F.of(spin);
    R const force = R(2.0) * body.mass() / (h * h);
    memory.after = force * (start * (reach - reached));
    attitude = A::retract(attitude, f);
    Mat3<S> const end = rotation_of<A>(attitude);
    position = end * r;
    v = (R(1.0) / h) * (start * reached) + half * g;
    omega = body.lifted(body.inertia().inverse) * F.reversed().turned(momentum);
    Vec3<S> const impulse = body.impulse_against(end, end, body.constraint_rate(end, omega, v));
    auto const change = body.impulse(end, impulse);
    add(omega, change.first);
    add(v, change.second);
    memory.before = (R(1.0) / half) * impulse;
    memory.multiplier = body.multiplier(end, omega);
  }
};

}  // namespace polhode
