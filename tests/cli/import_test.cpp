// `import` and `doctor` as a user meets them.
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<std::string> const contract{
    "schema",         "status",         "points",           "attitude_error_max", "attitude_error_end",
    "rate_error_max", "norm_drift_max", "energy_drift_max", "momentum_drift_max", "momentum_direction_max",
    "reference_bar"};

Json score(Folder const& folder, std::string const& words) {
  Result const result = polhode(folder, "import " + words + " --json");
  EXPECT_EQ(result.code, 0) << words << "\n" << result.err;
  Json json = Json::parse(result.out, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << result.out;
  for (std::string const& key : contract) EXPECT_TRUE(json.contains(key)) << key;
  return json;
}

/// A coarse run of our own, whose errors can be seen.
class CliImport : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared = new Folder;
    Result const result = polhode(*shared, "simulate free_body --integrator rk4 --h 0.25 --every 0.5 --out own.csv");
    ASSERT_EQ(result.code, 0) << result.err;
    plain = score(*shared, "own.csv --problem free_body");
  }
  static void TearDownTestSuite() { delete shared; }

  /// The shared file with its rows (t, q1 ... q4, wx, wy, wz) changed.
  static void write_changed(std::string const& name, std::function<void(std::size_t, std::vector<double>&)> const& f) {
    std::istringstream in(text_of(shared->path / "own.csv"));
    std::ostringstream out;
    out.precision(17);
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
      if (line.empty() || (std::isdigit(static_cast<unsigned char>(line[0])) == 0)) {
        out << line << "\n";
        continue;
      }
      std::vector<double> row;
      std::istringstream fields(line);
      for (std::string field; std::getline(fields, field, ',');) row.push_back(std::stod(field));
      f(number++, row);
      for (std::size_t i = 0; i < row.size(); ++i) out << (i == 0 ? "" : ",") << row[i];
      out << "\n";
    }
    shared->write(name, out.str());
  }
  static void expect_same(Json const& json) {
    for (std::string const key : {"attitude_error_max", "attitude_error_end", "rate_error_max", "norm_drift_max"}) {
      double const a = json.at(key), b = plain.at(key);
      EXPECT_NEAR(a, b, 1e-6 * b + 1e-15) << key;
    }
  }

  static inline Folder* shared = nullptr;
  static inline Json plain;
};

TEST_F(CliImport, ScoresWhatRunMeasures) {
  EXPECT_EQ(plain.at("schema"), 1);
  EXPECT_EQ(plain.at("status"), "ok");
  EXPECT_EQ(plain.at("points"), 101);
  EXPECT_THAT(plain.at("remarks"), IsEmpty());
  EXPECT_LT(plain.at("reference_bar"), 1e-28);
  shared->write("one.toml",
                "name = 'one'\ntiming = { enabled = false }\n[[sweep]]\nproblem = 'free_body'\n"
                "formulation = 'quaternion'\nintegrator = 'rk4'\nh = 0.25\n");
  ASSERT_EQ(polhode(*shared, "run one.toml --out one --fresh").code, 0);
  Json run;
  for (auto const& entry : fs::directory_iterator(shared->path / "one")) {
    if (entry.path().extension() != ".jsonl") continue;
    std::istringstream in(text_of(entry.path()));
    for (std::string line; std::getline(in, line);)
      if (Json const json = Json::parse(line); json.at("kind") == "run") run = json;
  }
  ASSERT_FALSE(run.is_null());
  for (std::string const key : {"attitude_error_end", "rate_error_end", "attitude_error_max", "norm_drift_max",
                                "energy_drift_max", "momentum_drift_max", "momentum_direction_max"}) {
    if (!plain.contains(key)) continue;
    double const imported = plain.at(key), measured = run.at(key);
    EXPECT_GT(imported, 1e-12) << key;
    EXPECT_NEAR(imported, measured, 0.02 * measured) << key;  // every second step of those that the run sees
  }
}

TEST_F(CliImport, TheSignOfAQuaternionIsFree) {
  write_changed("signs.csv", [](std::size_t i, auto& row) {
    for (std::size_t k = 1; k <= 4; ++k) row[k] *= i % 3 == 0 ? -1 : 1;
  });
  expect_same(score(*shared, "signs.csv --problem free_body"));
}

TEST_F(CliImport, OtherReadingsAreFlagsAndWhenForgottenAreNamed) {
  struct Case {
    std::string flag;
    std::function<void(std::size_t, std::vector<double>&)> change;
  };
  auto const scalar_first = [](std::size_t, auto& row) {
    std::rotate(row.begin() + 1, row.begin() + 4, row.begin() + 5);
  };
  auto const inverse = [](std::size_t, auto& row) {
    for (std::size_t k = 1; k <= 3; ++k) row[k] *= -1;
  };
  auto const degrees = [](std::size_t, auto& row) {
    for (std::size_t k = 5; k <= 7; ++k) row[k] *= 180 / std::numbers::pi;
  };
  for (auto const& [flag, change] : {Case{"--scalar first", scalar_first}, Case{"--map inertial-to-body", inverse},
                                     Case{"--rate-unit deg/s", degrees}}) {
    write_changed("other.csv", change);
    Json const right = score(*shared, "other.csv --problem free_body " + flag);
    expect_same(right);
    EXPECT_THAT(right.at("remarks"), IsEmpty()) << flag;
    Json const wrong = score(*shared, "other.csv --problem free_body");
    ASSERT_EQ(wrong.at("remarks").size(), 1U) << wrong;
    EXPECT_THAT(wrong.at("remarks")[0].get<std::string>(), HasSubstr(" far better if read with " + flag)) << flag;
  }
  write_changed("both.csv", [&](std::size_t i, auto& row) {
    inverse(i, row);
    scalar_first(i, row);
  });
  Json const both = score(*shared, "both.csv --problem free_body");
  EXPECT_EQ(both.at("status"), "inaccurate");
  EXPECT_THAT(both.at("remarks").dump(), HasSubstr("--scalar first --map inertial-to-body"));
}

TEST_F(CliImport, AnotherBodyOrStartIsSaid) {
  Json const body = score(*shared, "own.csv --problem free_body --set inertia=1,2,2.5");
  EXPECT_THAT(body.at("remarks").dump(), HasSubstr("are the problem, its --variant and its parameters"));
  Json const start = score(*shared, "own.csv --problem free_body --set omega0=0.1,0.2,0.3");
  EXPECT_THAT(start.at("remarks").dump(), HasSubstr("at 0 s the file is"));
}

TEST_F(CliImport, AnyGridAndAnyEnd) {
  write_changed("cut.csv", [](std::size_t, auto&) {});
  std::string text = text_of(shared->path / "cut.csv");
  std::size_t const at20 = text.find("\n20,"), at31 = text.find("\n31,");
  shared->write("gap.csv", text.substr(0, at20) + text.substr(at31));
  Json const gap = score(*shared, "gap.csv --problem free_body");
  EXPECT_NEAR(gap.at("attitude_error_end"), plain.at("attitude_error_end").get<double>(), 1e-12);
  EXPECT_THAT(gap.at("remarks").dump(), HasSubstr("1 gap(s) in time, the widest of 11.5 s"));
  shared->write("short.csv", text.substr(0, at20));
  Json const early = score(*shared, "short.csv --problem free_body");
  EXPECT_EQ(early.at("points"), 40);
  EXPECT_LT(early.at("attitude_error_max"), plain.at("attitude_error_max"));
  Json const until = score(*shared, "own.csv --problem free_body --t-end 19.5");
  EXPECT_EQ(until.at("points"), 40);
  EXPECT_THAT(until.at("remarks").dump(), HasSubstr("61 row(s) after 19.5 s are left out"));
  EXPECT_EQ(until.at("reference_bar"), plain.at("reference_bar")) << "the committed one of the whole horizon";
}

TEST_F(CliImport, ATableForPeople) {
  Result const result = polhode(*shared, "import own.csv --problem free_body");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("own.csv against free_body: 101 points from 0 s to 50 s\n"),
                                HasSubstr("attitude error, greatest"), HasSubstr("arcsec"), HasSubstr("status")));
}

TEST_F(CliImport, EveryProblemReadsItsOwnColumns) {
  for (std::string const problem : {"tether_capture", "pd_slew", "krogh_b5", "gravity_gradient", "heavy_top"}) {
    Result const made =
        polhode(*shared, "simulate " + problem + " --integrator dopri5 --rtol 1e-9 --t-end 2 --out p.csv");
    ASSERT_EQ(made.code, 0) << made.err;
    Json const json = score(*shared, "p.csv --problem " + problem);
    bool const attitude = problem != "krogh_b5";
    EXPECT_EQ(json.at("attitude_error_max").is_null(), !attitude) << problem;
    EXPECT_LT(json.at(attitude ? "attitude_error_max" : "rate_error_max"), 1e-5) << problem;
  }
}

TEST_F(CliImport, MistakesOnTheCommandLineExitWith2AndInFilesWith5) {
  auto const fails = [&](int code, std::string const& words, std::string const& message) {
    Result const result = polhode(*shared, "import " + words);
    EXPECT_EQ(result.code, code) << words;
    EXPECT_THAT(result.err, HasSubstr(message)) << words;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "") << words;
  };
  fails(2, "own.csv", "--problem is required");
  fails(2, "own.csv --problem free_bdy", "unknown problem 'free_bdy'; did you mean 'free_body'?");
  fails(2, "own.csv --problem free_body --scalar frist", "unknown --scalar 'frist'; did you mean 'first'?");
  fails(2, "own.csv --problem free_body --rate-unit rpm", "choose from rad/s, deg/s");
  fails(2, "own.csv --problem free_body --set inertia=1,1", "inertia");
  fails(5, "nowhere.csv --problem free_body", "nowhere.csv: cannot be read: No such file");
  fails(5, ". --problem free_body", ".: is a directory; give a file");
  fails(5, "/dev/zero --problem free_body", "/dev/zero: is a device; give a file");
  std::string const header = "t,q1,q2,q3,q4,wx,wy,wz\n";
  shared->write("nan.csv", header + "0,0,0,0,1,0,0,0\n1,0,0,0,1,0,nan,0\n");
  fails(5, "nan.csv --problem free_body", "nan.csv:3: column 7 (wy): 'nan' is not finite");
  shared->write("zero.csv", header + "0,0,0,0,1,0,0,0\n1,0,0,0,0,0,0,0\n");
  fails(5, "zero.csv --problem free_body", "zero.csv:3: q1 to q4 are all 0; a quaternion has length 1");
  shared->write("ms.csv", header + "0,0,0,0,1,0,0,0\n50000,0,0,0,1,0,0,0\n");
  fails(5, "ms.csv --problem free_body", "ms.csv:3: t = 50000 s is more than 100 times the horizon of free_body, 50 s");
  shared->write("few.csv", "t,q1,q2,q3,q4\n0,0,0,0,1\n1,0,0,0,1\n");
  fails(5, "few.csv --problem free_body", "few.csv:1: column 'wx' is missing; there must be t, q1, q2, q3, q4, wx");
}

TEST_F(CliImport, AFullDiskIsNoSuccess) {
  Process process(shared->path, split("import own.csv --problem free_body"), {}, "/dev/full");
  Result const result = process.finish();
  EXPECT_EQ(result.code, 5);
  EXPECT_THAT(result.err, HasSubstr("No space left on device"));
}

// ---- doctor ---------------------------------------------------------------------------------------------------------

TEST(CliDoctor, SaysWhatIsBuiltAndExitsWith0) {
  Folder folder;
  Result const result = polhode(folder, "doctor");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (std::string const word : {"compiler", "GNU", "flags", "rivals", "odeint_rk4", "vectors", "timer", "load",
                                 "governor", "processors", "fit to take times on"})
    EXPECT_THAT(result.out, HasSubstr(word));
  EXPECT_TRUE(folder.contents().empty());
}

TEST(CliDoctor, TheSameAsJson) {
  Folder folder;
  Result const result = polhode(folder, "doctor --json");
  EXPECT_EQ(result.code, 0);
  Json const json = Json::parse(result.out);
  EXPECT_EQ(json.at("schema"), 1);
  bool troubles = false;
  for (Json const& finding : json.at("findings")) {
    EXPECT_NE(finding.at("name"), "");
    troubles |= !finding.at("trouble").get_ref<std::string const&>().empty();
  }
  EXPECT_EQ(json.at("fit"), !troubles);
}

TEST(CliDoctor, MissingDataAreTrouble) {
  Folder folder;
  Result const result = polhode(folder, split("doctor"), {"POLHODE_DATA=" + (folder.path / "nothing").string()});
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("!! suites or references are missing"), HasSubstr("not quite fit")));
}

}  // namespace
}  // namespace polhode::cli
