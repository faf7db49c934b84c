/// The verb import: a trajectory of another simulator against a problem's certified reference.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "bench/commands/commands.hpp"
#include "bench/input/cell_flags.hpp"
#include "bench/process/data.hpp"
#include "bench/process/patience.hpp"
#include "bench/score/import.hpp"

namespace polhode::bench {
namespace {

struct ImportFlags {
  CellFlags cell;
  std::string file, scalar = "last", map = "body-to-inertial", rate_unit = "rad/s";
  bool as_json = false;
};

/// True for the second of two words. Throws UsageError for a third.
bool is_second(std::string const& flag, std::string const& word, std::string const& first, std::string const& second) {
  if (word != first && word != second) throw UsageError(unknown(flag, word, {first, second}));
  return word == second;
}

/// The time until which a file is scored: what --t-end says, else its last row; close to the problem's own horizon,
/// that.
double scored_until(TrajectoryTable const& table, PreparedCell const& prepared, bool chosen) {
  constexpr double longest = 100, rounding = 1e-9;
  double const horizon = prepared.cell.t_end, last = table.times.back();
  if (chosen) return horizon;
  if (!(last > 0)) throw TrajectoryError(fmt::format("{}: all its times are 0 s", table.file));
  if (last > longest * horizon)
    throw TrajectoryError(
        fmt::format("{}:{}: t = {:g} s is more than {:g} times the horizon of {}, {:g} s: t is in "
                    "seconds; if it is, say how far to score with --t-end",
                    table.file, table.lines.back(), last, longest, prepared.cell.problem, horizon));
  return std::fabs(last - horizon) <= rounding * horizon ? horizon : last;
}

void import(ImportFlags const& flags) {
  Reading reading;
  reading.scalar_first = is_second("--scalar", flags.scalar, "last", "first");
  reading.inertial_to_body = is_second("--map", flags.map, "body-to-inertial", "inertial-to-body");
  reading.degrees = is_second("--rate-unit", flags.rate_unit, "rad/s", "deg/s");
  results::Cell cell = physics_alone(flags.cell.chosen());
  PreparedCell prepared = prepare(cell);
  TrajectoryTable const table = read_trajectory(flags.file, columns_to_import(prepared));
  cell.t_end = scored_until(table, prepared, flags.cell.has_t_end->count() > 0);
  if (cell.t_end != prepared.cell.t_end) prepared = prepare(cell);
  std::string const making =
      fmt::format("making the reference of {} until {:g} s in quadruple precision, or less with --t-end",
                  prepared.cell.problem, prepared.cell.t_end);
  auto const [reference, why_none] =
      patiently(making, [&] { return References(references_folder()).of(prepared, prepared.problem->horizon()); });
  Score score = bench::score(table, prepared, reference.get(), reading);
  for (std::string const& remark : {prepared.problem->warning(), why_none})
    if (!remark.empty()) score.remarks.push_back(remark);
  std::string const text = flags.as_json ? json_text(score) : score_text(score, flags.file, prepared.cell.problem);
  std::fwrite(text.data(), 1, text.size(), stdout);
  for (std::string const& remark : score.remarks) warn(remark);
}

}  // namespace

void add_import(CLI::App& app) {
  auto const flags = std::make_shared<ImportFlags>();
  CLI::App* verb = app.add_subcommand("import", "Score a trajectory that another program made, as CSV");
  verb->add_option("FILE", flags->file, "CSV with the columns of `polhode simulate`: t, q1 to q4, wx, wy, wz")
      ->required();
  flags->cell.add_physics(*verb, "--problem");
  verb->add_option("--scalar", flags->scalar, "The scalar of a quaternion is q4 or q1: last, first")
      ->capture_default_str();
  verb->add_option("--map", flags->map, "What q turns: body-to-inertial, inertial-to-body")->capture_default_str();
  verb->add_option("--rate-unit", flags->rate_unit, "Of wx, wy, wz: rad/s, deg/s")->capture_default_str();
  verb->add_flag("--json", flags->as_json, "As JSON");
  verb->callback([=] { import(*flags); });
}

}  // namespace polhode::bench
