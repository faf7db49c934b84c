/// Samples that run alone: through the erased problem and the run loop, like every measured run.
#include <algorithm>
#include <cmath>

#include "bench/ensemble/job.hpp"
#include "bench/solve/state.hpp"

namespace polhode::bench {
namespace {

std::size_t place_of(std::vector<Column> const& columns, std::string_view name) {
  return std::size_t(std::ranges::find(columns, name, &Column::name) - columns.begin());
}

/// Of one body: how far its attitude is from the constraint, as its space measures it; 0 without an attitude.
template <SmallSpace M>
double defect_of(Point<M> const& x) {
  if constexpr (Attitude<M> || Triple<M>)
    return M::defect(x);
  else
    return defect_of<typename M::Factor>(x.first);
}

/// Looks at one sample at samples and output times.
template <Space M>
class SampleWatch final : public Watch<M> {
 public:
  SampleWatch(Erased<M> const& problem, ChosenProblem const& chosen, double t_end, double settle_angle)
      : problem_(problem),
        t_end_(t_end),
        points_(!chosen.info().pointing.empty()),
        metrics_(settle_angle, chosen.sample_period() > 0) {
    std::vector<Column> const columns = chosen.columns();
    shown_.resize(columns.size());
    angle_ = place_of(columns, chosen.info().pointing);
    torque_ = place_of(columns, "torque_x");
    free_ = chosen.torque_free();
  }
  void at_stop(Stop const& stop, Point<M> const& x) override {
    if (stop.sample || stop.output) metrics_.see(stop.time, look(stop.time, x), stop.time >= t_end_);
    if constexpr (!PowerSpace<M>) end_ = end_of<M>(x);
  }
  void after_step(double, Point<M> const&, Projections const&) override {}

  SampleMetrics<double> const& metrics() const { return metrics_; }
  std::array<double, 7> const& end() const { return end_; }

 private:
  Look<double> look(double t, Point<M> const& x) {
    Look<double> seen{0, {0, 0, 0}, {0, 0, 0}, 0};
    each_body<M>(
        x, [&]<class Body>(Point<Body> const& body) { seen.defect = std::max(seen.defect, defect_of<Body>(body)); });
    if constexpr (!PowerSpace<M>) {
      auto const end = end_of<M>(x);
      seen.omega = {end[4], end[5], end[6]};
      if (!shown_.empty()) problem_.show(t, x, shown_);
      if (angle_ < shown_.size())
        seen.angle = shown_[angle_];
      else if (points_)
        seen.angle = 2.0 * arctangent(length(Vec3<double>{end[0], end[1], end[2]}), std::fabs(end[3]));
      seen.torque = torque(t, x);
    }
    return seen;
  }
  Vec3<double> torque([[maybe_unused]] double t, [[maybe_unused]] Point<M> const& x) const {
    if (torque_ < shown_.size()) return {shown_[torque_], shown_[torque_ + 1], shown_[torque_ + 2]};
    if constexpr (requires { problem_.torque(t, x); })
      if (!free_ && problem_.is_rigid_body()) return problem_.torque(t, x);
    return {0, 0, 0};
  }
  template <SmallSpace Body>
  static std::array<double, 7> end_of(Point<Body> const& x) {
    if constexpr (Triple<Body>) {
      return {0, 0, 0, 0, x.x, x.y, x.z};
    } else if constexpr (Attitude<Body>) {
      Quat<double> const q = Body::attitude(x);
      return {q.x, q.y, q.z, q.w, 0, 0, 0};
    } else {
      auto end = end_of<typename Body::Factor>(x.first);
      if constexpr (Attitude<typename Body::Factor>) end[4] = x.second.x, end[5] = x.second.y, end[6] = x.second.z;
      return end;
    }
  }

  Erased<M> const& problem_;
  double t_end_;
  bool points_;
  SampleMetrics<double> metrics_;
  std::vector<double> shown_;
  std::size_t angle_ = 0, torque_ = 0;
  bool free_ = false;
  std::array<double, 7> end_{};
};

}  // namespace

bool has_torque(ChosenProblem const& problem, std::string_view formulation) {
  std::vector<Column> const columns = problem.columns();
  if (place_of(columns, "torque_x") < columns.size()) return true;
  if (problem.torque_free()) return false;
  return std::visit(
      []<Space M>(std::unique_ptr<Erased<M>> const& field) {
        if constexpr (requires { field->is_rigid_body(); })
          return field->is_rigid_body();
        else
          return false;
      },
      problem.in(formulation));
}

SampleResult run_alone(PreparedCell const& base, Choice const& choice, double settle_angle) {
  SampleResult result;
  std::unique_ptr<ChosenProblem> chosen;
  try {
    chosen = problem_named(base.cell.problem).choose(choice);
  } catch (ParameterError const&) {
    result.refused = true;
    return result;
  }
  ProblemInFormulation const problem = chosen->in(base.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        SampleWatch<M> watch(*field, *chosen, base.cell.t_end, settle_angle);
        Outcome const outcome = method_named<M>(base.cell.integrator).solve(*field, base.plan, watch);
        if (outcome.ended) std::rethrow_exception(outcome.ended);
        result.status = outcome.status;
        for (std::size_t m = 0; m < metric_count; ++m) result.metrics[m] = watch.metrics().of(Metric(m));
        result.end = watch.end();
      },
      problem);
  return result;
}

}  // namespace polhode::bench
