// `run` and `report`: what is written, what is run again, and what a kill or an interrupt leaves.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "results/store.hpp"
#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Json = nlohmann::json;

/// 4 cells in one group: 3 run and 1 is refused.
std::string suite(std::string const& timing) {
  return "name = 'tiny'\n[timing]\n" + timing +
         "\n[[sweep]]\nproblem = 'free_body'\nformulation = 'quaternion'\nintegrator = ['rk4', 'gauss2', 'dopri5']\n"
         "h = 0.1\nt_end = 5\n"
         "[[sweep]]\nproblem = 'free_body'\nformulation = 's3'\nintegrator = 'rk4'\nh = 0.1\nt_end = 5\n";
}
std::string const untimed = suite("enabled = false");
std::string const timed = suite("min_time = 0.001\nrepetitions = 3");

/// 8 cells in each of 6 groups, one group after the other: long enough to be stopped on the way.
std::string const long_suite =
    "name = 'long'\n[timing]\nenabled = false\n[[sweep]]\nproblem = 'free_body'\nformulation = 'quaternion'\n"
    "integrator = ['rk4', 'gauss4']\nh = [0.02, 0.04, 0.05, 0.1]\n"
    "t_end = [1, 2, 3, 4, 5, 6]\n";
constexpr std::size_t long_cells = 48;

/// Every line of kind `run` in all files of a result folder.
std::vector<Json> runs_in(fs::path const& folder) {
  std::vector<Json> runs;
  if (!fs::is_directory(folder)) return runs;
  for (auto const& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".jsonl") continue;
    std::istringstream in(text_of(entry.path()));
    for (std::string line; std::getline(in, line) && !in.eof();) {
      Json json = Json::parse(line);
      if (json.at("kind") == "run") runs.push_back(std::move(json));
    }
  }
  return runs;
}

/// The fields that do not depend on the machine's speed, by cell. Expects no cell twice.
std::map<std::string, Json> deterministic(fs::path const& folder) {
  std::map<std::string, Json> cells;
  for (Json run : runs_in(folder)) {
    for (std::string const key : {"cpu_time_s", "allocations_per_step"}) run.erase(key);
    std::string const cell = run.at("cell");
    EXPECT_TRUE(cells.emplace(cell, std::move(run)).second) << cell << " is there twice";
  }
  return cells;
}

std::string run_of(Folder const& folder, std::string const& words) {
  Result const result = polhode(folder, "run " + words);
  EXPECT_EQ(result.code, 0) << words << "\n" << result.err;
  EXPECT_EQ(result.err, "") << words;  // the progress bar is for terminals
  return result.out;
}

TEST(CliRun, WritesOnceAndSkipsWhatIsDone) {
  Folder folder;
  folder.write("tiny.toml", untimed);
  EXPECT_EQ(run_of(folder, "tiny.toml"), "polhode-results/tiny: 4 cells: 3 ok, 1 refused, 0 failed, 0 already done\n");
  fs::path const results = folder.path / "polhode-results/tiny";
  EXPECT_EQ(text_of(results / "suite.toml"), untimed);
  EXPECT_EQ(text_of(results / "catalogue.json"), polhode(folder, "list integrators --json").out);
  auto const first = deterministic(results);
  EXPECT_EQ(first.size(), 4U);
  for (auto const& [cell, run] : first) {
    bool const refused = run.at("formulation") == "s3";
    EXPECT_EQ(run.at("status"), refused ? "refused" : "ok") << run;
    EXPECT_EQ(run.at("reason"), refused ? "needs flat coordinates" : "") << run;
  }
  for (Json const& run : runs_in(results)) EXPECT_TRUE(run.at("cpu_time_s").is_null()) << run;

  auto const before = folder.contents();
  EXPECT_EQ(run_of(folder, "tiny.toml"), "polhode-results/tiny: 4 cells: 0 ok, 0 refused, 0 failed, 4 already done\n");
  EXPECT_EQ(folder.contents(), before);

  EXPECT_EQ(run_of(folder, "tiny.toml --fresh"),
            "polhode-results/tiny: 4 cells: 3 ok, 1 refused, 0 failed, 0 already done\n");
  EXPECT_EQ(deterministic(results), first);
}

TEST(CliRun, FilterRunsPartAndTheRestLater) {
  Folder folder;
  folder.write("tiny.toml", untimed);
  EXPECT_EQ(run_of(folder, "tiny.toml --out r --filter /rk4/"),
            "r: 2 cells: 1 ok, 1 refused, 0 failed, 0 already done\n");
  EXPECT_EQ(run_of(folder, "tiny.toml --out r"), "r: 4 cells: 2 ok, 0 refused, 0 failed, 2 already done\n");
  EXPECT_EQ(deterministic(folder.path / "r").size(), 4U);
}

TEST(CliRun, ShardsAreDisjointAndTogetherTheWhole) {
  Folder folder;
  folder.write("tiny.toml", timed);
  EXPECT_EQ(run_of(folder, "tiny.toml --out a --shard 1/2"), "a: 2 cells: 2 ok, 0 refused, 0 failed, 0 already done\n");
  EXPECT_EQ(run_of(folder, "tiny.toml --out a --shard 2/2"), "a: 2 cells: 1 ok, 1 refused, 0 failed, 0 already done\n");
  EXPECT_EQ(run_of(folder, "tiny.toml --out a"), "a: 4 cells: 0 ok, 0 refused, 0 failed, 4 already done\n");
}

TEST(CliRun, DryRunWritesNothing) {
  Folder folder;
  folder.write("tiny.toml", timed);
  auto const before = folder.contents();
  std::string const out = run_of(folder, "tiny.toml --dry-run");
  EXPECT_EQ(std::count(out.begin(), out.end(), '\n'), 5) << out;
  EXPECT_NE(out.find("\n4 cells, about "), std::string::npos) << out;
  EXPECT_NE(out.find(" free_body//quaternion/gauss2/none h=0.1\n"), std::string::npos) << out;
  EXPECT_NE(out.find(" free_body//s3/rk4/none h=0.1  refused: needs flat coordinates\n"), std::string::npos) << out;
  EXPECT_EQ(folder.contents(), before);
}

TEST(CliRun, TimesAndThreadsDoNotChangeTheNumbers) {
  Folder folder;
  folder.write("tiny.toml", untimed);
  folder.write("timed.toml", timed);
  run_of(folder, "tiny.toml --out one --threads 1");
  run_of(folder, "tiny.toml --out two --threads 2");
  run_of(folder, "timed.toml --out timed");
  auto const one = deterministic(folder.path / "one");
  EXPECT_EQ(one.size(), 4U);
  EXPECT_EQ(deterministic(folder.path / "two"), one);
  EXPECT_EQ(deterministic(folder.path / "timed"), one);
  for (Json const& run : runs_in(folder.path / "timed")) {
    Json const& time = run.at("cpu_time_s");
    EXPECT_EQ(time.is_null(), run.at("status") == "refused") << run;
    if (time.is_null()) continue;
    EXPECT_GT(time.at("low"), 0) << run;
    EXPECT_LE(time.at("low"), time.at("median")) << run;
    EXPECT_LE(time.at("median"), time.at("high")) << run;
    EXPECT_EQ(time.at("repetitions"), 3) << run;
    EXPECT_EQ(run.at("allocations_per_step"), 0) << run;
  }
}

TEST(CliRun, ADivergedCellIsARecord) {
  Folder folder;
  folder.write(
      "wild.toml",
      "name = 'wild'\n[timing]\nenabled = false\n[[sweep]]\nproblem = 'free_body'\nformulation = "
      "'quaternion'\nintegrator = 'rk4'\nh = [1e-5, 0.005]\nt_end = 0.005\nset = { omega0 = [1000, 2000, 3000] }\n");
  EXPECT_EQ(run_of(folder, "wild.toml --out r").substr(0, 11), "r: 2 cells:");
  for (Json const& run : runs_in(folder.path / "r")) EXPECT_EQ(run.at("h") == 0.005, run.at("status") != "ok") << run;
}

// ---- Stopped on the way ---------------------------------------------------------------------------------------------

/// Starts the long suite, and sends a signal once the first record is there.
Result stopped_by(int signal, Folder const& folder) {
  Process process(folder.path, split("run long.toml --out r --threads 1"));
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (runs_in(folder.path / "r").empty() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  process.signal(signal);
  return process.finish();
}

/// The same command completes the folder, and the numbers are those of a run in one go.
void expect_resumes(Folder const& folder) {
  std::size_t const done = runs_in(folder.path / "r").size();
  EXPECT_GT(done, 0U);
  EXPECT_LT(done, long_cells);
  std::string const missing = std::to_string(long_cells - done);
  EXPECT_EQ(run_of(folder, "long.toml --out r"),
            "r: 48 cells: " + missing + " ok, 0 refused, 0 failed, " + std::to_string(done) + " already done\n");
  run_of(folder, "long.toml --out whole");
  auto const whole = deterministic(folder.path / "whole");
  EXPECT_EQ(whole.size(), long_cells);
  EXPECT_EQ(deterministic(folder.path / "r"), whole);
  EXPECT_TRUE(results::read(folder.path / "r").unfinished.empty());
}

TEST(CliRun, KilledRunGoesOn) {
  Folder folder;
  folder.write("long.toml", long_suite);
  Result const result = stopped_by(SIGKILL, folder);
  EXPECT_EQ(result.code, 128 + SIGKILL);
  expect_resumes(folder);
}

TEST(CliRun, InterruptedRunGoesOn) {
  Folder folder;
  folder.write("long.toml", long_suite);
  Result const result = stopped_by(SIGINT, folder);
  EXPECT_EQ(result.code, 130);
  EXPECT_EQ(result.err, "polhode: interrupted; the same command goes on from here\n");
  expect_resumes(folder);
}

// ---- Terminal -------------------------------------------------------------------------------------------------------

TEST(CliRun, ProgressOnATerminal) {
  int const master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(master, 0);
  ASSERT_EQ(::grantpt(master) | ::unlockpt(master), 0);
  std::string const terminal = ::ptsname(master);
  int const keep_open = ::open(terminal.c_str(), O_RDWR | O_NOCTTY);
  Folder folder;
  folder.write("tiny.toml", untimed);
  Result const result = Process(folder.path, split("run tiny.toml --out r"), {}, {}, terminal).finish();
  EXPECT_EQ(result.code, 0);
  std::string shown(4096, '\0');
  shown.resize(std::size_t(std::max<ssize_t>(0, ::read(master, shown.data(), shown.size()))));
  ::close(keep_open);
  ::close(master);
  EXPECT_NE(shown.find("free_body: accuracy"), std::string::npos) << shown;
  EXPECT_NE(shown.find('%'), std::string::npos) << shown;
  EXPECT_TRUE(shown.ends_with("\r\033[K")) << shown;  // it wipes itself off
}

// ---- report ---------------------------------------------------------------------------------------------------------

TEST(CliReport, WritesPageTablesAndFigures) {
  Folder folder;
  folder.write("tiny.toml", timed);
  run_of(folder, "tiny.toml --out r");
  for (std::string const words : {"report r", "report r --out elsewhere"}) {
    Result const result = polhode(folder, words);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    fs::path const out = words == "report r" ? "r/report" : "elsewhere";
    EXPECT_EQ(result.out, (out / "report.html").string() + "\n");
    for (std::string const name : {"report.md", "report.html"}) {
      std::string const text = text_of(folder.path / out / name);
      for (std::string const word : {"gauss2", "needs flat coordinates"})
        EXPECT_NE(text.find(word), std::string::npos) << name << ": " << word;
    }
    for (std::string const name : {"tables", "figures"}) EXPECT_FALSE(fs::is_empty(folder.path / out / name)) << name;
  }
  EXPECT_EQ(deterministic(folder.path / "r").size(), 4U);  // the results are left alone
}

}  // namespace
}  // namespace polhode::cli
