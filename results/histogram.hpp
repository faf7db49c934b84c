#pragma once
/// Histograms that add up: whole numbers of values in bins that are the same for everybody, so that any order and any
/// grouping of the data gives the same counts, and the memory does not depend on how many there are.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace polhode::results {

/// Plain numbers and texts as bytes, written and read in the same order: what ranks of one build send each other.
class Bytes {
 public:
  Bytes() = default;
  explicit Bytes(std::string text) : text_(std::move(text)) {}
  void put(std::int64_t number);
  void put(double number);
  void put(std::string_view text);
  /// They throw std::invalid_argument at the end of the bytes.
  std::int64_t whole();
  double number();
  std::string text();
  bool at_end() const { return at_ == text_.size(); }
  std::string const& all() const { return text_; }

 private:
  void take(void* to, std::size_t size);
  std::string text_;
  std::size_t at_ = 0;
};

/// Log-linear bins: each power of two in 128 equal parts, so a bin is at most 1/128 = 0.8% wide; zeros have a bin of
/// their own, negative values mirror the positive ones. Values up to the greatest double; below 1e-300 they are 0.
/// Source: Tene, HdrHistogram; bins are the leading bits of the number itself.
class Histogram {
 public:
  struct Bin {
    double low, high;  ///< low <= |value| < high; both 0 for zeros
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
