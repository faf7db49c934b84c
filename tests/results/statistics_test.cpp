/// Rank tests against known answers: SciPy 1.10 (mannwhitneyu, wilcoxon), the examples of R's documentation, and, where
/// those refuse ties, every arrangement counted one by one.
#include "results/statistics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace polhode::results {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using Values = std::vector<double>;

Values sequence(int count, int step, int modulus, double shift = 0) {
  Values values;
  for (int i = 0; i < count; ++i) values.push_back(i * step % modulus + shift);
  return values;
}

TEST(MannWhitney, AgreesWithScipyOnSmallSamples) {
  RankTest const test = mann_whitney({1.03, 1.10, 0.98, 1.21, 1.07}, {1.15, 1.32, 1.24, 1.19, 1.40});
  EXPECT_EQ(test.statistic, 2);
  EXPECT_NEAR(test.p, 0.031746031746031744, 1e-15);
  EXPECT_TRUE(test.exact);
}

/// Hollander and Wolfe (1973), p. 69: the example of R's wilcox.test, which prints W = 35, p = 0.2544.
TEST(MannWhitney, AgreesWithRsExample) {
  RankTest const test =
      mann_whitney({0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46}, {1.15, 0.88, 0.90, 0.74, 1.21});
  EXPECT_EQ(test.statistic, 35);
  EXPECT_NEAR(test.p, 0.2544122544122544, 1e-15);
}

/// 39 of the 462 ways to deal the ranks are as far from the middle.
TEST(MannWhitney, TiesAreExactToo) {
  RankTest const test = mann_whitney({1, 2, 2, 3, 5}, {2, 4, 4, 5, 6, 7});
  EXPECT_EQ(test.statistic, 5.5);
  EXPECT_NEAR(test.p, 39.0 / 462, 1e-15);
}

TEST(MannWhitney, AgreesWithScipyAtTheLargestExactSize) {
  RankTest const test = mann_whitney(sequence(31, 37, 101), sequence(29, 53, 97, 24.5));
  EXPECT_TRUE(test.exact);
  EXPECT_EQ(test.statistic, 306);
  EXPECT_NEAR(test.p, 0.03370623235973372, 1e-12);
}

TEST(MannWhitney, AgreesWithScipyOnLargeSamplesWithTies) {
  RankTest const test = mann_whitney(sequence(40, 37, 101), sequence(36, 53, 97, 25));
  EXPECT_FALSE(test.exact);
  EXPECT_EQ(test.statistic, 477);
  EXPECT_NEAR(test.p, 0.011467079358446047, 1e-12);
}

TEST(MannWhitney, NothingDiffersFromItselfOrFromNothing) {
  EXPECT_EQ(mann_whitney({1, 2, 3}, {1, 2, 3}).p, 1);
  EXPECT_EQ(mann_whitney({1, 1}, {1, 1, 1}).p, 1);
  EXPECT_EQ(mann_whitney({}, {1, 2}).p, 1);
  EXPECT_EQ(mann_whitney(Values(40, 1), Values(40, 1)).p, 1) << "no variance at all";
}

/// Hollander and Wolfe (1973), p. 29: R prints V = 40, p = 0.03906.
TEST(SignedRank, AgreesWithRsExample) {
  Values const x{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  Values const y{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  Values differences;
  for (std::size_t i = 0; i < x.size(); ++i) differences.push_back(x[i] - y[i]);
  RankTest const test = signed_rank(differences);
  EXPECT_EQ(test.statistic, 40);
  EXPECT_NEAR(test.p, 0.0390625, 1e-15);
}

/// 182 of the 512 ways to give signs to 9 ranks.
TEST(SignedRank, TiesAreExactTooAndZerosAreDropped) {
  RankTest const test = signed_rank({1, -1, 2, 2, -3, 4, 0, 5, -5, 6});
  EXPECT_EQ(test.statistic, 31);
  EXPECT_NEAR(test.p, 0.35546875, 1e-15);
}

TEST(SignedRank, AgreesWithScipyOnLargeSamples) {
  RankTest const test = signed_rank(sequence(80, 37, 101, -30));
  EXPECT_FALSE(test.exact);
  EXPECT_EQ(test.statistic, 2581);
  EXPECT_NEAR(test.p, 9.977178123189782e-07, 1e-18);
}

TEST(SignedRank, OfNothingSaysNothing) {
  EXPECT_EQ(signed_rank({}).p, 1);
  EXPECT_EQ(signed_rank({0, 0}).p, 1);
  EXPECT_EQ(signed_rank({3}).p, 1);
}

/// R: p.adjust(c(0.01, 0.04, 0.03, 0.005, 0.5), "holm").
TEST(Holm, AgreesWithR) {
  EXPECT_THAT(holm({0.01, 0.04, 0.03, 0.005, 0.5}),
              ElementsAre(DoubleNear(0.04, 1e-15), DoubleNear(0.09, 1e-15), DoubleNear(0.09, 1e-15),
                          DoubleNear(0.025, 1e-15), DoubleNear(0.5, 1e-15)));
  EXPECT_TRUE(holm({}).empty());
  EXPECT_THAT(holm({0.7, 0.8}), ElementsAre(1, 1));
}

TEST(Effects, ShiftAndSuperiority) {
  EXPECT_EQ(shift_ratio({1, 2, 4}, {2, 4, 8}), 2) << "of 9 ratios, .5 1 1 2 2 2 4 4 8, the fifth";
  EXPECT_EQ(shift_ratio({}, {1}), 1);
  EXPECT_EQ(superiority({1, 2}, {3, 4}), 1);
  EXPECT_EQ(superiority({1, 2}, {2, 0}), (1 + 0.5) / 4);
  EXPECT_EQ(superiority({}, {1}), 0.5);
  EXPECT_EQ(median({3, 1, 2, 10}), 2.5);
}

TEST(Effects, TheSmallestPIsWhatTheTestGivesForSamplesApart) {
  EXPECT_NEAR(smallest_p(5, 5), 1.0 / 126, 1e-15);
  EXPECT_NEAR(smallest_p(5, 5), mann_whitney({1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}).p, 1e-15);
  EXPECT_NEAR(smallest_p(3, 7), mann_whitney({1, 2, 3}, {4, 5, 6, 7, 8, 9, 10}).p, 1e-15);
  EXPECT_EQ(smallest_p(0, 5), 1);
}

}  // namespace
}  // namespace polhode::results
