#pragma once
/// Gauss collocation on the canonical variables of a rigid body, (q, p) in T*S3: symplectic.
///
///   p = 2 q (L, 0), L = J omega the angular momentum in body axes [N m s]: p.q' = L.omega, for q' = 1/2 q (omega, 0)
///   H = 1/2 L.J^-1 L with L = 1/2 vec(conj(q) p), a function on all of R^8
///   q' =  dH/dp = 1/2 q (omega, 0)
///   p' = -dH/dq = 1/2 p (omega, 0) + 2 q (torque, 0)
///
/// q and p turn alike, so |q|, |p|, q.p and the angular momentum in space, 1/2 vec(p conj(q)), are quadratic invariants
/// of the free body, which Gauss keeps to round-off; H is of degree 4, so it oscillates. Torques enter as generalised
/// forces, those of a potential as the slope of one on all of R^4 that does not feel |q|: stages leave the sphere.
///
/// Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, VI.4 (Gauss is symplectic), VII.5 (rigid body)
#include <memory>

#include "integrators/gauss.hpp"
#include "integrators/rigid_motion.hpp"

namespace polhode {

/// (q, p); velocities are those of the eight numbers. The defect is that of q.
template <Scalar S>
struct CotangentS3 : Flat<S, Pair<Quat<S>, Quat<S>>> {
  using Velocity = Pair<Quat<S>, Quat<S>>;
  using Point = Velocity;
  static constexpr bool constrained = true;
  static POLHODE_INLINE Velocity rate(Point const&, Velocity const& v) { return v; }
  static POLHODE_INLINE Velocity chart_rate(Point const&, Velocity const&, Velocity const& v) { return v; }
  /// L [N m s, body].
  static POLHODE_INLINE Vec3<S> momentum(Point const& x) { return S(0.5) * vec(conj(x.first) * x.second); }
  /// The p of q and L.
  static POLHODE_INLINE Quat<S> conjugate(Quat<S> const& q, Vec3<S> const& L) {
    return scaled(S(4.0), quaternion_rate(q, L));
  }
  static POLHODE_INLINE S defect(Point const& x) { return UnitQuaternion<S>::defect(x.first); }
  /// Projects q, and keeps L.
  static S project(Point& x) {
    Vec3<S> const L = momentum(x);
    S const moved = UnitQuaternion<S>::project(x.first);
    x.second = conjugate(x.first, L);
    return moved;
  }
};

/// The field of a body in canonical variables.
template <RigidBodyProblem P>
class CanonicalField {
  using A = typename P::Space::Factor;
  using S = typename A::Scalar;

 public:
  using Space = CotangentS3<S>;
  using State = Point<Space>;

  explicit CanonicalField(P const& body) : body_(&body), inertia_(body.inertia_matrix()), axes_(inertia_) {}

  Velocity<Space> operator()(S const& t, State const& x) const {
    Vec3<S> const omega = rate(Space::momentum(x));
    Velocity<Space> v{quaternion_rate(x.first, omega), quaternion_rate(x.second, omega)};
    if (!body_->torque_free()) {
      Vec3<S> const torque = body_->torque(t, {A::from_attitude(normalised(x.first)), omega});
      add(v.second, S(S(1.0) / dot(x.first, x.first)), Space::conjugate(x.first, torque));
    }
    return v;
  }
  State initial() const { return canonical(body_->initial()); }

  State canonical(Point<typename P::Space> const& x) const {
    Quat<S> const q = A::attitude(x.first);
    return {q, Space::conjugate(q, inertia_ * x.second)};
  }
  Point<typename P::Space> body_state(State const& x) const {
    return {A::from_attitude(x.first), rate(Space::momentum(x))};
  }

 private:
  /// J^-1 L.
  Vec3<S> rate(Vec3<S> const& L) const { return axes_.to_body(axes_.rate(axes_.to_principal(L))); }

  P const* body_;
  Mat3<S> inertia_;
  PrincipalAxes<S> axes_;
};

/// Keeps (q, p) between advances as long as nobody changes the body's state meanwhile: conversions would add rounding
/// errors of their own, and lose what compensated summation carries.
template <RigidBodyProblem P>
class CanonicalStepper {
  using X = Point<typename P::Space>;
  using S = typename P::Space::Scalar;
  using R = Real<S>;
  using Field = CanonicalField<P>;

 public:
  CanonicalStepper(int stages, P const& p, FixedStep control, NormPolicy policy)
      : field_(std::make_unique<Field>(p)), stepper_(GaussOf{stages}.bind(*field_, control, policy)) {}

  Status advance(X& x, R t, R t_end) {
    take_up(x);
    return give(x, stepper_.advance(state_, t, t_end));
  }
  Status one_step(X& x, R t, R t_end) {
    take_up(x);
    return give(x, stepper_.one_step(state_, t, t_end));
  }
  bool moves_time() const { return stepper_.moves_time(); }
  Status relaxed_step(X& x, R& t, R t_end) {
    take_up(x);
    return give(x, stepper_.relaxed_step(state_, t, t_end));
  }
  void restart() {
    stepper_.restart();
    begun_ = false;
  }
  Work work() const { return stepper_.work(); }
  Projections projections() const { return stepper_.projections(); }
  /// (q, p) where the last advance ended.
  Point<typename Field::Space> const& canonical() const { return state_; }

 private:
  void take_up(X const& x) {
    if (begun_ && distance<S>(x, given_) == S(0.0)) return;
    stepper_.restart();
    state_ = field_->canonical(x);
    begun_ = true;
  }
  Status give(X& x, Status status) {
    x = given_ = field_->body_state(state_);
    return status;
  }

  std::unique_ptr<Field> field_;  // the stepper points at it
  decltype(GaussOf{}.bind(std::declval<Field const&>(), FixedStep{}, NormPolicy::none)) stepper_;
  Point<typename Field::Space> state_;
  X given_;
  bool begun_ = false;
};

/// order 2s; symplectic, symmetric; keeps |q| and the angular momentum of a free body in space; H oscillates.
/// fails as gauss.hpp
template <int s>
struct GaussCanonical {
  static_assert(1 <= s && s <= most_gauss_stages);
  static constexpr std::string_view names[] = {"gauss1_canonical", "gauss2_canonical", "gauss3_canonical",
                                               "gauss4_canonical", "gauss5_canonical", "gauss6_canonical",
                                               "gauss7_canonical", "gauss8_canonical"};
  static constexpr MethodInfo info{
      .name = names[s - 1],
      .family = Family::gauss,
      .order = 2 * s,
      .needs = Needs::rigid_body,
      .preserves = keeps_norm | keeps_momentum | keeps_momentum_direction | is_symplectic | is_symmetric,
      .source = "Hairer, Lubich & Wanner, VI.4, VII.5",
      .pitfall = "energy oscillates; only for one rigid body of known inertia"};

  template <RigidBodyProblem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return CanonicalStepper<P>(s, p, control, policy);
  }
};

}  // namespace polhode
