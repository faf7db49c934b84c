#pragma once
/// Free bodies for tests of methods that are made for them: fields, invariants, random bodies near every degeneracy.
#include <algorithm>
#include <array>
#include <string>

#include "integrators/integrator.hpp"
#include "problems/exact.hpp"
#include "problems/rigid_body.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode::test {

/// A body, 3 principal moments or xx yy zz xy xz yz [kg m^2], its rate [rad/s] and attitude.
struct FreeCase {
  std::string kind;
  std::vector<double> inertia{60, 120, 90};
  Vec3<double> omega0{0.3, -0.2, 0.25};
  Quat<double> q0{0.227, 0.383, 0.227, 0.866};

  BodyParameters body() const {
    return {.inertia = inertia, .q0 = {q0.x, q0.y, q0.z, q0.w}, .omega0 = {omega0.x, omega0.y, omega0.z}};
  }
  template <Scalar S, template <class> class A>
  auto field() const {
    return controlled_body<S, A, true>(body(), NoTorque<S>{});
  }
  template <Scalar S, template <class> class A>
  auto field_of_matrix() const {
    return controlled_body<S, A, false>(body(), NoTorque<S>{});
  }
  /// 3 principal moments only.
  template <class S>
  ExactFreeBody<S> exact() const {
    Vec3<S> const J{S(inertia[0]), S(inertia[1]), S(inertia[2])};
    return {J, body().attitude<S>(), in<S>(omega0)};
  }
  double momentum() const {
    auto const J = body().matrix<double>();
    return length(J * omega0);
  }
  double least_moment() const { return *std::min_element(inertia.begin(), inertia.begin() + 3); }
};

/// None of whose axes is a principal one.
inline FreeCase turned_axes() {
  FreeCase c{.kind = "products of inertia"};
  c.inertia = {78, 96, 96, -18, 9, 12};
  return c;
}

/// How far a state is from what a free body keeps, relative; the norm as q.q - 1 or the Frobenius norm of R^T R - 1.
struct Drift {
  double norm = 0, energy = 0, momentum = 0, direction = 0;

  double worst() const { return std::max({norm, energy, momentum, direction}); }
  void widen(Drift const& other) {
    norm = std::max(norm, other.norm);
    energy = std::max(energy, other.energy);
    momentum = std::max(momentum, other.momentum);
    direction = std::max(direction, other.direction);
  }
};
template <class P>
Drift drift_of(P const& problem, Point<typename P::Space> const& x) {
  using M = typename P::Space;
  using A = typename M::Factor;
  auto const energy = [&](auto const& y) { return dot(y.second, problem.inertia_matrix() * y.second); };
  auto const momentum = [&](auto const& y) {
    return to_inertial(normalised(A::attitude(y.first)), problem.inertia_matrix() * y.second);
  };
  auto const start = problem.initial();
  auto const L0 = momentum(start), L = momentum(x);
  auto const size = length(L0);
  return {double(M::defect(x)), std::fabs(double(energy(x) / energy(start) - 1)),
          std::fabs(double(length(L) / size - 1)), double(length(L - L0) / size)};
}
/// The worst of n samples, `apart` seconds from each other, of a run with steps of h [s].
template <class P, class Method>
Drift drift_over(P const& problem, Method const& method, double h, int n, double apart) {
  auto stepper = method.bind(problem, FixedStep{h}, NormPolicy::none);
  auto x = problem.initial();
  Drift drift;
  for (int i = 0; i < n; ++i) {
    if (stepper.advance(x, i * apart, (i + 1) * apart) != Status::ok) return {.norm = 1e300};
    drift.widen(drift_of(problem, x));
  }
  return drift;
}

/// Random bodies whose moments obey the triangle inequality, sizes over seven decades. Of ten in a row four are nothing
/// special, and one each is near or at: two equal moments, three, the separatrix, a spin about one axis, a thin rod, a
/// flat plate.
inline FreeCase random_case(Random& random, int n) {
  auto const tiny = [&] { return std::pow(10, random.uniform(-16, -1)); };
  double const a = random.uniform(0.1, 1), b = random.uniform(0.1, 1), c = random.uniform(0.1, 1);
  std::array<double, 3> I{b + c, c + a, a + b};
  std::array<double, 3> w{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  std::string kind = "generic";
  switch (n % 10) {
    case 4:
      kind = "two near moments";
      I[1] = n % 20 == 4 ? I[0] * (1 + tiny()) : I[0];
      break;
    case 5:
      kind = "three near moments";
      I[1] = I[0] * (1 + tiny());
      I[2] = n % 20 == 5 ? I[0] * (1 - tiny()) : I[0];
      break;
    case 6: {
      kind = "near the separatrix";
      std::sort(I.begin(), I.end());
      double const on = std::sqrt(I[0] * (I[1] - I[0]) / (I[2] * (I[2] - I[1])));
      w[2] = std::copysign(w[0] * on * (1 + (n % 20 == 6 ? tiny() : -tiny())), w[2]);
      break;
    }
    case 7: {
      kind = "near a spin";
      auto const axis = std::size_t(random.uniform(0, 3));
      w[(axis + 1) % 3] *= tiny();
      w[(axis + 2) % 3] *= n % 20 == 7 ? tiny() : 0;
      break;
    }
    case 8:
      kind = "thin rod";
      I = {c * random.uniform(1e-3, 1e-2), a + b, a + b * random.uniform(0.99, 1)};
      break;
    case 9:
      kind = "flat plate";
      I = {a, b, (a + b) * (1 - 1e-3 * tiny())};
      break;
    default:
      break;
  }
  double const size = std::pow(10, random.uniform(-3, 4));
  std::size_t const shift = std::size_t(random.uniform(0, 3));
  auto const turned = [&](std::array<double, 3> const& v, std::size_t i) { return v[(i + shift) % 3]; };
  FreeCase result{.kind = kind};
  for (std::size_t i = 0; i < 3; ++i) result.inertia[i] = size * turned(I, i);
  result.omega0 = {turned(w, 0), turned(w, 1), turned(w, 2)};
  result.q0 = random.attitude();
  return result;
}

}  // namespace polhode::test
