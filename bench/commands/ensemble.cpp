/// The verb ensemble: many samples of one problem, and what is known of them all.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/commands/commands.hpp"
#include "bench/ensemble/output.hpp"
#include "bench/input/cell_flags.hpp"
#include "bench/job/ranks.hpp"
#include "bench/process/clock.hpp"
#include "bench/process/machine.hpp"
#include "bench/process/progress.hpp"
#include "bench/process/signals.hpp"
#include "results/store.hpp"
#include "results/whole_file.hpp"

namespace polhode::bench {
namespace {

struct EnsembleFlags {
  CellFlags cell;
  std::vector<std::string> disperse;
  std::string samples, seed = "1", out, raw;
  double settle = EnsembleRequest{}.settle_angle, every = 0, threads = 0, worst = 5;
  CLI::Option *has_threads = nullptr, *has_every = nullptr;
  bool json = false;

  EnsembleRequest request() const {
    EnsembleRequest wanted;
    wanted.cell = cell.chosen();
    wanted.disperse = disperse;
    wanted.seed = whole_number("seed", seed, 0, std::numeric_limits<std::uint64_t>::max());
    wanted.samples = std::int64_t(whole_number("samples", samples, 1, 1'000'000'000'000));
    wanted.settle_angle = settle;
    if (!(settle > 0) || !std::isfinite(settle))
      throw UsageError(fmt::format("settle = {}: an angle in rad greater than 0 is wanted", settle));
    if (has_every->count() > 0) check_positive("every", every);
    wanted.every = every;
    wanted.worst = std::size_t(whole_number("worst", worst, 0, 1000));
    wanted.raw = !raw.empty();
    return wanted;
  }
  int thread_count(int ranks_here) const {
    int const processors = std::max(1, int(std::thread::hardware_concurrency()));
    if (has_threads->count() == 0) return std::max(1, processors / ranks_here);
    return whole_number("threads", threads, 1, most_threads);
  }
};

std::ofstream opened(std::filesystem::path const& file) {
  std::ofstream out(file, std::ios::binary);
  if (!out) throw results::StoreError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  return out;
}
/// The greatest resident size of this process [B]; that of getrusage may be its parent's.
std::int64_t peak_memory() {
  return 1024 * std::atoll(entry_of("/proc/self/status", "VmHWM").c_str());
}

/// Deals the items out and joins what comes back, in order.
results::EnsembleStatistics gather(EnsembleJob const& job, EnsembleTiming& timing, std::string const& raw,
                                   Ranks& ranks) {
  EnsemblePart all = job.nothing();
  std::ofstream rows;
  if (job.request().raw && ranks.manager()) {
    rows = opened(raw);
    rows << job.columns();
  }
  Progress progress(ranks.manager() ? std::size_t(job.items()) : 0);
  progress.say(fmt::format("{} samples of {}", job.request().samples, job.prepared().cell.problem));
  ranks.distribute(
      job.items(),
      [&](std::int64_t item) {  // one at a time
        double const begin = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
        std::string bytes = job.work(item, timing.threads, interrupted);
        timing.cpu_seconds += seconds_of(CLOCK_PROCESS_CPUTIME_ID) - begin;
        timing.samples_here += job.samples_in(item);
        return bytes;
      },
      [&](std::int64_t, std::string const& bytes) {
        EnsemblePart const part = job.part(bytes);
        all.statistics += part.statistics;
        rows << part.rows;
        progress.advance();
      },
      &interrupted);
  if (rows.is_open() && !rows.flush())
    throw results::StoreError(fmt::format("{}: cannot be written: {}", raw, std::strerror(errno)));
  return all.statistics;
}

/// Returns the exit code.
int run_ensemble_verb(EnsembleFlags const& flags) {
  Ranks ranks = Ranks::of_this_job();
  std::unique_ptr<EnsembleJob> job;
  EnsembleTiming timing{.ranks = ranks.size()};
  ranks.together([&] {
    job = std::make_unique<EnsembleJob>(flags.request());
    timing.threads = flags.thread_count(ranks.on_this_node());
    if (!flags.out.empty() && ranks.manager()) std::filesystem::create_directories(flags.out);
  });
  if (ranks.manager()) warn(job->prepared().problem->warning());

  auto const begin = std::chrono::steady_clock::now();
  results::EnsembleStatistics const statistics = gather(*job, timing, flags.raw, ranks);
  if (!ranks.manager()) return exit_ok;
  if (interrupted) {
    std::fputs("polhode: interrupted; nothing was written but rows of --raw\n", stderr);
    return exit_interrupted;
  }
  timing.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  timing.kernel_rate = plain_kernel_rate(timing.threads);
  timing.peak_memory = peak_memory();

  std::string const json = ensemble_json(*job, statistics, timing).dump(1) + "\n";
  if (!flags.out.empty()) results::write_whole(std::filesystem::path(flags.out) / results::ensemble_file, json);
  std::string const text =
      flags.json ? json : ensemble_text(*job, statistics, timing, results::outlet_of(fileno(stdout)));
  std::fwrite(text.data(), 1, text.size(), stdout);
  bool const any = statistics.endings().contains("ok") || statistics.endings().contains("never_settled");
  if (!any) std::fputs("polhode: no sample reached its end\n", stderr);
  return any ? exit_ok : exit_run_failed;
}

}  // namespace

void add_ensemble(CLI::App& app, int& code) {
  auto const flags = std::make_shared<EnsembleFlags>();
  CLI::App* verb = app.add_subcommand(
      "ensemble", "Run many samples of one problem with dispersed parameters; quantiles, histograms and worst cases");
  flags->cell.add_physics(*verb);
  flags->cell.add_method(*verb);
  verb->add_option("--samples", flags->samples, "How many samples")->type_name("INT")->required();
  verb->add_option("--seed", flags->seed,
                   "Of the random numbers (Philox4x32-10): a sample follows from seed and number")
      ->type_name("INT")
      ->capture_default_str();
  verb->add_option("--disperse", flags->disperse,
                   "NAME=normal(MEAN,SIGMA), uniform(A,B), log_uniform(A,B), for each component or for one "
                   "(omega0.x=...); q0=so3(); repeatable")
      ->type_name("NAME=LAW")
      ->allow_extra_args(false);
  add_number(*verb, "--settle", flags->settle, "Settled while the angle stays below [rad]; default 1 deg");
  flags->has_every = add_number(*verb, "--every", flags->every,
                                "From look to look [s], under continuous control; default t_end / 500");
  flags->has_threads = add_number(*verb, "--threads", flags->threads, "Default one per processor, shared by the ranks")
                           ->type_name("INT");
  verb->add_option("--out", flags->out, "Folder for ensemble.json, which `polhode report` reads")->type_name("DIR");
  verb->add_option("--raw", flags->raw, "A row for each sample: metrics, dispersed numbers, end state")
      ->type_name("FILE.csv");
  add_number(*verb, "--worst", flags->worst, "Samples to list of each metric")->type_name("INT")->capture_default_str();
  verb->add_flag("--json", flags->json, "ensemble.json on standard output instead of the table");
  verb->callback([=, &code] {
    interruptible();
    code = run_ensemble_verb(*flags);
  });
}

}  // namespace polhode::bench
