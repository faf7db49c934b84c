#pragma once
/// The explicit pairs of high order, each with its tableau: what typed tests go over.
#include <gtest/gtest.h>

#include "integrators/high_order.hpp"

namespace polhode::test {

template <class M, class T>
struct PairWithTableau {
  using Method = M;
  using Tableau = T;
};
using HighOrderPairs = testing::Types<PairWithTableau<Dop853, DormandPrince853>, PairWithTableau<Verner65, Verner6>,
                                      PairWithTableau<Verner76, Verner7>, PairWithTableau<Verner98, Verner9>>;

}  // namespace polhode::test
