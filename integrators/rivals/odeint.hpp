#pragma once
/// Boost.Odeint behind our face, unmodified: its state is std::array<double, n>, the flat coordinates in storage order.
/// Source: Ahnert & Mulansky (2011), Odeint - solving ordinary differential equations in C++; Boost 1.74
#include <array>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4_classic.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>

#include "integrators/integrator.hpp"

namespace polhode {

/// A problem as Odeint's system function.
template <Problem P>
struct OdeintSystem {
  using M = typename P::Space;
  using State = std::array<double, std::size_t(Chart<M>::size)>;
  P const* problem;

  void operator()(State const& y, State& dydt, double t) const {
    Point<M> x;
    load(x, y.data());
    store(M::rate(x, (*problem)(t, x)), dydt.data());
  }
};

/// Fixed steps of a one-step method of Odeint.
template <class OdeintStepper, Problem P>
class OdeintFixed {
  using M = typename P::Space;

 public:
  OdeintFixed(P const& problem, FixedStep control, NormPolicy policy)
      : system_{&problem}, h_(control.h), policy_(policy) {}

  Status advance(Point<M>& x, double t, double t_end) {
    typename OdeintSystem<P>::State y;
    store(x, y.data());
    auto const whole = std::int64_t(std::floor((t_end - t) / h_ + 1e-9));
    double const reached = t + double(whole) * h_;
    for (std::int64_t i = 0; i < whole; ++i) step(y, t + double(i) * h_, h_);
    if ((t_end - reached) / h_ > 1e-9) step(y, reached, t_end - reached);
    load(x, y.data());
    return all_finite(x) ? Status::ok : Status::diverged;
  }
  void restart() { stepper_ = {}; }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  void step(typename OdeintSystem<P>::State& y, double t, double h) {
    stepper_.do_step(system_, y, t, h);
    ++work_.steps;
    if (policy_ != NormPolicy::project) return;
    Point<M> x;
    load(x, y.data());
    projections_.template apply<M>(x);
    store(x, y.data());
    stepper_ = {};  // a method that reuses its last slope must not: the state moved
  }

  OdeintSystem<P> system_;
  double h_;
  NormPolicy policy_;
  OdeintStepper stepper_;
  Work work_;
  Projections projections_;
};

/// Odeint's own error control around its Dormand-Prince pair, stepped as its integrate_adaptive does.
template <class OdeintPair, Problem P>
class OdeintControlled {
  using M = typename P::Space;
  using ControlledStepper = typename boost::numeric::odeint::result_of::make_controlled<OdeintPair>::type;

 public:
  OdeintControlled(P const& problem, Adaptive control, NormPolicy policy)
      : system_{&problem}, control_(control), policy_(policy), stepper_(make()) {}

  Status advance(Point<M>& x, double t, double t_end) {
    while (t < t_end)
      if (Status const status = step(x, t, t_end); status != Status::ok) return status;
    return Status::ok;
  }
  Status step(Point<M>& x, double& t, double t_end) {
    typename OdeintSystem<P>::State y;
    store(x, y.data());
    for (int trial = 0; trial < most_trials; ++trial) {
      double h = std::min(h_, t_end - t);
      bool const last = h >= t_end - t;
      double const tried = h;
      auto const result = stepper_.try_step(system_, y, t, h);
      if (result == boost::numeric::odeint::success) {
        ++work_.steps;
        if (last) t = t_end;
        if (!last || h < tried || tried == h_) h_ = h;  // a step cut short says little about the next one
        load(x, y.data());
        if (policy_ == NormPolicy::project) {
          projections_.template apply<M>(x);
          stepper_ = make();
        }
        return all_finite(x) ? Status::ok : Status::diverged;
      }
      ++work_.rejected;
      h_ = h;
      if (!(h_ > 10 * std::numeric_limits<double>::epsilon() * std::fabs(t))) return Status::step_underflow;
    }
    return Status::max_steps;
  }
  void restart() { stepper_ = make(); }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  static constexpr int most_trials = 1000;
  ControlledStepper make() const {
    return boost::numeric::odeint::make_controlled(control_.atol, control_.rtol, OdeintPair{});
  }

  OdeintSystem<P> system_;
  Adaptive control_;
  NormPolicy policy_;
  ControlledStepper stepper_;
  double h_ = 0.01;  ///< Odeint asks its user for a first step; its control corrects it within a few
  Work work_;
  Projections projections_;
};

namespace odeint_detail {
template <Problem P>
using State = typename OdeintSystem<P>::State;
template <Problem P>
using Kutta4 = boost::numeric::odeint::runge_kutta4_classic<State<P>>;
template <Problem P>
using Dopri5 = boost::numeric::odeint::runge_kutta_dopri5<State<P>>;
template <class P>
concept Suits = Problem<P> && FlatSpace<typename P::Space> && std::same_as<typename P::Space::Scalar, double>;
}  // namespace odeint_detail

struct OdeintRk4 {
  static constexpr MethodInfo info{.name = "odeint_rk4",
                                   .family = Family::library,
                                   .order = 4,
                                   .needs = Needs::flat,
                                   .rival = true,
                                   .source = "Boost.Odeint 1.74, runge_kutta4_classic on std::array"};
  template <odeint_detail::Suits P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return OdeintFixed<odeint_detail::Kutta4<P>, P>(p, control, policy);
  }
};

struct OdeintDopri5 {
  static constexpr MethodInfo info{.name = "odeint_dopri5",
                                   .family = Family::library,
                                   .order = 5,
                                   .needs = Needs::flat,
                                   .rival = true,
                                   .source = "Boost.Odeint 1.74, runge_kutta_dopri5 on std::array, make_controlled",
                                   .pitfall = "reuses its last slope: must be restarted wherever the field jumps"};
  template <odeint_detail::Suits P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return OdeintFixed<odeint_detail::Dopri5<P>, P>(p, control, policy);
  }
  template <odeint_detail::Suits P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return OdeintControlled<odeint_detail::Dopri5<P>, P>(p, control, policy);
  }
};

}  // namespace polhode
