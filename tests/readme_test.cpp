// The READMEs against what they speak of: examples are the files of tests/consumer that the consumer tests compile,
// tables list every file of their folder, links lead somewhere, and the lines for a clone stand where they say.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

fs::path const root = POLHODE_SOURCE_DIR;

std::string contents(fs::path const& file) {
  std::ifstream in(root / file);
  EXPECT_TRUE(in) << file;
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The code block of `readme` that follows the comment `<!-- NAME -->`, without its fences.
std::string block(std::string const& readme, std::string const& name) {
  std::string const text = contents(readme), opening = "<!-- " + name + " -->\n```", closing = "\n```\n";
  std::size_t const start = text.find(opening);
  if (start == std::string::npos) return "no block " + name + " in " + readme;
  std::size_t const first = text.find('\n', start + opening.size()) + 1;
  return text.substr(first, text.find(closing, first) - first + 1);
}
void expect_block(std::string const& readme, std::string const& name) {
  EXPECT_EQ(block(readme, name), contents(name)) << "of " << readme;
}

TEST(Readme, ExampleProblemIsTheCompiledOne) {
  expect_block("problems/README.md", "tests/consumer/damped_body.hpp");
}
TEST(Readme, ExampleIntegratorsAreTheCompiledOnes) {
  expect_block("integrators/README.md", "tests/consumer/heun.hpp");
}
TEST(Readme, FirstUseOfTheCoreIsTheCompiledOne) {
  expect_block("README.md", "tests/consumer/main.cpp");
}
TEST(Readme, ProjectOfOnesOwnIsTheBuiltOne) {
  expect_block("integrators/README.md", "tests/consumer/plugin/CMakeLists.txt");
  expect_block("integrators/README.md", "tests/consumer/plugin/mine.toml");
}
TEST(Readme, ListsForALineInACloneAreWhereItSays) {
  EXPECT_THAT(contents("integrators/README.md"), HasSubstr("struct ExplicitMethods : Types<Rk4, Dopri5, "));
  EXPECT_THAT(contents("integrators/catalog/explicit.hpp"), HasSubstr("struct ExplicitMethods : Types<Rk4, Dopri5, "));
  EXPECT_THAT(contents("problems/README.md"), HasSubstr("using OtherProblems = Types<\n    HeavyTop,\n"));
  EXPECT_THAT(contents("problems/catalog.hpp"), HasSubstr("using OtherProblems = Types<\n    HeavyTop,\n"));
}

TEST(Readme, TablesListEveryHeaderOfTheirFolder) {
  for (fs::path const folder : {"integrators", "problems"}) {
    std::string const text = contents(folder / "README.md");
    int headers = 0;
    for (auto const& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".hpp") continue;
      EXPECT_THAT(text, HasSubstr("](" + fs::relative(entry.path(), root / folder).generic_string() + ")"));
      ++headers;
    }
    EXPECT_GT(headers, 30) << folder;
  }
}
TEST(Readme, LinksLeadSomewhere) {
  std::regex const link(R"(\]\(([^)#:]+)(#[^)]*)?\))");  // of this repository: without a scheme
  int links = 0;
  for (fs::path const folder : {"", "bench", "integrators", "problems", "report", "results", "tests"}) {
    std::string const text = contents(folder / "README.md");
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at, ++links)
      EXPECT_TRUE(fs::exists(root / folder / (*at)[1].str())) << (folder / "README.md") << ": " << (*at)[1];
  }
  EXPECT_GT(links, 100);
}

}  // namespace
