#pragma once
/// Lie group variational integrator of a rigid body under a torque: half a step's kick by the torque, a turn by
/// discrete Moser-Veselov, the other half at the end. Without a torque it is dmv2; with one of a potential the energy
/// error stays bounded, and a component of the angular momentum in space that the potential does not change is kept to
/// round-off.
///
/// A torque that depends on the body rate makes the second kick implicit: a fixed point, solved to round-off, so the
/// step stays symmetric.
///
/// Use under torques of attitude and time over long times; not with steps of a radian and more.
///
/// Source: Lee, Leok & McClamroch (2007), Comput. Methods Appl. Mech. Engrg. 196, 2907; the turn: moser_veselov.hpp
#include "integrators/fixed_point.hpp"
#include "integrators/moser_veselov.hpp"

namespace polhode {

/// order 2; an evaluation of the torque per step, some more if it depends on the rate; symmetric, symplectic
///
/// fails  Status::nonlinear_fail if the turn or the second kick does not converge: the step is too long
struct LieVariational2 {
  static constexpr MethodInfo info{
      .name = "lgvi2",
      .family = Family::rigid_body,
      .order = 2,
      .needs = Needs::rigid_body,
      .preserves = keeps_norm | keeps_energy | keeps_momentum | keeps_momentum_direction | is_symplectic | is_symmetric,
      .source = "Lee, Leok & McClamroch (2007), Comput. Methods Appl. Mech. Engrg. 196, 2907",
      .pitfall = "without a torque every invariant is right and the phase is wrong by O(h^2)"};

  template <class R>
  struct Method {
    PrincipalAxes<R> body;

    /// The motion, and the torque that belongs to it.
    template <Space M>
    struct Memory : Motion<M> {
      Vec3<typename M::Scalar> torque;  ///< [N m, principal axes]
      std::int64_t iterations = 0;
      bool unconverged = false;
    };
    template <Space M>
    struct Frame {};

    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) const {
      R const half = R(0.5) * h;
      bool const free = p.torque_free();
      if (memory.open(body, x) && !free) memory.torque = body.to_principal(p.torque(t, x));
      if (!free) memory.accelerate(half * memory.torque);

      Vec3<R> const& I = body.moments();
      Vec3<S> const J{S(I.x), S(I.y), S(I.z)};
      Vec3<S> c;
      if (!moser_veselov_turn(J, S(half) * memory.momentum, c, memory.iterations)) [[unlikely]]
        memory.unconverged = true;
      memory.turn(body, x, Turn<S>::by_tangent(c));

      if (!free) {
        if (p.torque_feels_rate())
          find_torque(p, S(t + h), half, x, memory);
        else
          memory.torque = body.to_principal(p.torque(S(t + h), x));
        memory.accelerate(half * memory.torque);
      }
      memory.close(body, x);
    }

   private:
    static constexpr int most_sweeps = 100;

    /// The torque at the end of the step, where the momentum is the one in hand and half a kick of that torque. Ends
    /// when the change has no new minimum twice running.
    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    POLHODE_INLINE void find_torque(P const& p, S const& t, R const& half, Point<M>& x, Memory<M>& memory) const {
      S change(0.0);
      AtRest<S> at_rest;
      for (int sweep = 0; sweep < most_sweeps && !at_rest; ++sweep) {
        x.second = body.to_body(body.rate(memory.momentum + half * memory.torque));
        Vec3<S> const next = body.to_principal(p.torque(t, x));
        change = distance<S>(next, memory.torque);
        memory.torque = next;
        ++memory.iterations;
        at_rest.see(change);
      }
      if (!is_solved(change, largest<S>(memory.torque))) [[unlikely]]
        memory.unconverged = true;
    }
  };

  template <RigidBodyProblem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    return Fixed<Method<R>, P>(Method<R>{PrincipalAxes<R>(p.inertia_matrix())}, p, control, policy);
  }
};

}  // namespace polhode
