#include "bench/commands.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <set>

#include "bench/cell.hpp"
#include "bench/cell_flags.hpp"
#include "bench/run_report.hpp"
#include "results/store.hpp"

namespace polhode::bench {
namespace {

// ---- run ------------------------------------------------------------------------------------------------------------

int thread_count(double wanted) {
  constexpr int most = 1024;
  if (wanted >= 1 && wanted <= most && wanted == std::floor(wanted)) return int(wanted);
  throw UsageError(fmt::format("threads = {}: a whole number from 1 to {} is wanted", wanted, most));
}

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
RunSummary run_in_file(std::filesystem::path const& file, Suite const& suite, RunOptions const& options) {
  try {
    return run_suite(suite, options);
  } catch (SuiteError const& error) {
    throw SuiteError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

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
  verb->callback([=, &code] {
    options->out = *out;
    if (!shard->empty()) read_shard(*shard, *options);
    bool const no_limit = !(options->timeout >= 0) || std::isinf(options->timeout);
    if (no_limit)
      throw UsageError(
          fmt::format("timeout = {}: a limit is a finite number of seconds; 0 for none", options->timeout));
    if (has_threads->count() > 0) options->threads = thread_count(*threads);
    std::filesystem::path const file = suite_file(*name);
    Suite const suite = read_suite(file, vocabulary());
    interruptible();
    RunSummary const summary = run_in_file(file, suite, *options);
    if (options->dry_run) return;
    if (::isatty(STDOUT_FILENO) != 0)  // what scripts read is the line below
      fmt::print("{}", run_text(results::read(summary.out), build_id(), results::outlet_of(STDOUT_FILENO)));
    fmt::print("{}: {} cells: {} ok, {} refused, {} failed, {} already done\n", summary.out.string(), summary.cells,
               summary.ok, summary.refused, summary.failed, summary.skipped);
    constexpr int interrupted = 130, run_failed = 4;
    if (summary.died > 0) code = run_failed;
    if (summary.interrupted) {
      std::fputs("polhode: interrupted; the same command goes on from here\n", stderr);
      code = interrupted;
    }
  });
}

// ---- reference ------------------------------------------------------------------------------------------------------

/// Before the work, so that the work is not lost.
void make_folder(std::filesystem::path const& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw ReferenceError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
}

/// Computes, certifies and saves the reference of one cell's physics.
void make_reference(results::Cell const& cell, std::filesystem::path const& folder) {
  PreparedCell const prepared = prepare(physics_alone(cell));
  make_folder(folder);
  Reference const reference = Reference::solve(*prepared.problem, prepared.schedule);
  Certificate const certificate = certify(prepared.physics, *prepared.problem, prepared.schedule, reference);
  save(certificate, folder);
  fmt::print(
      "{}  bar {:.1e} rad  (Taylor against Gauss {:.1e}, Gauss against half its step {:.1e}{})  {}\n", certificate.id,
      certificate.bar, certificate.disagreement, certificate.halving,
      certificate.closed_form ? fmt::format(", Taylor against the closed form {:.1e}", *certificate.closed_form) : "",
      certificate.subject);
}

/// One cell for each reference that the built-in suites need: their physics, without repetition.
std::vector<results::Cell> physics_of_suites() {
  std::vector<results::Cell> cells;
  std::set<std::string> seen;
  for (std::string const& name : suite_names())
    for (SuiteCell const& wanted : read_suite(suite_file(name), vocabulary()).cells) {
      if (!wanted.reference) continue;
      PreparedCell const prepared = prepare(wanted.cell);
      if (seen.insert(reference_subject(prepared.physics)).second) cells.push_back(prepared.physics);
    }
  return cells;
}

void add_reference(CLI::App& app) {
  auto const flags = std::make_shared<CellFlags>();
  auto const out = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand(
      "reference", "Compute and certify a reference in quadruple precision; without PROBLEM, all that the suites need");
  flags->add_physics(*verb);
  verb->get_option("PROBLEM")->required(false);
  verb->add_option("--out", *out, "Folder; default the committed references")->type_name("DIR");
  verb->callback([=] {
    std::filesystem::path const folder = out->empty() ? references_folder() : std::filesystem::path(*out);
    if (!flags->cell.problem.empty()) return make_reference(flags->chosen(), folder);
    if (!flags->cell.variant.empty() || !flags->settings.empty() || flags->has_t_end->count() > 0)
      throw UsageError("--variant, --set and --t-end need a PROBLEM");
    for (results::Cell const& cell : physics_of_suites()) make_reference(cell, folder);
  });
}

}  // namespace

void add_commands(CLI::App& app, int& code, Faces const& faces) {
  add_list(app);
  add_run(app, code);
  add_simulate(app, code, faces.plot);
  add_reference(app);
  add_check(app, code);
  add_compare(app, code, faces.comparison);
  add_export(app);
  add_import(app);
  add_doctor(app);
}

}  // namespace polhode::bench
