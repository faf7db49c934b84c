#pragma once
/// Made-up records for tests of the report: errors that are exact power laws, costs and drifts as told.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "results/store.hpp"

namespace polhode::report::samples {

using results::Contents;
using results::Record;
using results::Series;

struct Method {
  std::string name;
  double order, constant, cost, drift;
};

/// A run whose error is constant * h^order, never better than the bar.
inline Record made(std::string problem, std::string variant, Method const& m, double h, std::string policy = "none") {
  constexpr double bar = 1e-14;
  Record r;
  r.of.problem = std::move(problem);
  r.of.variant = std::move(variant);
  r.of.formulation = "quaternion";
  r.of.integrator = m.name;
  r.of.policy = std::move(policy);
  r.of.h = h;
  r.of.t_end = 50;
  r.cell = fmt::format("{}/{}/{}/{}/{}", r.of.problem, r.of.variant, m.name, r.of.policy, h);
  r.build = "b1";
  r.steps = static_cast<std::int64_t>(50 / h);
  r.evaluations = static_cast<std::int64_t>(m.cost) * *r.steps;
  r.norm_drift_raw_max = m.drift;
  r.norm_drift_max = r.of.policy == "none" ? m.drift : 2.2e-16;
  r.attitude_error_max = std::max(bar, m.constant * std::pow(h, m.order));
  r.attitude_error_end = r.attitude_error_max;
  r.reference = "free_body.elliptic";
  r.reference_bar = bar;
  double const t = 2e-8 * static_cast<double>(*r.evaluations);
  r.cpu_time_s = results::CpuTime{t, 0.98 * t, 1.02 * t, 5};
  return r;
}

/// A run with a horizon of its own, and claims "name: value", all reproduced.
inline Record run_of(std::string problem, std::string variant, Method const& m, double h, double t_end,
                     std::map<std::string, double> const& claims = {}) {
  Record r = made(std::move(problem), std::move(variant), m, h);
  r.of.t_end = t_end;
  r.cell += fmt::format("/{}", t_end);
  for (auto const& [name, value] : claims) r.claims[name] = {value, std::nullopt, "reproduced"};
  return r;
}

inline Record adaptive(Record r, double rtol) {
  r.of.h.reset();
  r.of.rtol = rtol;
  r.of.atol = 1e-6;
  r.cell += fmt::format("/rtol {}", rtol);
  return r;
}

inline Series drift_of(Record const& r) {
  Series s{r.cell, "drift", {"t", "norm_drift", "norm_drift_raw", "attitude_error"}, {"s", "", "", "rad"}, {}};
  for (int i = 0; i <= 500; ++i) {
    double const t = 0.1 * i;
    s.rows.push_back({t, *r.norm_drift_max * t / 50, *r.norm_drift_raw_max * t / 50, 1e-9 * t});
  }
  return s;
}

inline Series history_of(Record const& r, int which) {
  Series s{r.cell,
           "history",
           {"t", "q1", "q2", "q3", "q4", "wx", "wy", "wz", "alpha", "tether_force", "energy_c"},
           {"s", "", "", "", "", "rad/s", "rad/s", "rad/s", "rad", "N", "N^2 m^2 s"},
           {}};
  for (int i = 0; i <= 500; ++i) {
    double const t = 0.1 * i, alpha = 0.92 * std::exp(-t / (8 + 4 * which)) * (which == 1 ? std::cos(t) : 1);
    double const q = std::sin(alpha / 2), w = 0.17 * std::exp(-t / 6);
    s.rows.push_back({t, 0, 0.6 * q, 0.8 * q, std::cos(alpha / 2), w, w * std::cos(t / (1 + which)), -w, alpha, 0,
                      100.0 * (which + 1) * (1 - std::exp(-t / 10))});
  }
  return s;
}

/// A set like the default suite's.
inline Contents full() {
  std::vector<Method> const methods{{"rk4", 4, 5e-3, 4, 8e-11},        {"dopri5", 5, 2e-3, 6, 3e-12},
                                    {"gauss1", 2, 1e-2, 6, 1e-15},     {"gauss2", 4, 5e-6, 12, 2e-15},
                                    {"gauss3", 6, 1e-7, 18, 3e-15},    {"gauss2_sweeps1", 2, 2e-2, 4, 7e-6},
                                    {"odeint_rk4", 4, 5e-3, 5, 8e-11}, {"cvode_adams", 3, 1e-4, 2, 4e-8}};
  Contents c;
  for (Method const& m : methods) {
    for (double const h : {0.0125, 0.025, 0.05, 0.1, 0.2}) {
      for (auto const* policy : {"none", "project"}) {
        for (auto const* problem : {"free_body", "tether_capture"}) {
          std::string const variant = problem == std::string("free_body") ? "" : "free,g1";
          c.records.push_back(made(problem, variant, m, h, policy));
          if (h == 0.1 && !variant.empty()) c.series.push_back(drift_of(c.records.back()));
        }
      }
    }
  }
  int which = 0;
  for (auto const* variant : {"case1,g1", "case2,g1", "case3,g1"}) {
    for (Method const& m : methods) {
      for (double const h : {0.0125, 0.025, 0.05, 0.1}) {
        Record r = made("tether_capture", variant, m, h);
        double const energy[] = {266.0679905645, 0, 324.9367918187};
        r.claims["energy_c"] = {energy[which], std::nullopt, "reproduced"};
        r.claims["alpha_end"] = {which == 1 ? 0.3213 : 0.0002, std::nullopt,
                                 which == 1 ? "not reproduced" : "reproduced"};
        c.records.push_back(r);
        if (h == 0.1) c.series.push_back(history_of(r, which));
      }
    }
    ++which;
  }
  // The erratum: the printed sign keeps energy and |L|, and turns L.
  for (auto const* variant : {"free,g1", "free,g1,as_printed"}) {
    Record r = made("tether_capture", variant, {"gauss4", 8, 1e-7, 24, 2e-16}, 0.05);
    r.energy_drift_max = 1.5e-16;
    r.momentum_drift_max = 7e-17;
    r.momentum_direction_max = variant == std::string("free,g1") ? 1.9e-16 : 0.2731;
    c.records.push_back(r);
  }
  // The sample period tied to the step: the error grows as the step is refined.
  for (double const h : {0.0125, 0.05, 0.1}) {
    Record r = made("tether_capture", "case1,g1,coupled", {"gauss2", 4, 5e-6, 12, 2e-15}, h);
    if (h < 0.1) r.attitude_error_max = 0.03 - 0.2 * h;
    c.records.push_back(r);
  }
  for (Record& r : c.records) {
    if (r.of.problem != "free_body") continue;
    r.energy_drift_max = r.momentum_drift_max = r.of.integrator.starts_with("gauss") ? 1e-16 : 2.5e-11;
    r.momentum_direction_max = 0.1 * *r.attitude_error_max;
  }
  Record failed = c.records.front();
  failed.cell = "failed";
  failed.of.integrator = "euler";
  failed.status = results::Status::diverged;
  failed.reason = "the state is not finite at t = 3 s";
  c.records.push_back(failed);
  c.metas.push_back({{"cpu", "made-up"}, {"compiler", "g++ 12.2"}});
  return c;
}

}  // namespace polhode::report::samples
