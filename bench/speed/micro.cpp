/// polhode-bench: what a step costs, side by side in one run. Google Benchmark with its own flags
/// (--benchmark_filter=...), and --out DIR; repetitions are interleaved at random, and the pairs' ratios are printed at
/// the end. Absolute times are this machine's.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

#include "bench/cell/cell.hpp"
#include "bench/cell/reference.hpp"
#include "bench/process/provenance.hpp"
#include "bench/speed/reporter.hpp"
#include "bench/speed/speed.hpp"
#include "problems/exact.hpp"
#include "results/store.hpp"

namespace {

using namespace polhode;
using namespace polhode::bench;

constexpr double step_size = 0.01;  // [s]

/// One solve of the problem's horizon with the typed method; the rate is in steps.
void solve_cost(benchmark::State& state, TimedSolve& solve, double steps) {
  for (auto _ : state) benchmark::DoNotOptimize(solve.solve());
  count_steps(state, steps);
}

std::vector<Comparison> const comparisons{
    {"RK4 step, free body: polhode / Odeint on std::array", "step/free_body/quaternion/rk4",
     "plain/free_body/odeint_rk4"},
    {"RK4 step, free body: polhode / Odeint behind our face", "step/free_body/quaternion/rk4",
     "step/free_body/quaternion/odeint_rk4"},
    {"RK4 step, PD slew: polhode / Odeint behind our face", "step/pd_slew/quaternion/rk4",
     "step/pd_slew/quaternion/odeint_rk4"},
    {"RK4, tether capture, 2 steps a sample: polhode / Odeint behind our face", "step/tether_capture/quaternion/rk4",
     "step/tether_capture/quaternion/odeint_rk4"},
    {"DP5 step, free body: polhode / Odeint behind our face", "step/free_body/quaternion/dopri5",
     "step/free_body/quaternion/odeint_dopri5"},
    {"RK4, cost per craft and step: 10^5 craft / 100", "network/quaternion_sync/quaternion/rk4/100000",
     "network/quaternion_sync/quaternion/rk4/100"},
    {"CF4 on S3, the same", "network/quaternion_sync/s3/cf4/100000", "network/quaternion_sync/s3/cf4/100"},
    {"Gauss of 2 stages, the same", "network/quaternion_sync/quaternion/gauss2/100000",
     "network/quaternion_sync/quaternion/gauss2/100"},
    {"RK4 step, free body: its type forgotten at every evaluation / at every solve",
     "erased/free_body/quaternion/rk4/evaluation", "step/free_body/quaternion/rk4"},
    {"RK4 step, free body: its type forgotten at every solve / never", "step/free_body/quaternion/rk4",
     "twin/free_body/rk4/generic"}};

/// Short steps, so that a solve is a loop over them; those of a sampled problem divide its period.
double step_of(ProblemEntry const& entry) {
  bool const sampled = entry.choose({})->sample_period() > 0;
  return sampled ? entry.info().step : std::min(step_size, entry.info().step);
}

/// The cell of a solve from the catalogue's names alone.
results::Cell cell_of(std::string_view problem, std::string_view formulation, std::string_view integrator, double h) {
  results::Cell cell;
  cell.problem = problem;
  cell.formulation = formulation;
  cell.integrator = integrator;
  cell.h = h;
  return cell;
}

/// Every typed fixed-step method on every problem and formulation.
void register_steps() {
  for (ProblemEntry const* entry : all_problems())
    for (std::string_view formulation : entry->formulations())
      for (IntegratorWord const& word : vocabulary().integrators) {
        // a solve by the closed form is one value, not steps
        if (!word.fixed || !word.not_built.empty() || word.family == "exact") continue;
        PreparedCell const prepared = prepare(cell_of(entry->info().name, formulation, word.name, step_of(*entry)));
        if (!prepared.refusal.empty()) continue;
        std::shared_ptr<TimedSolve> const solve = prepared.problem->timed(formulation, word.name, prepared.plan);
        if (!solve) continue;
        double const steps = prepared.cell.t_end / *prepared.cell.h;
        std::string const name = fmt::format("step/{}/{}/{}", entry->info().name, formulation, word.name);
        benchmark::RegisterBenchmark(name.c_str(), [solve, steps](benchmark::State& state) {
          solve_cost(state, *solve, steps);
        })->Unit(benchmark::kMicrosecond);
      }
}

/// Networks of 5 to 10^5 craft, all over the same second, so many times that craft times steps is the same: equal
/// times are equal cost per craft and step. (Over longer horizons the smaller would be at rest most of the time, where
/// Gauss needs three sweeps instead of twenty.)
void register_networks() {
  constexpr double h = 0.1;
  constexpr int steps = 10, most_craft = 100'000;
  for (auto const& [formulation, integrator] :
       {std::pair{"quaternion", "rk4"}, {"s3", "cf4"}, {"quaternion", "gauss2"}})
    for (int const n : {5, 100, 1000, 10'000, most_craft}) {
      results::Cell cell = cell_of("quaternion_sync", formulation, integrator, h);
      cell.t_end = steps * h;
      cell.set["n"] = {double(n)};
      PreparedCell const prepared = prepare(cell);
      std::shared_ptr<TimedSolve> const solve = prepared.problem->timed(formulation, integrator, prepared.plan);
      std::string const name = fmt::format("network/quaternion_sync/{}/{}/{}", formulation, integrator, n);
      benchmark::RegisterBenchmark(name.c_str(), [solve, n](benchmark::State& state) {
        for (auto _ : state)
          for (int solved = 0; solved < most_craft; solved += n) benchmark::DoNotOptimize(solve->solve());
        count_steps(state, double(most_craft) * steps);
      })->Unit(benchmark::kMillisecond);
    }
}

/// The free body's field behind a virtual call at every evaluation.
void register_erased() {
  using M = RigidBody<FlatQuaternion<double>>;
  PreparedCell const prepared = prepare(cell_of("free_body", "quaternion", "rk4", step_size));
  auto field = std::get<std::unique_ptr<Erased<M>>>(prepared.problem->in("quaternion"));
  std::shared_ptr<TimedSolve> const solve = method_named<M>("rk4").timed(std::move(field), prepared.plan);
  double const steps = prepared.cell.t_end / step_size;
  benchmark::RegisterBenchmark("erased/free_body/quaternion/rk4/evaluation", [solve, steps](auto& state) {
    solve_cost(state, *solve, steps);
  })->Unit(benchmark::kMicrosecond);
}

/// What a changed free body costs before its first run: its reference by Taylor series, and the proof by Gauss.
void register_certification() {
  benchmark::RegisterBenchmark("certify/free_body", [](benchmark::State& state) {
    PreparedCell const prepared = prepare(cell_of("free_body", "quaternion", "rk4", step_size));
    double bar = 0;
    for (auto _ : state) {
      Reference const reference = Reference::solve(*prepared.problem, prepared.schedule);
      bar = certify(prepared.physics, *prepared.problem, prepared.schedule, reference).bar;
    }
    state.counters["bar"] = bar;
  })->Unit(benchmark::kMillisecond);
}

/// The closed form of the free body: a value of it, at times that no two evaluations share, and what comes before the
/// first.
void register_closed_form() {
  auto const made = [] {
    BodyParameters const body;
    auto const& J = body.inertia;
    return ExactFreeBody<double>({J[0], J[1], J[2]}, body.attitude<double>(), body.rate<double>());
  };
  benchmark::RegisterBenchmark("exact/free_body/evaluation", [made](benchmark::State& state) {
    constexpr int values = 1000;
    auto motion = made();
    for (auto _ : state) {
      benchmark::DoNotOptimize(motion);
      for (int i = 1; i <= values; ++i) benchmark::DoNotOptimize(motion.at(double(i)));
    }
    count_steps(state, values);
  })->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("exact/free_body/setup", [made](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(made());
    count_steps(state, 1);
  })->Unit(benchmark::kMicrosecond);
}

/// What this program reads itself; the rest is Google Benchmark's.
struct Flags {
  std::string out;
  bool each_repetition = false;  ///< printed, beside median and deviation
  std::vector<char*> others;
};
/// None if --out has no folder.
std::optional<Flags> flags_of(int argc, char** argv) {
  Flags flags;
  std::string const brief = "--benchmark_report_aggregates_only";
  for (int i = 0; i < argc; ++i) {
    std::string const word = argv[i];
    if (word == "--out") {
      if (i + 1 == argc) return {};
      flags.out = argv[++i];
    } else if (word.starts_with("--out=")) {
      flags.out = word.substr(6);
    } else if (word.starts_with(brief)) {
      std::string const value = word.size() > brief.size() ? word.substr(brief.size() + 1) : "true";
      flags.each_repetition = value == "false" || value == "0" || value == "no";
    } else {
      flags.others.push_back(argv[i]);
      continue;
    }
    if (word.starts_with("--out") && flags.out.empty()) return {};
  }
  return flags;
}

void print_help() {
  fmt::print(
      "polhode-bench [--out DIR] [--benchmark_...]\n\n"
      "What steps, ensembles and networks cost, side by side in one run; absolute times are this machine's.\n\n"
      "  --out DIR                      write DIR/{}, for `polhode report DIR`\n"
      "  --version                      version, commit, compiler, libraries\n"
      "  --benchmark_filter=REGEX       those whose names match\n"
      "  --benchmark_list_tests         say which there are\n"
      "  --benchmark_repetitions=N      9 unless given; --benchmark_min_time=SECONDS of each: 0.02\n"
      "  --benchmark_report_aggregates_only=false   print each repetition, too\n"
      "  --benchmark_format=console|json|csv        and all other flags of Google Benchmark\n\n"
      "Exit codes: 0 ok, 2 usage, 3 the filter matches nothing, 5 DIR cannot be written.\n",
      results::benchmarks_file);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--version") != 0) continue;
    fmt::print("{}", version_text());
    return 0;
  }
  auto flags = flags_of(argc, argv);
  if (!flags) {
    std::fputs("polhode-bench: --out needs a folder\n", stderr);
    return 2;
  }
  // Before the user's own flags, so that these win.
  std::string interleave = "--benchmark_enable_random_interleaving=true", repeat = "--benchmark_repetitions=9",
              short_time = "--benchmark_min_time=0.02";
  flags->others.insert(flags->others.begin() + 1, {interleave.data(), repeat.data(), short_time.data()});
  int count = int(flags->others.size());
  benchmark::Initialize(&count, flags->others.data(), print_help);
  if (benchmark::ReportUnrecognizedArguments(count, flags->others.data())) return 2;

  register_steps();
  register_networks();
  register_erased();
  register_certification();
  register_closed_form();
  std::vector<Comparison> compared = comparisons;
  add_twins(compared);
  add_worst_cases();
  add_ensembles(compared);
  add_odeint_loops();
  results::Meta const meta = provenance();  // the load before we make it
  std::error_code error;
  if (!flags->out.empty()) std::filesystem::create_directories(flags->out, error);
  if (error) {  // now, and not after minutes
    std::fputs(fmt::format("polhode-bench: {}: {}\n", flags->out, error.message()).c_str(), stderr);
    return 5;
  }
  Reporter reporter(flags->each_repetition);
  if (benchmark::RunSpecifiedBenchmarks(&reporter) == 0) {
    std::fputs("polhode-bench: --benchmark_filter matches nothing\n", stderr);
    return 3;
  }
  reporter.print_ratios(compared);
  try {
    auto const all = reporter.benchmarks();  // none if they were only listed
    if (!flags->out.empty() && !all.empty()) results::write_benchmarks(flags->out, {meta, all});
  } catch (results::StoreError const& trouble) {
    std::fputs(fmt::format("polhode-bench: {}\n", trouble.what()).c_str(), stderr);
    return 5;
  }
  return 0;
}
