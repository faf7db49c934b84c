#pragma once
/// The verbs of the command line, each in a file of its own. The report's is in main.cpp.
#include <CLI/App.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "results/compare.hpp"
#include "results/terminal.hpp"

namespace polhode::bench {

/// What the program returns: a contract, which README.md and --help state, too.
enum ExitCode {
  exit_ok = 0,
  exit_expectation_failed = 1,
  exit_usage = 2,
  exit_nothing_selected = 3,
  exit_run_failed = 4,
  exit_bad_file = 5,
  exit_interrupted = 130
};

/// Draws rows (t first, units beside the names) into a file; throws if it cannot.
using PlotTrajectory =
    std::function<void(results::Series const& rows, std::string const& title, std::filesystem::path const& file)>;

/// How a comparison may be written down.
enum class ComparisonForm { terminal, markdown, html };
using WriteComparison = std::function<std::string(results::Comparison const& comparison, ComparisonForm form,
                                                  results::Outlet const& outlet)>;

/// What the verbs leave to somebody who knows how things look: the harness does not know the report.
struct Faces {
  PlotTrajectory plot;
  WriteComparison comparison;
};

/// To the file that the user named, or to standard output if none: main() sees whether all of that went out. Throws
/// StoreError.
void write_out(std::string const& file, std::string_view text);

/// Adds the verbs to `app`. A verb that ran writes its exit code; mistakes are thrown.
void add_commands(CLI::App& app, int& code, Faces const& faces);
/// The verb list: what there is.
void add_list(CLI::App& app);
/// The verb run: a suite, on one process or on the ranks of an MPI job.
void add_run(CLI::App& app, int& code);
/// The verb simulate: one cell.
void add_simulate(CLI::App& app, int& code, PlotTrajectory const& plot);
/// The verb reference: certified references, made.
void add_reference(CLI::App& app);
/// The verb ensemble: many samples of one problem.
void add_ensemble(CLI::App& app, int& code);
/// The verb compare: two sets of records.
void add_compare(CLI::App& app, int& code, WriteComparison const& write);
/// The verb check: expectations and golden columns.
void add_check(CLI::App& app, int& code);
/// The verbs export and merge: records in other files.
void add_export(CLI::App& app);
/// The verb doctor: what is built in, and the machine.
void add_doctor(CLI::App& app);
/// The verb import: trajectories of other programs.
void add_import(CLI::App& app);

}  // namespace polhode::bench
