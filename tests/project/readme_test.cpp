// The documents against what they speak of: examples are the files of tests/consumer that the consumer tests compile,
// tables list every file of their folder, links lead somewhere, the lines for a clone stand where they say, and the
// version is the project's.
#include <gmock/gmock.h>

#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <string>

#include "tests/support/documents.hpp"

namespace {

namespace fs = std::filesystem;
using polhode::test::contents;
using polhode::test::documents;
using polhode::test::parts_of;
using testing::Contains;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

fs::path const root = POLHODE_SOURCE_DIR;

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

TEST(Readme, VersionIsThatOfTheProject) {
  std::string const project = contents("CMakeLists.txt");
  std::smatch version;
  ASSERT_TRUE(std::regex_search(project, version, std::regex(R"(project\(polhode VERSION ((\d+\.\d+)\.\d+))")));
  EXPECT_THAT(contents("CITATION.cff"), HasSubstr("\nversion: " + version.str(1) + "\n"));
  std::string const changelog = contents("CHANGELOG.md");
  std::smatch release;
  ASSERT_TRUE(std::regex_search(changelog, release, std::regex(R"(\n## (\S+) \((\d{4}-\d\d-\d\d)\)\n)")));
  EXPECT_EQ(release.str(1), version.str(1));
  EXPECT_THAT(contents("CITATION.cff"), HasSubstr("\ndate-released: " + release.str(2) + "\n"));
  EXPECT_THAT(contents("README.md"), HasSubstr("find_package(polhode " + version.str(2) + " REQUIRED)"));
}

// ---- Links ----------------------------------------------------------------------------------------------------------

/// The anchors of the headings of Markdown, as GitHub makes them: small letters, hyphens for blanks, no other signs.
std::set<std::string> anchors(std::string const& text) {
  static std::regex const heading("(^|\n)#+ ([^\n]+)");
  std::set<std::string> all;
  std::string const kept = parts_of(text).prose;
  for (std::sregex_iterator at(kept.begin(), kept.end(), heading), end; at != end; ++at) {
    std::string anchor;
    for (char const c : (*at)[2].str())
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == ' ')
        anchor += c == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    all.insert(anchor);
  }
  return all;
}

TEST(Readme, AnchorsAreThoseOfHeadings) {
  EXPECT_THAT(anchors("# One, `two`\n```\n# no\n```\n## The x-y_z part\n"),
              UnorderedElementsAre("one-two", "the-x-y_z-part"));
}
TEST(Readme, LinksLeadSomewhere) {
  static std::regex const code("`[^`\n]*`");
  static std::regex const link(R"(\]\(([^)\s#:]*)(#([^)\s]+))?\))");  // of this repository: without a scheme
  int links = 0, to_headings = 0;
  for (fs::path const& document : documents()) {
    std::string const text = std::regex_replace(parts_of(contents(document)).prose, code, "``");
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at, ++links) {
      fs::path const target = (*at)[1].length() == 0 ? document : document.parent_path() / (*at)[1].str();
      EXPECT_TRUE(fs::exists(root / target)) << document << ": " << at->str();
      if ((*at)[3].length() == 0) continue;
      EXPECT_THAT(anchors(contents(target)), Contains((*at)[3].str())) << document << ": " << at->str();
      ++to_headings;
    }
  }
  EXPECT_GT(links, 100);
  EXPECT_GT(to_headings, 5);
}

}  // namespace
