#pragma once
/// Histograms that add up: whole numbers of values in bins that are the same for everybody, so that any order and any
/// grouping of the data gives the same counts, and the memory does not depend on how many there are.
#include <cstdint>
#include <vector>

#include "results/bytes.hpp"

namespace polhode::results {

/// Log-linear bins: each power of two in 128 equal parts, so a bin is at most 1/128 = 0.8% wide; zeros have a bin of
/// their own, negative values mirror the positive ones. Values up to the greatest double; below 1e-300 they are 0.
/// Source: Tene, HdrHistogram; bins are the leading bits of the number itself.
class Histogram {
 public:
  struct Bin {
    double low, high;  ///< low < high, except for zeros: both 0. The end nearer to 0 belongs to the bin
    std::int64_t count;
  };

  /// The value is finite.
  void add(double value);
  Histogram& operator+=(Histogram const& other);
  bool operator==(Histogram const& other) const;

  std::int64_t count() const { return count_; }
  /// Those that are not empty, ascending.
  std::vector<Bin> bins() const;
  /// The bin that holds the value of rank 1 <= rank <= count().
  Bin bin_of_rank(std::int64_t rank) const;

  void put(Bytes& bytes) const;
  static Histogram from(Bytes& bytes);

 private:
  static std::int64_t key_of(double value);
  static double edge(std::int64_t key);
  static Bin bin_at(std::int64_t key, std::int64_t count);
  void reach(std::int64_t key);

  std::int64_t first_ = 0;  ///< key of counts_[0]
  std::vector<std::int64_t> counts_;
  std::int64_t count_ = 0;
};

}  // namespace polhode::results
