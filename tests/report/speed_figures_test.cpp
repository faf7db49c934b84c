// What polhode-bench measured, in the report: tables hold the file's numbers, quotients are those of its times.
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;
using results::Benchmark;

/// So many steps an iteration, each of that time; within 10%.
Benchmark of(std::string name, double per_step, double steps = 1000) {
  double const t = per_step * steps;
  return {std::move(name), false, {t, 0.9 * t, 1.1 * t, 9, {}}, {{"per_step", per_step}}};
}
Contents measured() {
  Contents c;
  c.records.push_back(made("free_body", "", {"rk4", 4, 1, 1, 1e-15}, 0.1));
  c.benchmarks.meta = {{"cpu_model", "bench machine"}, {"cpu_mhz", "2596.1"}};
  c.benchmarks.all = {of("step/free_body/quaternion/rk4", 25.04e-9),
                      of("step/pd_slew/quaternion/rk4", 40e-9),
                      of("step/free_body/quaternion/odeint_rk4", 34e-9),
                      of("step/dead_zone/quaternion/rk4", 1e-6),
                      of("plain/free_body/odeint_rk4", 30e-9),
                      of("ensemble/free_body/rk4", 2.5e-9),
                      of("ensemble/free_body/rk4_float", 1.25e-9),
                      of("ensemble/free_body/odeint_rk4", 25e-9),
                      of("ensemble/free_body/odeint_rk4_avx2", 20e-9),
                      of("ensemble/fused_peak", 2e-9),
                      of("ensemble/free_body/rk4_threads_1", 2.6e-9),
                      of("ensemble/free_body/rk4_threads_2", 1.3e-9),
                      of("network/quaternion_sync/quaternion/rk4/100", 20e-9),
                      of("network/quaternion_sync/quaternion/rk4/100000", 38e-9),
                      of("network/quaternion_sync/quaternion/rk4/99999999999999", 1),  // no number of craft
                      of("worst/limited_slew_sampled/rk4/period", 1e-7),
                      of("certify/free_body", 0.018, 1),
                      of("exact/free_body/evaluation", 60e-9),
                      of("somebody/else's", 1)};
  c.benchmarks.all[2].counters.clear();  // without a count of steps: an iteration is what it costs
  c.benchmarks.all[6].counters["lost"] = 2.4e-6;
  c.benchmarks.all[9].counters["flops"] = 143.2e9;
  c.benchmarks.all[15].counters.insert({{"p50", 171e-9}, {"p99.9", 181e-9}, {"max", 1.25e-5}});
  c.benchmarks.all[16].counters["bar"] = 4e-33;
  return c;
}

TEST(SpeedFigures, TablesHoldTheFilesNumbers) {
  Folder const folder;
  std::string const text = markdown_of(measured(), folder.path);
  expect_sound(folder.path);
  for (auto const* row :
       {"| rk4 | quaternion | own | 25 ns | 40 ns | – |", "| odeint_rk4 | quaternion | Odeint | 34 µs | – | – |",
        "| free_body | rk4 | 2.5 ns | 8 | 80 | – |", "| free_body | rk4_float | 1.25 ns | 16 | – | 2.4e-6 |",
        "| rk4 (quaternion) | 20 ns | 38 ns | 1.9 | 1.55 to 2.32 |",
        "| RK4, free body: Odeint on a plain array / ours | 1.2 | 0.98 to 1.46 |",
        "| ensemble, wall time: 1 thread / 2, runs of 200 steps | 2 | 1.64 to 2.44 |",
        "| ensemble of free bodies: double / single precision | 2 | 1.64 to 2.44 |",
        "| a period of sampled control: 99.9% take at most | 181 ns |",
        "| a certified reference of the free body, 50 s, to 4e-33 rad | 18 ms |",
        "| closed form of the free body: a value | 60 ns |", "| peak of fused operations on one core [GFLOP/s] | 143 |",
        "| processor | bench machine |", "| clock [MHz] | 2596.1 |"})
    EXPECT_TRUE(contains(text, row)) << row;
  EXPECT_FALSE(contains(text, "99999999"));
  EXPECT_TRUE(contains(slurp(folder.path / "tables" / "speed-steps.csv"), "rk4,quaternion,own,2.504e-08,4e-08,"));
  EXPECT_TRUE(contains(slurp(folder.path / "tables" / "speed-networks.tex"), "38"));
}

TEST(SpeedFigures, WithoutThemTheReportSaysHowToGetThem) {
  Folder const folder;
  Contents c = measured();
  c.benchmarks = {};
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(
      contains(text, "The folder holds no figures of steps, ensembles and networks; `polhode-bench --out DIR`"));
  EXPECT_FALSE(contains(text, "speed-machine"));
}

}  // namespace
}  // namespace polhode::report
