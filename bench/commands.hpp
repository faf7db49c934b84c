#pragma once
/// The verbs of the command line that need the harness: list, run, simulate, reference.
#include <CLI/App.hpp>

#include "bench/provenance.hpp"
#include "bench/run.hpp"
#include "bench/vocabulary.hpp"

namespace polhode::bench {

/// Adds the verbs to `app`. A verb that ran writes its exit code; mistakes are thrown.
void add_commands(CLI::App& app, int& code);
/// The verb list: what there is.
void add_list(CLI::App& app);
/// The verb check: expectations and golden columns.
void add_check(CLI::App& app, int& code);
/// The verbs export and merge: records in other files.
void add_export(CLI::App& app);
/// The verb doctor: what is built in, and the machine.
void add_doctor(CLI::App& app);
/// The verb import: trajectories of other programs.
void add_import(CLI::App& app);

}  // namespace polhode::bench
