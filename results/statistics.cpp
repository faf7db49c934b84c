#include "results/statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/special_functions/binomial.hpp>
#include <cmath>
#include <numeric>

namespace polhode::results {
namespace {

/// Twice the mid-ranks, which are whole numbers, and the sum of t^3 - t over groups of t ties.
struct Ranks {
  std::vector<std::size_t> doubled;
  double ties = 0;
};

Ranks ranks_of(std::vector<double> const& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  Ranks ranks{std::vector<std::size_t>(values.size()), 0};
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first;
    while (last + 1 < order.size() && values[order[last + 1]] == values[order[first]]) ++last;
    for (std::size_t i = first; i <= last; ++i) ranks.doubled[order[i]] = first + last + 2;
    auto const t = static_cast<double>(last - first + 1);
    ranks.ties += t * t * t - t;
    first = last + 1;
  }
  return ranks;
}

/// Two-sided p-value of `sum` under weights of sums 0, 1, ...: what lies as far from the mean, or farther.
double tail(std::vector<double> const& weights, double sum, double mean) {
  double const far = std::abs(sum - mean);
  double all = 0, beyond = 0;
  for (std::size_t s = 0; s < weights.size(); ++s) {
    all += weights[s];
    if (std::abs(static_cast<double>(s) - mean) >= far - 1e-9) beyond += weights[s];
  }
  return std::min(1.0, beyond / all);
}

/// Two-sided p-value of a normal deviate.
double normal_tail(double deviation, double variance) {
  if (!(variance > 0)) return 1;
  boost::math::normal const standard;
  return std::min(1.0,
                  2 * boost::math::cdf(boost::math::complement(standard, std::abs(deviation) / std::sqrt(variance))));
}

/// In how many ways `chosen` of the ranks have each sum.
std::vector<double> sums_of_choices(std::vector<std::size_t> const& ranks, std::size_t chosen) {
  std::size_t const most = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<std::vector<double>> ways(chosen + 1, std::vector<double>(most + 1, 0));
  ways[0][0] = 1;
  for (std::size_t const rank : ranks) {
    for (std::size_t k = chosen; k > 0; --k) {
      for (std::size_t s = most; s >= rank; --s) ways[k][s] += ways[k - 1][s - rank];
    }
  }
  return ways[chosen];
}

/// In how many ways the positive ones of the ranks have each sum.
std::vector<double> sums_of_signs(std::vector<std::size_t> const& ranks) {
  std::size_t const most = std::accumulate(ranks.begin(), ranks.end(), std::size_t{0});
  std::vector<double> ways(most + 1, 0);
  ways[0] = 1;
  for (std::size_t const rank : ranks) {
    for (std::size_t s = most; s >= rank; --s) ways[s] += ways[s - rank];
  }
  return ways;
}

}  // namespace

RankTest mann_whitney(std::vector<double> const& a, std::vector<double> const& b) {
  RankTest test;
  if (a.empty() || b.empty()) return test;
  std::vector<double> all = a;
  all.insert(all.end(), b.begin(), b.end());
  Ranks const ranks = ranks_of(all);
  auto const na = static_cast<double>(a.size()), nb = static_cast<double>(b.size()), n = na + nb;
  std::size_t doubled = 0;
  for (std::size_t i = 0; i < a.size(); ++i) doubled += ranks.doubled[i];
  auto const sum = static_cast<double>(doubled);
  test.statistic = sum / 2 - na * (na + 1) / 2;
  test.exact = all.size() <= most_exact;
  if (test.exact) {
    test.p = tail(sums_of_choices(ranks.doubled, a.size()), sum, na * (n + 1));
  } else {
    double const variance = na * nb / 12 * (n + 1 - ranks.ties / (n * (n - 1)));
    test.p = normal_tail(test.statistic - na * nb / 2, variance);
  }
  return test;
}

RankTest signed_rank(std::vector<double> const& differences) {
  RankTest test;
  std::vector<double> values, sizes;
  for (double const d : differences) {
    if (d == 0) continue;
    values.push_back(d);
    sizes.push_back(std::abs(d));
  }
  if (values.empty()) return test;
  Ranks const ranks = ranks_of(sizes);
  std::size_t doubled = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] > 0) doubled += ranks.doubled[i];
  }
  auto const n = static_cast<double>(values.size()), sum = static_cast<double>(doubled);
  test.statistic = sum / 2;
  test.exact = values.size() <= most_exact;
  if (test.exact) {
    test.p = tail(sums_of_signs(ranks.doubled), sum, n * (n + 1) / 2);
  } else {
    double const variance = n * (n + 1) * (2 * n + 1) / 24 - ranks.ties / 48;
    test.p = normal_tail(test.statistic - n * (n + 1) / 4, variance);
  }
  return test;
}

std::vector<double> holm(std::vector<double> const& p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return p[i]; });
  std::vector<double> adjusted(p.size());
  double greatest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    greatest = std::max(greatest, std::min(1.0, static_cast<double>(p.size() - i) * p[order[i]]));
    adjusted[order[i]] = greatest;
  }
  return adjusted;
}

double shift_ratio(std::vector<double> const& a, std::vector<double> const& b) {
  std::vector<double> ratios;
  for (double const x : a) {
    for (double const y : b) ratios.push_back(y / x);
  }
  return ratios.empty() ? 1 : median(std::move(ratios));
}

double superiority(std::vector<double> const& a, std::vector<double> const& b) {
  if (a.empty() || b.empty()) return 0.5;
  double above = 0;
  for (double const x : a) {
    for (double const y : b) above += y > x ? 1 : y == x ? 0.5 : 0;
  }
  return above / static_cast<double>(a.size() * b.size());
}

double smallest_p(std::size_t a, std::size_t b) {
  if (a == 0 || b == 0) return 1;
  auto const n = static_cast<unsigned>(a + b), k = static_cast<unsigned>(a);
  return std::min(1.0, 2 / boost::math::binomial_coefficient<double>(n, k));
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  std::size_t const n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

}  // namespace polhode::results
