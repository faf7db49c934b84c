/// The layers: who may include whom, no cycles, and every header introduced by a file comment.
/// problems <- integrators <- bench -> results <- report; only bench/main.cpp sees both bench and report. bench has
/// floors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace polhode {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Sources = std::map<std::string, std::string>;  ///< path from the root -> text

std::map<std::string, std::set<std::string>> const allowed{
    {"problems", {"problems"}},
    {"integrators", {"problems", "integrators"}},
    {"results", {"results"}},
    {"report", {"report", "results"}},
    {"bench", {"problems", "integrators", "bench", "results"}},
    {"tests", {"problems", "integrators", "bench", "results", "report", "tests"}},
};

std::string layer_of(std::string const& path) {
  return path.substr(0, path.find('/'));
}
bool is_header(std::string const& path) {
  return path.ends_with(".hpp");
}

/// What the build writes: CMake's facts for the record's provenance.
std::set<std::string> const generated{"build_info.hpp"};
/// Folders whose sources are written as if by somebody else, against the installed library.
std::set<std::string> const strangers{"tests/consumer", "tests/must_fail"};

/// The floors of bench: a folder knows itself, and those of lower floors.
std::map<std::string, int> const floors{
    {"bench/process", 0},  {"bench/input", 1}, {"bench/solve", 2}, {"bench/cell", 3},     {"bench/job", 4},
    {"bench/ensemble", 4}, {"bench/score", 4}, {"bench/speed", 5}, {"bench/commands", 5}, {"bench", 6},
};
bool goes_down(std::string const& file, std::string const& included) {
  std::string const from = file.substr(0, file.rfind('/')), to = included.substr(0, included.rfind('/'));
  return from == to || floors.at(from) > floors.at(to);
}

bool may_include(std::string const& file, std::string const& included) {
  if (file == "bench/main.cpp" && layer_of(included) == "report") return true;
  if (layer_of(file) == "bench" && layer_of(included) == "bench" && !goes_down(file, included)) return false;
  return allowed.at(layer_of(file)).contains(layer_of(included));
}

/// The path of an include line: by quotes, or by brackets from a layer of ours. Empty for every other line.
std::string included_by(std::string line) {
  std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
  constexpr std::string_view directive = "#include";
  if (!line.starts_with(directive)) return "";
  line.erase(0, directive.size());
  bool const quoted = line.starts_with('"');
  std::size_t const end = line.find_first_of("\">", 1);
  if (end == std::string::npos) return "";
  std::string const path = line.substr(1, end - 1);
  bool const ours = path.find('/') != std::string::npos && allowed.contains(layer_of(path));
  return quoted || ours ? path : "";
}
std::vector<std::string> includes_of(std::string const& text) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (std::string path = included_by(line); !path.empty()) found.push_back(std::move(path));
  return found;
}

/// Follows includes from `file`; a file met again on the way is a cycle.
void find_cycles(Sources const& sources, std::string const& file, std::vector<std::string>& way,
                 std::set<std::string>& done, std::vector<std::string>& wrong) {
  if (std::find(way.begin(), way.end(), file) != way.end()) {
    wrong.push_back(file + ": includes itself through " + way.back());
    return;
  }
  if (!sources.contains(file) || !done.insert(file).second) return;
  way.push_back(file);
  for (std::string const& next : includes_of(sources.at(file))) find_cycles(sources, next, way, done, wrong);
  way.pop_back();
}

/// Everything that breaks a rule, in order of path.
std::vector<std::string> violations(Sources const& sources) {
  std::vector<std::string> wrong;
  std::set<std::string> done;
  for (auto const& [file, text] : sources) {
    for (std::string const& included : includes_of(text)) {
      if (generated.contains(included) && layer_of(file) == "bench") continue;
      if (!sources.contains(included))
        wrong.push_back(file + ": \"" + included + "\" is no file of the project (paths start at its root)");
      else if (!may_include(file, included))
        wrong.push_back(file + ": must not know " + included);
    }
    if (is_header(file) && !text.starts_with("#pragma once\n"))
      wrong.push_back(file + ": must start with #pragma once");
    if (is_header(file) && !text.starts_with("#pragma once\n///"))
      wrong.push_back(file + ": the file comment (///) must follow #pragma once");
    std::vector<std::string> way;
    find_cycles(sources, file, way, done, wrong);
  }
  return wrong;
}

Sources sources_of_the_project() {
  std::filesystem::path const root = POLHODE_SOURCE_DIR;
  Sources sources;
  for (auto const& [layer, _] : allowed)
    for (auto const& entry : std::filesystem::recursive_directory_iterator(root / layer)) {
      std::string const extension = entry.path().extension();
      if (extension != ".hpp" && extension != ".cpp") continue;
      std::filesystem::path const path = std::filesystem::relative(entry.path(), root);
      if (strangers.contains(path.parent_path().generic_string())) continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      sources[path.generic_string()] = text.str();
    }
  return sources;
}

TEST(Layering, TheProjectKeepsIt) {
  Sources const sources = sources_of_the_project();
  EXPECT_GT(sources.size(), 50u);
  for (auto const& [layer, _] : allowed)
    EXPECT_TRUE(std::any_of(sources.begin(), sources.end(), [&](auto const& s) { return layer_of(s.first) == layer; }))
        << layer << " has no sources: did it move?";
  EXPECT_THAT(violations(sources), IsEmpty());
}

std::string const head = "#pragma once\n/// What.\n";

TEST(Layering, WhatIsRightPasses) {
  EXPECT_THAT(violations({{"problems/a.hpp", head + "#include <vector>\n"},
                          {"integrators/b.hpp", head + "#include \"problems/a.hpp\"\n#include <Eigen/Dense>\n"},
                          {"report/r.hpp", head},
                          {"bench/main.cpp", "#include \"integrators/b.hpp\"\n#include \"report/r.hpp\"\n"}}),
              IsEmpty());
}

TEST(Layering, BenchIsClimbedFromFloorToFloor) {
  Sources sources{{"bench/input/suite.hpp", head},
                  {"bench/job/run.hpp", head + "#include \"bench/input/suite.hpp\"\n"},
                  {"bench/ensemble/job.hpp", head}};
  EXPECT_THAT(violations(sources), IsEmpty());
  sources["bench/input/up.hpp"] = head + "#include \"bench/job/run.hpp\"\n";
  sources["bench/job/aside.hpp"] = head + "#include \"bench/ensemble/job.hpp\"\n";
  EXPECT_THAT(violations(sources), ElementsAre("bench/input/up.hpp: must not know bench/job/run.hpp",
                                               "bench/job/aside.hpp: must not know bench/ensemble/job.hpp"));
}

TEST(Layering, UpwardIncludesAreFound) {
  Sources const sources{{"bench/c.hpp", head},
                        {"bench/job/run.cpp", "#include \"report/r.hpp\"\n"},
                        {"integrators/b.hpp", head + "#include \"bench/c.hpp\"\n"},
                        {"problems/a.hpp", head + "# include <integrators/b.hpp>\n"},
                        {"report/r.hpp", head + "#include \"problems/a.hpp\"\n"},
                        {"results/s.cpp", "  #include \"report/r.hpp\"\n"}};
  EXPECT_THAT(
      violations(sources),
      ElementsAre("bench/job/run.cpp: must not know report/r.hpp", "integrators/b.hpp: must not know bench/c.hpp",
                  "problems/a.hpp: must not know integrators/b.hpp", "report/r.hpp: must not know problems/a.hpp",
                  "results/s.cpp: must not know report/r.hpp"));
}

TEST(Layering, CyclesAreFound) {
  EXPECT_THAT(violations({{"problems/a.hpp", head + "#include \"problems/b.hpp\"\n"},
                          {"problems/b.hpp", head + "#include \"problems/c.hpp\"\n"},
                          {"problems/c.hpp", head + "#include \"problems/a.hpp\"\n"}}),
              ElementsAre("problems/a.hpp: includes itself through problems/c.hpp"));
}

TEST(Layering, HeadersWithoutGuardOrCommentAreFound) {
  EXPECT_THAT(violations({{"bench/a.hpp", "/// What.\n#pragma once\n"}, {"bench/b.hpp", "#pragma once\n\nint x;\n"}}),
              ElementsAre("bench/a.hpp: must start with #pragma once",
                          "bench/a.hpp: the file comment (///) must follow #pragma once",
                          "bench/b.hpp: the file comment (///) must follow #pragma once"));
}

TEST(Layering, PathsStartAtTheRoot) {
  EXPECT_THAT(violations({{"bench/a.cpp", "#include \"b.hpp\"\n"}, {"bench/b.hpp", head}}),
              ElementsAre("bench/a.cpp: \"b.hpp\" is no file of the project (paths start at its root)"));
}

}  // namespace
}  // namespace polhode
