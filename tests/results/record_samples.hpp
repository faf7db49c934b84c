#pragma once
/// A cell and a record in which every field holds a value of its own.
#include <functional>
#include <stdexcept>
#include <string>

#include "results/record.hpp"
#include "tests/support/complaint.hpp"

namespace polhode::results::test {
inline Cell some_cell() {
  Cell cell;
  cell.problem = "tether_capture";
  cell.variant = "case2,g1";
  cell.formulation = "s3";
  cell.integrator = "cf4";
  cell.policy = "project";
  cell.h = 0.1;
  cell.rtol = 1e-6;
  cell.atol = 1e-9;
  cell.set = {{"inertia", {0.5, 0.85, 1.0}}, {"rho", {0.25}}};
  cell.seed = -7;
  cell.t_end = 50;
  return cell;
}

/// Every field holds a value of its own.
inline Record full_record() {
  Record record;
  record.of = some_cell();
  record.cell = cell_id(record.of);
  record.build = "b0";
  record.status = Status::max_steps;
  record.reason = "a \"quoted\"\nreason";
  record.steps = 1;
  record.rejected = 2;
  record.evaluations = 9007199254740993;  // needs more than a double's 53 bits
  record.jacobians = 4;
  record.iterations = 5;
  record.controller_calls = 6;
  record.events_located = 7;
  record.projections = 8;
  record.norm_drift_raw_max = 0.5;
  record.norm_drift_max = 1.5;
  record.norm_drift_final = -2.5;
  record.norm_drift_rms = 3.5;
  record.norm_growth_exponent = 4.5;
  record.projection_work = 5.5;
  record.attitude_error_max = 6.5;
  record.attitude_error_end = 7.5;
  record.attitude_error_l2 = 8.5;
  record.rate_error_max = 9.5;
  record.rate_error_end = 10.5;
  record.energy_drift_max = 11.5;
  record.momentum_drift_max = 12.5;
  record.momentum_direction_max = 13.5;
  record.position_defect_max = 14.5;
  record.velocity_defect_max = 15.5;
  record.acceleration_defect_max = 16.5;
  record.multiplier_error_max = 17.5;
  record.reference = "ref";
  record.reference_bar = 1e-30;
  record.claims["alpha"] = Claim{0.1, 0.2, "not reproduced"};
  record.claims["statement"] = Claim{1.0, std::nullopt, "reproduced"};
  record.cpu_time_s = CpuTime{1.25, 1.0, 1.5, 5};
  record.allocations_per_step = 14.5;
  record.bodies = 5;
  return record;
}

inline std::string message_of(std::function<void()> const& f) {
  return polhode::test::complaint_of<std::invalid_argument>(f);
}

}  // namespace polhode::results::test
