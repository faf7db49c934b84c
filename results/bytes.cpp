#include "results/bytes.hpp"

#include <cstring>
#include <stdexcept>

namespace polhode::results {

void Bytes::put(std::int64_t number) {
  text_.append(reinterpret_cast<char const*>(&number), sizeof number);
}
void Bytes::put(double number) {
  text_.append(reinterpret_cast<char const*>(&number), sizeof number);
}
void Bytes::put(std::string_view text) {
  put(std::int64_t(text.size()));
  text_.append(text);
}
void Bytes::take(void* to, std::size_t size) {
  if (text_.size() - at_ < size) throw std::invalid_argument("bytes of statistics are too short");
  std::memcpy(to, text_.data() + at_, size);
  at_ += size;
}
std::int64_t Bytes::whole() {
  std::int64_t number;
  take(&number, sizeof number);
  return number;
}
double Bytes::number() {
  double number;
  take(&number, sizeof number);
  return number;
}
std::string Bytes::text() {
  std::int64_t const size = whole();
  if (size < 0 || text_.size() - at_ < std::size_t(size)) throw std::invalid_argument("bytes of statistics are torn");
  std::string read = text_.substr(at_, std::size_t(size));
  at_ += std::size_t(size);
  return read;
}

}  // namespace polhode::results
