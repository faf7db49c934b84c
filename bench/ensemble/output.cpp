#include "bench/ensemble/output.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/process/provenance.hpp"

namespace polhode::bench {
namespace {

using Json = nlohmann::ordered_json;

/// What ensemble and simulate have in common.
std::string physics_flags(EnsembleJob const& job) {
  results::Cell const& cell = job.prepared().cell;
  std::string flags = cell.problem;
  if (!cell.variant.empty()) flags += " --variant " + cell.variant;
  flags += fmt::format(" --formulation {} --integrator {}", cell.formulation, cell.integrator);
  if (cell.policy != "none") flags += " --policy " + cell.policy;
  flags += fmt::format(" --h {} --t-end {}", *cell.h, cell.t_end);
  for (auto const& [name, values] : cell.set) flags += fmt::format(" --set {}={}", name, fmt::join(values, ","));
  for (Dispersion const& each : job.dispersions().list()) flags += fmt::format(" --disperse '{}'", each.text);
  return flags + fmt::format(" --seed {}", job.request().seed);
}

std::string number(double value) {
  return fmt::format("{:.4g}", value);
}
/// "12.3 [12.1, 12.6]"; what lies beyond all samples that have a value is a dash.
std::string with_interval(results::Quantile const& q) {
  auto const end = [](std::optional<double> const& value) { return value ? number(*value) : std::string("-"); };
  return fmt::format("{} [{}, {}]", end(q.value), end(q.low), end(q.high));
}

std::string metric_table(results::EnsembleStatistics const& statistics, results::Outlet const& outlet) {
  std::vector<results::TextColumn> columns{{"metric", false, true}, {"unit", false, true}, {"mean", true}};
  for (double const p : results::shown_quantiles) columns.push_back({fmt::format("{:g}%", 100 * p), true});
  columns.push_back({"max", true});
  columns.push_back({"of sample", true});
  std::vector<std::vector<results::TextCell>> rows;
  for (std::size_t i = 0; i < statistics.names().size(); ++i) {
    results::MetricStatistics const& metric = statistics.metric(i);
    auto const& [name, unit] = statistics.names()[i];
    std::vector<results::TextCell> row{name, unit, metric.mean() ? number(*metric.mean()) : "-"};
    for (double const p : results::shown_quantiles) row.emplace_back(with_interval(metric.quantile(p)));
    row.emplace_back(metric.greatest() ? number(metric.greatest()->value) : "-");
    row.emplace_back(metric.greatest() ? std::to_string(metric.greatest()->sample) : "-");
    rows.push_back(std::move(row));
  }
  return text_table(columns, rows, outlet);
}

std::string endings_text(results::EnsembleStatistics const& statistics) {
  std::string text;
  for (auto const& [name, ending] : statistics.endings()) {
    text += fmt::format("{}: {}", name, ending.count);
    if (name != "ok") text += fmt::format(", first {}", fmt::join(ending.first, " "));
    text += '\n';
  }
  return text;
}

/// The sample that one would look at first: of those that did not settle the first, else the slowest; else the last
/// metric's worst.
std::optional<std::int64_t> first_to_look_at(results::EnsembleStatistics const& statistics) {
  for (auto const& [name, ending] : statistics.endings())
    if (name != "ok" && name != "invalid" && !ending.first.empty()) return ending.first.front();
  for (std::size_t i = 0; i < statistics.names().size(); ++i)
    if (auto const most = statistics.metric(i).greatest()) return most->sample;
  return {};
}

}  // namespace

double EnsembleTiming::rate(EnsembleJob const& job) const {
  return double(job.request().samples) * double(job.steps()) / seconds;
}
std::optional<double> EnsembleTiming::cpu_rate(EnsembleJob const& job) const {
  if (samples_here == 0 || !(cpu_seconds > 0)) return {};
  return double(samples_here) * double(job.steps()) / cpu_seconds;
}
std::optional<double> EnsembleTiming::share_of_kernel(EnsembleJob const& job) const {
  std::optional<double> const rate = cpu_rate(job);
  if (!rate) return {};
  return *rate / kernel_rate;
}

std::string ensemble_command(EnsembleJob const& job) {
  EnsembleRequest const& request = job.request();
  std::string command = fmt::format("polhode ensemble {} --samples {} --settle {}", physics_flags(job), request.samples,
                                    request.settle_angle);
  if (request.every > 0) command += fmt::format(" --every {}", request.every);
  return command;
}
std::string replay_command(EnsembleJob const& job, std::int64_t sample) {
  return fmt::format("polhode simulate {} --sample {}", physics_flags(job), sample);
}

Json ensemble_json(EnsembleJob const& job, results::EnsembleStatistics const& statistics,
                   EnsembleTiming const& timing) {
  results::Cell const& cell = job.prepared().cell;
  Json disperse = Json::array();
  for (Dispersion const& each : job.dispersions().list()) disperse.push_back(each.text);
  auto const optional = [](std::optional<double> const& value) { return value ? Json(*value) : Json(nullptr); };
  std::string replay = replay_command(job, 0);
  replay.back() = 'K';
  return {{"schema", results::schema},
          {"kind", "ensemble"},
          {"command", ensemble_command(job)},
          {"replay", replay},
          {"problem", cell.problem},
          {"variant", cell.variant},
          {"formulation", cell.formulation},
          {"integrator", cell.integrator},
          {"policy", cell.policy},
          {"h", *cell.h},
          {"t_end", cell.t_end},
          {"set", cell.set},
          {"disperse", disperse},
          {"seed", job.request().seed},
          {"generator", "philox4x32-10"},
          {"settle_angle", job.request().settle_angle},
          {"look_period", job.look_period()},
          {"steps", job.steps()},
          {"in_lanes", job.in_lanes()},
          {"confidence", 0.95},
          {"statistics", statistics.json()},
          {"timing",
           {{"seconds", timing.seconds},
            {"threads", timing.threads},
            {"ranks", timing.ranks},
            {"body_steps_per_second", timing.rate(job)},
            {"body_steps_per_cpu_second", optional(timing.cpu_rate(job))},
            {"plain_rk4_body_steps_per_cpu_second", timing.kernel_rate},
            {"share_of_plain_rk4", optional(timing.share_of_kernel(job))},
            {"peak_memory_bytes", timing.peak_memory}}},
          {"provenance", results::to_json(provenance())}};
}

std::string ensemble_text(EnsembleJob const& job, results::EnsembleStatistics const& statistics,
                          EnsembleTiming const& timing, results::Outlet const& outlet) {
  results::Cell const& cell = job.prepared().cell;
  std::string text =
      fmt::format("{} samples of {}{}{}: {} on {}, h = {:g} s, to {:g} s, {}\n", statistics.samples(), cell.problem,
                  cell.variant.empty() ? "" : " ", cell.variant, cell.integrator, cell.formulation, *cell.h, cell.t_end,
                  job.in_lanes() ? "in lanes over bodies" : "one body after the other");
  text += metric_table(statistics, outlet);
  text += "quantiles with their 95% intervals; samples without a value lie above all others\n";
  text += endings_text(statistics);
  text += fmt::format("{:.2f} s on {} thread{}{}: {:.3g} body-steps/s", timing.seconds, timing.threads,
                      timing.threads == 1 ? "" : "s",
                      timing.ranks == 1 ? "" : fmt::format(" of each of {} ranks", timing.ranks), timing.rate(job));
  if (auto const share = timing.share_of_kernel(job))
    text += fmt::format("; {:.3g} per second of processor time, {:.0f}% of the plain RK4 kernel's {:.3g}",
                        *timing.cpu_rate(job), 100 * *share, timing.kernel_rate);
  text += fmt::format("; {:.0f} MiB\n", double(timing.peak_memory) / (1 << 20));
  if (auto const sample = first_to_look_at(statistics)) text += "replay: " + replay_command(job, *sample) + "\n";
  return text;
}

}  // namespace polhode::bench
