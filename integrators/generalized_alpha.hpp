#pragma once
/// The generalized-alpha method on a Lie group for constrained systems: the standard of flexible multibody dynamics.
/// Use where stiff parts are to be damped; it keeps neither energy nor the velocity constraint.
/// fails   Status::nonlinear_fail if Newton does not converge: the step turns the body too far
#include "integrators/constrained.hpp"

namespace polhode {

/// The Lie-group generalized-alpha method with rho_inf = .8, index 3: only Phi = 0 is imposed.
///   u     = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),  q_1 = q_0 exp(u),  v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1)
///   (1 - alpha_m) a_1 + alpha_m a_0 = (1 - alpha_f) v'_1 + alpha_f v'_0,   M v'_1 = f - G^T lambda_1,  Phi(q_1) = 0
/// with v for (omega, v) and q for (R, x). x_1 = R_1 r and lambda_1 are eliminated: three equations for the rotation.
/// Starting values: a_0 = v'(t_0 + (alpha_m - alpha_f) h), and a velocity off its constraint by O(h^2), against the
/// local error of q: without them lambda is of order 1 until the transient is damped.
/// order 2 in all of q, v, lambda; G u = O(h^2).
/// Source: Bruels, Cardona & Arnold (2012), Mech. Mach. Theory 48, 121; start: Arnold, Bruels & Cardona (2015), Numer.
/// Math. 129, 149
struct GeneralizedAlpha {
  static constexpr MethodInfo info{
      .name = "generalized_alpha",
      .family = Family::lie_group,
      .order = 2,
      .needs = Needs::constraint_on_group,
      .preserves = keeps_norm,
      .source = "Bruels, Cardona & Arnold (2012), Mech. Mach. Theory 48, 121; Arnold, Bruels & Cardona (2015)",
      .pitfall = "damps energy by design; the velocity constraint is met to O(h^2) only"};

  template <ConstrainedProblem P>
    requires(is_moving_body<typename P::Space> && !P::Space::flat)
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<GeneralizedAlpha, P>(*this, p, control, policy);
  }
  template <Space M>
  struct Frame {};
  template <Space M>
  struct Memory : ConstrainedMemory<M> {
    using S = typename M::Scalar;
    typename PinnedBody<S>::Accelerations rate, a;  ///< v' and a at the end of the last step
    Real<S> h{0.0};                                 ///< of the last step; 0: none
    std::int64_t iterations = 0;
    void restart() { h = Real<S>(0.0); }
  };
  /// alpha_m, alpha_f, gamma, beta of rho_inf.
  template <class R>
  struct Coefficients {
    R rho = R(4.0) / R(5.0);
    R alpha_m = (R(2.0) * rho - R(1.0)) / (rho + R(1.0));
    R alpha_f = rho / (rho + R(1.0));
    R gamma = R(0.5) + alpha_f - alpha_m;
    R beta = R(0.25) * (gamma + R(0.5)) * (gamma + R(0.5));
  };

  template <ConstrainedProblem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  void step(P const& p, S const&, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) const {
    using A = AttitudeOf<M>;
    Coefficients<R> const k;
    auto const& body = p.mechanics();
    auto& [attitude, omega] = x.first;
    auto& [position, v] = x.second;
    if (memory.h == R(0.0))
      start<A>(body, k, h, x, memory);
    else if (!(memory.h == h))
      rescale(R(h / memory.h), memory);
    memory.h = h;

    Vec3<S> const r = body.lifted(body.arm()), g = body.lifted(body.gravity());
    Mat3<S> const J = body.lifted(body.inertia().J), before = rotation_of<A>(attitude);
    R const early = (R(0.5) - k.beta) * h * h, late = k.beta * h * h, share = R(1.0) / (R(1.0) - k.alpha_f);
    R const stiffness = (R(1.0) - k.alpha_m) * share / late, damping = k.gamma / (k.beta * h), mass = body.mass();
    // Translation in the axes of the body at the step's start.
    Vec3<S> const turn = h * omega + early * memory.a.first;
    Vec3<S> const shift = transposed_times(before, h * v + early * memory.a.second);
    auto const rate_of = [&](Vec3<S> const& a, Vec3<S> const& a0, Vec3<S> const& rate) POLHODE_LAMBDA {
      return share * ((R(1.0) - k.alpha_m) * a + k.alpha_m * a0 - k.alpha_f * rate);
    };
    Vec3<S> const a0 = transposed_times(before, memory.a.second), rate0 = transposed_times(before, memory.rate.second);
    Vec3<S> const weight = transposed_times(before, g);
    auto const swing = StepRotation<S>::by(r);
    Vec3<S> a_turn, a_shift, omega_end, rate_turn, rate_shift, force;
    auto const look = [&](StepRotation<S> const& F, Vec3<S> const& f) POLHODE_LAMBDA {
      a_turn = (R(1.0) / late) * (f - turn);
      a_shift = (R(1.0) / late) * (F.of(swing) - shift);
      omega_end = omega + (h * (R(1.0) - k.gamma)) * memory.a.first + (h * k.gamma) * a_turn;
      rate_turn = rate_of(a_turn, memory.a.first, memory.rate.first);
      rate_shift = rate_of(a_shift, a0, rate0);
      force = mass * (weight - rate_shift);
    };
    Vec3<S> f = h * omega;
    std::int64_t const sweeps_before = memory.iterations;
    bool const converged = newton(f, memory.iterations, [&](Vec3<S> const& at) POLHODE_LAMBDA {
      StepRotation<S> const F(at), back = F.reversed();
      look(F, at);
      Vec3<S> const momentum = J * omega_end;
      Vec3<S> const residual = J * rate_turn - cross(momentum, omega_end) - cross(r, back.turned(force));
      auto const push = StepRotation<S>::by(force);
      auto const slope = [&](Vec3<S> const& d) POLHODE_LAMBDA {
        Vec3<S> const Jd = J * d;
        Vec3<S> const torque = back.turned((-stiffness * mass) * F.slope(swing, d)) - back.slope(push, d);
        return stiffness * Jd - damping * (cross(Jd, omega_end) + cross(momentum, d)) - cross(r, torque);
      };
      return S(-1.0) * solve(jacobian<S>(slope), residual);
    });
    memory.unconverged |= !converged;
    memory.evaluations += memory.iterations - sweeps_before;

    look(StepRotation<S>(f), f);
    v = v + (h * (R(1.0) - k.gamma)) * memory.a.second + (h * k.gamma) * (before * a_shift);
    omega = omega_end;
    attitude = A::retract(attitude, f);
    position = rotation_of<A>(attitude) * r;
    memory.a = {a_turn, before * a_shift};
    memory.rate = {rate_turn, before * rate_shift};
    memory.multiplier = before * force;
  }

 private:
  /// The starting values; x gets its velocity off the constraint.
  template <Attitude A, class S, class R, class X, class Kept>
  static void start(PinnedBody<S> const& body, Coefficients<R> const& k, R const& h, X& x, Kept& memory) {
    auto& [attitude, omega] = x.first;
    R const offset = (k.alpha_m - k.alpha_f) * h;
    auto const rate_at = [&](Mat3<S> const& rotation, Vec3<S> const& spin) {
      return body.accelerations(rotation, spin, body.multiplier(rotation, spin));
    };
    Mat3<S> const here = rotation_of<A>(attitude);
    memory.rate = rate_at(here, omega);
    memory.a = rate_at(rotation_of<A>(A::retract(attitude, offset * omega)), omega + offset * memory.rate.first);
    memory.evaluations += 2;
    // The local error of q over h^3: (beta + (alpha_m - alpha_f) / 2 - 1/6) v'' - omega x omega' / 12.
    R const part = (k.beta - R(1.0) / R(6.0)) / offset + R(0.5) / h;
    Vec3<S> const turn =
        part * (memory.a.first - memory.rate.first) - (R(1.0) / R(12.0)) * cross(omega, memory.rate.first);
    Vec3<S> const shift = part * (memory.a.second - memory.rate.second);
    Vec3<S> const off = (h * h) * body.constraint_rate(here, turn, shift);
    auto const change = body.impulse(here, body.impulse_against(here, here, off));
    add(omega, change.first);
    add(x.second.second, change.second);
  }
  /// a belongs to a time that depends on h: a = v' + (alpha_m - alpha_f) h v''.
  template <class R, class Kept>
  static void rescale(R const& ratio, Kept& memory) {
    auto& [turn, shift] = memory.a;
    turn = memory.rate.first + ratio * (turn - memory.rate.first);
    shift = memory.rate.second + ratio * (shift - memory.rate.second);
  }
};

}  // namespace polhode
