#include "results/ensemble_statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace polhode::results {
namespace {

constexpr std::size_t first_samples = 10;  ///< kept of each ending

bool worse(SampleValue const& a, SampleValue const& b) {
  return a.value != b.value ? a.value > b.value : a.sample < b.sample;
}

void put(Bytes& bytes, SampleValue const& value) {
  bytes.put(value.value);
  bytes.put(value.sample);
}
SampleValue sample_value(Bytes& bytes) {
  double const value = bytes.number();
  return {value, bytes.whole()};
}

}  // namespace

// P(X_l <= quantile <= X_u) = P(l <= K <= u - 1) for the number K of samples below it, Binomial(n, p).
RankInterval quantile_ranks(std::int64_t n, double p, double confidence) {
  if (n <= 0) return {0, n + 1};
  double const tail = (1 - confidence) / 2;
  boost::math::binomial const below(double(n), p);
  // Greatest l with P(K < l) <= tail; least u with P(K >= u) <= tail. Guesses, and a few steps to the exact ranks.
  auto low = std::int64_t(std::floor(boost::math::quantile(below, tail)));
  auto const under = [&](std::int64_t l) { return l <= 0 ? 0.0 : boost::math::cdf(below, double(l - 1)); };
  while (low < n && under(low + 1) <= tail) ++low;
  while (low > 0 && under(low) > tail) --low;
  auto high = std::int64_t(std::ceil(boost::math::quantile(below, 1 - tail))) + 1;
  high = std::min(high, n + 1);
  auto const over = [&](std::int64_t u) {
    return u > n ? 0.0 : u <= 0 ? 1.0 : boost::math::cdf(boost::math::complement(below, double(u - 1)));
  };
  while (high > 1 && over(high - 1) <= tail) --high;
  while (high <= n && over(high) > tail) ++high;
  return {low, high};
}

void MetricStatistics::consider(SampleValue const& candidate) {
  if (keep_ == 0 || (worst_.size() == keep_ && !worse(candidate, worst_.back()))) return;
  worst_.insert(std::ranges::upper_bound(worst_, candidate, worse), candidate);
  if (worst_.size() > keep_) worst_.pop_back();
}

void MetricStatistics::add(std::int64_t sample, double value) {
  if (!std::isfinite(value)) {
    ++without_;
    return;
  }
  histogram_.add(value);
  double const off = value - mean_;
  mean_ += off / double(count());
  squares_ += off * (value - mean_);
  if (!least_ || value < least_->value) least_ = {value, sample};
  if (!greatest_ || value > greatest_->value) greatest_ = {value, sample};
  consider({value, sample});
}

// Mean and squares: Chan, Golub & LeVeque (1979).
MetricStatistics& MetricStatistics::operator+=(MetricStatistics const& later) {
  without_ += later.without_;
  if (later.count() == 0) return *this;
  double const mine = double(count()), theirs = double(later.count()), all = mine + theirs;
  double const apart = later.mean_ - mean_;
  squares_ += later.squares_ + apart * apart * (mine * theirs / all);
  mean_ += apart * (theirs / all);
  histogram_ += later.histogram_;
  if (!least_ || later.least_->value < least_->value) least_ = later.least_;
  if (!greatest_ || later.greatest_->value > greatest_->value) greatest_ = later.greatest_;
  for (SampleValue const& candidate : later.worst_) consider(candidate);
  return *this;
}

std::optional<double> MetricStatistics::mean() const {
  if (count() == 0) return {};
  return mean_;
}
std::optional<double> MetricStatistics::deviation() const {
  if (count() < 2) return {};
  return std::sqrt(squares_ / double(count() - 1));
}

Quantile MetricStatistics::quantile(double p) const {
  std::int64_t const n = count() + without_;
  Quantile q{.p = p, .value = {}, .low = {}, .high = {}};
  if (n == 0) return q;
  auto const inside = [&](double value) { return std::clamp(value, least_->value, greatest_->value); };
  auto const holds = [&](std::int64_t rank) { return 1 <= rank && rank <= count(); };
  auto const rank = std::clamp<std::int64_t>(std::int64_t(std::ceil(p * double(n))), 1, n);
  RankInterval const ranks = quantile_ranks(n, p);
  if (holds(rank)) {
    Histogram::Bin const bin = histogram_.bin_of_rank(rank);
    q.value = inside((bin.low + bin.high) / 2);
  }
  if (holds(ranks.low)) q.low = inside(histogram_.bin_of_rank(ranks.low).low);
  if (holds(ranks.high)) q.high = inside(histogram_.bin_of_rank(ranks.high).high);
  return q;
}

void MetricStatistics::put(Bytes& bytes) const {
  histogram_.put(bytes);
  bytes.put(without_);
  bytes.put(mean_);
  bytes.put(squares_);
  if (count() == 0) return;
  results::put(bytes, *least_);
  results::put(bytes, *greatest_);
  bytes.put(std::int64_t(worst_.size()));
  for (SampleValue const& value : worst_) results::put(bytes, value);
}
MetricStatistics MetricStatistics::from(Bytes& bytes, std::size_t worst) {
  MetricStatistics read(worst);
  read.histogram_ = Histogram::from(bytes);
  read.without_ = bytes.whole();
  read.mean_ = bytes.number();
  read.squares_ = bytes.number();
  if (read.count() == 0) return read;
  read.least_ = sample_value(bytes);
  read.greatest_ = sample_value(bytes);
  for (std::int64_t left = bytes.whole(); left > 0; --left) read.worst_.push_back(sample_value(bytes));
  return read;
}

EnsembleStatistics::EnsembleStatistics(std::vector<std::pair<std::string, std::string>> metrics, std::size_t worst)
    : names_(std::move(metrics)), worst_(worst), metrics_(names_.size(), MetricStatistics(worst)) {}

void EnsembleStatistics::add(std::int64_t sample, std::string const& ending, std::vector<double> const& values) {
  ++samples_;
  EndingStatistics& found = endings_[ending];
  ++found.count;
  if (found.first.size() < first_samples) found.first.push_back(sample);
  for (std::size_t i = 0; i < metrics_.size(); ++i) metrics_[i].add(sample, values.at(i));
}

EnsembleStatistics& EnsembleStatistics::operator+=(EnsembleStatistics const& later) {
  if (later.names_ != names_) throw std::invalid_argument("statistics of different metrics");
  samples_ += later.samples_;
  for (std::size_t i = 0; i < metrics_.size(); ++i) metrics_[i] += later.metrics_[i];
  for (auto const& [name, theirs] : later.endings_) {
    EndingStatistics& mine = endings_[name];
    mine.count += theirs.count;
    for (std::int64_t const sample : theirs.first)
      if (mine.first.size() < first_samples) mine.first.push_back(sample);
  }
  return *this;
}

std::string EnsembleStatistics::bytes() const {
  Bytes bytes;
  bytes.put(samples_);
  for (MetricStatistics const& metric : metrics_) metric.put(bytes);
  bytes.put(std::int64_t(endings_.size()));
  for (auto const& [name, ending] : endings_) {
    bytes.put(name);
    bytes.put(ending.count);
    bytes.put(std::int64_t(ending.first.size()));
    for (std::int64_t const sample : ending.first) bytes.put(sample);
  }
  return bytes.all();
}
void EnsembleStatistics::read(std::string const& text) {
  Bytes bytes(text);
  samples_ = bytes.whole();
  for (MetricStatistics& metric : metrics_) metric = MetricStatistics::from(bytes, worst_);
  endings_.clear();
  for (std::int64_t left = bytes.whole(); left > 0; --left) {
    EndingStatistics& ending = endings_[bytes.text()];
    ending.count = bytes.whole();
    for (std::int64_t some = bytes.whole(); some > 0; --some) ending.first.push_back(bytes.whole());
  }
  if (!bytes.at_end()) throw std::invalid_argument("bytes of statistics are too long");
}

nlohmann::ordered_json EnsembleStatistics::json() const {
  using Json = nlohmann::ordered_json;
  auto const optional = [](std::optional<double> const& value) { return value ? Json(*value) : Json(nullptr); };
  auto const of_sample = [](std::optional<SampleValue> const& value) {
    return value ? Json{{"value", value->value}, {"sample", value->sample}} : Json(nullptr);
  };
  Json all{{"samples", samples_}};
  all["endings"] = Json::object();
  for (auto const& [name, ending] : endings_)
    all["endings"][name] = {{"count", ending.count}, {"first_samples", ending.first}};
  all["metrics"] = Json::object();
  for (std::size_t i = 0; i < metrics_.size(); ++i) {
    MetricStatistics const& metric = metrics_[i];
    Json one{{"unit", names_[i].second},
             {"count", metric.count()},
             {"without", metric.without()},
             {"min", of_sample(metric.least())},
             {"max", of_sample(metric.greatest())},
             {"mean", optional(metric.mean())},
             {"deviation", optional(metric.deviation())}};
    one["quantiles"] = Json::array();
    for (double const p : shown_quantiles) {
      Quantile const q = metric.quantile(p);
      one["quantiles"].push_back(
          {{"p", q.p}, {"value", optional(q.value)}, {"low", optional(q.low)}, {"high", optional(q.high)}});
    }
    one["worst"] = Json::array();
    for (SampleValue const& value : metric.worst()) one["worst"].push_back(of_sample(value));
    one["histogram"] = Json::array();
    for (Histogram::Bin const& bin : metric.histogram().bins())
      one["histogram"].push_back(Json::array({bin.low, bin.high, bin.count}));
    all["metrics"][names_[i].first] = std::move(one);
  }
  return all;
}

}  // namespace polhode::results
