/// Graphs that users bring: by flag and by suite, right and wrong.
#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

/// Every rule that a graph can break, in a file of the user's.
TEST(CliGraph, ARuleThatIsBrokenIsNamed) {
  struct Broken {
    std::string graph, problem;
    int code;
    std::vector<std::string> words;
  };
  std::string const groups = "1 2 1\n1 3 1\n2 3 1\n4 5 1\n";
  for (auto const& [graph, problem, code, words] :
       std::vector<Broken>{{groups + "1 4 1\n2 5 1\n1 5 -1\n", "group_consensus", 2, {"graph", "node 2", "balance"}},
                           {groups + "1 6 1\n", "group_consensus", 2, {"graph", "6", "5"}},
                           {"1 2 1\n4 5 1\n", "group_consensus", 2, {"graph", "connected"}},
                           {"1 2 1\n2 1 1\n", "quaternion_sync", 2, {"graph", "connected"}},
                           {"1 2 1\nfour 5 1\n", "quaternion_sync", 5, {"wrong.txt:2", "not a number", "four"}},
                           {"1 2 1\n4 5\n", "quaternion_sync", 5, {"wrong.txt:2", "i j weight"}},
                           {"1 1 1\n", "quaternion_sync", 5, {"wrong.txt:1", "itself"}},
                           {"# nothing\n", "quaternion_sync", 5, {"no links"}}}) {
    Folder folder;
    folder.write("wrong.txt", graph);
    Result const result =
        polhode(folder, "simulate " + problem + " --integrator rk4 --h 0.1 --set graph=wrong.txt --out out.csv");
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (std::string const& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << ": " << result.err;
    EXPECT_EQ(folder.contents(), (std::map<std::string, std::string>{{"wrong.txt", graph}})) << "nothing is written";
  }
}

TEST(CliGraph, AMissingFileIsAMistakeInAFile) {
  Folder folder;
  Result const result = polhode(folder, "simulate quaternion_sync --integrator rk4 --h 0.1 --set graph=missing.txt");
  EXPECT_EQ(result.code, 5);
  EXPECT_EQ(result.err, "polhode: parameter graph: missing.txt: cannot be read: No such file or directory\n");
}

// Ends of a path coupled to a pair: balanced, but driven apart.
std::string const repelled = "1 2 1\n2 3 1\n4 5 1\n1 4 1\n1 5 -1\n3 4 -1\n3 5 1\n";

TEST(CliGraph, ANegativeEigenvalueIsAWarningAndARemarkInTheRecord) {
  Folder folder;
  folder.write("swarm.txt", repelled);
  folder.write("suite.toml",
               "name = \"graphs\"\n[timing]\nenabled = false\n[[sweep]]\nproblem = \"group_consensus\"\nformulation = "
               "\"quaternion\"\nintegrator = \"rk4\"\nh = 0.02\nt_end = 2.0\nset = { graph = \"swarm.txt\" }\n");
  Result const result = polhode(folder, "run suite.toml --out out");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.err.find("warning"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("negative eigenvalue"), std::string::npos) << result.err;
  // Its copy makes the results complete, and the records hold the links.
  Result const checked = polhode(folder, "check out");
  EXPECT_NE(checked.code, 5) << checked.err;
  Result const report = polhode(folder, "report out --out page");
  EXPECT_EQ(report.code, 0) << report.err;
  EXPECT_NE(folder.contents().at("page/report.md").find("negative eigenvalue"), std::string::npos);
}

TEST(CliGraph, TheSameRingByFileAndByDefaultIsTheSame) {
  Folder folder;
  folder.write("ring.txt", "1 2 1\n1 5 1\n2 3 1\n2 4 1\n3 4 1\n4 1 1  # as printed\n5 4 1\n");
  std::string const words = "simulate quaternion_sync --integrator rk4 --h 0.1 --every 20";
  auto const rows = [](std::string const& csv) { return csv.substr(csv.find("\nt,")); };
  EXPECT_EQ(rows(polhode(folder, words + " --set graph=ring.txt").out), rows(polhode(folder, words).out));
}

}  // namespace
}  // namespace polhode::cli
