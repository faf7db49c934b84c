#pragma once
/// One body on flat quaternions with its constraints, as differential-algebraic equations of index 2 in the stabilised
/// form: what IDA is given. A system is
///   State                    the point of the problem's space
///   size, differential       unknowns; the first `differential` have derivatives in the equations
///   calls_field              a residual is an evaluation of the problem, which counts it itself
///   from(y)                  the point that the unknowns describe
///   residual(t, y, r)        r = F(t, y, y') - y' of the differential unknowns, F of the algebraic ones
///   has_jacobian(), jacobian(t, y, columns)   dr/dy by columns
///   start(t, x, y)           the unknowns at x, consistent: IDA finds no such values for index 2
///
/// Source: Gear, Leimkuhler & Gupta (1985), J. Comput. Appl. Math. 12, 77
#include <algorithm>
#include <array>
#include <span>

#include "integrators/rivals/jacobian.hpp"
#include "problems/dual.hpp"
#include "problems/pinned_body.hpp"

namespace polhode {

// ---- The norm alone -------------------------------------------------------------------------------------------------

/// An ordinary problem of one body; the norm is its constraint, nu the multiplier [1/s], which is 0 but for round-off:
///   q' = q omega / 2 + nu q,  omega' = f,  0 = q.q - 1
template <Problem P>
  requires std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>>
class UnitNormSystem {
 public:
  using State = Point<typename P::Space>;
  static constexpr int differential = State::size, size = differential + 1;
  static constexpr bool calls_field = true;

  explicit UnitNormSystem(P const& problem) : field_(problem) {}

  static State from(double const* y) {
    State x;
    load(x, y);
    return x;
  }
  void residual(double t, double const* y, double* r) const {
    double const nu = y[differential];
    field_(t, y, r);
    for (int i = 0; i < differential; ++i) r[i] = -r[i] - (i < 4 ? nu * y[i] : 0);
    Quat<double> const q = from(y).first;
    r[differential] = dot(q, q) - 1;
  }
  bool has_jacobian() const {
    if constexpr (DifferentiableProblem<P>)
      return field_.problem().has_jacobian();
    else
      return false;
  }
  void jacobian([[maybe_unused]] double t, [[maybe_unused]] double const* y,
                [[maybe_unused]] std::span<double> columns) const {
    if constexpr (DifferentiableProblem<P>) {
      constexpr auto n = std::size_t(size), m = std::size_t(differential);
      std::array<double, m * m> rate;
      field_.problem().jacobian(t, from(y), rate);
      for (std::size_t j = 0; j < m; ++j) {
        for (std::size_t i = 0; i < m; ++i) columns[i + n * j] = -rate[i + m * j];
        if (j < 4) columns[j + n * j] -= y[m];
        columns[m + n * j] = j < 4 ? 2 * y[j] : 0;
        columns[j + n * m] = j < 4 ? -y[j] : 0;
      }
      columns[m + n * m] = 0;
    }
  }
  /// q is put on its norm, to which it held within the tolerance.
  void start(State x, double* y) const {
    FlatQuaternion<double>::project(x.first);
    store(x, y);
    y[differential] = 0;
  }

 private:
  LibraryField<P> field_;
};

// ---- A constrained body ---------------------------------------------------------------------------------------------

/// The unknowns of a pinned body in storage order.
template <class S>
struct PinnedUnknowns {
  Point<MovingBody<FlatQuaternion<S>>> x;
  Vec3<S> lambda, mu;  ///< [N], [N s]
  S nu;                ///< [1/s]
  static constexpr int differential = 13, size = 20;

  static PinnedUnknowns from(S const* y) {
    PinnedUnknowns u;
    load(u.x, y);
    load(u.lambda, y + differential);
    load(u.mu, y + differential + 3);
    u.nu = y[size - 1];
    return u;
  }
};

/// The residual of a pinned body, without its derivatives.
template <class S>
std::array<S, PinnedUnknowns<S>::size> pinned_residual(PinnedBody<S> const& body, S const* y) {
  auto const u = PinnedUnknowns<S>::from(y);
  Quat<S> const& q = u.x.first.first;
  Vec3<S> const &omega = u.x.first.second, &position = u.x.second.first, &v = u.x.second.second;
  Mat3<S> const R = matrix(q);
  auto const shift = body.impulse(R, u.mu);
  auto const a = body.accelerations(R, omega, u.lambda);
  Point<MovingBody<FlatQuaternion<S>>> rate{{quaternion_rate(q, omega + shift.first), a.first},
                                            {v + shift.second, a.second}};
  add(rate.first.first, u.nu, q);
  scale(rate, S(-1.0));
  std::array<S, PinnedUnknowns<S>::size> r;
  S* const algebraic = r.data() + PinnedUnknowns<S>::differential;
  store(rate, r.data());
  store(body.constraint(R, position), algebraic);
  store(body.constraint_rate(R, omega, v), algebraic + 3);
  r.back() = dot(q, q) - S(1.0);
  return r;
}

/// A pinned body with the norm as one more constraint:
///   q' = q (omega + d_omega) / 2 + nu q,  x' = v + d_v       (d_omega, d_v) = -M^-1 G^T mu
///   M u' = f - G^T lambda,  0 = Phi,  0 = G u,  0 = q.q - 1
class PinnedSystem {
 public:
  using State = Point<MovingBody<FlatQuaternion<double>>>;
  static constexpr int differential = PinnedUnknowns<double>::differential, size = PinnedUnknowns<double>::size;
  static constexpr bool calls_field = false;

  template <ConstrainedProblem P>
  explicit PinnedSystem(P const& problem)
      : body_(problem.mechanics()), slopes_(body_.mass(), body_.inertia().J, body_.arm(), body_.gravity()) {}

  static State from(double const* y) { return PinnedUnknowns<double>::from(y).x; }
  void residual(double, double const* y, double* out) const { std::ranges::copy(pinned_residual(body_, y), out); }
  bool has_jacobian() const { return true; }
  void jacobian(double, double const* y, std::span<double> columns) const {
    constexpr auto n = std::size_t(size);
    std::array<Slopes, n> point;
    for (std::size_t i = 0; i < n; ++i) {
      point[i] = y[i];
      point[i].slope[i] = 1;
    }
    auto const r = pinned_residual(slopes_, point.data());
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) columns[i + n * j] = r[i].slope[j];
  }
  /// The state is put on its constraints, to which it held within the tolerance; lambda is that of index 1, mu and nu
  /// are 0.
  void start(State x, double* y) const {
    auto& [q, omega] = x.first;
    auto& [position, v] = x.second;
    FlatQuaternion<double>::project(q);
    put_on_constraint<FlatQuaternion<double>>(body_, q, position);
    Mat3<double> const R = matrix(q);
    auto const change = body_.impulse(R, body_.impulse_against(R, R, body_.constraint_rate(R, omega, v)));
    add(omega, change.first);
    add(v, change.second);
    std::fill_n(y, size, 0.0);
    store(x, y);
    store(body_.multiplier(R, omega), y + differential);
  }

 private:
  using Slopes = Dual<size>;
  PinnedBody<double> body_;
  PinnedBody<Slopes> slopes_;
};

}  // namespace polhode
