#pragma once
/// The record: what was asked of one run (its cell), what came of it, and how it is named, field by field.
/// Everything downstream (JSON Lines, CSV, expectations, tables) goes through `for_each_field`, so a field is added
/// here and nowhere else. SI units, radians. What does not apply is null, never zero.
#include <cstdint>
#include <iosfwd>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace polhode::results {

/// Version of the record's layout; a reader refuses any other.
inline constexpr int schema = 1;

/// How a run ended. Everything but `ok` counts as infinite in a ranking and stays in the table.
enum class Status {
  ok,
  inaccurate,
  diverged,
  step_underflow,
  max_steps,
  nonlinear_fail,
  stalled,
  timeout,
  crashed,
  refused
};

std::string_view name_of(Status status);
/// Throws std::invalid_argument for an unknown name.
Status status_of(std::string_view name);

/// What identifies a run: the physics, the method and its control. Two runs with equal cells must give equal results.
struct Cell {
  std::string problem;
  std::string variant;      ///< canonical, e.g. "case2,g1"; empty for a problem without variants
  std::string formulation;  ///< "quaternion", "s3", ...
  std::string integrator;
  std::string policy = "none";
  std::optional<double> h;                         ///< step size [s]; null for adaptive runs
  std::optional<double> rtol;                      ///< relative tolerance; null for fixed steps
  std::optional<double> atol;                      ///< absolute tolerance; null for fixed steps
  std::map<std::string, std::vector<double>> set;  ///< parameters that differ from the problem's defaults
  std::int64_t seed = 1;
  double t_end = 0;  ///< [s]
};

/// Calls f(name, unit, member) for every member of a cell, in the order of the schema; C is Cell or Cell const.
template <class C, class Visit>
void for_each_cell_field(C& cell, Visit&& visit) {
  visit("problem", "", cell.problem);
  visit("variant", "", cell.variant);
  visit("formulation", "", cell.formulation);
  visit("integrator", "", cell.integrator);
  visit("policy", "", cell.policy);
  visit("h", "s", cell.h);
  visit("rtol", "", cell.rtol);
  visit("atol", "", cell.atol);
  visit("set", "", cell.set);
  visit("seed", "", cell.seed);
  visit("t_end", "s", cell.t_end);
}

/// The text that a cell's id is the hash of: every member, in order, numbers with 17 significant digits. A number that
/// is not finite counts as null, as in JSON, so that an id outlives being written and read.
std::string canonical_text(Cell const& cell);
/// 16 hexadecimal digits of a text: FNV-1a, 64 bits. Tells texts apart; keeps no secrets.
std::string hash_of(std::string_view text);
/// The same of all that a stream gives, however long, in constant memory.
std::string hash_of(std::istream& in);
/// hash_of the canonical text.
std::string cell_id(Cell const& cell);

/// One of the paper's claims, held against one run.
struct Claim {
  std::optional<double> value;      ///< what we measured
  std::optional<double> published;  ///< what is printed; null if the claim is a statement
  std::string verdict;              ///< "reproduced", "not reproduced", or a short reason
};

/// CPU time of one solve [s]: median and bootstrap interval over repetitions.
struct CpuTime {
  double median = 0, low = 0, high = 0;
  int repetitions = 0;
  std::vector<double> samples = {};  ///< each repetition, as they came; empty in older files
};

/// One run.
struct Record {
  std::string cell;   ///< cell_id of `of`
  std::string build;  ///< id of the binary that made it
  Cell of;            ///< what was asked

  Status status = Status::ok;
  std::string reason;  ///< why not ok, in words

  // Work: deterministic, so it gates.
  std::optional<std::int64_t> steps, rejected, evaluations, jacobians, iterations, controller_calls, events_located,
      projections;

  // Norm drift: raw = before projection, without prefix = delivered. See README.md for the definition per space.
  std::optional<double> norm_drift_raw_max, norm_drift_max, norm_drift_final, norm_drift_rms, norm_growth_exponent,
      projection_work;

  // Accuracy against the certified reference.
  std::optional<double> attitude_error_max, attitude_error_end, attitude_error_l2;  ///< [rad]
  std::optional<double> rate_error_max, rate_error_end;                             ///< relative to max |omega_ref|

  // Invariants of a torque-free body: relative; the direction of the angular momentum in rad.
  std::optional<double> energy_drift_max, momentum_drift_max, momentum_direction_max;

  // A constraint in space and its hidden ones: [m], [m/s], [m/s^2]; its multiplier, relative to the greatest.
  std::optional<double> position_defect_max, velocity_defect_max, acceleration_defect_max, multiplier_error_max;

  std::string reference;                ///< id of the reference
  std::optional<double> reference_bar;  ///< its error bar [rad]

  std::map<std::string, Claim> claims;
  std::optional<CpuTime> cpu_time_s;
  std::optional<double> allocations_per_step;
  std::optional<std::int64_t> bodies;  ///< that the state is of
};

/// Calls f(name, unit, member) for every field of a record, in the order of the schema ("" = dimensionless or text).
/// R is Record or Record const. `visit` sees std::string, Status, the optionals, the map of claims and of `set`.
template <class R, class Visit>
void for_each_field(R& r, Visit&& visit) {
  visit("cell", "", r.cell);
  visit("build", "", r.build);
  for_each_cell_field(r.of, visit);
  visit("status", "", r.status);
  visit("reason", "", r.reason);
  visit("steps", "", r.steps);
  visit("rejected", "", r.rejected);
  visit("evaluations", "", r.evaluations);
  visit("jacobians", "", r.jacobians);
  visit("iterations", "", r.iterations);
  visit("controller_calls", "", r.controller_calls);
  visit("events_located", "", r.events_located);
  visit("projections", "", r.projections);
  visit("norm_drift_raw_max", "", r.norm_drift_raw_max);
  visit("norm_drift_max", "", r.norm_drift_max);
  visit("norm_drift_final", "", r.norm_drift_final);
  visit("norm_drift_rms", "", r.norm_drift_rms);
  visit("norm_growth_exponent", "", r.norm_growth_exponent);
  visit("projection_work", "", r.projection_work);
  visit("attitude_error_max", "rad", r.attitude_error_max);
  visit("attitude_error_end", "rad", r.attitude_error_end);
  visit("attitude_error_l2", "rad", r.attitude_error_l2);
  visit("rate_error_max", "", r.rate_error_max);
  visit("rate_error_end", "", r.rate_error_end);
  visit("energy_drift_max", "", r.energy_drift_max);
  visit("momentum_drift_max", "", r.momentum_drift_max);
  visit("momentum_direction_max", "rad", r.momentum_direction_max);
  visit("position_defect_max", "m", r.position_defect_max);
  visit("velocity_defect_max", "m/s", r.velocity_defect_max);
  visit("acceleration_defect_max", "m/s^2", r.acceleration_defect_max);
  visit("multiplier_error_max", "", r.multiplier_error_max);
  visit("reference", "", r.reference);
  visit("reference_bar", "rad", r.reference_bar);
  visit("claims", "", r.claims);
  visit("cpu_time_s", "s", r.cpu_time_s);
  visit("allocations_per_step", "", r.allocations_per_step);
  visit("bodies", "", r.bodies);
}

/// A sampled history of one run, for figures: row i is (columns[0] at time i, ...). Column 0 is t [s].
struct Series {
  std::string cell;
  std::string name;  ///< "drift", "history" or "invariants"
  std::vector<std::string> columns;
  std::vector<std::string> units;
  std::vector<std::vector<double>> rows;
};

/// Where and how a file of records was made. Free-form by design: what the machine cannot tell is absent.
using Meta = std::map<std::string, std::string>;

/// A run has begun. Without its run after it, the process died in that cell.
struct Begin {
  std::string cell;
  std::string build;
};

/// The keys stand in the order of the schema; what is empty or not finite is null.
nlohmann::ordered_json to_json(Record const& record);
nlohmann::ordered_json to_json(Begin const& begin);
/// As `cpu_time_s` of a record.
nlohmann::ordered_json to_json(CpuTime const& time);
/// Throws std::invalid_argument unless every column has a unit and every row a number per column.
nlohmann::ordered_json to_json(Series const& series);
/// Throws std::invalid_argument for the keys "schema" and "kind", which are the record's own.
nlohmann::ordered_json to_json(Meta const& meta);

/// "run", "begin", "series" or "meta". Throws std::invalid_argument for anything else and for another schema.
std::string kind_of(nlohmann::ordered_json const& json);
/// Throw std::invalid_argument that names the field that is missing, unknown or of the wrong type, and what would be
/// right. A null reads as an empty optional, or as NaN where a number must stand.
Record record_from_json(nlohmann::ordered_json const& json);
Begin begin_from_json(nlohmann::ordered_json const& json);
/// `where` names the time in what is thrown.
CpuTime cpu_time_from_json(nlohmann::ordered_json const& json, std::string const& where);
Series series_from_json(nlohmann::ordered_json const& json);
Meta meta_from_json(nlohmann::ordered_json const& json);

}  // namespace polhode::results
