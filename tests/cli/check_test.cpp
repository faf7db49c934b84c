// `check`, `export` and `merge` as a user meets them: what a wrong expectation says, golden columns, files for others.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/cli/results.hpp"

namespace polhode::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A folder with results of the tiny suite; each test puts its own expectations into the suite of a copy.
class CliCheck : public TinyResults {
 protected:
  void SetUp() override {
    ::unsetenv("CI");
    copy_results_to("results");
  }
  Result check(std::string const& expectations, std::string const& flags = "") {
    folder.write("results/suite.toml", tiny_suite + expectations);
    return polhode(folder, "check results --golden golden " + flags);
  }
};

std::string const right =
    "[[expect]]\nselect = { integrator = 'gauss2' }\nnorm_drift = { max = 1e-13 }\nmin_cells = 2\n";

TEST_F(CliCheck, WhatHoldsExitsWith0) {
  Result const result = check(right);
  EXPECT_EQ(result.code, 0) << result.out;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("{integrator = gauss2}"), HasSubstr("<= 1e-13"), HasSubstr("passed"),
                                HasSubstr("1 checks: 1 passed, 0 failed")));
  EXPECT_THAT(result.out, HasSubstr("suite tiny (results/suite.toml): 4 of 4 cells have records of build "));
  EXPECT_THAT(result.out, Not(HasSubstr("\033")));
}

TEST_F(CliCheck, WhatFailsExitsWith1AndNamesCellFieldValueAndBound) {
  Result const result = check("[[expect]]\nselect = { integrator = 'rk4' }\nnorm_drift = { max = 1e-20 }\n");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.out, AllOf(HasSubstr("results/suite.toml:9: free_body//quaternion/rk4/none/h=0.1 ["),
                                HasSubstr("]: norm_drift = "), HasSubstr("e-"), HasSubstr(", must be <= 1e-20\n")));
  EXPECT_THAT(result.out, HasSubstr("free_body//s3/rk4/none/h=0.1"));
  EXPECT_THAT(result.out, HasSubstr("norm_drift = refused: ")) << "a refusal violates a bound on a number";
}

TEST_F(CliCheck, VacuousAndUnexpectedPassesExitWith1) {
  Result const vacuous = check(right + "[[expect]]\nselect = { h = 0.2 }\nnorm_drift = { max = 1 }\n");
  EXPECT_EQ(vacuous.code, 1);
  EXPECT_THAT(vacuous.out, HasSubstr("{h = 0.2}: selects 0 cells, min_cells = 1"));
  EXPECT_EQ(check(right + "xfail = 'not so'\n").code, 1);
  EXPECT_EQ(check("[[expect]]\nselect = {}\nsteps = { max = 1 }\nxfail = 'takes more'\n").code, 0);
}

TEST_F(CliCheck, NothingToJudgeExitsWith3) {
  EXPECT_EQ(check("").code, 3);
  Result const nothing = check("[[expect]]\nselect = { h = 0.2 }\nnorm_drift = { max = 1 }\n");
  EXPECT_EQ(nothing.code, 3);
  EXPECT_THAT(nothing.err, HasSubstr("no expectation selects a cell with a record"));
  folder.write("empty/suite.toml", tiny_suite + right);
  Result const empty = polhode(folder, "check empty");
  EXPECT_EQ(empty.code, 3);
  EXPECT_THAT(empty.err, HasSubstr("holds no records"));
}

TEST_F(CliCheck, BadFilesExitWith5) {
  Result const typo = check("[[expect]]\nselect = {}\nnorm_drfit = { max = 1 }\n");
  EXPECT_EQ(typo.code, 5);
  EXPECT_THAT(typo.err, HasSubstr("results/suite.toml:11: unknown key 'norm_drfit'"));
  EXPECT_EQ(polhode(folder, "check nowhere").code, 5);
  folder.write("golden/tiny.jsonl", "no golden file\n");
  Result const golden = check(right);
  EXPECT_EQ(golden.code, 5);
  EXPECT_THAT(golden.err, HasSubstr("golden/tiny.jsonl:1: "));
  Result const unwritable = check(right, "--junit nowhere/junit.xml");
  EXPECT_EQ(unwritable.code, 5);
}

TEST_F(CliCheck, SecondsAreNeverGated) {
  Result const result = check("[[expect]]\nselect = {}\ncpu_time_s = { max = 1 }\n");
  EXPECT_EQ(result.code, 5);
  EXPECT_THAT(result.err, HasSubstr("seconds are never gated"));
}

TEST_F(CliCheck, FilesForCi) {
  Result const result = check("[[expect]]\nselect = { formulation = 's3' }\nstatus = { is = 'ok' }\n",
                              "--junit junit.xml --markdown summary.md");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(text_of(folder.path / "junit.xml"),
              AllOf(HasSubstr("<testsuites tests=\"1\" failures=\"1\""), HasSubstr("status = refused (")));
  EXPECT_THAT(text_of(folder.path / "summary.md"), HasSubstr("| line | selector | field |"));
}

TEST_F(CliCheck, GoldenColumnsAreWrittenComparedAndChanged) {
  std::string const golden = "[[expect]]\nselect = {}\nevaluations = { golden = true }\nstatus = { golden = true }\n";
  EXPECT_EQ(check(golden).code, 1) << "there are none yet";
  Result const made = check(golden, "--update");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("+ free_body//quaternion/rk4/none/h=0.1\n"), HasSubstr("4 lines, 4 changed")));
  EXPECT_EQ(check(golden).code, 0);
  std::string const committed = text_of(folder.path / "golden/tiny.jsonl");
  EXPECT_THAT(check(golden, "--update").out, HasSubstr("4 lines, 0 changed"));
  EXPECT_EQ(text_of(folder.path / "golden/tiny.jsonl"), committed);

  std::string tampered = committed;
  std::string const now = "\"evaluations\":200";
  ASSERT_NE(tampered.find(now), std::string::npos) << tampered;
  tampered.replace(tampered.find(now), now.size(), "\"evaluations\":300");
  folder.write("golden/tiny.jsonl", tampered);
  Result const off = check(golden);
  EXPECT_EQ(off.code, 1);
  EXPECT_THAT(off.out, HasSubstr("evaluations = 200 (golden 300), must be golden within 2%"));
  EXPECT_THAT(check(golden, "--update").out,
              HasSubstr("~ free_body//quaternion/rk4/none/h=0.1: evaluations 300 -> 200\n"));
  EXPECT_EQ(text_of(folder.path / "golden/tiny.jsonl"), committed);
}

TEST_F(CliCheck, NobodyUpdatesGoldenColumnsInCi) {
  folder.write("results/suite.toml", tiny_suite + right);
  Result const result = polhode(folder, "check results --golden golden --update", {"CI=true"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("--update: not where CI is set"));
  EXPECT_FALSE(fs::exists(folder.path / "golden"));
}

TEST_F(CliCheck, ExportsCsvAndBenchmarkJson) {
  Result const csv = polhode(folder, "export results");
  EXPECT_EQ(csv.code, 0) << csv.err;
  EXPECT_THAT(csv.out, testing::StartsWith("cell,build,problem,variant,formulation,integrator,policy,h,"));
  EXPECT_EQ(std::count(csv.out.begin(), csv.out.end(), '\n'), 5);
  Result const json = polhode(folder, "export results --format benchmark-json --out times.json");
  EXPECT_EQ(json.code, 0) << json.err;
  EXPECT_THAT(json.err, HasSubstr("1 of 4 records left out"));
  auto const rows = nlohmann::json::parse(text_of(folder.path / "times.json")).at("benchmarks");
  EXPECT_EQ(std::ranges::count(rows, "aggregate", [](auto const& row) { return row.at("run_type"); }), 3);
  EXPECT_EQ(rows.size(), 18u) << "a row for each of five repetitions besides";
}

TEST_F(CliCheck, ExportSaysWhatIsWrong) {
  Result const format = polhode(folder, "export results --format cvs");
  EXPECT_EQ(format.code, 2);
  EXPECT_THAT(format.err, HasSubstr("unknown format 'cvs'; did you mean 'csv'?"));
  EXPECT_EQ(polhode(folder, "export nowhere").code, 5);
  fs::create_directory(folder.path / "empty");
  EXPECT_EQ(polhode(folder, "export empty").code, 3);
  EXPECT_EQ(polhode(folder, "export results --out nowhere/a.csv").code, 5);
}

TEST_F(CliCheck, MergesFoldersIntoOneThatCanBeChecked) {
  check(right);  // gives the folder its expectation
  fs::copy(folder.path / "results", folder.path / "again", fs::copy_options::recursive);
  Result const merged = polhode(folder, "merge all results again");
  EXPECT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(merged.out, "all: 4 records from 2 files of 2 folders; 4 repeated runs left out\n");
  EXPECT_EQ(merged.err, "");
  EXPECT_EQ(polhode(folder, "check all --golden golden").code, 0);
  EXPECT_EQ(polhode(folder, "merge all results").code, 5) << "it holds records already";
}

TEST_F(CliCheck, MergeNamesWhatItLeaves) {
  folder.write("results/notes.txt", "ours");
  for (int i = 0; i < 9; ++i) folder.write("results/other" + std::to_string(i), "");
  Result const merged = polhode(folder, "merge all results");
  EXPECT_EQ(merged.code, 0);
  EXPECT_THAT(merged.err, testing::StartsWith("polhode: left where they are: results/notes.txt, results/other0, "));
  EXPECT_THAT(merged.err, testing::EndsWith(", results/other6 and 2 more\n"));
}

TEST_F(CliCheck, MergeRefusesDamageWithItsLine) {
  for (auto const& entry : fs::directory_iterator(folder.path / "results"))
    if (entry.path().extension() == ".jsonl") std::ofstream(entry.path(), std::ios::app) << "damage\n";
  Result const result = polhode(folder, "merge all results");
  EXPECT_EQ(result.code, 5);
  EXPECT_THAT(result.err, HasSubstr(": not JSON (byte 1); a line must be one JSON object"));
  EXPECT_FALSE(fs::exists(folder.path / "all"));
}

}  // namespace
}  // namespace polhode::cli
