#include "bench/cell.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace polhode::bench {
namespace {

/// Thrown by a watch when a run has used up its time.
struct Timeout {};

class Deadline {
 public:
  explicit Deadline(Limits const& limits)
      : stop_(limits.stop), limited_(limits.timeout > 0), end_(Clock::now() + to_ticks(limits.timeout)) {}
  void check() {
    if (++calls_ % 256 != 0) return;
    if (stop_ && *stop_) throw Interrupted{};
    if (limited_ && Clock::now() > end_) throw Timeout{};
  }

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::duration to_ticks(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  std::atomic<bool> const* stop_;
  bool limited_;
  Clock::time_point end_;
  std::int64_t calls_ = 0;
};

template <class V>
auto widened(V const& v) {
  if constexpr (requires { v.w; })
    return Quat<Quad>{v.x, v.y, v.z, v.w};
  else
    return Vec3<Quad>{v.x, v.y, v.z};
}

/// Collects the history, and the metrics if they are wanted.
template <Space M>
class Recorder final : public Watch<M> {
  using A = typename M::Factor;
  using Wide = typename A::template Over<Quad>;

 public:
  Recorder(Erased<M> const& problem, std::size_t own_columns, Metrics* metrics, History& history, Limits const& limits)
      : problem_(problem), own_columns_(own_columns), metrics_(metrics), history_(history), deadline_(limits) {}

  void at_stop(Stop const& stop, Point<M> const& x) override {
    if (stop.time == 0 && metrics_) metrics_->see(sight(0, x, {}));
    if (!stop.sample && !stop.output) return;
    Quat<double> const q = A::attitude(x.first);
    std::vector<double> row{q.x, q.y, q.z, q.w, x.second.x, x.second.y, x.second.z};
    row.resize(row.size() + own_columns_);
    problem_.show(x, std::span(row).last(own_columns_));
    history_.times.push_back(stop.time);
    history_.rows.push_back(std::move(row));
  }
  void after_step(double t, Point<M> const& x, Projections const& projections) override {
    deadline_.check();
    reached = t;
    if (metrics_) metrics_->see(sight(t, x, projections));
  }

  double reached = 0;  ///< the time of the last accepted step [s]

 private:
  static Sight sight(double t, Point<M> const& x, Projections const& projections) {
    Sight seen{
        .t = t, .q = widened(A::attitude(x.first)), .omega = widened(x.second), .raw_defect = projections.raw_defect};
    if constexpr (std::same_as<Point<A>, Quat<double>>) {
      seen.drift = double(dot(seen.q, seen.q) - 1);
    } else {
      Mat3<Quad> const wide{widened(x.first.e1), widened(x.first.e2), widened(x.first.e3)};
      seen.drift = double(Wide::defect(wide));
    }
    return seen;
  }

  Erased<M> const& problem_;
  std::size_t own_columns_;
  Metrics* metrics_;
  History& history_;
  Deadline deadline_;
};

results::Status status_of(Status status) {
  switch (status) {
    case Status::ok:
      return results::Status::ok;
    case Status::diverged:
      return results::Status::diverged;
    case Status::step_underflow:
      return results::Status::step_underflow;
    case Status::max_steps:
      return results::Status::max_steps;
    case Status::nonlinear_fail:
      return results::Status::nonlinear_fail;
  }
  return results::Status::crashed;
}

template <Space M>
MethodOn<M> const& method_named(std::string_view name) {
  for (MethodOn<M> const& entry : all_methods_on<M>())
    if (entry.info->name == name) return entry;
  throw std::out_of_range("no integrator " + std::string(name));
}

/// Runs a prepared cell on its erased problem.
Trajectory run(PreparedCell const& prepared, Metrics* metrics, Limits const& limits) {
  Trajectory trajectory;
  trajectory.columns = columns_of(*prepared.problem);
  for (Column const& column : trajectory.columns) trajectory.history.columns.push_back(column.name);
  std::size_t const own = prepared.problem->columns().size();

  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        Recorder<M> recorder(*field, own, metrics, trajectory.history, limits);
        try {
          trajectory.outcome = method_named<M>(prepared.cell.integrator).solve(*field, prepared.plan, recorder);
          trajectory.status = status_of(trajectory.outcome.status);
          if (trajectory.status != results::Status::ok)
            trajectory.reason =
                fmt::format("{} after t = {:.6g} s", results::name_of(trajectory.status), recorder.reached);
        } catch (Timeout const&) {
          trajectory.status = results::Status::timeout;
          trajectory.reason =
              fmt::format("stopped after {:g} s of wall time at t = {:.6g} s", limits.timeout, recorder.reached);
        } catch (std::exception const& error) {
          trajectory.status = results::Status::crashed;
          trajectory.reason = error.what();
        }
      },
      problem);
  return trajectory;
}

bool divides(double h, double period) {
  double const ratio = period / h;
  return std::round(ratio) >= 1 && std::fabs(ratio - std::round(ratio)) <= 1e-9 * ratio;
}

/// Why a norm policy is refused for a method on space M; empty if it is not.
template <Space M>
std::string_view policy_refusal(MethodInfo const& info, NormPolicy policy) {
  if (policy == NormPolicy::none) return "";
  if (!M::constrained) return "this formulation has no norm to project";
  if (policy == NormPolicy::native) return info.projects_natively ? "" : "has no projection of its own";
  if (policy == NormPolicy::project_multiplier && !std::same_as<Point<typename M::Factor>, Quat<double>>)
    return "the multiplier form of the projection is that of a quaternion";
  return info.no_projection;
}

/// Why the combination does not run, in the order in which a user would want to know.
std::string refusal_of(PreparedCell const& prepared) {
  std::string refusal;
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const&) {
        MethodOn<M> const& method = method_named<M>(prepared.cell.integrator);
        refusal = method.refusal;
        if (refusal.empty()) refusal = policy_refusal<M>(*method.info, prepared.plan.policy);
      },
      problem);
  return refusal;
}

NormPolicy policy_named(std::string_view name) {
  for (PolicyName const& entry : policy_names)
    if (entry.name == name) return entry.policy;
  throw std::out_of_range("no norm policy " + std::string(name));
}

std::set<std::string> words_of(std::string const& variant) {
  std::set<std::string> words;
  for (std::size_t from = 0; from < variant.size();) {
    std::size_t const to = std::min(variant.find(',', from), variant.size());
    words.insert(variant.substr(from, to - from));
    from = to + 1;
  }
  return words;
}

/// A variant text without some of its words.
std::string without(std::string const& variant, std::vector<std::string> const& dropped) {
  std::string kept;
  for (std::size_t from = 0; from < variant.size();) {
    std::size_t const to = std::min(variant.find(',', from), variant.size());
    std::string const word = variant.substr(from, to - from);
    if (std::find(dropped.begin(), dropped.end(), word) == dropped.end()) kept += (kept.empty() ? "" : ",") + word;
    from = to + 1;
  }
  return kept;
}

/// A schedule is kept in memory: a slip in a period must not fill it.
void check_number_of_stops(Schedule const& schedule) {
  constexpr double most = 1e7;
  for (double const period : {schedule.sample_period, schedule.output_period})
    if (period > 0 && schedule.t_end / period > most)
      throw UsageError(
          fmt::format("{:g} s in intervals of {:g} s are more than {:.0f}; shorten t_end or lengthen the "
                      "interval",
                      schedule.t_end, period, most));
}

}  // namespace

std::vector<Column> columns_of(ChosenProblem const& problem) {
  std::vector<Column> columns{{"q1", ""},      {"q2", ""},      {"q3", ""},     {"q4", ""},
                              {"wx", "rad/s"}, {"wy", "rad/s"}, {"wz", "rad/s"}};
  for (Column const& column : problem.columns()) columns.push_back(column);
  return columns;
}

PreparedCell prepare(results::Cell cell, double every) {
  check_words(vocabulary(), cell);
  PreparedCell prepared;
  Choice const choice{.words = words_of(cell.variant), .set = cell.set, .step = cell.h.value_or(0)};
  try {
    prepared.problem = problem_named(cell.problem).choose(choice);
  } catch (ParameterError const& error) {
    throw UsageError(fmt::format("{}: {}", cell.problem, error.what()));
  }
  if (!(cell.t_end > 0)) cell.t_end = prepared.problem->horizon();
  double const period = prepared.problem->sample_period();
  if (cell.h && period > 0 && !divides(*cell.h, period))
    throw UsageError(
        fmt::format("h = {:g} s does not divide the sample period {:g} s of {}: a step must not straddle a "
                    "sample; h = {:g} would be right",
                    *cell.h, period, cell.problem, period / std::ceil(period / *cell.h)));
  if (cell.h && every > 0 && !divides(*cell.h, every))
    throw UsageError(
        fmt::format("outputs every {:g} s are no multiple of h = {:g} s: output times are ends of steps; "
                    "give --every {:g}",
                    every, *cell.h, *cell.h * std::max(1.0, std::round(every / *cell.h))));

  prepared.schedule = {.t_end = cell.t_end, .sample_period = period, .jumps = {}, .output_period = every};
  ProblemInFormulation const problem = prepared.problem->in(cell.formulation);
  std::visit([&](auto const& field) { prepared.schedule.jumps = field->time_events(); }, problem);
  check_number_of_stops(prepared.schedule);
  prepared.plan.stops = stops_of(prepared.schedule);
  prepared.plan.policy = policy_named(cell.policy);
  if (cell.h)
    prepared.plan.control = FixedStep{*cell.h};
  else
    prepared.plan.control = Adaptive{*cell.rtol, *cell.atol};
  prepared.physics = cell;
  prepared.physics.variant = without(cell.variant, prepared.problem->info().driven);
  prepared.cell = std::move(cell);
  prepared.refusal = refusal_of(prepared);
  return prepared;
}

std::shared_ptr<UsableReference const> References::of(PreparedCell const& prepared) {
  std::shared_ptr<Slot> slot;
  {
    std::lock_guard const lock(mutex_);
    auto& found = slots_[reference_subject(prepared.physics)];
    if (!found) found = std::make_shared<Slot>();
    slot = found;
  }
  std::call_once(slot->made, [&] {
    Choice const choice{.words = words_of(prepared.physics.variant), .set = prepared.physics.set};
    auto const problem = problem_named(prepared.physics.problem).choose(choice);
    Schedule schedule = prepared.schedule;
    schedule.sample_period = problem->sample_period();
    schedule.output_period = 0;
    slot->reference = obtain(prepared.physics, *problem, schedule, committed_);
  });
  return slot->reference;
}

results::Record refused(PreparedCell const& prepared, std::string const& build) {
  results::Record record;
  record.cell = results::cell_id(prepared.cell);
  record.build = build;
  record.of = prepared.cell;
  record.status = results::Status::refused;
  record.reason = prepared.refusal;
  return record;
}

Measured measure(PreparedCell const& prepared, References& references, std::string const& build, Limits const& limits) {
  Measured measured;
  results::Record& record = measured.record;
  record.cell = results::cell_id(prepared.cell);
  record.build = build;
  record.of = prepared.cell;

  auto const reference = references.of(prepared);
  record.reference = reference->id;
  record.reference_bar = reference->bar;
  Metrics metrics(*reference, prepared.problem->body(), prepared.problem->torque_free(), prepared.cell.t_end);
  Trajectory trajectory = run(prepared, &metrics, limits);

  record.status = trajectory.status;
  record.reason = trajectory.reason;
  Outcome const& outcome = trajectory.outcome;
  record.steps = outcome.work.steps;
  if (prepared.cell.rtol) record.rejected = outcome.work.rejected;
  record.evaluations = outcome.evaluations;
  record.jacobians = outcome.work.jacobians;
  record.iterations = outcome.work.iterations;
  if (prepared.schedule.sample_period > 0)
    record.controller_calls = std::count_if(prepared.plan.stops.begin(), prepared.plan.stops.end(),
                                            [](Stop const& stop) { return stop.sample; });
  if (prepared.plan.policy != NormPolicy::none) record.projections = outcome.projections.count;
  if (record.status == results::Status::ok) {
    metrics.fill(record);
    if (prepared.plan.policy != NormPolicy::none) record.projection_work = outcome.projections.work;
    if (*record.attitude_error_max > 1) {
      record.status = results::Status::inaccurate;
      record.reason = fmt::format("attitude error {:.2g} rad: no digit is right", *record.attitude_error_max);
    }
    for (ClaimResult const& claim : prepared.problem->claims(trajectory.history)) {
      std::string const verdict = !claim.holds ? "no printed value" : *claim.holds ? "reproduced" : "not reproduced";
      record.claims[claim.name] = {claim.value, claim.published, verdict};
    }
  }
  measured.drift = metrics.drift_series(record.cell);
  measured.history = std::move(trajectory.history);
  return measured;
}

Trajectory simulate(PreparedCell const& prepared, Limits const& limits) {
  return run(prepared, nullptr, limits);
}

}  // namespace polhode::bench
