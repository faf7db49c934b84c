/// The verb reference: certified references, made anew.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <set>

#include "bench/cell/cell.hpp"
#include "bench/commands/commands.hpp"
#include "bench/input/cell_flags.hpp"
#include "bench/input/suite.hpp"
#include "bench/process/data.hpp"

namespace polhode::bench {
namespace {

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

}  // namespace

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

}  // namespace polhode::bench
