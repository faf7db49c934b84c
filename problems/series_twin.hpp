#pragma once
/// A body's field together with itself on power series, for methods that expand its solution (taylor.hpp).
#include <memory>
#include <utility>

#include "problems/erased.hpp"

namespace polhode {

/// The field P, and its twin on power series, which is told what the field is told: both hold the same torque.
template <Problem P>
  requires std::same_as<typename P::Space, RigidBody<FlatQuaternion<double>>>
class WithSeriesTwin : public P {
  using X = Point<typename P::Space>;
  using Y = Point<SeriesTwin::Space>;

 public:
  WithSeriesTwin(P problem, std::unique_ptr<SeriesTwin> twin) : P(std::move(problem)), twin_(std::move(twin)) {
    if constexpr (std::copyable<P>) fresh_.emplace(static_cast<P const&>(*this));
  }

  SeriesTwin const* series() const { return twin_.get(); }

  /// A new run: what both remember is forgotten.
  void begin() {
    if constexpr (requires(P & p) { p.begin(); })
      P::begin();
    else
      static_cast<P&>(*this) = *fresh_;
    twin_->begin();
  }
  void sample(double t, X const& x) requires SampledProblem<P> {
    P::sample(t, x);
    twin_->sample(t, constant(x));
  }
  void enter_phase(double t) requires requires(P& p) { p.enter_phase(t); }
  {
    P::enter_phase(t);
    twin_->enter_phase(t);
  }
  void take_sides(double t, X const& x) requires SwitchingProblem<P> {
    P::take_sides(t, x);
    twin_->take_sides(t, constant(x));
  }
  void cross(int k) requires SwitchingProblem<P> {
    P::cross(k);
    twin_->cross(k);
  }

 private:
  static Y constant(X const& x) {
    std::array<double, std::size_t(X::size)> numbers;
    store(x, numbers.data());
    std::array<SeriesTwin::S, std::size_t(X::size)> series;
    std::copy(numbers.begin(), numbers.end(), series.begin());
    Y y;
    load(y, series.data());
    return y;
  }

  std::optional<P> fresh_;
  std::unique_ptr<SeriesTwin> twin_;
};

}  // namespace polhode
