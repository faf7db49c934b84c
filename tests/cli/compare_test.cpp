// `compare` and `simulate --plot` as a user meets them: exit codes, files, and no colour codes in a pipe.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "tests/cli/results.hpp"

namespace polhode::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

/// The folder of results that every test compares with.
class CliCompare : public TinyResults {
 protected:
  void SetUp() override {
    for (char const* name : {"a", "b"}) copy_results_to(name);
  }
  /// Applies f to every run in b.
  void change(std::function<void(Json&)> const& f) const {
    for (auto const& entry : fs::directory_iterator(folder.path / "b")) {
      if (entry.path().extension() != ".jsonl") continue;
      std::istringstream in(text_of(entry.path()));
      std::string out;
      for (std::string line; std::getline(in, line);) {
        Json json = Json::parse(line);
        if (json["kind"] == "run" || json["kind"] == "meta") f(json);
        out += json.dump() + "\n";
      }
      std::ofstream(entry.path(), std::ios::binary) << out;
    }
  }
};

void spoil(Json& json) {
  if (json["kind"] == "run" && json["integrator"] == "rk4" && json["status"] == "ok")
    json["attitude_error_max"] = 10 * json["attitude_error_max"].get<double>();
}

TEST_F(CliCompare, ASetAndItselfAreTheSame) {
  Result const result = polhode(folder, "compare a b --fail-on-regression");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("# Polhode: comparison"), HasSubstr("4 cells are in both."),
                                HasSubstr("Every cell ended as before."), HasSubstr("## Times"),
                                Not(HasSubstr("not compared")), Not(HasSubstr("\033"))));
}

TEST_F(CliCompare, ARecordFileServesAsWell) {
  fs::path file;
  for (auto const& entry : fs::directory_iterator(folder.path / "b"))
    if (entry.path().extension() == ".jsonl") file = entry.path();
  EXPECT_EQ(polhode(folder, {"compare", "a", file.string()}).code, 0);
}

TEST_F(CliCompare, ARegressionExitsWith1WhereThatIsAskedFor) {
  change(spoil);
  Result const result = polhode(folder, "compare a b");
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, HasSubstr("| attitude_error_max |"));
  EXPECT_THAT(result.out, HasSubstr("\\+1.00 digits | worse |"));
  EXPECT_EQ(polhode(folder, "compare a b --fail-on-regression").code, 1);
  EXPECT_EQ(polhode(folder, "compare b a --fail-on-regression").code, 0) << "better is no regression";
  EXPECT_EQ(polhode(folder, "compare a b --fail-on-regression --digits 2").code, 0);
}

TEST_F(CliCompare, AStatusThatIsWorseIsShownFirst) {
  change([](Json& json) {
    if (json["kind"] == "run" && json["integrator"] == "gauss2") json["status"] = "diverged";
  });
  Result const result = polhode(folder, "compare a b --fail-on-regression");
  EXPECT_EQ(result.code, 1);
  EXPECT_LT(result.out.find("| diverged | worse |"), result.out.find("## Errors and counts")) << result.out;
}

TEST_F(CliCompare, OtherMachinesAreNotTimed) {
  change([](Json& json) {
    if (json["kind"] == "meta") json["cpu_model"] = "another";
  });
  EXPECT_THAT(polhode(folder, "compare a b").out, HasSubstr("Times are not compared: the machines differ: "));
}

TEST_F(CliCompare, FilesByTheirNames) {
  change(spoil);
  Result const result = polhode(folder, "compare a b --out c.md --out c.html --json c.json --html d.html");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, "") << "it is in the files";
  EXPECT_THAT(text_of(folder.path / "c.md"), HasSubstr("# Polhode: comparison"));
  EXPECT_EQ(text_of(folder.path / "c.html"), text_of(folder.path / "d.html"));
  EXPECT_THAT(text_of(folder.path / "c.html"), HasSubstr("</html>"));
  Json const json = Json::parse(text_of(folder.path / "c.json"));
  EXPECT_EQ(json.at("regressed"), true);
  EXPECT_EQ(json.at("common"), 4);
}

TEST_F(CliCompare, ColoursOnlyWhereTheyAreForced) {
  change(spoil);
  EXPECT_THAT(polhode(folder, "compare a b --format text").out, Not(HasSubstr("\033")));
  EXPECT_THAT(polhode(folder, "compare a b --format text", {"CLICOLOR_FORCE=1"}).out,
              HasSubstr("\033[31mworse\033[0m"));
  EXPECT_THAT(polhode(folder, "compare a b --format text", {"CLICOLOR_FORCE=1", "NO_COLOR=1"}).out,
              Not(HasSubstr("\033")));
}

TEST_F(CliCompare, Mistakes) {
  folder.write("empty/x.txt", "");
  folder.write("other.toml", tiny_suite + "\n[[exclude]]\nh = 0.1\n");
  struct Mistake {
    std::string words;
    int code;
    std::string message;
  };
  for (Mistake const& m :
       std::vector<Mistake>{{"compare a", 2, "B is required"},
                            {"compare a b --format pdf", 2, "unknown format 'pdf'"},
                            {"compare a b --out c.xyz", 2, "--out 'c.xyz': end its name in .md, .html, .json or .txt"},
                            {"compare a b --digits -1", 2, "--digits = -1: must be a number from 0 on"},
                            {"compare a missing", 5, "missing: "},
                            {"compare a empty", 3, "empty: holds no records"},
                            {"compare a b --out missing/c.md", 5, "missing/c.md: cannot be written"}}) {
    Result const result = polhode(folder, m.words);
    EXPECT_EQ(result.code, m.code) << m.words << "\n" << result.err;
    EXPECT_THAT(result.err, HasSubstr(m.message));
    EXPECT_EQ(result.out, "") << m.words;
  }
}

TEST_F(CliCompare, NothingInCommonExitsWith3) {
  change([](Json& json) { json.erase("nothing"); });
  folder.write("far.toml", std::string(tiny_suite).replace(tiny_suite.find("h = 0.1"), 7, "h = 0.05"));
  ASSERT_EQ(polhode(folder, "run far.toml --out far").code, 0);
  Result const result = polhode(folder, "compare a far");
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr("a and far have no cell in common"));
}

// ---- simulate --plot ------------------------------------------------------------------------------------------------

bool have_gnuplot() {
  return fs::exists("/usr/bin/gnuplot");
}

TEST(CliPlot, ThePictureStandsBesideTheCsv) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Folder const folder;
  Result const result =
      polhode(folder, "simulate tether_capture --integrator rk4 --h 0.1 --out run.csv --plot run.svg");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out + result.err, "");
  EXPECT_THAT(text_of(folder.path / "run.svg"),
              AllOf(HasSubstr("</svg>"), HasSubstr("angle from the start [deg]"), HasSubstr("tether_capture")));
  EXPECT_FALSE(text_of(folder.path / "run.csv").empty());
  EXPECT_EQ(folder.contents().size(), 2u);
}

TEST(CliPlot, WithoutGnuplotTheCsvIsWrittenAllTheSame) {
  Folder const folder;
  Result const result =
      polhode(folder, "simulate free_body --integrator rk4 --h 0.1 --t-end 10 --plot run.svg", {"PATH=/nowhere"});
  EXPECT_EQ(result.code, 5);
  EXPECT_EQ(result.err, "polhode: run.svg: not drawn: gnuplot is not on the PATH\n");
  EXPECT_THAT(result.out, HasSubstr("# status ok"));
  EXPECT_TRUE(folder.contents().empty());
}

TEST(CliPlot, ANameThatIsNoPictureIsRefusedBeforeTheRun) {
  Folder const folder;
  Result const result = polhode(folder, "simulate free_body --integrator rk4 --h 0.1 --plot run.png");
  EXPECT_EQ(result.code, 2);
  EXPECT_EQ(result.err, "polhode: --plot 'run.png': write FILE.svg or FILE.pdf\n");
  EXPECT_EQ(result.out, "");
}

}  // namespace
}  // namespace polhode::cli
