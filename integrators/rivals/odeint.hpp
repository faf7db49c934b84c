#pragma once
/// Boost.Odeint behind our face, unmodified: its state is std::array<double, n>, the flat coordinates in storage order.
/// Source: Ahnert & Mulansky (2011), Odeint - solving ordinary differential equations in C++; Boost 1.74
#include <array>
#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4_classic.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_cash_karp54.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <optional>
#include <vector>

#include "integrators/rivals/library_field.hpp"

namespace polhode {

/// Odeint's state: an array for one body, a vector for many.
template <Space M>
struct OdeintState {
  using type = std::vector<double>;
  static type of(Point<M> const& x) {
    type y(std::size_t(size_of(x)));
    store(x, y.data());
    return y;
  }
};
template <SmallSpace M>
struct OdeintState<M> {
  using type = std::array<double, std::size_t(Chart<M>::size)>;
  static type of(Point<M> const&) { return {}; }
};

/// A problem as Odeint's system function.
template <Problem P>
struct OdeintSystem {
  using State = typename OdeintState<typename P::Space>::type;
  LibraryField<P> field;

  void operator()(State const& y, State& dydt, double t) const { field(t, y.data(), dydt.data()); }
};

/// Steps of a method of Odeint, for LibraryFixed.
template <class OdeintStepper, Problem P>
class OdeintSteps {
 public:
  explicit OdeintSteps(P const& problem)
      : system_{LibraryField<P>(problem)}, y_(OdeintState<typename P::Space>::of(problem.initial())) {}
  LibraryField<P> const& field() const { return system_.field; }
  double* numbers() { return y_.data(); }
  void step(double t, double h) { stepper_->do_step(system_, y_, t, h); }
  void restart() { stepper_.emplace(); }

 private:
  OdeintSystem<P> system_;
  typename OdeintSystem<P>::State y_;
  std::optional<OdeintStepper> stepper_{std::in_place};  // made anew in place: Odeint never initialises its buffers
};

/// Odeint's own error control, stepped as its integrate_adaptive does. Controller is made from (atol, rtol).
template <class ControlledStepper, Problem P>
class OdeintControlled {
  using M = typename P::Space;

 public:
  OdeintControlled(P const& problem, Adaptive control, NormPolicy policy)
      : system_{LibraryField<P>(problem)},
        y_(OdeintState<M>::of(problem.initial())),
        control_(control),
        policy_(policy),
        stepper_(make()) {}

  Status advance(Point<M>& x, double t, double t_end) {
    return in_own_steps(
        t, t_end, [&](double& now) { return step(x, now, t_end); }, [&] { return work_.steps + work_.rejected; });
  }
  Status step(Point<M>& x, double& t, double t_end) {
    store(x, y_.data());
    for (int trial = 0; trial < most_trials_of_a_step; ++trial) {
      double h = std::min(h_, t_end - t);
      bool const last = h >= t_end - t;
      double const tried = h;
      auto const result = stepper_.try_step(system_, y_, t, h);
      if (result == boost::numeric::odeint::success) {
        ++work_.steps;
        if (last) t = t_end;
        if (!last || h < tried || tried == h_) h_ = h;  // a step cut short says little about the next one
        load(x, y_.data());
        if (policy_ != NormPolicy::none) {
          projections_.template apply<M>(x, policy_);
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
  /// A new run: the step size is forgotten, too.
  void begin() {
    restart();
    h_ = first_step;
  }
  Work work() const { return work_; }
  Projections projections() const { return projections_; }

 private:
  static constexpr int most_trials_of_a_step = 1000;
  static constexpr double first_step = 0.01;  ///< [s]; Odeint asks its user for one, and corrects it within a few steps
  ControlledStepper make() const {
    if constexpr (requires { typename ControlledStepper::error_checker_type; })
      return boost::numeric::odeint::make_controlled(control_.atol, control_.rtol,
                                                     typename ControlledStepper::stepper_type{});
    else
      return ControlledStepper(control_.atol, control_.rtol);  // Bulirsch-Stoer is its own controller
  }

  OdeintSystem<P> system_;
  typename OdeintSystem<P>::State y_;
  Adaptive control_;
  NormPolicy policy_;
  ControlledStepper stepper_;
  double h_ = first_step;
  Work work_;
  Projections projections_;
};

namespace odeint_detail {
namespace odeint = boost::numeric::odeint;
template <Problem P>
using State = typename OdeintSystem<P>::State;
template <Problem P>
using Kutta4 = odeint::runge_kutta4_classic<State<P>>;
template <Problem P>
using CashKarp54 = odeint::runge_kutta_cash_karp54<State<P>>;
template <Problem P>
using Dopri5 = odeint::runge_kutta_dopri5<State<P>>;
template <Problem P>
using Fehlberg78 = odeint::runge_kutta_fehlberg78<State<P>>;
/// Eight steps of Adams-Bashforth-Moulton need eight starting values as good as themselves: from Fehlberg's pair, not
/// from the default, RK4, which would hold the method down to order 4 after every restart.
template <Problem P>
using Abm8 = odeint::adams_bashforth_moulton<8, State<P>, double, State<P>, double,
                                             typename odeint::algebra_dispatcher<State<P>>::algebra_type,
                                             odeint::default_operations, odeint::initially_resizer, Fehlberg78<P>>;
template <Problem P>
using BulirschStoer = odeint::bulirsch_stoer<State<P>>;

/// What the entries below share: a stepper template, driven fixed.
template <template <class> class Stepper>
struct RunsFixedSteps {
  template <LibraryProblem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return LibraryFixed<OdeintSteps<Stepper<P>, P>, P>(p, control, policy);
  }
};
/// The same, and under Odeint's error control.
template <template <class> class Pair>
struct RunsBoth : RunsFixedSteps<Pair> {
  using RunsFixedSteps<Pair>::bind;
  template <LibraryProblem P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return OdeintControlled<typename odeint::result_of::make_controlled<Pair<P>>::type, P>(p, control, policy);
  }
};

constexpr MethodInfo info(std::string_view name, int order, std::string_view source, std::string_view pitfall = "",
                          std::string_view no_projection = "", bool one_step = true) {
  return {.name = name,
          .family = Family::library,
          .order = order,
          .needs = Needs::flat,
          .rival = true,
          .source = source,
          .pitfall = pitfall,
          .no_projection = no_projection,
          .locates_events = one_step};
}
}  // namespace odeint_detail

/// Kutta (1901), equal steps.
struct OdeintRk4 : odeint_detail::RunsFixedSteps<odeint_detail::Kutta4> {
  static constexpr MethodInfo info =
      odeint_detail::info("odeint_rk4", 4, "Boost.Odeint 1.74, runge_kutta4_classic on std::array");
};
/// Cash & Karp (1990), 5(4).
struct OdeintCashKarp54 : odeint_detail::RunsBoth<odeint_detail::CashKarp54> {
  static constexpr MethodInfo info =
      odeint_detail::info("odeint_cash_karp54", 5, "Boost.Odeint 1.74, runge_kutta_cash_karp54, make_controlled");
};
/// Dormand & Prince (1980), 5(4).
struct OdeintDopri5 : odeint_detail::RunsBoth<odeint_detail::Dopri5> {
  static constexpr MethodInfo info =
      odeint_detail::info("odeint_dopri5", 5, "Boost.Odeint 1.74, runge_kutta_dopri5, make_controlled",
                          "reuses its last slope: must be restarted wherever the field jumps");
};
/// Fehlberg (1968), 7(8).
struct OdeintRkf78 : odeint_detail::RunsBoth<odeint_detail::Fehlberg78> {
  static constexpr MethodInfo info =
      odeint_detail::info("odeint_rkf78", 8, "Boost.Odeint 1.74, runge_kutta_fehlberg78, make_controlled",
                          "the error estimate vanishes for quadratures");
};
/// Bulirsch & Stoer (1966): extrapolation of the midpoint rule, adaptive in order and step.
struct OdeintBulirschStoer {
  static constexpr MethodInfo info =
      odeint_detail::info("odeint_bulirsch_stoer", 0, "Boost.Odeint 1.74, bulirsch_stoer");
  template <LibraryProblem P>
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return OdeintControlled<odeint_detail::BulirschStoer<P>, P>(p, control, policy);
  }
};
/// Adams-Bashforth-Moulton of 8 steps, equal steps, started by Runge-Kutta.
struct OdeintAbm8 : odeint_detail::RunsFixedSteps<odeint_detail::Abm8> {
  static constexpr MethodInfo info =
      odeint_detail::info("odeint_abm8", 8, "Boost.Odeint 1.74, adams_bashforth_moulton<8>, started by Fehlberg 7(8)",
                          "eight starting steps after every restart",
                          "projection would break the history that the next step extrapolates", false);
};

}  // namespace polhode
