// The readers of files from outside against mutated files: no input makes one do anything but return or refuse. The
// sanitizers' build sees the most. Longer with POLHODE_FULL=1.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <random>
#include <vector>

#include "tests/fuzz/targets.hpp"

namespace polhode::fuzz {
namespace {

std::vector<std::string> corpus(std::string_view target) {
  std::vector<std::string> files;
  std::filesystem::path const folder = std::filesystem::path(POLHODE_SOURCE_DIR) / "tests/fuzz/corpus" / target;
  for (auto const& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  std::ranges::sort(files);  // a folder has no order
  return files;
}

/// Words that readers look for, and numbers at the edges.
using std::string_view_literals::operator""sv;
constexpr std::array words{
    "nan"sv,  "inf"sv,       "-0"sv,     "1e999"sv,       "1e-999"sv,  "0x1p3"sv, "9223372036854775808"sv,
    "-1"sv,   "\0"sv,        "\n"sv,     "\r\n"sv,        "\v"sv,      "#"sv,     ","sv,
    "\""sv,   "'"sv,         "\'\'\'"sv, "\\"sv,          "\\u0000"sv, "\xff"sv,  "["sv,
    "]"sv,    "[["sv,        "{"sv,      "}"sv,           "="sv,       "."sv,     "null"sv,
    "true"sv, "{}"sv,        "[]"sv,     "kind"sv,        "run"sv,     "meta"sv,  "e"sv,
    " "sv,    "=\xc7\xa8"sv, "\"\"\""sv, "\xEF\xBB\xBF"sv};

class Mutator {
 public:
  Mutator(std::vector<std::string> const& corpus, unsigned seed) : corpus_(corpus), random_(seed) {}
  std::string next() {
    std::string text = corpus_[below(corpus_.size())];
    for (std::size_t n = 1 + below(4); n > 0; --n) change(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : std::size_t(random_() % n); }
  void change(std::string& text) {
    std::size_t const at = below(text.size() + 1), length = below(std::min<std::size_t>(text.size() - at, 40) + 1);
    switch (below(7)) {
      case 0:
        if (at < text.size()) text[at] = char(text[at] ^ (1 << below(8)));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, words[below(words.size())]);
        break;
      case 3:
        text.replace(at, length, words[below(words.size())]);
        break;
      case 4: {  // a piece of another file
        std::string const& other = corpus_[below(corpus_.size())];
        std::size_t const from = below(other.size() + 1);
        text.insert(at, other.substr(from, below(80)));
        break;
      }
      case 5: {  // a piece again and again
        std::string const piece = text.substr(at, length);
        for (std::size_t n = below(60); n > 0; --n) text.insert(at, piece);
        break;
      }
      default:
        text.resize(at);
    }
  }

  std::vector<std::string> const& corpus_;
  std::mt19937 random_;
};

void hammer(int inputs, unsigned seed) {
  for (Target const& target : targets) {
    std::vector<std::string> const files = corpus(target.name);
    ASSERT_GE(files.size(), 2U) << target.name;
    for (std::string const& file : files) EXPECT_NO_THROW(target.run(file)) << target.name;
    Mutator mutator(files, seed);
    for (int i = 0; i < inputs; ++i) {
      std::string const input = mutator.next();
      ASSERT_NO_THROW(target.run(input)) << target.name << " " << i << ":\n" << testing::PrintToString(input);
    }
  }
}

TEST(Fuzz, ReadersReturnOrRefuse) {
  hammer(1500, 1);
}
TEST(Fuzz, NestingWithoutEndOverflowsNoStack) {
  for (Target const& target : targets)
    for (std::string const piece : {"[", "{\"name\":", "{\"kind\":[", "[[sweep]]\nx=[", "a."}) {
      std::string deep;
      for (int i = 0; i < 200'000; ++i) deep += piece;
      EXPECT_NO_THROW(target.run(deep)) << target.name << ": " << piece << piece << "...";
      EXPECT_NO_THROW(target.run("[" + deep + "]")) << target.name << ": [" << piece << piece << "...";
    }
  // What is nested and complete is not refused by the parser.
  std::string const open(200'000, '['), close(200'000, ']');
  for (Target const& target : targets)
    for (std::string const& around : {std::string("[{\"name\":\"rk4\",\"own\":"), std::string("{\"kind\":"),
                                      std::string("{\"schema\":1,\"kind\":\"meta\",\"a\":")})
      EXPECT_NO_THROW(target.run(around + open + close + "}" + (around[0] == '[' ? "]" : ""))) << target.name;
}
TEST(Full, ReadersReturnOrRefuseForLong) {
  if (std::getenv("POLHODE_FULL") == nullptr) GTEST_SKIP() << "a minute; POLHODE_FULL=1 runs it";
  for (unsigned seed = 2; seed < 6; ++seed) hammer(25'000, seed);
}

}  // namespace
}  // namespace polhode::fuzz
