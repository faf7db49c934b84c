#pragma once
/// What is done about the norm at the border of a step: an axis of its own, not a property of a method.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "problems/space.hpp"

namespace polhode {

enum class NormPolicy {
  none,     ///< nothing: the undisturbed method
  project,  ///< the nearest point of the constraint after every step. For quaternions the tether paper's explicit
            ///< projection, eq. (16), which is renormalisation
  project_multiplier,  ///< the same point by Newton on quaternion and multiplier, the paper's eq. (12): what it saves
  native,              ///< the library's own projection
};

/// The policies by their words.
struct PolicyName {
  NormPolicy policy;
  std::string_view name;
};
inline constexpr std::array policy_names{
    PolicyName{NormPolicy::none, "none"}, PolicyName{NormPolicy::project, "project"},
    PolicyName{NormPolicy::project_multiplier, "project_multiplier"}, PolicyName{NormPolicy::native, "native"}};

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

/// What projection did: it never hides the raw drift.
struct Projections {
  std::int64_t count = 0;
  double raw_defect = 0;  ///< the greatest defect that a step had before its projection
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
