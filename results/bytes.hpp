#pragma once
/// What ranks of one build send each other.
#include <cstdint>
#include <string>
#include <string_view>

namespace polhode::results {

/// Numbers and texts as bytes, read in the order in which they were written.
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

}  // namespace polhode::results
