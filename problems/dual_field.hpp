#pragma once
/// Jacobians of a field in flat coordinates, from the same field in dual numbers: exact to round-off. For implicit
/// methods.
/// Source: Griewank & Walther (2008), Evaluating Derivatives, ch. 3 (forward mode, by chunks of directions)
///
///   WithJacobian<P, D>         a problem over double, and itself over dual numbers, D; D may be an Erased
///
///   with_differentiable_field  a definition's field as chosen, with its Jacobian where its space is flat
///
/// Both halves are told of samples, phases, sides and new runs, so both hold the same torque.
#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "problems/definition.hpp"
#include "problems/dual.hpp"
#include "problems/erased.hpp"

namespace polhode {

/// Directions that one evaluation differentiates in. Of 1, 4, 5, 7, 8 and 12, 4 took the least time on one body, where
/// it makes two evaluations.
inline constexpr int jacobian_directions = 4;
using JacobianScalar = Dual<jacobian_directions>;

/// A field in dual numbers, spoken to in doubles. Owns the field: by value, or where its type is forgotten by pointer.
///   D  a problem over Dual<N> on a flat space
template <Problem D>
  requires FlatSpace<typename D::Space>
class DualField {
  using M = typename D::Space;
  using S = typename M::Scalar;
  static constexpr int N = int(std::tuple_size_v<decltype(S::slope)>);

 public:
  using Owned = std::conditional_t<std::is_abstract_v<D>, std::unique_ptr<D>, D>;

  explicit DualField(Owned field) : field_(std::move(field)), fresh_(copy_of(field_)) {
    if constexpr (PowerSpace<M>) {
      room_.x = problem().initial();
      room_.v = shaped_like<Velocity<M>>(room_.x);
      room_.k = shaped_like<Chart<M>>(room_.x);
    }
  }

  /// J[i + n j] = d rate_i / d x_j at (t, x): by columns, n numbers in a state. x is the point in doubles, as
  /// everywhere below.
  template <class X>
  void jacobian(double t, X const& x, std::span<double> J) const {
    int const n = size_of(x);
    for (int first = 0; first < n; first += N) {
      with_point(x, first, [&](Room& room) {
        slope(problem(), S(t), room.x, room.v, room.k);
        store_columns(room.k, first, n, J);
      });
    }
  }
  /// A new run: what it remembers is forgotten.
  void begin() {
    if constexpr (requires(D & d) { d.begin(); })
      problem().begin();
    else if constexpr (!std::is_abstract_v<D>)
      field_ = fresh_;
  }
  template <class X>
  void sample([[maybe_unused]] double t, [[maybe_unused]] X const& x) {
    if constexpr (SampledProblem<D>) with_point(x, nowhere, [&](Room& room) { problem().sample(t, room.x); });
  }
  template <class X>
  void take_sides([[maybe_unused]] double t, [[maybe_unused]] X const& x) {
    if constexpr (SwitchingProblem<D>) with_point(x, nowhere, [&](Room& room) { problem().take_sides(t, room.x); });
  }
  void cross([[maybe_unused]] int k) {
    if constexpr (SwitchingProblem<D>) problem().cross(k);
  }
  void enter_phase([[maybe_unused]] double t) {
    if constexpr (requires(D & d) { d.enter_phase(t); }) problem().enter_phase(t);
  }

 private:
  struct Room {
    Point<M> x;
    Velocity<M> v;
    Chart<M> k;
  };
  struct Nothing {};
  using Copy = std::conditional_t<std::is_abstract_v<D>, Nothing, Owned>;
  static Copy copy_of([[maybe_unused]] Owned const& field) {
    if constexpr (std::is_abstract_v<D>)
      return {};
    else
      return field;
  }
  static constexpr int nowhere = -N;  ///< no coordinate moves

  D const& problem() const {
    if constexpr (std::is_abstract_v<D>)
      return *field_;
    else
      return field_;
  }
  D& problem() { return const_cast<D&>(std::as_const(*this).problem()); }

  /// Calls f(room), room.x being x with the coordinates from `first` on as directions.
  template <class X, class F>
  void with_point(X const& x, int first, F f) const {
    if constexpr (PowerSpace<M>) {
      seed(room_.x, x, first);
      f(room_);
    } else {
      Room here;
      seed(here.x, x, first);
      f(here);
    }
  }
  template <class X>
  static void seed(Point<M>& y, X const& x, int first) {
    int direction = -first;
    Point<M>::each(
        [&](S& component, double value) {
          component = value;
          if (0 <= direction && direction < N) component.slope[std::size_t(direction)] = 1;
          ++direction;
        },
        y, x);
  }
  static void store_columns(Chart<M> const& k, int first, int n, std::span<double> J) {
    int const count = std::min(N, n - first);
    double* out = J.data() + std::ptrdiff_t(first) * n;
    Chart<M>::each(
        [&](S const& rate) {
          for (int j = 0; j < count; ++j) out[std::ptrdiff_t(j) * n] = rate.slope[std::size_t(j)];
          ++out;
        },
        k);
  }

  Owned field_;
  Copy fresh_;
  mutable std::conditional_t<PowerSpace<M>, Room, Nothing> room_;
};

/// A problem over double that has its Jacobian from itself over dual numbers.
template <Problem P, Problem D>
class WithJacobian : public P {
  using X = Point<typename P::Space>;

 public:
  WithJacobian(P problem, typename DualField<D>::Owned duals)
      : P(problem), fresh_(std::move(problem)), duals_(std::move(duals)) {}

  bool has_jacobian() const { return true; }
  void jacobian(double t, X const& x, std::span<double> columns) const { duals_.jacobian(t, x, columns); }

  /// A new run: what both halves remember is forgotten.
  void begin() {
    if constexpr (requires(P & p) { p.begin(); })
      P::begin();
    else
      static_cast<P&>(*this) = fresh_;
    duals_.begin();
  }
  void sample(double t, X const& x) requires SampledProblem<P> {
    P::sample(t, x);
    duals_.sample(t, x);
  }
  void enter_phase(double t) requires requires(P& p) { p.enter_phase(t); }
  {
    P::enter_phase(t);
    duals_.enter_phase(t);
  }
  void take_sides(double t, X const& x) requires SwitchingProblem<P> {
    P::take_sides(t, x);
    duals_.take_sides(t, x);
  }
  void cross(int k) requires SwitchingProblem<P> {
    P::cross(k);
    duals_.cross(k);
  }

 private:
  P fresh_;
  DualField<D> duals_;
};

/// The same space over the scalar T.
template <class M, class T>
struct SpaceOver {
  using type = typename M::template Over<T>;
};
template <class S, class T>
struct SpaceOver<Euclidean3<S>, T> {
  using type = Euclidean3<T>;
};
template <class A, class B, class T>
struct SpaceOver<Product<A, B>, T> {
  using type = Product<typename SpaceOver<A, T>::type, typename SpaceOver<B, T>::type>;
};
template <class M, int n, class T>
struct SpaceOver<Power<M, n>, T> {
  using type = Power<typename SpaceOver<M, T>::type, n>;
};

/// Calls f(field) with the field as chosen, over double; on a flat space the field knows its Jacobian.
template <template <class> class A, Definition D, class F>
void with_differentiable_field(D const& definition, F f) {
  with_field<double, A>(definition, [&](auto field) {
    using P = decltype(field);
    if constexpr (FlatSpace<typename P::Space>) {
      using Duals = typename SpaceOver<typename P::Space, JacobianScalar>::type;
      f(WithJacobian<P, Erased<Duals>>(std::move(field), erased_on<Duals, A>(definition)));
    } else {
      f(std::move(field));
    }
  });
}

}  // namespace polhode
