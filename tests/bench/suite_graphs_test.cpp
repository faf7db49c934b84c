// The graph files of a suite, which are copied into the result folder under their names.
#include "bench/input/suite_graphs.hpp"

#include <gmock/gmock.h>

#include "problems/parameters.hpp"
#include "results/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::bench {
namespace {

namespace fs = std::filesystem;
using Links = std::vector<double>;
using testing::HasSubstr;

/// A folder of a suite, with graphs below it and beside it.
class SuiteGraphs : public testing::Test {
 protected:
  SuiteGraphs() {
    write("suites/ring.txt", "1 2 1\n");
    write("suites/a/ring.txt", "1 2 3\n");
    write("suites/a/star.txt", "1 3 1\n");
    write("ring.txt", "1 2 4\n");
  }
  void write(fs::path const& name, std::string const& text) const { folder_.write(name, text); }
  /// What is said of a graph of that name.
  std::string complaint(std::string const& written) {
    try {
      graphs_.read(written);
    } catch (ParameterError const& error) {
      return error.what();
    }
    return "";
  }

  polhode::test::TemporaryFolder folder_;
  fs::path const top_ = folder_.path;
  GraphFiles graphs_{top_ / "suites"};
};

TEST_F(SuiteGraphs, AreFoundFromTheSuitesFolder) {
  EXPECT_EQ(graphs_.read("ring.txt"), (Links{1, 2, 1}));
  EXPECT_EQ(graphs_.read("a/star.txt"), (Links{1, 3, 1}));
  EXPECT_EQ(graphs_.read("./ring.txt"), (Links{1, 2, 1})) << "the same file";
  EXPECT_EQ(graphs_.files().size(), 2U);
  EXPECT_THAT(complaint("missing.txt"), HasSubstr("missing.txt: cannot be read: No such file"));
}

TEST_F(SuiteGraphs, InAResultFolderTheCopyCounts) {
  EXPECT_EQ(graphs_.read("../ring.txt"), (Links{1, 2, 4}));
  write("suites/" + std::string(results::catalogue_file), "[]");
  GraphFiles copied(top_ / "suites");
  EXPECT_EQ(copied.read("../ring.txt"), (Links{1, 2, 1}));
  EXPECT_EQ(copied.read((top_ / "ring.txt").string()), (Links{1, 2, 1}));
}

TEST_F(SuiteGraphs, TwoOfOneNameAreRefused) {
  EXPECT_EQ(complaint("ring.txt"), "");
  EXPECT_THAT(complaint("a/ring.txt"), HasSubstr("have one name, but are copied to one folder; rename one"));
  EXPECT_THAT(complaint("../ring.txt"), HasSubstr("have one name"));
  EXPECT_EQ(graphs_.files().size(), 1U);
}

TEST_F(SuiteGraphs, NoneIsCalledWhatAResultFolderHas) {
  using std::string_literals::operator""s;
  for (std::string const& name : {"suite.toml"s, "catalogue.json"s, "catalogue.json.7"s, "benchmarks.json"s,
                                  "run-1.jsonl"s, ".lock-1-of-2"s, ""s, ".."s, "suite.toml\0.txt"s, "a\nb"s}) {
    write("suites/" + name.substr(0, name.find('\0')) + "/x", "");  // it is not the file that is missing
    EXPECT_THAT(complaint(name), HasSubstr("cannot hold a graph called")) << name;
    EXPECT_THAT(complaint("a/" + name), HasSubstr("cannot hold a graph called")) << name;
  }
}

TEST_F(SuiteGraphs, DevicesAndFoldersAreNone) {
  EXPECT_THAT(complaint("/dev/zero"), HasSubstr("/dev/zero: is a device; give a file"));
  EXPECT_THAT(complaint("a"), HasSubstr("is a directory"));
}

}  // namespace
}  // namespace polhode::bench
