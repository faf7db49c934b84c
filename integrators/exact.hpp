#pragma once
/// The closed form of the free rigid body as an integrator: Jacobi's elliptic functions and a theta function of time.
/// Every advance starts from the beginning of the arc, not from the last step, so errors do not accumulate: they are
/// those of one evaluation, a few units of round-off times (1 + |L| t / least moment). Any step, backwards, too.
/// Use it for free bodies, above all over long times; under torque see exact_kicks in splitting.hpp.
/// Sources: problems/exact.hpp, where the formulas are; Celledoni, Faso, Safstrom & Zanna (2008), SIAM J. Sci. Comput.
/// 30, 2084
#include <optional>

#include "integrators/rigid_motion.hpp"
#include "problems/exact.hpp"

namespace polhode {

/// An arc begins with the first advance after bind() or restart(); the state that it is given then is the start.
template <RigidBodyProblem P>
class ExactStepper {
  using M = typename P::Space;
  using S = typename M::Scalar;
  using R = Real<S>;

 public:
  ExactStepper(P const& problem, NormPolicy policy) : body_(problem.inertia_matrix()), policy_(policy) {}

  Status advance(Point<M>& x, R t, R t_end) {
    if (!motion_) {
      Quat<S> const here{S(0.0), S(0.0), S(0.0), S(1.0)};
      motion_.emplace(body_.moments(), here, body_.to_principal(x.second));
      start_ = x;
      begun_ = t;
    }
    auto const [turn, omega] = motion_->at(t_end - begun_);
    Vec3<S> const e = body_.to_body(vec(turn));
    x = {turned(start_.first, Quat<S>{e.x, e.y, e.z, turn.w}), body_.to_body(omega)};
    ++work_.steps;
    if (policy_ != NormPolicy::none) projections_.template apply<M>(x, policy_);
    return all_finite(x) ? Status::ok : Status::diverged;
  }
  Status one_step(Point<M>& x, R t, R t_end) { return advance(x, t, t_end); }
  void restart() { motion_.reset(); }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  static Quat<S> turned(Quat<S> const& q, Quat<S> const& turn) { return q * turn; }
  static Mat3<S> turned(Mat3<S> const& m, Quat<S> const& turn) { return m * matrix(turn); }

  PrincipalAxes<R> body_;
  NormPolicy policy_;
  std::optional<ExactFreeBody<S>> motion_;  ///< from the attitude 1, in principal axes
  Point<M> start_;
  R begun_ = R(0.0);
  Work work_;
  Projections projections_;
};

/// Exact but for round-off at any step; 1 evaluation of the closed form per advance, none of the field.
/// keeps  the norm, energy, |L| and the direction of L in space, bounded for ever
struct Exact {
  static constexpr std::string_view arc =
      "each state is that of the closed form at its time, not a step from the one before";
  static constexpr MethodInfo info{
      .name = "exact",
      .family = Family::exact,
      .needs = Needs::free_body,
      .preserves = keeps_norm | keeps_energy | keeps_momentum | keeps_momentum_direction | is_symplectic | is_symmetric,
      .source = "van Zon & Schofield (2007), J. Comput. Phys. 225, 145; Celledoni, Faso, Safstrom & Zanna (2008)",
      .pitfall = "near the separatrix rounding errors of the data themselves grow, whoever integrates",
      .no_feedback = arc,
      .no_relaxation = arc};
  template <RigidBodyProblem P>
    requires std::same_as<typename P::Space::Scalar, Real<typename P::Space::Scalar>>
  auto bind(P const& p, FixedStep, NormPolicy policy) const { return ExactStepper<P>(p, policy); }
};

}  // namespace polhode
