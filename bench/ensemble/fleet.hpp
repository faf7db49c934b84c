#pragma once
/// How a problem becomes a fleet in lanes. Included by the units of the problems that can.
#include <algorithm>
#include <string_view>
#include <vector>

#include "bench/ensemble/lanes.hpp"
#include "integrators/commutator_free.hpp"
#include "integrators/high_order.hpp"
#include "integrators/lie_group.hpp"
#include "integrators/runge_kutta.hpp"
#include "problems/definition.hpp"
#include "problems/formulations.hpp"

namespace polhode::bench {

/// The fixed steps of a catalogue's entry that knows adaptive ones, too.
template <class Entry, class Fixed>
struct StepsOf : Fixed {
  static constexpr MethodInfo const& info = Entry::info;
};
/// The methods that run in lanes, by formulation. Others of this kind could; they would be compiled, too.
using LaneMethodsFlat =
    Types<Rk4, StepsOf<Dopri5, Explicit<DormandPrince5>>, StepsOf<Dop853, Explicit<DormandPrince853>>>;
using LaneMethodsGroup = Types<Rkmk4, CommutatorFree4>;

/// A body in lanes S, or alone, that is looked at whenever its controller is asked.
template <class Body, class S>
struct WatchedBody {
  using Space = typename Body::Space;

  Body body;
  SampleMetrics<S> metrics;
  double period = 0;  ///< from look to look [s]
  bool sampled = false;
  double looks = 0;

  Velocity<Space> operator()(S const& t, Point<Space> const& x) const { return body(t, x); }
  Point<Space> initial() const { return body.initial(); }
  void sample(Real<S> const& t, Point<Space> const& x) {
    if constexpr (SampledProblem<Body>)
      if (sampled) body.sample(t, x);
    metrics.see(looks * period, look(S(t), x, false), false);
    looks += 1;
  }
  Look<S> look(S const& t, Point<Space> const& x, bool last) const {
    using A = typename Space::Factor;
    Quat<S> const q = A::attitude(x.first);
    S const off = dot(q, q) - S(1.0);
    Look<S> seen{S(0.0), zero<Vec3<S>>(), x.second, abs_of(off)};
    if constexpr (requires { body.control.last_angle(); }) {
      seen.torque = body.held;
      seen.angle = sampled && !last ? body.control.last_angle() : body.control.pointing_angle(q);
    } else if constexpr (!Body::torque_free()) {
      seen.torque = body.torque(t, x);
      seen.angle = S(2.0) * arctangent(length(vec(q)), abs_of(q.w));
    }
    return seen;
  }
};

/// The fleet of definition D on attitude space A by one method.
template <class D, template <class> class A, class Method>
class FleetInLanes final : public LaneFleet {
  using Field = decltype(std::declval<D const&>().template field<double, A, true>());

 public:
  explicit FleetInLanes(FleetPlan const& plan) : plan_(plan) {}

  void run(Bodies const& bodies, std::span<SampleResult> results) const override {
    std::vector<Field> const fields = fields_of(bodies, results);
    auto const place = [&](std::int64_t k) { return std::size_t(k - bodies.first); };
    auto const make = [&]<class S>(BodyBlock const& block) {
      auto const of = [&](int lane) -> Field const& { return fields[place(block.index(lane))]; };
      SampleMetrics<S> const metrics(plan_.threshold, SampledProblem<Field> && plan_.sampled);
      if constexpr (std::same_as<S, double>) {
        return WatchedBody<Field, S>{of(0), metrics, plan_.period, plan_.sampled};
      } else {
        auto body = Field::template gathered<S>(of);
        return WatchedBody<decltype(body), S>{body, metrics, plan_.period, plan_.sampled};
      }
    };
    auto const deliver = [&](std::int64_t k, auto const& x, Status status) {
      SampleResult& result = results[place(k)];
      if (result.refused) return;
      result.status = status;
      Quat<double> const q = A<double>::attitude(x.first);
      result.end = {q.x, q.y, q.z, q.w, x.second.x, x.second.y, x.second.z};
    };
    double const end = double(plan_.run.steps) * plan_.run.h;
    auto const watch = [&]<class P, class X>(BodyBlock const& block, double t, P const& problem, X const& x) {
      if (t < end) return;
      using S = typename P::Space::Scalar;
      auto metrics = problem.metrics;
      metrics.see(plan_.t_end, problem.look(S(t), x, true), true);
      for (std::size_t m = 0; m < metric_count; ++m) {
        S const values = metrics.of(Metric(m));
        for (int lane = 0; lane < S::count && block.first + lane < block.last; ++lane)
          results[place(block.first + lane)].metrics[m] = values[lane];
      }
    };
    run_ensemble(Method{}, plan_.run, bodies, make, deliver, watch);
  }

 private:
  /// One for each sample; what a rule refuses is a body without dispersions that nobody looks at.
  std::vector<Field> fields_of(Bodies const& bodies, std::span<SampleResult> results) const {
    D definition(plan_.choice);
    auto const field = [&] { return definition.template field<double, A, true>(); };
    Field const plain = field();
    std::vector<Parameter> parameters = definition.parameters();
    std::vector<Parameter*> dispersed;
    for (std::string const& name : plan_.dispersions->parameters())
      dispersed.push_back(&*std::ranges::find(parameters, name, &Parameter::name));

    std::vector<Field> fields;
    fields.reserve(results.size());
    std::vector<std::vector<double>> values;
    for (std::int64_t k = bodies.first; k < bodies.last; ++k) {
      plan_.dispersions->draw(k, values);
      try {
        for (std::size_t i = 0; i < dispersed.size(); ++i) dispersed[i]->assign(values[i]);
        fields.push_back(field());
      } catch (ParameterError const&) {
        results[std::size_t(k - bodies.first)].refused = true;
        fields.push_back(plain);
      }
    }
    return fields;
  }

  FleetPlan plan_;
};

template <class D, template <class> class A, class... Method>
std::unique_ptr<LaneFleet> fleet_by(FleetPlan const& plan, Types<Method...>) {
  std::unique_ptr<LaneFleet> fleet;
  auto const take = [&]<class M>() {
    if (M::info.name == plan.integrator) fleet = std::make_unique<FleetInLanes<D, A, M>>(plan);
  };
  (take.template operator()<Method>(), ...);
  return fleet;
}

/// Null if the choice, the formulation or the method is not one for lanes.
template <class D>
std::unique_ptr<LaneFleet> fleet_of(FleetPlan const& plan) {
  D const definition(plan.choice);
  if (!is_principal(definition) || !is_plain(definition)) return nullptr;
  if (plan.formulation == FlatQuaternion<double>::name) return fleet_by<D, FlatQuaternion>(plan, LaneMethodsFlat{});
  if (plan.formulation == S3<double>::name) return fleet_by<D, S3>(plan, LaneMethodsGroup{});
  return nullptr;
}

}  // namespace polhode::bench
