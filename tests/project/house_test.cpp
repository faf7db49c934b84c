/// The house rules that a reader can check by eye, checked here: public types are documented, files are short, nothing
/// stands in two files, and the paths that CONTRIBUTING.md names exist.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace polhode {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using Lines = std::vector<std::string>;

Lines lines_of(fs::path const& file) {
  std::ifstream in(file);
  Lines lines;
  for (std::string line; std::getline(in, line);) lines.push_back(std::move(line));
  return lines;
}

/// Our own sources below these folders: path from the root -> lines.
std::map<std::string, Lines> sources(std::vector<std::string> const& folders) {
  fs::path const root = POLHODE_SOURCE_DIR;
  std::map<std::string, Lines> found;
  for (std::string const& folder : folders)
    for (auto entry = fs::recursive_directory_iterator(root / folder); entry != fs::recursive_directory_iterator();
         ++entry) {
      if (entry->path().filename() == "node_modules") entry.disable_recursion_pending();
      std::string const extension = entry->path().extension();
      if (extension == ".hpp" || extension == ".cpp" || extension == ".js" || extension == ".mjs")
        found[fs::relative(entry->path(), root)] = lines_of(entry->path());
    }
  return found;
}
std::vector<std::string> const everywhere{"problems", "integrators", "bench", "results", "report", "tests"};

// ---- Documentation --------------------------------------------------------------------------------------------------

/// Types and concepts of `lines`, outside namespace detail, that no comment introduces: as "line: text".
std::vector<std::string> undocumented(Lines const& lines) {
  static std::regex const type(R"((class|struct|enum class) [A-Z]\w*[^<;(]*(\{.*|$)|concept .*)");
  static std::regex const introduction(R"((template|requires|  requires|    ).*)");
  std::vector<std::string> found;
  bool hidden = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string const& line = lines[i];
    if (line.starts_with("namespace ")) hidden = line.find("detail") != std::string::npos;
    if (line.starts_with("}  // namespace ")) hidden = false;
    if (hidden || !std::regex_match(line, type)) continue;
    std::size_t above = i;
    while (above > 0 && std::regex_match(lines[above - 1], introduction)) --above;
    if (above == 0 || !lines[above - 1].starts_with("///")) found.push_back(std::to_string(i + 1) + ": " + line);
  }
  return found;
}

TEST(House, FindsATypeWithoutAComment) {
  EXPECT_THAT(undocumented({"/// One.", "template <class T>", "struct A {", "};"}), IsEmpty());
  EXPECT_THAT(undocumented({"template <class T>", "struct A {", "};"}), testing::SizeIs(1));
  EXPECT_THAT(undocumented({"template <class T>", "concept A = requires(T t) { t(); };"}), testing::SizeIs(1));
  EXPECT_THAT(undocumented({"namespace detail {", "struct A {};", "}  // namespace detail"}), IsEmpty());
}

TEST(House, PublicTypesAreDocumented) {
  for (auto const& [file, lines] : sources({"problems", "integrators"}))
    EXPECT_THAT(undocumented(file.ends_with(".hpp") ? lines : Lines{}), IsEmpty()) << file;
}

// ---- Size and repetition --------------------------------------------------------------------------------------------

TEST(House, FilesAreShort) {
  for (auto const& [file, lines] : sources(everywhere)) EXPECT_LE(lines.size(), 400U) << file;
}

struct Place {
  std::string file;
  std::size_t line;
};
/// Runs of six equal lines in two files, blank lines, includes and lone brackets aside: one place in each file.
std::vector<std::pair<Place, Place>> repetitions(std::map<std::string, Lines> const& files) {
  static std::regex const idle(R"(\s*([{}();, ]*|#include.*|\}?\s*(// )?namespace.*)\s*)");
  std::map<std::string, Place> seen;
  std::set<std::pair<std::string, std::string>> pairs;
  std::vector<std::pair<Place, Place>> found;
  for (auto const& [file, lines] : files) {
    std::vector<std::pair<std::size_t, std::string>> kept;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      std::string const& line = lines[i];
      if (!std::regex_match(line, idle)) kept.emplace_back(i + 1, line.substr(line.find_first_not_of(" \t")));
    }
    for (std::size_t i = 0; i + 6 <= kept.size(); ++i) {
      std::string run;
      for (std::size_t k = i; k < i + 6; ++k) run += kept[k].second + '\n';
      auto const [at, fresh] = seen.try_emplace(run, Place{file, kept[i].first});
      if (fresh || at->second.file == file || !pairs.emplace(at->second.file, file).second) continue;
      found.emplace_back(at->second, Place{file, kept[i].first});
    }
  }
  return found;
}

TEST(House, FindsWhatStandsTwice) {
  Lines const six{"a;", "b;", "c;", "d;", "e;", "f;"}, other{"a;", "b;", "c;", "d;", "e;", "g;"};
  EXPECT_THAT(repetitions({{"one", six}, {"two", other}}), IsEmpty());
  EXPECT_THAT(repetitions({{"one", six}, {"two", six}}), testing::SizeIs(1));
}

TEST(House, NothingStandsInTwoFiles) {
  /// Allowed, with the reason.
  std::map<std::string, std::string> const reasons{
      {"tests/consumer/damped_body.hpp", "an example has to be complete, and begins like the simplest problem"},
  };
  for (auto const& [one, two] : repetitions(sources(everywhere)))
    if (!reasons.contains(one.file) && !reasons.contains(two.file))
      ADD_FAILURE() << one.file << ":" << one.line << " stands in " << two.file << ":" << two.line << ", too";
}

// ---- The paths of CONTRIBUTING.md -----------------------------------------------------------------------------------

/// `file`: `name`, `name` ... of the tables below <!-- paths -->.
TEST(House, ThePathsOfContributingExist) {
  fs::path const root = POLHODE_SOURCE_DIR;
  static std::regex const quoted("`([^`]+)`");
  bool inside = false;
  int names = 0;
  for (std::string const& line : lines_of(root / "CONTRIBUTING.md")) {
    if (line == "<!-- paths -->") inside = true;
    if (line.empty()) inside = false;
    std::string text;
    for (std::sregex_iterator at(line.begin(), line.end(), quoted), end; inside && at != end; ++at) {
      std::string const word = (*at)[1];
      if (word.find('/') != std::string::npos) {
        ASSERT_TRUE(fs::exists(root / word)) << word;
        text.clear();
        for (std::string const& code : lines_of(root / word)) text += code + '\n';
      } else {
        std::string const name = word.substr(word.rfind(':') == std::string::npos ? 0 : word.rfind(':') + 1);
        EXPECT_NE(text.find(name), std::string::npos) << name << " in " << line;
        ++names;
      }
    }
  }
  EXPECT_GE(names, 8);
}

}  // namespace
}  // namespace polhode
