// The README's workflow, command by command, as a CI server runs it.
#include <gmock/gmock.h>

#include <map>
#include <sstream>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Step {
  std::string name, commands;
};

/// The steps of the README's workflow that run commands. Enough YAML for this one: `- name:`, and `run:` with a line or
/// with a block.
std::vector<Step> steps_of_readme() {
  std::string const readme = text_of(fs::path(POLHODE_SOURCE_DIR) / "README.md");
  std::string const opening = "<!-- workflow -->\n```yaml\n";
  std::size_t const start = readme.find(opening);
  EXPECT_NE(start, std::string::npos);
  if (start == std::string::npos) return {};
  std::size_t const first = start + opening.size();
  std::istringstream lines(readme.substr(first, readme.find("```", first) - first));
  std::vector<Step> steps;
  std::string name;
  std::size_t block = 0;  // how far a block is indented; 0: there is none
  for (std::string line; std::getline(lines, line);) {
    std::size_t const indent = std::min(line.find_first_not_of(' '), line.size());
    std::string const text = line.substr(indent);
    if (block > 0 && indent >= block) {
      steps.back().commands += text + "\n";
      continue;
    }
    block = 0;
    if (text.starts_with("- name: ")) name = text.substr(8, text.find("  #") - 8);
    if (!text.starts_with("run: ")) continue;
    steps.push_back({name, text == "run: |" ? "" : text.substr(5) + "\n"});
    if (text == "run: |") block = indent + 2;
  }
  for (Step& step : steps) step.name.resize(step.name.find_last_not_of(' ') + 1);
  return steps;
}

/// A checkout, and a path on which `polhode` is the built one.
class Workflow : public testing::Test {
 protected:
  Workflow() {
    fs::create_directory(folder.path / "bin");
    fs::create_symlink(POLHODE_BINARY, folder.path / "bin/polhode");
    for (Step const& step : steps_of_readme()) steps[step.name] = step.commands;
    EXPECT_EQ(polhode(folder, "simulate free_body --integrator gauss4 --h 0.05 --out trajectory.csv").code, 0);
    folder.write("ci/trajectory.csv", text_of(folder.path / "trajectory.csv"));
  }
  void write_suite(std::string const& bound) const {
    folder.write("ci/attitude.toml",
                 "name = 'attitude'\n[timing]\nmin_time = 0.001\nrepetitions = 3\n[[sweep]]\nproblem = 'free_body'\n"
                 "formulation = ['quaternion', 's3']\nintegrator = ['gauss2', 'cf4']\nh = [0.1, 0.25]\nt_end = 5\n"
                 "[[expect]]\nselect = { integrator = 'gauss2' }\nnorm_drift = { max = " +
                     bound + " }\nmin_cells = 4\n");
  }
  /// As the runner does: bash -e, in the checkout. The exit code.
  int run(std::string const& step) {
    EXPECT_TRUE(steps.contains(step)) << "the README has no step " << step;
    folder.write("step.sh", steps[step]);
    std::string const root = folder.path.string();
    std::string const command = "cd '" + root + "' && PATH='" + root + "/bin':\"$PATH\" CI=true GITHUB_ACTIONS=true " +
                                "GITHUB_STEP_SUMMARY='" + root + "/summary.md' bash -e -o pipefail step.sh >log 2>&1";
    int const status = std::system(command.c_str());
    log = text_of(folder.path / "log");
    return WEXITSTATUS(status);
  }

  Folder folder;
  std::map<std::string, std::string> steps;
  std::string log;
};

TEST_F(Workflow, EveryStepWorks) {
  write_suite("1e-13");
  folder.write("summary.md", "what another tool wrote\n");
  for (std::string const step : {"Run", "Check", "Score our own trajectory", "Report"})
    EXPECT_EQ(run(step), 0) << step << "\n" << log;
  EXPECT_EQ(steps.size(), 5U) << "these and the installation";
  EXPECT_THAT(steps["Install Polhode"], HasSubstr("cmake --install polhode/build/ci\n"));
  EXPECT_THAT(text_of(folder.path / "summary.md"),
              testing::AllOf(HasSubstr("what another tool wrote\n"), HasSubstr("## polhode check: attitude")));
  EXPECT_THAT(text_of(folder.path / "junit.xml"), HasSubstr("failures=\"0\""));
  EXPECT_TRUE(fs::exists(folder.path / "results/report/report.html"));
  EXPECT_THAT(text_of(folder.path / "score.json"), HasSubstr("\"status\": \"ok\""));
}

TEST_F(Workflow, AFailureIsMarkedWhereItIs) {
  write_suite("1e-30");
  EXPECT_EQ(run("Run"), 0) << log;
  EXPECT_EQ(run("Check"), 1);
  EXPECT_THAT(log, HasSubstr("::error file=ci/attitude.toml,line=11,title=polhode check%3A norm_drift::"));
  EXPECT_THAT(log, HasSubstr("norm_drift = "));
  EXPECT_THAT(text_of(folder.path / "summary.md"), HasSubstr("= 1e-30\n"));
  EXPECT_THAT(text_of(folder.path / "junit.xml"), Not(HasSubstr("failures=\"0\"")));
}

/// The file of the annotations that `check` makes of a folder.
std::string marked_file(Folder const& folder, std::string const& results) {
  Result const result = polhode(folder, "check " + results, {"GITHUB_ACTIONS=true", "GITHUB_STEP_SUMMARY="});
  std::size_t const from = result.out.find("::error file=") + 13;
  return result.out.substr(from, result.out.find(',', from) - from);
}

TEST_F(Workflow, TheMarkIsInTheFileOfTheRepository) {
  write_suite("1e-30");
  fs::create_directory(folder.path / ".git");
  std::string const root = folder.path.string();
  // Started below the top of the repository; the suite by an absolute path; from a folder outside.
  EXPECT_EQ(Process(folder.path / "ci", split("run attitude.toml --out ../below")).finish().code, 0);
  EXPECT_EQ(polhode(folder, "run " + root + "/ci/attitude.toml --out absolute").code, 0);
  Folder const elsewhere;
  EXPECT_EQ(polhode(elsewhere, "run " + root + "/ci/attitude.toml --out " + root + "/outside").code, 0);
  EXPECT_EQ(marked_file(folder, "below"), "ci/attitude.toml");
  EXPECT_EQ(marked_file(folder, "absolute"), "ci/attitude.toml");
  EXPECT_EQ(marked_file(folder, "outside"), "outside/suite.toml") << "unknown: the copy";
  EXPECT_EQ(polhode(folder, "merge all below").code, 0);
  EXPECT_EQ(marked_file(folder, "all"), "ci/attitude.toml");
}

TEST_F(Workflow, AWorseTrajectoryFails) {
  EXPECT_EQ(polhode(folder, "simulate free_body --integrator rk4 --h 0.5 --out ci/trajectory.csv").code, 0);
  EXPECT_NE(run("Score our own trajectory"), 0);
  EXPECT_THAT(log, HasSubstr("AssertionError"));
}

TEST_F(Workflow, OutsideGithubNothingIsMarked) {
  write_suite("1e-30");
  EXPECT_EQ(run("Run"), 0) << log;
  ::unsetenv("GITHUB_ACTIONS");
  Result const result = polhode(folder, "check results");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.out, Not(HasSubstr("::error")));
}

}  // namespace
}  // namespace polhode::cli
