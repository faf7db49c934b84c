#pragma once
/// Tests on ranks: do two sets of times differ, and by how much? Times of a benchmark are skewed and have outliers, so
/// nothing here assumes a distribution. Small samples get exact p-values, ties included; large ones the normal limit.
#include <cstddef>
#include <vector>

namespace polhode::results {

/// What a rank test says.
struct RankTest {
  double statistic = 0;  ///< U of the first sample, or W+ of the positive differences
  double p = 1;          ///< two-sided: the chance of ranks at least as far from their mean, if nothing differs
  bool exact = true;     ///< over all arrangements of the ranks; otherwise from the normal distribution
};

/// Samples up to this many values in all get exact p-values.
inline constexpr std::size_t most_exact = 60;

/// Mann and Whitney (1947): do values of `a` tend to be above those of `b`? Ties share the mean of their ranks; the
/// exact p-value is over all ways to deal the observed ranks. For more than `most_exact` values the variance is
/// corrected for ties, without a correction for continuity. An empty sample differs from nothing: p = 1.
RankTest mann_whitney(std::vector<double> const& a, std::vector<double> const& b);

/// Wilcoxon's signed-rank test (1945): do differences tend to one side of 0? Zeros are dropped; ties as above, over all
/// signs of the observed ranks.
RankTest signed_rank(std::vector<double> const& differences);

/// Holm (1979): p-values such that rejecting those below alpha errs anywhere with probability alpha at most. In the
/// order of the input.
std::vector<double> holm(std::vector<double> const& p);

/// Hodges and Lehmann (1963): the factor between two samples of positive values, the median of b_j / a_i; 1 if one is
/// empty.
double shift_ratio(std::vector<double> const& a, std::vector<double> const& b);

/// Vargha and Delaney (2000): the chance that a value of b is above one of a, ties counted half: 0.5 = no effect.
double superiority(std::vector<double> const& a, std::vector<double> const& b);

/// The smallest p-value that Mann and Whitney's test can give for samples of these sizes without ties: with 5 and 5
/// values it is 1/126, however far they are apart.
double smallest_p(std::size_t a, std::size_t b);

/// The median; 0 of nothing.
double median(std::vector<double> values);

}  // namespace polhode::results
