#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Ensemble;
using results::EnsembleMetric;

/// "23.9 [23.8, 24]".
Entry with_interval(results::Quantile const& q) {
  auto const end = [](std::optional<double> const& value) { return value ? significant(*value, 4) : absent; };
  Entry entry(fmt::format("{} [{}, {}]", end(q.value), end(q.low), end(q.high)), q.value ? exact(*q.value) : "");
  entry.interval = fmt::format("{}, {}", end(q.low), end(q.high));
  return entry;
}

Table quantile_table(Ensemble const& ensemble) {
  Table table{.name = "ensemble",
              .caption =
                  "Quantiles over all samples with their 95% intervals, from order statistics without an "
                  "assumption on the distribution, to 0.8%. Samples without a value lie above all others; mean and "
                  "extremes are of those that have one.",
              .columns = {{"metric"}, {"unit"}, {"mean", true}}};
  for (double const p : results::shown_quantiles) table.columns.push_back({fmt::format("{:g}%", 100 * p), true});
  for (char const* title : {"min", "max", "of sample", "without a value"}) table.columns.push_back({title, true});
  for (EnsembleMetric const& metric : ensemble.metrics) {
    std::vector<Entry> row{metric.name, metric.unit, number(metric.mean, 4)};
    for (results::Quantile const& q : metric.quantiles) row.push_back(with_interval(q));
    row.push_back(metric.least ? number(metric.least->value, 4) : Entry(absent));
    row.push_back(metric.greatest ? number(metric.greatest->value, 4) : Entry(absent));
    row.emplace_back(metric.greatest ? std::to_string(metric.greatest->sample) : absent);
    row.emplace_back(std::to_string(metric.without));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table worst_table(Ensemble const& ensemble) {
  Table table{.name = "ensemble-worst",
              .caption = Text({{"The samples with the greatest values, and the first of those that did not end well. "},
                               {ensemble.replay, true},
                               {" runs sample K again, to the last bit."}}),
              .columns = {{"what"}, {"samples"}}};
  for (EnsembleMetric const& metric : ensemble.metrics) {
    std::vector<std::string> samples;
    for (results::SampleValue const& worst : metric.worst)
      samples.push_back(fmt::format("{} ({})", worst.sample, significant(worst.value, 4)));
    if (!samples.empty()) table.rows.push_back({metric.name, fmt::format("{}", fmt::join(samples, ", "))});
  }
  for (auto const& [name, ending] : ensemble.endings)
    if (name != "ok") table.rows.push_back({one_line(name), fmt::format("{}", fmt::join(ending.first, ", "))});
  return table;
}

/// Shares of samples in equal bins, in the logarithm where values lie decades apart: the outline of a histogram. What
/// lies in a bin of the file is spread evenly over it.
Panel histogram_of(EnsembleMetric const& metric, std::int64_t samples) {
  constexpr int bins = 40;
  constexpr double decades = 1.5;
  double const least = metric.least->value, greatest = metric.greatest->value;
  bool const log = least > 0 && std::log10(greatest / least) > decades;
  auto const place = [&](double value) { return log ? std::log10(value) : value; };
  double const from = place(least), width = (place(greatest) - from) / bins;
  std::vector<double> share(bins, 0);
  for (results::Histogram::Bin const& bin : metric.histogram) {
    double const low = place(std::max(bin.low, least)), high = place(std::min(bin.high, greatest));
    double const part = double(bin.count) / double(samples);
    for (int i = 0; i < bins; ++i) {
      double const begin = from + i * width, end = begin + width;
      double const inside = high > low
                                ? std::clamp(std::min(high, end) - std::max(low, begin), 0.0, high - low) / (high - low)
                                : (begin <= low && (low < end || i == bins - 1) ? 1.0 : 0.0);
      share[std::size_t(i)] += part * inside;
    }
  }
  Curve outline{.label = "", .style = {.index = 3, .points = false}};
  auto const value = [&](double at) { return log ? std::pow(10, at) : at; };
  for (int i = 0; i < bins; ++i) {
    outline.points.push_back({value(from + i * width), share[std::size_t(i)]});
    outline.points.push_back({value(from + (i + 1) * width), share[std::size_t(i)]});
  }
  std::string const label = metric.unit.empty() ? metric.name : fmt::format("{} [{}]", metric.name, metric.unit);
  Panel panel{.x = {label, log}, .y = {"share of samples"}};
  panel.curves.push_back(std::move(outline));
  return panel;
}

void add_histograms(Document& document, Ensemble const& ensemble) {
  Figure figure{.name = "ensemble-histograms",
                .caption =
                    "Share of all samples in each of 40 equal bins from the least to the greatest value; on a "
                    "logarithmic axis in its logarithm.",
                .columns = 2};
  for (EnsembleMetric const& metric : ensemble.metrics)
    if (metric.least && metric.greatest && metric.least->value < metric.greatest->value)
      figure.panels.push_back(histogram_of(metric, ensemble.samples));
  if (!figure.panels.empty()) document.add(std::move(figure));
}

}  // namespace

void add_ensembles(Document& document, Facts const& facts) {
  if (!facts.contents.ensemble) return;
  Ensemble const& ensemble = *facts.contents.ensemble;
  document.section("Ensembles");
  std::vector<std::string> laws;
  for (std::string const& law : ensemble.disperse) laws.push_back(one_line(law));
  document.say(
      Text({{fmt::format("{} samples of {}{}{} by {} on {}, h = {:g} s, to {:g} s, each with numbers of its own: {}. "
                         "Settled means that the angle stays below {} deg to the end. The same again: ",
                         ensemble.samples, one_line(ensemble.problem), ensemble.variant.empty() ? "" : " ",
                         one_line(ensemble.variant), one_line(ensemble.integrator), one_line(ensemble.formulation),
                         ensemble.h, ensemble.t_end, laws.empty() ? "none differs" : listed(laws),
                         significant(degrees(ensemble.settle_angle)))},
            {one_line(ensemble.command), true},
            {"."}}));
  std::vector<std::string> endings;
  for (auto const& [name, ending] : ensemble.endings)
    endings.push_back(fmt::format("{} {}", ending.count, one_line(name)));
  std::string const share = ensemble.share_of_plain_rk4
                                ? fmt::format(
                                      ", by processor time {:.0f}% of what the plain RK4 step does there without "
                                      "control and without looking",
                                      100 * *ensemble.share_of_plain_rk4)
                                : "";
  document.say(fmt::format(
      "They ended: {}. It took {} s on {} of {}: {} body-steps per second{}, in {:.0f} MiB at most.", listed(endings),
      significant(ensemble.seconds), counted(std::size_t(ensemble.threads), "thread", "threads"),
      counted(std::size_t(ensemble.ranks), "process", "processes"), significant(ensemble.rate), share,
      double(ensemble.peak_memory) / (1 << 20)));
  document.add(quantile_table(ensemble));
  add_histograms(document, ensemble);
  document.add(worst_table(ensemble));
}

}  // namespace polhode::report
