#pragma once
/// What is known of an ensemble after its samples have gone by: for each metric a histogram, quantiles with confidence
/// intervals, exact extremes, mean and deviation, and the worst samples; and how the samples ended. Nothing grows with
/// the number of samples.
///
/// Samples come in parts: within a part in order of sample; parts join in order. Counts and extremes are the same for
/// any parts; mean and deviation for the same parts, which the ensemble fixes beforehand. So neither threads nor ranks
/// change a bit.
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "results/histogram.hpp"

namespace polhode::results {

/// A value and the sample that it belongs to.
struct SampleValue {
  double value = 0;
  std::int64_t sample = 0;
  bool operator==(SampleValue const&) const = default;
};

/// A quantile in a confidence interval. Absent ends are infinite: samples without a value (never settled, diverged)
/// lie above all others, and few samples do not bound a far quantile.
struct Quantile {
  double p = 0;
  std::optional<double> value, low, high;
};

/// Ranks l <= u such that the quantile p of a distribution lies between the order statistics l and u of n independent
/// samples with at least the given confidence; 0 and n + 1 stand for no bound. From the binomial distribution, without
/// an assumption on the samples'.   Source: Conover (1999), Practical Nonparametric Statistics, sec. 3.2
struct RankInterval {
  std::int64_t low = 0, high = 0;
};
RankInterval quantile_ranks(std::int64_t n, double p, double confidence = 0.95);

/// One metric of an ensemble.
class MetricStatistics {
 public:
  /// `worst` values are kept, the greatest first, ties by sample.
  explicit MetricStatistics(std::size_t worst = 5) : keep_(worst) {}

  /// Infinity or NaN: the sample has no value, and counts as greater than all that have.
  void add(std::int64_t sample, double value);
  /// Later samples.
  MetricStatistics& operator+=(MetricStatistics const& later);

  std::int64_t count() const { return histogram_.count(); }  ///< of samples with a value
  std::int64_t without() const { return without_; }          ///< of those that have none
  std::optional<SampleValue> least() const { return least_; }
  std::optional<SampleValue> greatest() const { return greatest_; }
  std::optional<double> mean() const;       ///< of those with a value
  std::optional<double> deviation() const;  ///< standard deviation of the distribution, unbiased variance
  /// To the width of a bin (0.8%); an interval's ends are the outer edges of their bins.
  Quantile quantile(double p) const;
  std::vector<SampleValue> const& worst() const { return worst_; }
  Histogram const& histogram() const { return histogram_; }

  void put(Bytes& bytes) const;
  static MetricStatistics from(Bytes& bytes, std::size_t worst);

 private:
  void consider(SampleValue const& candidate);

  std::size_t keep_;
  Histogram histogram_;
  std::int64_t without_ = 0;
  std::optional<SampleValue> least_, greatest_;
  double mean_ = 0, squares_ = 0;  ///< sum of squared deviations from the mean
  std::vector<SampleValue> worst_;
};

/// Samples that ended in one way: how many, and the first of them.
struct EndingStatistics {
  std::int64_t count = 0;
  std::vector<std::int64_t> first;
};

/// All metrics of an ensemble, and how its samples ended.
class EnsembleStatistics {
 public:
  EnsembleStatistics() = default;
  /// Metrics by name and unit, in the order in which they are shown.
  EnsembleStatistics(std::vector<std::pair<std::string, std::string>> metrics, std::size_t worst);

  /// values[i] is that of the i-th metric; `ending` says how the sample ended ("ok", "diverged", "never_settled").
  void add(std::int64_t sample, std::string const& ending, std::vector<double> const& values);
  EnsembleStatistics& operator+=(EnsembleStatistics const& later);

  std::int64_t samples() const { return samples_; }
  std::vector<std::pair<std::string, std::string>> const& names() const { return names_; }
  MetricStatistics const& metric(std::size_t i) const { return metrics_[i]; }
  std::map<std::string, EndingStatistics> const& endings() const { return endings_; }

  std::string bytes() const;
  /// Of statistics with these metrics. Throws std::invalid_argument.
  void read(std::string const& bytes);
  /// Equal statistics give equal text.
  nlohmann::ordered_json json() const;

 private:
  std::vector<std::pair<std::string, std::string>> names_;
  std::size_t worst_ = 0;
  std::vector<MetricStatistics> metrics_;
  std::map<std::string, EndingStatistics> endings_;
  std::int64_t samples_ = 0;
};

/// The quantiles that are shown.
inline constexpr double shown_quantiles[] = {0.5, 0.9, 0.99, 0.999};

}  // namespace polhode::results
