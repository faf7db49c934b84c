#pragma once
/// What is done about the norm at the border of a step: an axis of its own, not a property of a method.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "problems/power.hpp"

namespace polhode {

/// What is done about the norm at the border of a step.
enum class NormPolicy {
  none,     ///< nothing: the undisturbed method
  project,  ///< the nearest point of the constraint after every step. For quaternions the tether paper's explicit
            ///< projection, eq. (16), which is renormalisation
  project_multiplier,  ///< the same point by Newton on quaternion and multiplier, the paper's eq. (12): what it saves
  project_symmetric,   ///< the step begins as far off the constraint as it ends, and is projected back from there: of a
                       ///< symmetric method it leaves a symmetric one. Hairer (2000), BIT 40, 726; Hairer, Lubich &
                       ///< Wanner, Geometric Numerical Integration, V.4.1. Takes each step two to four times
  baumgarte,   ///< feedback of the defect, q' += K (1 - q.q) q with K = 1 / s, as in six-degrees-of-freedom blocks:
               ///< its flow over the step, after the step. Baumgarte (1972), Comput. Methods Appl. Mech. Eng. 1,
               ///< 1; Ascher, Chin & Reich (1994), Numer. Math. 67, 131
  relaxation,  ///< the increment of the step, all of it, times the gamma that keeps |q|, in gamma times the time.
               ///< Ketcheson (2019), SIAM J. Numer. Anal. 57, 2850
  native,      ///< the library's own projection
};

/// A policy that moves the state to the nearest point of the constraint, after a step that knows nothing of it.
constexpr bool is_projection(NormPolicy policy) {
  return policy == NormPolicy::project || policy == NormPolicy::project_multiplier;
}

/// The policies by their words.
struct PolicyName {
  NormPolicy policy;
  std::string_view name;
};
inline constexpr std::array policy_names{PolicyName{NormPolicy::none, "none"},
                                         PolicyName{NormPolicy::project, "project"},
                                         PolicyName{NormPolicy::project_multiplier, "project_multiplier"},
                                         PolicyName{NormPolicy::project_symmetric, "project_symmetric"},
                                         PolicyName{NormPolicy::baumgarte, "baumgarte"},
                                         PolicyName{NormPolicy::relaxation, "relaxation"},
                                         PolicyName{NormPolicy::native, "native"}};

/// One body, and its attitude a quaternion of four free numbers: where the policies that change the step itself,
/// relaxation and project_symmetric, have their meaning.
template <class M>
concept OneFlatQuaternion = SmallSpace<M> && M::flat && M::constrained && requires(Point<M> x) {
  { x.first } -> std::same_as<Quat<typename M::Scalar>&>;
};

/// The unit quaternion nearest to q by Newton on (q, lambda): q = q^ + lambda q, q.q = 1, from (q^, 0), until the
/// residual no longer falls, at most 20 iterations. Returns the distance moved. Source: Xu et al. (2017), eq. (12),
/// whose closed form is eq. (16)
template <class S>
[[gnu::noinline]] S project_by_multiplier(Quat<S>& q) {
  Quat<S> const start = q;
  S lambda(0.0);
  auto const residual = [&] {
    Quat<S> f;
    Quat<S>::each([&](S& r, S const& now, S const& from) { r = now - from - lambda * now; }, f, q, start);
    return f;
  };
  auto const size = [](Quat<S> const& f, S const& g) { return max_of(distance<S>(f, zero<Quat<S>>()), abs_of(g)); };
  Quat<S> f = residual();
  S g = dot(q, q) - S(1.0);
  for (int iteration = 0; iteration < 20; ++iteration) {
    // (1 - lambda) dq - q dlambda = -f,  2 q.dq = -g
    S const change = (dot(q, f) - S(0.5) * (S(1.0) - lambda) * g) / dot(q, q);
    Quat<S> const q_before = q;
    S const lambda_before = lambda, size_before = size(f, g);
    Quat<S>::each([&](S& a, S const& b, S const& r) { a = b + (change * b - r) / (S(1.0) - lambda_before); }, q,
                  q_before, f);
    lambda = lambda + change;
    f = residual();
    g = dot(q, q) - S(1.0);
    if (size(f, g) < size_before) continue;
    q = q_before;  // round-off: the point before was as good
    break;
  }
  return abs_of(S(sqrt(dot(start, start)) - S(1.0)));
}

/// The feedback gain K of policy baumgarte [1/s]; in h seconds it takes 1 - exp(-2 K h) off a small defect.
inline constexpr double feedback_gain = 1;
/// What part that is, of a step of h [s] in either direction.
inline double feedback_part(double h) {
  return -std::expm1(-2 * feedback_gain * std::fabs(h));
}

/// x moves towards the constraint of M by the part w of its distance, in linear coordinates: the flow of
/// q' = K (1 - q.q) q over h seconds for 1 - w = exp(-2 K h), but for the square of the defect. Stable for every h,
/// which the feedback as a term of the field is not. Returns the distance moved, of many bodies the greatest.
template <Space M>
double move_nearer(Point<M>& x, double w) {
  using Body = typename BodyOf<M>::type;
  using S = typename M::Scalar;
  double most = 0;
  for_each_body<M>(x, [&](auto const& at) {
    Point<Body> nearest = at(x);
    most = std::max(most, w * double(Body::project(nearest)));
    Point<Body>::each([&](S& a, S const& b) { a += S(w) * (b - a); }, at(x), nearest);
  });
  return most;
}

/// |q| - 1, of q near the sphere without cancellation.
template <class S>
S norm_less_one(Quat<S> const& q) {
  S const excess = norm_excess(q);
  return excess / (S(1.0) + sqrt(S(1.0) + excess));
}

/// b - a.
template <class S>
Quat<S> difference(Quat<S> const& a, Quat<S> const& b) {
  return {b.x - a.x, b.y - a.y, b.z - a.z, b.w - a.w};
}
/// Ketcheson's gamma of a step from x to y, with which |q| at x + gamma (y - x) is that at x; less 1, as
/// (|q_x|^2 - |q_y|^2) / |q_y - q_x|^2. 0 for steps so short that rounding decides; they hardly change the norm.
template <OneFlatQuaternion M>
Real<typename M::Scalar> relaxation_less_one(Point<M> const& x, Point<M> const& y) {
  using S = typename M::Scalar;
  Quat<S> const d = difference(x.first, y.first);
  S const length = dot(d, d), least(std::same_as<S, double> ? 0x1p-36 : 0x1p-96);
  if (length < least) return Real<S>(0.0);
  return Real<S>((norm_excess(x.first) - norm_excess(y.first)) / length);
}
/// Gammas further from 1 are refused: the step is too long for relaxation to mean anything.
inline constexpr double farthest_gamma = 0.1;
template <class R>
bool can_relax(R const& gamma_less_one) {
  return std::fabs(double(gamma_less_one)) < farthest_gamma;
}
/// A step of h lands if no more than this times h is left: a step that does not land ends before the end in relaxed
/// time, too, and none is left that is tiny.
inline constexpr double relaxed_reach = 1 + farthest_gamma;

/// q at y, scaled to the length that it has at x.
template <OneFlatQuaternion M>
void take_length(Point<M> const& x, Point<M>& y) {
  using S = typename M::Scalar;
  S const is = norm_less_one(y.first), wanted = norm_less_one(x.first);
  scale(y.first, S((S(1.0) + wanted) / (S(1.0) + is)));
}

/// What the policy did: it never hides the raw drift.
struct Projections {
  std::int64_t count = 0;
  double raw_defect = 0;  ///< the greatest defect that a step had before the policy acted
  double work = 0;        ///< accumulated distance moved

  /// Notes that x, whose defect was `defect`, has been moved by `moved`.
  POLHODE_INLINE void note(double defect, double moved) {
    raw_defect = defect > raw_defect ? defect : raw_defect;
    work += moved;
    ++count;
  }
  /// Projects x onto the constraint of M, as the policy says: project or project_multiplier.
  template <Space M>
  POLHODE_INLINE void apply(Point<M>& x, NormPolicy policy) {
    double const defect = double(M::defect(x));
    note(defect, double(policy == NormPolicy::project ? M::project(x) : by_multiplier(x)));
  }
  /// The same after a step of h [s], whose length policy baumgarte asks for.
  template <Space M>
  void apply(Point<M>& x, NormPolicy policy, double h) {
    if (policy == NormPolicy::baumgarte)
      feed_back<M>(x, feedback_part(h));
    else
      apply<M>(x, policy);
  }
  /// Policy baumgarte after a step, of whose length `part` is the feedback_part.
  template <Space M>
  void feed_back(Point<M>& x, double part) {
    double const defect = double(M::defect(x));
    note(defect, move_nearer<M>(x, part));
  }
  /// Relaxes the step from x to y: y = x + gamma (y - x).
  template <OneFlatQuaternion M>
  void relax(Point<M> const& x, Point<M>& y, Real<typename M::Scalar> const& gamma_less_one) {
    using S = typename M::Scalar;
    double const defect = double(M::defect(y));
    Quat<S> const d = difference(x.first, y.first);
    double const moved = std::fabs(double(gamma_less_one)) * double(sqrt(dot(d, d)));
    Point<M>::each([&](S& b, S const& a) { b += gamma_less_one * (b - a); }, y, x);
    note(defect, moved);
  }
  /// What the policy does after an accepted step of h [s] from x to y, with the gamma of relaxation.
  template <Space M>
  void apply(Point<M> const& x, Point<M>& y, NormPolicy policy, double h,
             Real<typename M::Scalar> const& gamma_less_one) {
    if constexpr (OneFlatQuaternion<M>)
      if (policy == NormPolicy::relaxation) return relax<M>(x, y, gamma_less_one);
    apply<M>(y, policy, h);
  }
  /// What the policy does to a state y within a step, `since` [s] after it began at x, with the gamma that relaxed its
  /// end. Not counted.
  template <Space M>
  static void apply_inside(Point<M> const& x, Point<M>& y, NormPolicy policy, double since,
                           Real<typename M::Scalar> const& gamma_less_one) {
    using S = typename M::Scalar;
    if constexpr (OneFlatQuaternion<M>)
      if (policy == NormPolicy::relaxation) {
        Point<M>::each([&](S& b, S const& a) { b += gamma_less_one * (b - a); }, y, x);
        return take_length<M>(x, y);
      }
    Projections{}.template apply<M>(y, policy, since);
  }

 private:
  /// Only quaternions have this form; elsewhere the policy is refused beforehand.
  template <class X>
  static auto by_multiplier(X& x) {
    if constexpr (requires { x.first; })
      return by_multiplier(x.first);
    else if constexpr (requires { x.w; })
      return project_by_multiplier(x);
    else
      return 0.0;
  }
};

}  // namespace polhode
