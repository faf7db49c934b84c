#include "results/histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

namespace polhode::results {

namespace {

constexpr int dropped_bits = 52 - 7;  // of the mantissa: a power of two is cut into 2^7 bins
constexpr double least = 1e-300;      // a normal number: its bits are exponent and mantissa

constexpr std::int64_t leading_bits(double size) {
  return std::bit_cast<std::int64_t>(size) >> dropped_bits;
}
/// The key of `least` is 1.
constexpr std::int64_t before = leading_bits(least) - 1;

}  // namespace

/// The leading bits of |value|, counted from those of the least, with the value's sign.
std::int64_t Histogram::key_of(double value) {
  double const size = std::abs(value);
  if (size < least) return 0;
  std::int64_t const key = leading_bits(size) - before;
  return value < 0 ? -key : key;
}
/// The lower end of the bin of a positive key.
double Histogram::edge(std::int64_t key) {
  return std::bit_cast<double>((key + before) << dropped_bits);
}
Histogram::Bin Histogram::bin_at(std::int64_t key, std::int64_t count) {
  if (key == 0) return {0, 0, count};
  if (key > 0) return {edge(key), edge(key + 1), count};
  return {-edge(1 - key), -edge(-key), count};
}

void Histogram::reach(std::int64_t key) {
  if (counts_.empty()) {
    first_ = key;
    counts_.assign(1, 0);
  } else if (key < first_) {
    counts_.insert(counts_.begin(), std::size_t(first_ - key), 0);
    first_ = key;
  } else if (key >= first_ + std::int64_t(counts_.size())) {
    counts_.resize(std::size_t(key - first_ + 1), 0);
  }
}
void Histogram::add(double value) {
  std::int64_t const key = key_of(value);
  reach(key);
  ++counts_[std::size_t(key - first_)];
  ++count_;
}
Histogram& Histogram::operator+=(Histogram const& other) {
  if (other.counts_.empty()) return *this;
  reach(other.first_);
  reach(other.first_ + std::int64_t(other.counts_.size()) - 1);
  for (std::size_t i = 0; i < other.counts_.size(); ++i)
    counts_[std::size_t(other.first_ - first_) + i] += other.counts_[i];
  count_ += other.count_;
  return *this;
}
bool Histogram::operator==(Histogram const& other) const {
  auto const same = [](Bin const& a, Bin const& b) { return a.low == b.low && a.count == b.count; };
  std::vector<Bin> const mine = bins(), theirs = other.bins();
  return std::ranges::equal(mine, theirs, same);
}

std::vector<Histogram::Bin> Histogram::bins() const {
  std::vector<Bin> filled;
  for (std::size_t i = 0; i < counts_.size(); ++i)
    if (counts_[i] > 0) filled.push_back(bin_at(first_ + std::int64_t(i), counts_[i]));
  return filled;
}
Histogram::Bin Histogram::bin_of_rank(std::int64_t rank) const {
  std::int64_t below = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    below += counts_[i];
    if (below >= rank) return bin_at(first_ + std::int64_t(i), counts_[i]);
  }
  throw std::out_of_range("a histogram has no such rank");
}

void Histogram::put(Bytes& bytes) const {
  std::int64_t filled = 0;
  for (std::int64_t const count : counts_) filled += count > 0;
  bytes.put(filled);
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] == 0) continue;
    bytes.put(first_ + std::int64_t(i));
    bytes.put(counts_[i]);
  }
}
Histogram Histogram::from(Bytes& bytes) {
  Histogram read;
  for (std::int64_t left = bytes.whole(); left > 0; --left) {
    std::int64_t const key = bytes.whole(), count = bytes.whole();
    read.reach(key);
    read.counts_[std::size_t(key - read.first_)] += count;
    read.count_ += count;
  }
  return read;
}

}  // namespace polhode::results
