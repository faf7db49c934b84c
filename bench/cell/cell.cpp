#include "bench/cell/cell.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bench/cell/recorder.hpp"

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

results::Series history_series(std::string const& cell, std::vector<Column> const& columns, History const& history,
                               std::size_t most) {
  results::Series series{.cell = cell, .name = "history", .columns = {"t"}, .units = {"s"}, .rows = {}};
  for (Column const& column : columns) {
    series.columns.push_back(column.name);
    series.units.push_back(column.unit);
  }
  std::size_t const rows = history.times.size(), stride = std::max<std::size_t>(1, rows / most);
  for (std::size_t i = 0; i < rows; ++i) {
    if (i % stride != 0 && i + 1 != rows) continue;
    std::vector<double>& row = series.rows.emplace_back(1, history.times[i]);
    row.insert(row.end(), history.rows[i].begin(), history.rows[i].end());
  }
  return series;
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
        each_body<M>(field->initial(), [&]<class Body>(Point<Body> const&) { ++trajectory.bodies; });
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
          trajectory.reason =
              fmt::format("at t = {:.6g} s its steps are so short that the horizon would take more than 2e7 of them",
                          recorder.reached);
        } catch (std::exception const& error) {
          trajectory.status = results::Status::crashed;
          trajectory.reason = error.what();
        }
      },
      problem);
  return trajectory;
}

/// Counts, as far as they mean something for this cell.
void note_work(results::Record& record, PreparedCell const& prepared, Outcome const& outcome) {
  record.steps = outcome.work.steps;
  record.evaluations = outcome.evaluations;
  record.jacobians = outcome.work.jacobians;
  record.iterations = outcome.work.iterations;
  if (prepared.cell.rtol || prepared.plan.locate) record.rejected = outcome.work.rejected;
  if (prepared.problem->switches()) record.events_located = outcome.located.events;
  if (prepared.schedule.sample_period > 0)
    record.controller_calls = std::ranges::count(prepared.plan.stops, true, &Stop::sample);
  if (prepared.plan.policy != NormPolicy::none) record.projections = outcome.projections.count;
}

/// Why what was reached is no solution of the problem; empty if it may be one.
std::string why_inaccurate(results::Record const& record) {
  if (record.attitude_error_max.value_or(0) > 1)
    return fmt::format("attitude error {:.2g} rad: no digit is right", *record.attitude_error_max);
  if (record.norm_drift_max.value_or(0) > 1)
    return fmt::format("norm drift {:.2g}: the state is no attitude", *record.norm_drift_max);
  return "";
}

/// What a run that reached its end is worth.
void note_worth(results::Record& record, PreparedCell const& prepared, Metrics const& metrics,
                Trajectory const& trajectory) {
  metrics.fill(record);
  if (prepared.plan.policy != NormPolicy::none) record.projection_work = trajectory.outcome.projections.work;
  record.reason = why_inaccurate(record);
  if (!record.reason.empty()) record.status = results::Status::inaccurate;
  for (ClaimResult const& claim : prepared.problem->claims(trajectory.history)) {
    std::string const verdict = !claim.holds ? "no printed value" : *claim.holds ? "reproduced" : "not reproduced";
    record.claims[claim.name] = {claim.value, claim.published, verdict};
  }
}

}  // namespace

results::Record unmeasured(PreparedCell const& prepared, std::string const& build, results::Status status,
                           std::string const& reason) {
  results::Record record;
  record.cell = results::cell_id(prepared.cell);
  record.build = build;
  record.of = prepared.cell;
  record.status = status;
  record.reason = reason;
  return record;
}

Measured measure(PreparedCell const& prepared, References& references, std::string const& build, Limits const& limits) {
  if (!prepared.refusal.empty())
    return {.record = unmeasured(prepared, build, results::Status::refused, prepared.refusal)};

  auto const [reference, why_none] = references.of(prepared);
  Metrics metrics(reference.get(), prepared.problem->torque_free() ? prepared.problem->body() : nullptr,
                  prepared.cell.t_end, prepared.problem->pinned());
  Trajectory trajectory = run(prepared, &metrics, limits);

  results::Record record = unmeasured(prepared, build, trajectory.status, trajectory.reason);
  if (reference) {
    record.reference = reference->id;
    record.reference_bar = reference->bar;
  }
  record.bodies = trajectory.bodies;
  note_work(record, prepared, trajectory.outcome);
  if (trajectory.status == results::Status::ok) {
    note_worth(record, prepared, metrics, trajectory);
    for (std::string const& remark : {prepared.problem->warning(), why_none})
      if (!remark.empty()) record.reason += (record.reason.empty() ? "" : "; ") + remark;
  }
  return {.record = record,
          .drift = metrics.drift_series(record.cell),
          .invariants = metrics.invariant_series(record.cell),
          .history = std::move(trajectory.history),
          .columns = std::move(trajectory.columns)};
}

Trajectory simulate(PreparedCell const& prepared, Limits const& limits) {
  if (!prepared.refusal.empty()) throw std::logic_error("a refused cell cannot run: " + prepared.refusal);
  return run(prepared, nullptr, limits);
}

}  // namespace polhode::bench
