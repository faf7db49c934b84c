/// The verb run.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>

#include "bench/cell/cell.hpp"
#include "bench/commands/commands.hpp"
#include "bench/input/cell_flags.hpp"
#include "bench/job/ranks.hpp"
#include "bench/job/run.hpp"
#include "bench/job/run_report.hpp"
#include "bench/job/slurm.hpp"
#include "bench/job/tasks.hpp"
#include "bench/process/data.hpp"
#include "bench/process/provenance.hpp"
#include "bench/process/signals.hpp"
#include "results/store.hpp"

namespace polhode::bench {
namespace {

/// "2/8": the second of eight parts. Throws UsageError.
void read_shard(std::string const& text, RunOptions& options) {
  auto const slash = text.find('/');
  auto const part = [&](std::size_t from, std::size_t to, int& value) {
    auto const [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    return error == std::errc() && end == text.data() + to;
  };
  bool const read = slash != std::string::npos && part(0, slash, options.shard) &&
                    part(slash + 1, text.size(), options.shards) && 1 <= options.shard &&
                    options.shard <= options.shards;
  if (!read) throw UsageError(fmt::format("--shard {}: write K/N, the K-th of N parts, K from 1 to N", quote(text)));
}

/// What the cells of a suite get wrong names the suite's file.
RunSummary run_in_file(std::filesystem::path const& file, Suite const& suite, RunOptions const& options, Ranks& ranks) {
  try {
    return run_suite(suite, options, ranks);
  } catch (SuiteError const& error) {
    throw SuiteError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

/// What became of a run: on a terminal as a table, and in one line.
void say(RunSummary const& summary) {
  if (::isatty(STDOUT_FILENO) != 0 && !launched())  // what scripts read is the line below
    fmt::print("{}", run_text(results::read(summary.out), build_id(), results::outlet_of(STDOUT_FILENO)));
  fmt::print("{}: {} cells: {} ok, {} refused, {} failed, {} already done\n", summary.out.string(), summary.cells,
             summary.ok, summary.refused, summary.failed, summary.skipped);
  if (summary.interrupted) std::fputs("polhode: interrupted; the same command goes on from here\n", stderr);
}

// ---- --print-slurm --------------------------------------------------------------------------------------------------

/// What `run` is told of the script.
struct SlurmFlags {
  bool print = false;
  double ranks = 0, shards = 8;
  std::string time{};
};

constexpr int most_parts = 100'000;

/// The command that each job is to run; relative paths would depend on where it starts.
std::vector<std::string> command_of(std::string const& suite, std::filesystem::path const& out,
                                    RunOptions const& options) {
  std::vector<std::string> command{std::filesystem::read_symlink("/proc/self/exe"), "run", suite, "--out",
                                   std::filesystem::absolute(out)};
  if (!options.filter.empty()) command.insert(command.end(), {"--filter", options.filter});
  if (options.retry_failed) command.emplace_back("--retry-failed");
  if (options.timeout != RunOptions{}.timeout)
    command.insert(command.end(), {"--timeout", fmt::format("{:g}", options.timeout)});
  return command;
}

std::string script_of(std::string const& name, RunOptions const& options, SlurmFlags const& flags) {
  bool const parted = options.shards > 1 || options.isolate || options.fresh || options.dry_run;
  if (parted)
    throw UsageError(
        "--print-slurm makes the parts itself: it goes with neither --shard, --fresh, --isolate nor --dry-run");
  std::filesystem::path const file = suite_file(name);
  bool const built_in = file.parent_path() == suites_folder();
  Suite const suite = read_suite(file, vocabulary());
  auto const cells = int(tasks_of(suite, options.filter).size());
  bool const array = flags.ranks == 0;
  int const parts =
      array ? whole_number("shards", flags.shards, 1, most_parts) : whole_number("ranks", flags.ranks, 1, most_parts);
  std::filesystem::path const out = options.out.empty() ? default_folder(suite) : options.out;
  return slurm_script({.name = suite.name,
                       .command = command_of(built_in ? name : std::filesystem::absolute(file).string(), out, options),
                       .array = array,
                       .parts = std::min(parts, cells),
                       .time = flags.time.empty() ? "" : slurm_time(flags.time),
                       .exclusive = array && suite.timing.enabled});
}

// ---- run ------------------------------------------------------------------------------------------------------------

/// Whether the manager keeps up, and what a network has to carry.
void say(int ranks, Traffic const& traffic) {
  fmt::print(stderr, "polhode: {} ranks: the manager exchanged {} messages, {} bytes, in {:.4f} s of processor time\n",
             ranks, traffic.messages, traffic.bytes, traffic.cpu_time);
}

/// Returns the exit code.
int run_on_ranks(std::string const& name, RunOptions const& options, bool traffic) {
  Ranks ranks = Ranks::of_this_job();
  std::filesystem::path file;
  Suite suite;
  ranks.together([&] {
    file = suite_file(name);
    suite = read_suite(file, vocabulary());
  });
  RunSummary const summary = run_in_file(file, suite, options, ranks);
  if (options.dry_run || !ranks.manager()) return exit_ok;
  say(summary);
  if (traffic) say(ranks.size(), ranks.traffic());
  if (summary.interrupted) return exit_interrupted;
  return summary.died > 0 ? exit_run_failed : exit_ok;
}

}  // namespace

void add_run(CLI::App& app, int& code) {
  auto const options = std::make_shared<RunOptions>();
  auto const name = std::make_shared<std::string>("default");
  auto const out = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("run", "Run a suite; finished cells of the same build are not run again");
  verb->add_option("SUITE", *name, "Built-in suite or TOML file")->capture_default_str();
  verb->add_option("--out", *out, "Result folder; default polhode-results/SUITE")->type_name("DIR");
  verb->add_option("--filter", options->filter,
                   "Regular expression over problem/variant/formulation/integrator/policy");
  verb->add_flag("--fresh", options->fresh, "Forget what the folder holds");
  verb->add_flag("--retry-failed", options->retry_failed, "Run again what failed");
  verb->add_flag("--isolate", options->isolate,
                 "Measure each cell in a process of its own: one that crashes is a record, the others go on");
  verb->add_flag("--dry-run", options->dry_run, "Say what would run, and about how long it would take");
  auto const shard = std::make_shared<std::string>();
  verb->add_option("--shard", *shard, "The K-th of N parts, for as many machines")->type_name("K/N");
  add_number(*verb, "--timeout", options->timeout, "Limit per cell [s]; 0 for none")->capture_default_str();
  auto const threads = std::make_shared<double>(0);
  CLI::Option* has_threads =
      add_number(*verb, "--threads", *threads, "Of the accuracy pass; default one per processor")->type_name("INT");
  auto const traffic = std::make_shared<bool>(false);
  verb->add_flag("--traffic", *traffic, "Under mpirun: say on stderr how much the ranks had to tell each other");
  auto const slurm = std::make_shared<SlurmFlags>();
  CLI::Option* print = verb->add_flag("--print-slurm", slurm->print,
                                      "Print a script for sbatch instead: an array of --shards, or --ranks of one job");
  add_number(*verb, "--shards", slurm->shards, "Of the printed job array")->type_name("INT")->needs(print);
  CLI::Option* has_ranks =
      add_number(*verb, "--ranks", slurm->ranks, "Of the printed MPI job")->type_name("INT")->needs(print);
  verb->add_option("--time", slurm->time, "Limit of each printed job, as sbatch takes it")->needs(print);
  verb->callback([=, &code] {
    options->out = *out;
    if (!shard->empty()) read_shard(*shard, *options);
    bool const no_limit = !(options->timeout >= 0) || std::isinf(options->timeout);
    if (no_limit)
      throw UsageError(
          fmt::format("timeout = {}: a limit is a finite number of seconds; 0 for none", options->timeout));
    if (has_threads->count() > 0) options->threads = whole_number("threads", *threads, 1, most_threads);
    if (has_ranks->count() > 0) whole_number("ranks", slurm->ranks, 1, most_parts);
    if (slurm->print) return fmt::print("{}", script_of(*name, *options, *slurm));
    interruptible();
    code = run_on_ranks(*name, *options, *traffic);
  });
}

}  // namespace polhode::bench
