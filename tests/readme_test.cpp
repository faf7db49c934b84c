// The examples that the READMEs print are the files of tests/consumer that the consumer test compiles.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace {

std::string contents(std::string const& file) {
  std::ifstream in(std::string(POLHODE_SOURCE_DIR) + "/" + file);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The code block of `readme` that follows the comment `<!-- NAME -->`, without its fences.
std::string block(std::string const& readme, std::string const& name) {
  std::string const text = contents(readme), opening = "<!-- " + name + " -->\n```cpp\n", closing = "\n```\n";
  std::size_t const start = text.find(opening);
  if (start == std::string::npos) return "no block " + name + " in " + readme;
  std::size_t const first = start + opening.size();
  return text.substr(first, text.find(closing, first) - first + 1);
}

TEST(Readme, ExampleProblemIsTheCompiledOne) {
  EXPECT_EQ(block("problems/README.md", "tests/consumer/damped_body.hpp"), contents("tests/consumer/damped_body.hpp"));
}
TEST(Readme, ExampleIntegratorsAreTheCompiledOnes) {
  EXPECT_EQ(block("integrators/README.md", "tests/consumer/heun.hpp"), contents("tests/consumer/heun.hpp"));
}
TEST(Readme, FirstUseOfTheCoreIsTheCompiledOne) {
  EXPECT_EQ(block("README.md", "tests/consumer/main.cpp"), contents("tests/consumer/main.cpp"));
}

}  // namespace
