/// Streaming statistics against sorted data, however the data are cut into parts.
#include "results/ensemble_statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

namespace polhode::results {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Of many sizes and both signs.
double value_of(std::int64_t k) {
  double const unit = double((k * 7919 + 13) % 10007) / 10007;
  return (k % 5 == 0 ? -1 : 1) * std::exp(12 * unit - 6);
}

TEST(Histogram, BinsHoldTheirValuesAndAreNarrow) {
  for (double const value : {1e-299, 0.3, 1.0, 1.9999, 2.0, 77.7, 1e300, std::numeric_limits<double>::max() / 2, -0.3,
                             -1.0, -2.0, -1e-299}) {
    Histogram histogram;
    histogram.add(value);
    ASSERT_EQ(histogram.bins().size(), 1u);
    Histogram::Bin const bin = histogram.bins()[0];
    EXPECT_LE(bin.low, value);
    EXPECT_GE(bin.high, value);
    EXPECT_LE((bin.high - bin.low) / std::abs(value), 0.01) << value;
  }
  Histogram zeros;
  zeros.add(0);
  zeros.add(-0.0);
  zeros.add(1e-310);
  EXPECT_EQ(zeros.bins().size(), 1u);
  EXPECT_EQ(zeros.bins()[0].high, 0);
}
TEST(Histogram, RanksAreThoseOfSortedData) {
  Histogram histogram;
  std::vector<double> sorted;
  for (std::int64_t k = 0; k < 3000; ++k) {
    histogram.add(value_of(k));
    sorted.push_back(value_of(k));
  }
  std::ranges::sort(sorted);
  for (std::int64_t rank = 1; rank <= 3000; rank += 7) {
    Histogram::Bin const bin = histogram.bin_of_rank(rank);
    double const value = sorted[std::size_t(rank - 1)];
    EXPECT_LE(bin.low, value);
    EXPECT_GE(bin.high, value);
  }
  EXPECT_THROW(histogram.bin_of_rank(3001), std::out_of_range);
}
TEST(Histogram, AnyGroupingGivesTheSame) {
  Histogram whole, odd, even;
  for (std::int64_t k = 0; k < 1000; ++k) {
    whole.add(value_of(k));
    (k % 2 == 0 ? even : odd).add(value_of(k));
  }
  odd += even;
  EXPECT_EQ(odd, whole);
  Bytes bytes;
  whole.put(bytes);
  Bytes back(bytes.all());
  EXPECT_EQ(Histogram::from(back), whole);
  EXPECT_TRUE(back.at_end());
}

/// By summing the distribution's terms.
TEST(QuantileRanks, CoverTheQuantileAndNoMoreThanNeeded) {
  for (std::int64_t const n : {1, 7, 40, 1000}) {
    for (double const p : {0.5, 0.9, 0.99}) {
      std::vector<double> below(std::size_t(n) + 2, 0);  // P(K < l)
      for (std::int64_t k = 0; k <= n; ++k) {
        double const log_term = std::lgamma(double(n + 1)) - std::lgamma(double(k + 1)) -
                                std::lgamma(double(n - k + 1)) + double(k) * std::log(p) +
                                double(n - k) * std::log1p(-p);
        below[std::size_t(k + 1)] = below[std::size_t(k)] + std::exp(log_term);
      }
      RankInterval const ranks = quantile_ranks(n, p);
      ASSERT_GE(ranks.low, 0);
      ASSERT_LE(ranks.high, n + 1);
      EXPECT_LE(below[std::size_t(ranks.low)], 0.025 + 1e-9);
      EXPECT_GT(below[std::size_t(ranks.low + 1)], 0.025 - 1e-9);
      EXPECT_LE(1 - below[std::size_t(ranks.high)], 0.025 + 1e-9);
      EXPECT_GT(1 - below[std::size_t(ranks.high - 1)], 0.025 - 1e-9);
    }
  }
  RankInterval const few = quantile_ranks(10, 0.999);
  EXPECT_EQ(few.high, 11) << "10 samples do not bound the quantile .999";
}

EnsembleStatistics statistics() {
  return EnsembleStatistics({{"size", "m"}, {"other", ""}}, 4);
}
void add(EnsembleStatistics& to, std::int64_t k) {
  bool const lost = k % 100 == 3;
  to.add(k, lost ? "diverged" : "ok", {lost ? infinity : value_of(k), double(k % 11)});
}

TEST(EnsembleStatistics, AreThoseOfTheSortedData) {
  EnsembleStatistics all = statistics();
  std::vector<double> sorted;
  for (std::int64_t k = 0; k < 5000; ++k) {
    add(all, k);
    sorted.push_back(k % 100 == 3 ? infinity : value_of(k));
  }
  std::vector<double> finite;
  for (double const value : sorted)
    if (std::isfinite(value)) finite.push_back(value);
  std::ranges::sort(sorted);
  MetricStatistics const& size = all.metric(0);
  EXPECT_EQ(all.samples(), 5000);
  EXPECT_EQ(all.endings().at("diverged").count, 50);
  EXPECT_EQ(all.endings().at("diverged").first.front(), 3);
  EXPECT_EQ(size.without(), 50);
  double const mean = std::accumulate(finite.begin(), finite.end(), 0.0) / double(finite.size());
  double squares = 0;
  for (double const value : finite) squares += (value - mean) * (value - mean);
  EXPECT_NEAR(*size.mean(), mean, 1e-10 * std::abs(mean));
  EXPECT_NEAR(*size.deviation(), std::sqrt(squares / double(finite.size() - 1)), 1e-9);
  EXPECT_EQ(size.least()->value, *std::ranges::min_element(finite));
  EXPECT_EQ(size.least()->value, value_of(size.least()->sample));
  EXPECT_EQ(size.greatest()->value, *std::ranges::max_element(finite));
  for (double const p : {0.5, 0.9}) {
    double const value = sorted[std::size_t(std::ceil(p * 5000)) - 1];
    Quantile const q = size.quantile(p);
    EXPECT_NEAR(*q.value, value, 0.005 * std::abs(value));
    EXPECT_LE(*q.low, value);
    EXPECT_GE(*q.high, value);
  }
  // 1% have no value: beyond the quantile .99, inside its interval's upper end.
  EXPECT_TRUE(size.quantile(0.98).value.has_value());
  EXPECT_FALSE(size.quantile(0.99).high.has_value());
  EXPECT_FALSE(size.quantile(0.999).value.has_value());
}
TEST(EnsembleStatistics, TheWorstComeFirstAndTiesByNumber) {
  EnsembleStatistics all = statistics();
  for (std::int64_t k = 0; k < 200; ++k) add(all, k);
  std::vector<SampleValue> const expected{{10, 10}, {10, 21}, {10, 32}, {10, 43}};
  EXPECT_EQ(all.metric(1).worst(), expected);
}
TEST(EnsembleStatistics, PartsJoinInOrderWhoeverMadeThem) {
  constexpr static std::int64_t in_part = 64, count = 1000;
  auto const part = [](std::int64_t i) {
    EnsembleStatistics made = statistics();
    for (std::int64_t k = i * in_part; k < std::min((i + 1) * in_part, count); ++k) add(made, k);
    return made;
  };
  EnsembleStatistics direct = statistics(), by_bytes = statistics();
  for (std::int64_t i = 0; i * in_part < count; ++i) {
    direct += part(i);
    EnsembleStatistics received = statistics();
    received.read(part(i).bytes());
    by_bytes += received;
  }
  EXPECT_EQ(direct.json().dump(), by_bytes.json().dump());
  EXPECT_EQ(direct.samples(), count);
  EnsembleStatistics torn = statistics();
  std::string const bytes = direct.bytes();
  EXPECT_THROW(torn.read(bytes.substr(0, bytes.size() - 1)), std::invalid_argument);
  EXPECT_THROW(torn.read(bytes + "x"), std::invalid_argument);
}
TEST(EnsembleStatistics, TheirSizeDoesNotGrowWithTheSamples) {
  EnsembleStatistics all = statistics();
  std::size_t before = 0;
  for (std::int64_t k = 0; k < 300'000; ++k) {
    add(all, k);
    if (k == 150'000) before = all.bytes().size();  // every value has come by then
  }
  EXPECT_EQ(all.bytes().size(), before);
}
TEST(EnsembleStatistics, NothingIsKnownOfNothing) {
  EnsembleStatistics const none = statistics();
  EXPECT_FALSE(none.metric(0).mean());
  EXPECT_FALSE(none.metric(0).quantile(0.5).value);
  EXPECT_EQ(none.json()["samples"], 0);
}

}  // namespace
}  // namespace polhode::results
