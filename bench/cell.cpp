#include "bench/cell.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "bench/recorder.hpp"

namespace polhode::bench {

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

std::vector<Column> columns_of(PreparedCell const& prepared) {
  std::vector<Column> columns;
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        int body = 0;
        each_body<M>(field->initial(), [&]<class Body>(Point<Body> const&) {
          std::string const prefix = PowerSpace<M> ? fmt::format("b{}.", ++body) : "";
          for (Column const& column : shown_columns<Body>()) columns.push_back({prefix + column.name, column.unit});
        });
      },
      problem);
  for (Column const& column : prepared.problem->columns()) columns.push_back(column);
  return columns;
}

namespace {

/// What a measured run keeps: many bodies would fill the memory.
std::vector<Column> measured_columns(PreparedCell const& prepared) {
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  bool const many = std::visit([]<Space M>(std::unique_ptr<Erased<M>> const&) { return PowerSpace<M>; }, problem);
  return many ? prepared.problem->columns() : columns_of(prepared);
}

/// Runs a prepared cell on its erased problem. A measured run of many bodies keeps the problem's own columns alone.
Trajectory run(PreparedCell const& prepared, Metrics* metrics, Limits const& limits) {
  Trajectory trajectory;
  trajectory.columns = metrics ? measured_columns(prepared) : columns_of(prepared);
  for (Column const& column : trajectory.columns) trajectory.history.columns.push_back(column.name);

  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        Recorder<M> recorder(*field, prepared, metrics, trajectory.history, limits);
        try {
          trajectory.outcome = method_named<M>(prepared.cell.integrator).solve(*field, prepared.plan, recorder);
          trajectory.history.events = trajectory.outcome.located.times;
          if (trajectory.outcome.ended) std::rethrow_exception(trajectory.outcome.ended);
          trajectory.status = status_of(trajectory.outcome.status);
          if (trajectory.status != results::Status::ok)
            trajectory.reason =
                fmt::format("{} after t = {:.6g} s", results::name_of(trajectory.status), recorder.reached);
        } catch (Timeout const&) {
          trajectory.status = results::Status::timeout;
          trajectory.reason =
              fmt::format("stopped after {:g} s of wall time at t = {:.6g} s", limits.timeout, recorder.reached);
        } catch (Stalled const&) {
          trajectory.status = results::Status::stalled;
          trajectory.reason = fmt::format(
              "at t = {:.6g} s its steps are so short that the horizon would take more "
              "than 2e7 of them",
              recorder.reached);
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

template <Space M>
constexpr bool quaternion_body = false;
template <Attitude A>
constexpr bool quaternion_body<RigidBody<A>> = std::same_as<Point<A>, Quat<double>>;

/// The same of the policies that need steps of our own: where the feedback acts, or what a step is.
template <Space M>
std::string_view own_policy_refusal(MethodInfo const& info, NormPolicy policy, bool adaptive) {
  if (info.rival) return "a library takes its steps itself: this policy is built into our own";
  if (!M::flat) return "on a group there is no defect to feed back or to relax (formulation quaternion)";
  if (policy == NormPolicy::baumgarte) return info.no_feedback;
  if (!OneFlatQuaternion<M>) return "this policy is for one body on flat quaternions (formulation quaternion)";
  if (policy == NormPolicy::project_symmetric && adaptive) return "symmetric projection is that of equal steps (--h)";
  return info.no_relaxation;
}

/// Why a norm policy is refused for a method on space M; empty if it is not.
template <Space M>
std::string_view policy_refusal(MethodInfo const& info, NormPolicy policy, bool adaptive) {
  if (policy == NormPolicy::none) return "";
  if (!M::constrained) return "this formulation has no norm to project";
  if (policy == NormPolicy::native) return info.projects_natively ? "" : "has no projection of its own";
  if (policy == NormPolicy::project_multiplier && !quaternion_body<M>)
    return "the multiplier form of the projection is that of one body's quaternion";
  if (is_projection(policy)) return info.no_projection;
  return own_policy_refusal<M>(info, policy, adaptive);
}

/// What a method needs of the problem beside its space; empty if it is there.
template <Space M>
std::string_view problem_refusal(Needs needs, Erased<M> const& field) {
  if constexpr (requires { field.is_rigid_body(); }) {
    if (needs == Needs::rigid_body && !field.is_rigid_body()) return "needs a rigid body whose inertia is known";
    if (needs == Needs::free_body && !(field.is_rigid_body() && field.torque_free())) return "needs a free rigid body";
  }
  if constexpr (requires { field.prescribed_rates(); })
    if (needs == Needs::prescribed_rates && !field.prescribed_rates())
      return "needs an attitude under prescribed rates (problem coning)";
  return "";
}

/// Why the combination does not run, in the order in which a user would want to know.
std::string refusal_of(PreparedCell const& prepared) {
  std::string refusal = prepared.problem->refusal(prepared.cell.formulation);
  if (!refusal.empty()) return refusal;
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        MethodOn<M> const& method = method_named<M>(prepared.cell.integrator);
        refusal = method.refusal;
        if (refusal.empty()) refusal = problem_refusal<M>(method.info->needs, *field);
        if (refusal.empty())
          refusal = policy_refusal<M>(*method.info, prepared.plan.policy,
                                      std::holds_alternative<Adaptive>(prepared.plan.control));
      },
      problem);
  return refusal;
}

/// The method can end its steps on state events, and the field has some to end on.
bool locates_events(PreparedCell const& prepared) {
  bool locates = false;
  ProblemInFormulation const problem = prepared.problem->in(prepared.cell.formulation);
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        locates = field->state_events() > 0 && method_named<M>(prepared.cell.integrator).info->locates_events;
      },
      problem);
  return locates;
}

NormPolicy policy_named(std::string_view name) {
  for (PolicyName const& entry : policy_names)
    if (entry.name == name) return entry.policy;
  throw std::out_of_range("no norm policy " + std::string(name));
}

/// The words of a variant text, in its order.
std::vector<std::string> words_of(std::string const& variant) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from < variant.size();) {
    std::size_t const to = std::min(variant.find(',', from), variant.size());
    words.push_back(variant.substr(from, to - from));
    from = to + 1;
  }
  return words;
}

/// A variant text without some of its words.
std::string without(std::string const& variant, std::vector<std::string> const& dropped) {
  std::vector<std::string> kept = words_of(variant);
  std::erase_if(kept, [&](std::string const& word) { return std::ranges::find(dropped, word) != dropped.end(); });
  return fmt::format("{}", fmt::join(kept, ","));
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

Choice choice_of(results::Cell const& cell) {
  std::vector<std::string> const words = words_of(cell.variant);
  return {.words = {words.begin(), words.end()}, .set = cell.set, .step = cell.h.value_or(0)};
}

PreparedCell prepare(results::Cell cell, double every) {
  check_words(vocabulary(), cell);
  PreparedCell prepared;
  Choice const choice = choice_of(cell);
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
  std::visit([&](auto const& field) { prepared.schedule.jumps = field->time_events(); }, prepared.problem->in_quad());
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
  prepared.plan.locate = prepared.problem->switches() && prepared.problem->wants_events() && prepared.refusal.empty() &&
                         locates_events(prepared);
  return prepared;
}

FoundReference References::of(PreparedCell const& prepared, double whole) {
  if (!prepared.reference) return {};
  if (std::string const why = prepared.problem->no_reference(); !why.empty()) return {nullptr, why};
  std::shared_ptr<Slot> slot;
  {
    std::lock_guard const lock(mutex_);
    auto& found = slots_[reference_subject(prepared.physics)];
    if (!found) found = std::make_shared<Slot>();
    slot = found;
  }
  std::call_once(slot->made, [&] {
    Choice choice = choice_of(prepared.physics);
    choice.step = 0;  // a reference has none
    auto const problem = problem_named(prepared.physics.problem).choose(choice);
    Schedule schedule = prepared.schedule;
    schedule.sample_period = problem->sample_period();
    schedule.output_period = 0;
    try {
      slot->reference = obtain(prepared.physics, *problem, schedule, committed_, whole);
    } catch (Uncertified const& error) {
      slot->why_none = error.what();
    }
  });
  return {slot->reference, slot->why_none};
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
  if (!prepared.refusal.empty()) {
    measured.record = refused(prepared, build);
    return measured;
  }
  results::Record& record = measured.record;
  record.cell = results::cell_id(prepared.cell);
  record.build = build;
  record.of = prepared.cell;

  auto const [reference, why_none] = references.of(prepared);
  if (reference) {
    record.reference = reference->id;
    record.reference_bar = reference->bar;
  }
  Metrics metrics(reference.get(), prepared.problem->torque_free() ? prepared.problem->body() : nullptr,
                  prepared.cell.t_end, prepared.problem->pinned());
  Trajectory trajectory = run(prepared, &metrics, limits);

  record.status = trajectory.status;
  record.reason = trajectory.reason;
  Outcome const& outcome = trajectory.outcome;
  record.steps = outcome.work.steps;
  if (prepared.cell.rtol || prepared.plan.locate) record.rejected = outcome.work.rejected;
  record.evaluations = outcome.evaluations;
  if (prepared.problem->switches()) record.events_located = outcome.located.events;
  record.jacobians = outcome.work.jacobians;
  record.iterations = outcome.work.iterations;
  if (prepared.schedule.sample_period > 0)
    record.controller_calls = std::count_if(prepared.plan.stops.begin(), prepared.plan.stops.end(),
                                            [](Stop const& stop) { return stop.sample; });
  if (prepared.plan.policy != NormPolicy::none) record.projections = outcome.projections.count;
  if (record.status == results::Status::ok) {
    metrics.fill(record);
    if (prepared.plan.policy != NormPolicy::none) record.projection_work = outcome.projections.work;
    if (record.attitude_error_max.value_or(0) > 1) {
      record.status = results::Status::inaccurate;
      record.reason = fmt::format("attitude error {:.2g} rad: no digit is right", *record.attitude_error_max);
    }
    for (ClaimResult const& claim : prepared.problem->claims(trajectory.history)) {
      std::string const verdict = !claim.holds ? "no printed value" : *claim.holds ? "reproduced" : "not reproduced";
      record.claims[claim.name] = {claim.value, claim.published, verdict};
    }
    for (std::string const& remark : {prepared.problem->warning(), why_none})
      if (!remark.empty()) record.reason += (record.reason.empty() ? "" : "; ") + remark;
  }
  measured.drift = metrics.drift_series(record.cell);
  measured.invariants = metrics.invariant_series(record.cell);
  measured.history = std::move(trajectory.history);
  measured.columns = std::move(trajectory.columns);
  return measured;
}

Trajectory simulate(PreparedCell const& prepared, Limits const& limits) {
  if (!prepared.refusal.empty()) throw std::logic_error("a refused cell cannot run: " + prepared.refusal);
  return run(prepared, nullptr, limits);
}

}  // namespace polhode::bench
