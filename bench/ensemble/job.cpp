#include "bench/ensemble/job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/ensemble/ensemble.hpp"

namespace polhode::bench {
namespace {

/// Samples that are joined before anything else, and chunks of them that are dealt out as one item. Both are part of
/// what a result is: means are summed in this order.
constexpr std::int64_t samples_in_chunk = 512, chunks_in_item = 16, samples_in_item = samples_in_chunk * chunks_in_item;

std::int64_t parts_of(std::int64_t count, std::int64_t size) {
  return (count + size - 1) / size;
}

void check_control(results::Cell const& cell) {
  if (cell.rtol || cell.atol) throw UsageError("samples of an ensemble take equal steps: give --h, not --rtol");
  if (vocabulary().integrator(cell.integrator).rival)
    throw UsageError(fmt::format("{} is a library's: an ensemble runs our own integrators with fixed steps, e.g. rk4",
                                 cell.integrator));
}

}  // namespace

results::Cell sample_cell(results::Cell cell, std::vector<std::string> const& disperse, std::uint64_t seed,
                          std::int64_t sample) {
  Dispersions const dispersions(vocabulary().problem(cell.problem), cell.set, disperse, seed);
  cell.set = dispersions.with_sample(std::move(cell.set), sample);
  return cell;
}

std::string EnsemblePart::bytes() const {
  results::Bytes bytes;
  bytes.put(statistics.bytes());
  bytes.put(rows);
  return bytes.all();
}

EnsembleJob::EnsembleJob(EnsembleRequest const& request) : request_(request) {
  results::Cell const& asked = request_.cell;
  check_control(asked);
  dispersions_ = Dispersions(vocabulary().problem(asked.problem), asked.set, request_.disperse, request_.seed);
  prepared_ = std::make_unique<PreparedCell>(prepare(asked));
  double const h = *asked.h, t_end = prepared_->cell.t_end;
  steps_ = std::int64_t(std::llround(t_end / h));
  if (steps_ < 1 || std::fabs(double(steps_) * h - t_end) > 1e-9 * t_end)
    throw UsageError(
        fmt::format("t_end = {:g} s is no multiple of h = {:g} s: all samples end with a whole step; "
                    "--t-end {:g} would be right",
                    t_end, h, h * std::max(1.0, std::round(t_end / h))));
  double const sample_period = prepared_->problem->sample_period();
  if (sample_period > 0 && request_.every > 0)
    throw UsageError(fmt::format("{} is looked at whenever its controller is asked, every {:g} s: leave --every out",
                                 asked.problem, sample_period));
  constexpr double looks = 500;
  period_ = sample_period > 0    ? sample_period
            : request_.every > 0 ? request_.every
                                 : h * std::max(1.0, std::round(t_end / (looks * h)));
  prepared_ = std::make_unique<PreparedCell>(prepare(asked, sample_period > 0 ? 0 : period_));
  if (!prepared_->refusal.empty())
    throw UsageError(fmt::format("{} on {}: {}", asked.integrator, asked.formulation, prepared_->refusal));
  check_ends();
  choose_metrics();

  bool const plain_steps = prepared_->cell.policy == "none" && prepared_->schedule.jumps.empty();
  if (plain_steps)
    fleet_ = lane_fleet(asked.problem, {.choice = choice_of(prepared_->cell),
                                        .dispersions = &dispersions_,
                                        .formulation = asked.formulation,
                                        .integrator = asked.integrator,
                                        .run = {h, steps_, std::int64_t(std::llround(period_ / h))},
                                        .period = period_,
                                        .t_end = t_end,
                                        .sampled = sample_period > 0,
                                        .threshold = request_.settle_angle});
}

void EnsembleJob::check_ends() const {
  for (Dispersion const& each : dispersions_.list())
    for (bool const upper : {false, true}) {
      Choice choice = choice_of(prepared_->cell);
      choice.set = dispersions_.with_end(choice.set, each, upper);
      try {
        problem_named(request_.cell.problem).choose(choice);
      } catch (ParameterError const& error) {
        throw UsageError(fmt::format("--disperse {}: its numbers break a rule: {}", quote(each.text), error.what()));
      }
    }
}

void EnsembleJob::choose_metrics() {
  ChosenProblem const& problem = *prepared_->problem;
  auto const take = [&](auto... metrics) { (metrics_.push_back(metrics), ...); };
  if (!problem.info().pointing.empty()) take(Metric::settle_time, Metric::peak_angle, Metric::final_angle);
  if (has_torque(problem, prepared_->cell.formulation))
    take(Metric::peak_torque, Metric::control_effort, Metric::control_work);
  bool const one_body = std::visit([]<Space M>(std::unique_ptr<Erased<M>> const&) { return !PowerSpace<M>; },
                                   problem.in(prepared_->cell.formulation));
  if (one_body) take(Metric::final_rate);
  take(Metric::norm_drift);
}

EnsemblePart EnsembleJob::nothing() const {
  std::vector<std::pair<std::string, std::string>> names;
  for (Metric const metric : metrics_) names.push_back(metric_names()[std::size_t(metric)]);
  return {results::EnsembleStatistics(std::move(names), request_.worst), ""};
}
EnsemblePart EnsembleJob::part(std::string const& text) const {
  results::Bytes bytes(text);
  EnsemblePart read = nothing();
  read.statistics.read(bytes.text());
  read.rows = bytes.text();
  return read;
}

std::int64_t EnsembleJob::items() const {
  return parts_of(request_.samples, samples_in_item);
}

std::int64_t EnsembleJob::samples_in(std::int64_t item) const {
  return std::min(samples_in_item, request_.samples - item * samples_in_item);
}

std::string EnsembleJob::work(std::int64_t item, int threads, std::atomic<bool> const& stop) const {
  std::int64_t const first = item * samples_in_item, last = first + samples_in(item);
  std::int64_t const chunks = parts_of(last - first, samples_in_chunk);
  std::vector<EnsemblePart> parts(std::size_t(chunks), nothing());
  on_threads(threads, chunks, [&](std::int64_t k) {
    std::int64_t const begin = first + k * samples_in_chunk;
    parts[std::size_t(k)] = chunk({begin, std::min(begin + samples_in_chunk, last)}, stop);
  });
  EnsemblePart all = nothing();
  for (EnsemblePart const& part : parts) {
    all.statistics += part.statistics;
    all.rows += part.rows;
  }
  return all.bytes();
}

EnsemblePart EnsembleJob::chunk(Bodies const& bodies, std::atomic<bool> const& stop) const {
  EnsemblePart part = nothing();
  std::vector<SampleResult> results(std::size_t(bodies.last - bodies.first));
  if (fleet_) {
    if (!stop) fleet_->run(bodies, results);
  } else {
    Choice choice = choice_of(prepared_->cell);
    for (std::int64_t k = bodies.first; k < bodies.last && !stop; ++k) {
      choice.set = dispersions_.with_sample(prepared_->cell.set, k);
      results[std::size_t(k - bodies.first)] = run_alone(*prepared_, choice, request_.settle_angle);
    }
  }
  for (std::size_t i = 0; i < results.size(); ++i) add(part, bodies.first + std::int64_t(i), results[i]);
  return part;
}

std::string EnsembleJob::ending_of(SampleResult const& result) const {
  if (result.refused) return "invalid";
  if (result.status != Status::ok) return std::string(name_of(status_of(result.status)));
  bool const points = std::ranges::find(metrics_, Metric::settle_time) != metrics_.end();
  bool const settled = result.metrics[std::size_t(Metric::settle_time)] != SampleMetrics<double>::never;
  return points && !settled ? "never_settled" : "ok";
}

void EnsembleJob::add(EnsemblePart& part, std::int64_t sample, SampleResult const& result) const {
  bool const lost = result.refused || result.status != Status::ok;
  std::vector<double> values;
  for (Metric const metric : metrics_)
    values.push_back(lost ? std::numeric_limits<double>::infinity() : result.metrics[std::size_t(metric)]);
  std::string const ending = ending_of(result);
  part.statistics.add(sample, ending, values);
  if (!request_.raw) return;
  part.rows += fmt::format("{},{}", sample, ending);
  for (double const value : values) part.rows += std::isfinite(value) ? fmt::format(",{:.17g}", value) : ",";
  std::vector<std::vector<double>> drawn;
  dispersions_.draw(sample, drawn);
  for (auto const& numbers : drawn) part.rows += fmt::format(",{:.17g}", fmt::join(numbers, ","));
  for (double const value : result.end) part.rows += lost ? "," : fmt::format(",{:.17g}", value);
  part.rows += '\n';
}

std::string EnsembleJob::columns() const {
  std::string text = "sample,ending";
  for (Metric const metric : metrics_) text += "," + metric_names()[std::size_t(metric)].first;
  for (std::size_t i = 0; i < dispersions_.parameters().size(); ++i) {
    std::size_t const numbers = dispersions_.undispersed()[i].size();
    for (std::size_t j = 0; j < numbers; ++j)
      text += "," + dispersions_.parameters()[i] + (numbers > 1 ? fmt::format(".{}", j + 1) : "");
  }
  return text + ",q1,q2,q3,q4,wx,wy,wz\n";
}

}  // namespace polhode::bench
