/// The verb simulate: one cell, its trajectory as CSV, and its picture.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <memory>

#include "bench/cell/cell.hpp"
#include "bench/commands/commands.hpp"
#include "bench/ensemble/job.hpp"
#include "bench/input/cell_flags.hpp"
#include "bench/process/provenance.hpp"

namespace polhode::bench {
namespace {

std::string csv_of(PreparedCell const& prepared, Trajectory const& trajectory, results::Series const& rows) {
  results::Cell const& cell = prepared.cell;
  std::string text = fmt::format(
      "# polhode {} {}\n# problem {} {}\n# {} on {}, policy {}, {}\n", version(), build_id(), cell.problem,
      cell.variant, cell.integrator, cell.formulation, cell.policy,
      cell.h ? fmt::format("h = {:.17g} s", *cell.h) : fmt::format("rtol = {:g}, atol = {:g}", *cell.rtol, *cell.atol));
  for (auto const& [name, values] : cell.set) text += fmt::format("# {} = {:.17g}\n", name, fmt::join(values, ","));
  text += fmt::format("# steps {}, rejected {}, evaluations {}\n# status {}{}\n", trajectory.outcome.work.steps,
                      trajectory.outcome.work.rejected, trajectory.outcome.evaluations,
                      results::name_of(trajectory.status), trajectory.reason.empty() ? "" : ": " + trajectory.reason);
  std::vector<std::string> units;
  for (std::size_t i = 0; i < rows.columns.size(); ++i)
    if (!rows.units[i].empty()) units.push_back(fmt::format("{} [{}]", rows.columns[i], rows.units[i]));
  text += fmt::format("# units: {}\n{}\n", fmt::join(units, ", "), fmt::join(rows.columns, ","));
  for (std::vector<double> const& row : rows.rows) text += fmt::format("{:.17g}\n", fmt::join(row, ","));
  return text;
}

/// Samples and output times may differ: only rows at multiples of `every` are wanted.
void keep_outputs(Trajectory& trajectory, std::vector<Stop> const& stops) {
  History kept;
  for (std::size_t i = 0, k = 0; i < trajectory.history.times.size(); ++i) {
    while (stops[k].time < trajectory.history.times[i]) ++k;
    if (!stops[k].output) continue;
    kept.times.push_back(trajectory.history.times[i]);
    kept.rows.push_back(std::move(trajectory.history.rows[i]));
  }
  trajectory.history.times = std::move(kept.times);
  trajectory.history.rows = std::move(kept.rows);
}

std::string title_of(results::Cell const& cell) {
  return fmt::format("{}{}{}: {} on {}, {}", cell.problem, cell.variant.empty() ? "" : " ", cell.variant,
                     cell.integrator, cell.formulation,
                     cell.h ? fmt::format("h = {:g} s", *cell.h) : fmt::format("rtol = {:g}", *cell.rtol));
}

/// One sample of an ensemble, by the flags of both.
struct SampleFlags {
  std::vector<std::string> disperse;
  std::string seed = "1", sample;
  CLI::Option* has_seed = nullptr;

  void add(CLI::App& verb) {
    verb.add_option("--sample", sample, "Replay this sample of the ensemble with the same --seed and --disperse")
        ->type_name("INT");
    has_seed = verb.add_option("--seed", seed, "Of the ensemble")->type_name("INT");
    verb.add_option("--disperse", disperse, "As of `polhode ensemble`; repeatable")
        ->type_name("NAME=LAW")
        ->allow_extra_args(false);
  }
  results::Cell in(results::Cell cell) const {
    if (sample.empty()) {
      if (!disperse.empty() || has_seed->count() > 0)
        throw UsageError("--seed and --disperse choose a sample of an ensemble: give --sample, too");
      return cell;
    }
    return sample_cell(std::move(cell), disperse,
                       whole_number("seed", seed, 0, std::numeric_limits<std::uint64_t>::max()),
                       std::int64_t(whole_number("sample", sample, 0, std::numeric_limits<std::int64_t>::max())));
  }
};

int run_simulation(results::Cell const& cell, double every, std::string const& out, std::string const& picture,
                   PlotTrajectory const& plot) {
  PreparedCell prepared = prepare(cell);
  if (!(every > 0)) {
    double const period = prepared.problem->sample_period();
    every = period > 0 ? period : prepared.cell.t_end / 100;
  }
  constexpr double most_rows = 1e7;
  if (prepared.cell.t_end / every > most_rows)
    throw UsageError(
        fmt::format("outputs every {:g} s until {:g} s are more than {:.0f} rows; give --every {:g} or more", every,
                    prepared.cell.t_end, most_rows, prepared.cell.t_end / most_rows));
  prepared = prepare(cell, every);
  if (!prepared.refusal.empty())
    throw UsageError(
        fmt::format("{} on {}: {}", prepared.cell.integrator, prepared.cell.formulation, prepared.refusal));
  warn(prepared.problem->warning());
  Trajectory trajectory = simulate(prepared);
  keep_outputs(trajectory, prepared.plan.stops);
  results::Series const rows = history_series("", trajectory.columns, trajectory.history);
  write_out(out, csv_of(prepared, trajectory, rows));
  bool const failed = trajectory.status != results::Status::ok;
  if (!picture.empty() && !(failed && rows.rows.size() < 2)) plot(rows, title_of(prepared.cell), picture);
  if (!failed) return exit_ok;
  std::fputs(fmt::format("polhode: {} on {}: {}\n", prepared.cell.integrator, prepared.cell.problem, trajectory.reason)
                 .c_str(),
             stderr);
  return exit_run_failed;
}

}  // namespace

void add_simulate(CLI::App& app, int& code, PlotTrajectory const& plot) {
  auto const flags = std::make_shared<CellFlags>();
  auto const every = std::make_shared<double>(0);
  auto const out = std::make_shared<std::string>();
  auto const picture = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("simulate", "Run one problem with one integrator; the trajectory as CSV");
  flags->add_physics(*verb);
  flags->add_method(*verb);
  auto const sample = std::make_shared<SampleFlags>();
  sample->add(*verb);
  CLI::Option* has_every =
      add_number(*verb, "--every", *every, "Output interval [s]; default the sample period, else t_end / 100");
  verb->add_option("--out", *out, "File instead of standard output")->type_name("FILE");
  verb->add_option("--plot", *picture, "Draw attitude, rates and the problem's own columns: FILE.svg or FILE.pdf")
      ->type_name("FILE");
  verb->callback([=, &code] {
    if (has_every->count() > 0) check_positive("every", *every);
    if (!picture->empty() && !picture->ends_with(".svg") && !picture->ends_with(".pdf"))
      throw UsageError(fmt::format("--plot {}: write FILE.svg or FILE.pdf", quote(*picture)));
    code = run_simulation(sample->in(flags->chosen()), *every, *out, *picture, plot);
  });
}

}  // namespace polhode::bench
