#pragma once
/// The discrete Moser-Veselov algorithm for the free rigid body, and its orders 4 to 10 by modified moments of inertia.
///
/// One step turns the body by the unit quaternion (e, e_0) with  (h/2) L = e_0 J e + e x J e.  With J = I this is order
/// 2 and the same as RATTLE. The map is integrable and keeps the norm, energy and the momentum in space, so it runs
/// along the exact orbit, only at another speed. Moments that depend on h, the energy H and C = |L|^2 / 2 put that
/// right:
///   1 / J_k = (1 + h^2 s_3 + h^4 s_5 + ...) / I_k + h^2 d_3 + h^4 d_5 + ...
/// H and C do not change, so J is found once.
///
/// Use it for free bodies over long times; not with steps of a radian and more.
///
/// Sources: Moser & Veselov (1991), Commun. Math. Phys. 139, 217; McLachlan & Zanna (2005), Found. Comput. Math. 5, 87;
/// Hairer & Vilmart (2006), J. Phys. A 39, 13225 (modified moments, quaternions); Vilmart (2008), J. Comput. Phys. 227,
/// 7083 (round-off)
#include <span>

#include "integrators/rigid_motion.hpp"
#include "integrators/step_rotation.hpp"

namespace polhode {

/// A term of the modified moments:  integer C^c H^(k - c) sigma_1^a sigma_2^b sigma_3^(s - k) of h^(2 k),
/// sigma_1 = I_1 + I_2 + I_3, sigma_2 = I_1 I_2 + I_2 I_3 + I_3 I_1, sigma_3 = I_1 I_2 I_3.
struct MomentTerm {
  int integer, c, a, b, s;
};
/// s_(2k+1) and d_(2k+1), a common denominator taken out.
struct MomentOrder {
  int denominator;
  std::span<MomentTerm const> s, d;
};

namespace detail {
inline constexpr MomentTerm s3[] = {{-2, 0, 0, 1, 0}, {1, 1, 1, 0, 0}};
inline constexpr MomentTerm d3[] = {{1, 0, 1, 0, 0}, {-2, 1, 0, 0, 0}};
inline constexpr MomentTerm s5[] = {{2, 0, 0, 2, 0}, {-1, 0, 1, 0, 1}, {-2, 1, 1, 1, 0},
                                    {8, 1, 0, 0, 1}, {2, 2, 2, 0, 0},  {-6, 2, 0, 1, 0}};
inline constexpr MomentTerm d5[] = {
    {-1, 0, 1, 1, 0}, {-6, 0, 0, 0, 1}, {-1, 1, 2, 0, 0}, {8, 1, 0, 1, 0}, {-1, 2, 1, 0, 0}};
inline constexpr MomentTerm s7[] = {{-4, 0, 0, 3, 0},  {4, 0, 1, 1, 1},    {72, 0, 0, 0, 2},  {6, 1, 1, 2, 0},
                                    {41, 1, 2, 0, 1},  {-212, 1, 0, 1, 1}, {-36, 2, 2, 1, 0}, {132, 2, 0, 2, 0},
                                    {-30, 2, 1, 0, 1}, {17, 3, 3, 0, 0},   {-66, 3, 1, 1, 0}, {100, 3, 0, 0, 1}};
inline constexpr MomentTerm d7[] = {{2, 0, 1, 2, 0},    {-26, 0, 2, 0, 1}, {60, 0, 0, 1, 1}, {13, 1, 2, 1, 0},
                                    {-64, 1, 0, 2, 0},  {110, 1, 1, 0, 1}, {2, 2, 3, 0, 0},  {-2, 2, 1, 1, 0},
                                    {-176, 2, 0, 0, 1}, {-19, 3, 2, 0, 0}, {72, 3, 0, 1, 0}};
inline constexpr MomentTerm s9[] = {{2, 0, 0, 4, 0},     {-3, 0, 1, 2, 1},   {153, 0, 2, 0, 2},  {-486, 0, 0, 1, 2},
                                    {-4, 1, 1, 3, 0},    {-264, 1, 2, 1, 1}, {1104, 1, 0, 2, 1}, {-828, 1, 1, 0, 2},
                                    {156, 2, 2, 2, 0},   {-612, 2, 0, 3, 0}, {18, 2, 3, 0, 1},   {180, 2, 1, 1, 1},
                                    {1908, 2, 0, 0, 2},  {-154, 3, 3, 1, 0}, {612, 3, 1, 2, 0},  {282, 3, 2, 0, 1},
                                    {-2256, 3, 0, 1, 1}, {62, 4, 4, 0, 0},   {-342, 4, 2, 1, 0}, {378, 4, 0, 2, 0},
                                    {291, 4, 1, 0, 1}};
inline constexpr MomentTerm d9[] = {{-1, 0, 1, 3, 0},    {-6, 0, 2, 1, 1},  {-126, 0, 0, 2, 1}, {459, 0, 1, 0, 2},
                                    {-30, 1, 2, 2, 0},   {128, 1, 0, 3, 0}, {194, 1, 3, 0, 1},  {-552, 1, 1, 1, 1},
                                    {-1296, 1, 0, 0, 2}, {-30, 2, 3, 1, 0}, {114, 2, 1, 2, 0},  {-798, 2, 2, 0, 1},
                                    {2136, 2, 0, 1, 1},  {-1, 3, 4, 0, 0},  {222, 3, 2, 1, 0},  {-864, 3, 0, 2, 0},
                                    {684, 3, 1, 0, 1},   {-61, 4, 3, 0, 0}, {243, 4, 1, 1, 0},  {-610, 4, 0, 0, 1}};
}  // namespace detail

/// k = 1 .. 4. Found by matching the step with the power series of the exact turn; s_3 .. d_7 are those printed by
/// Hairer & Vilmart (2006) in other symmetric functions.
inline constexpr MomentOrder moment_orders[] = {{6, detail::s3, detail::d3},
                                                {60, detail::s5, detail::d5},
                                                {2520, detail::s7, detail::d7},
                                                {45360, detail::s9, detail::d9}};

/// The modified moments of a step h [s] for a body of principal moments I [kg m^2] and momentum L [N m s, principal
/// axes]; with k terms the method is of order 2 k + 2.
template <class S, class R>
Vec3<S> modified_moments(Vec3<R> const& I, Vec3<S> const& L, R const& h, std::span<MomentOrder const> terms) {
  S const sigma1(I.x + I.y + I.z), sigma2(I.x * I.y + I.y * I.z + I.z * I.x), sigma3(I.x * I.y * I.z);
  S const C = R(0.5) * dot(L, L), H = R(0.5) * (L.x * L.x / S(I.x) + L.y * L.y / S(I.y) + L.z * L.z / S(I.z));
  auto const power = [](S const& x, int n) {
    S product(1.0);
    for (int i = 0; i < n; ++i) product = product * x;
    return product;
  };
  S factor(1.0), shift(0.0), weight(1.0);
  int k = 0;
  for (MomentOrder const& order : terms) {
    ++k;
    weight = weight * (S(h * h) / sigma3);
    auto const sum = [&](std::span<MomentTerm const> polynomial) {
      S total(0.0);
      for (auto const& [integer, c, a, b, s] : polynomial)
        total += R(double(integer)) *
                 (power(C, c) * power(H, k - c) * power(sigma1, a) * power(sigma2, b) * power(sigma3, s));
      return weight * total / S(double(order.denominator));
    };
    factor += sum(order.s);
    shift += sum(order.d);
  }
  auto const modified = [&](R const& moment) { return S(1.0) / (factor / S(moment) + shift); };
  return {modified(I.x), modified(I.y), modified(I.z)};
}

/// c = e / e_0 of a step: Newton for  J c + c x J c = (1 + |c|^2) v,  v = (h/2) L. Counts its sweeps; false if they do
/// not converge: the step is too long.
template <class S>
bool moser_veselov_turn(Vec3<S> const& J, Vec3<S> const& v, Vec3<S>& c, std::int64_t& sweeps) {
  auto const times_J = [&J](Vec3<S> const& a) { return Vec3<S>{J.x * a.x, J.y * a.y, J.z * a.z}; };
  c = {v.x / J.x, v.y / J.y, v.z / J.z};
  return newton(c, sweeps, [&](Vec3<S> const& at) {
    Vec3<S> const Jc = times_J(at);
    auto const slope = [&](Vec3<S> const& d) {
      Vec3<S> const Jd = times_J(d);
      return Jd + cross(d, Jc) + cross(at, Jd) - (Real<S>(2.0) * dot(at, d)) * v;
    };
    return solve(jacobian<S>(slope), (S(1.0) + dot(at, at)) * v - Jc - cross(at, Jc));
  });
}

/// order 2, 4, 6, 8 or 10; implicit, no evaluation of the field; symmetric; order 2 is symplectic. The others are so in
/// the momentum alone: their moments depend on the state, and that of the attitude feels it.
/// keeps  the norm, energy, |L| and the direction of L in space to round-off
/// fails  Status::nonlinear_fail if Newton does not converge
template <int order>
struct MoserVeselov {
  static_assert(order >= 2 && order <= 10 && order % 2 == 0);
  static constexpr std::string_view names[] = {"dmv2", "dmv4", "dmv6", "dmv8", "dmv10"};
  static constexpr MethodInfo info{
      .name = names[order / 2 - 1],
      .family = Family::rigid_body,
      .order = order,
      .needs = Needs::free_body,
      .preserves = keeps_norm | keeps_energy | keeps_momentum | keeps_momentum_direction | is_symmetric |
                   (order == 2 ? is_symplectic : keeps_nothing),
      .source = order == 2 ? "Moser & Veselov (1991); the same as RATTLE: McLachlan & Zanna (2005)"
                           : "Hairer & Vilmart (2006), J. Phys. A 39, 13225; round-off: Vilmart (2008)",
      .pitfall = order == 2 ? "every invariant is right and the phase is wrong by O(h^2)"
                            : "its moments depend on h, energy and |L|: of no use under a torque, and symplectic for "
                              "the momentum alone, not with the attitude"};

  template <class R>
  struct Method {
    PrincipalAxes<R> body;

    /// The motion, and the moments that belong to it and to the step h.
    template <Space M>
    struct Memory : Motion<M> {
      R h = R(0.0);
      Vec3<typename M::Scalar> J;
      std::int64_t iterations = 0;
      bool unconverged = false;  ///< a step's Newton iteration failed
    };
    template <Space M>
    struct Frame {};

    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    void step(P const&, S const&, R const& h, Point<M>& x, Frame<M>&, Memory<M>& memory) const {
      bool const opened = memory.open(body, x);
      if (opened || memory.h != h) [[unlikely]] {
        memory.h = h;
        memory.J = modified_moments<S>(body.moments(), memory.momentum, h,
                                       std::span(moment_orders).first(std::size_t(order / 2 - 1)));
      }
      Vec3<S> c;
      if (!moser_veselov_turn(memory.J, S(R(0.5) * h) * memory.momentum, c, memory.iterations)) [[unlikely]]
        memory.unconverged = true;
      memory.turn(body, x, Turn<S>::by_tangent(c));
      memory.close(body, x);
    }
  };

  template <RigidBodyProblem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    return Fixed<Method<R>, P>(Method<R>{PrincipalAxes<R>(p.inertia_matrix())}, p, control, policy);
  }
};

}  // namespace polhode
