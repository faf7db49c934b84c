// What a machine does to a run: two of them at once, crashes, full disks, read-only folders; and names that would lead
// out of the result folder.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "results/store.hpp"
#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

/// Long enough that nobody waits for its end.
std::string const slow =
    "name = 'slow'\ntiming = { enabled = false }\n[[sweep]]\nproblem = 'free_body'\nformulation = 'quaternion'\n"
    "integrator = 'gauss4'\nh = 2e-6\n";
std::string const quick =
    "[[sweep]]\nproblem = 'free_body'\nformulation = 'quaternion'\nintegrator = ['rk4', 'gauss2']\nh = [0.1, 0.25]\n";

bool wait_for(std::function<bool()> const& what) {
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!what() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return what();
}
/// The text of all record files.
std::string records(fs::path const& folder) {
  std::string text;
  std::error_code none;
  for (auto const& entry : fs::directory_iterator(folder, none))
    if (entry.path().extension() == ".jsonl") text += text_of(entry.path());
  return text;
}
std::vector<Json> runs(fs::path const& folder) {
  std::vector<Json> all;
  std::istringstream in(records(folder));
  for (std::string line; std::getline(in, line) && !in.eof();)
    if (Json json = Json::parse(line); json.at("kind") == "run") all.push_back(std::move(json));
  return all;
}

// ---- Two at once ----------------------------------------------------------------------------------------------------

TEST(CliRobust, ASecondRunInTheSameFolderIsRefusedAndHarmless) {
  Folder folder;
  folder.write("slow.toml", slow);
  Process first(folder.path, split("run slow.toml --out r"));
  ASSERT_TRUE(wait_for([&] { return records(folder.path / "r").find("\"begin\"") != std::string::npos; }));
  std::string const before = records(folder.path / "r");
  for (std::string const flags : {"", " --fresh", " --shard 1/2"}) {
    Result const second = polhode(folder, "run slow.toml --out r" + flags);
    EXPECT_EQ(second.code, 5) << flags;
    EXPECT_EQ(second.err,
              "polhode: r: another process is writing results there; wait for it, or give another folder with "
              "--out\n");
  }
  EXPECT_EQ(records(folder.path / "r"), before);
  first.signal(SIGINT);
  EXPECT_EQ(first.finish().code, 130);
}

TEST(CliRobust, ShardsMayShareAFolder) {
  Folder folder;
  folder.write("two.toml",
               slow + "[[sweep]]\nproblem = 'free_body'\nformulation = 's3'\nintegrator = 'cf4'\nh = 2e-6\n");
  Process one(folder.path, split("run two.toml --out r --shard 1/2"));
  Process two(folder.path, split("run two.toml --out r --shard 2/2"));
  auto const begins = [&] {
    std::string const text = records(folder.path / "r");
    std::size_t count = 0;
    for (std::size_t at = text.find("\"begin\""); at != std::string::npos; at = text.find("\"begin\"", at + 1)) ++count;
    return count;
  };
  EXPECT_TRUE(wait_for([&] { return begins() == 2; }));
  EXPECT_EQ(polhode(folder, "run two.toml --out r --shard 2/2").code, 5);
  one.signal(SIGINT);
  two.signal(SIGINT);
  EXPECT_EQ(one.finish().code, 130);
  EXPECT_EQ(two.finish().code, 130);
}

// ---- Crashes --------------------------------------------------------------------------------------------------------

/// The only child of a process; 0 if it has none.
pid_t child_of(pid_t parent) {
  std::string const task = std::to_string(parent);
  std::string const children = text_of("/proc/" + task + "/task/" + task + "/children");
  return children.empty() ? 0 : pid_t(std::stol(children));
}

TEST(CliRobust, ACrashOfAnIsolatedCellIsARecord) {
  Folder folder;
  folder.write("s.toml", slow + quick);
  Process process(folder.path, split("run s.toml --out r --isolate --threads 1"));
  pid_t child = 0;
  ASSERT_TRUE(wait_for([&] { return (child = child_of(process.pid())) != 0; }));
  ::kill(child, SIGSEGV);
  Result const result = process.finish();
  EXPECT_EQ(result.code, 4) << result.err;
  EXPECT_EQ(result.out, "r: 5 cells: 4 ok, 0 refused, 1 failed, 0 already done\n");
  int crashed = 0;
  for (Json const& run : runs(folder.path / "r")) {
    bool const is_slow = run.at("integrator") == "gauss4";
    EXPECT_EQ(run.at("status"), is_slow ? "crashed" : "ok") << run;
    EXPECT_EQ(run.at("reason"), is_slow ? "its process ended: SIGSEGV" : "") << run;
    crashed += is_slow;
  }
  EXPECT_EQ(crashed, 1);
}

TEST(CliRobust, IsolatedCellsGiveTheSameRecords) {
  Folder folder;
  folder.write("q.toml", "name = 'q'\ntiming = { enabled = false }\n" + quick + "tags = ['history']\n" +
                             "[[sweep]]\nproblem = 'free_body'\nformulation = 's3'\nintegrator = 'rk4'\nh = 0.1\n");
  std::map<std::string, std::set<std::string>> lines;
  for (std::string const out : {"plain", "apart"}) {
    Result const result = polhode(folder, "run q.toml --out " + out + (out == "apart" ? " --isolate" : ""));
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, out + ": 5 cells: 4 ok, 1 refused, 0 failed, 0 already done\n");
    std::istringstream in(records(folder.path / out));
    for (std::string line; std::getline(in, line);)
      if (Json const json = Json::parse(line); json.at("kind") == "run" || json.at("kind") == "series")
        lines[out].insert(line);
  }
  EXPECT_EQ(lines["plain"], lines["apart"]);
  EXPECT_EQ(lines["plain"].size(), 5U + 3 * 4);  // drift, history and invariants of those that ran
}

TEST(CliRobust, AnInterruptEndsIsolatedCells) {
  Folder folder;
  folder.write("s.toml", slow + quick);
  Process process(folder.path, split("run s.toml --out r --isolate --threads 1"));
  pid_t child = 0;
  ASSERT_TRUE(wait_for([&] { return (child = child_of(process.pid())) != 0; }));
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().code, 130);
  EXPECT_TRUE(wait_for([&] { return ::kill(child, 0) != 0; })) << "a child is left";
  EXPECT_TRUE(runs(folder.path / "r").empty());
}

TEST(CliRobust, AKilledRunLeavesNoIsolatedCellBehind) {
  Folder folder;
  folder.write("s.toml", slow);
  Process process(folder.path, split("run s.toml --out r --isolate"));
  pid_t child = 0;
  ASSERT_TRUE(wait_for([&] { return (child = child_of(process.pid())) != 0; }));
  process.signal(SIGKILL);
  EXPECT_EQ(process.finish().code, 128 + SIGKILL);
  auto const gone = [&] {  // or a zombie that nobody reaps
    std::string const stat = text_of("/proc/" + std::to_string(child) + "/stat");
    return stat.empty() || stat.find(") Z ") != std::string::npos;
  };
  EXPECT_TRUE(wait_for(gone)) << "a child is left";
}

TEST(CliRobust, ALimitPerCellHoldsEverywhere) {
  Folder folder;
  folder.write("s.toml", slow + quick);
  for (std::string const flags : {"", " --isolate"}) {
    Result const result = polhode(folder, "run s.toml --fresh --out r --timeout 1" + flags);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, "r: 5 cells: 4 ok, 0 refused, 1 failed, 0 already done\n");
  }
}

// ---- Full disks, read-only folders ----------------------------------------------------------------------------------

/// Files of the processes that are started meanwhile cannot grow beyond a size.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit const now{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FileLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FileLimit(FileLimit const&) = delete;
  FileLimit& operator=(FileLimit const&) = delete;

 private:
  rlimit before_{};
};

std::set<std::string> complete_lines(fs::path const& folder) {
  std::set<std::string> lines;
  std::string const text = records(folder);
  for (std::size_t from = 0, to; (to = text.find('\n', from)) != std::string::npos; from = to + 1)
    lines.insert(text.substr(from, to - from));
  return lines;
}

TEST(CliRobust, AFullDiskLosesNothingThatWasAcknowledged) {
  Folder folder;
  folder.write("many.toml",
               "name = 'many'\ntiming = { enabled = false }\n[[sweep]]\nproblem = 'free_body'\nformulation = "
               "'quaternion'\nintegrator = ['rk4', 'gauss2']\nh = [0.1, 0.2, 0.5]\nt_end = [1, 2, 3, 4]\n");
  Result full;
  {
    FileLimit const limit(40'000);  // the catalogue takes 27 kB
    full = polhode(folder, "run many.toml --out r --threads 1");
  }
  EXPECT_EQ(full.code, 5) << full.out;
  EXPECT_THAT(full.err, AllOf(HasSubstr("polhode: r/run-"), HasSubstr(".jsonl: cannot write: File too large\n")));
  EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
  auto const before = complete_lines(folder.path / "r");
  std::size_t const done = runs(folder.path / "r").size();
  EXPECT_GT(done, 0U);
  EXPECT_LT(done, 24U);
  EXPECT_NO_THROW(results::read(folder.path / "r"));
  Result const rest = polhode(folder, "run many.toml --out r");
  EXPECT_EQ(rest.out, "r: 24 cells: " + std::to_string(24 - done) + " ok, 0 refused, 0 failed, " +
                          std::to_string(done) + " already done\n");
  auto const after = complete_lines(folder.path / "r");
  EXPECT_TRUE(std::ranges::includes(after, before));
  EXPECT_EQ(runs(folder.path / "r").size(), 24U);
}

TEST(CliRobust, AFullDiskBeforeTheFirstRecord) {
  Folder folder;
  folder.write("s.toml", "name = 's'\ntiming = { enabled = false }\n" + quick + "#" + std::string(3000, '-') + "\n");
  for (rlim_t const bytes : {1000U, 8000U}) {  // too little for the suite; for the catalogue
    Result result;
    {
      FileLimit const limit(bytes);
      result = polhode(folder, "run s.toml --out r");
    }
    EXPECT_EQ(result.code, 5) << bytes;
    EXPECT_THAT(result.err, AllOf(HasSubstr("cannot be written"), HasSubstr("File too large"))) << bytes;
  }
  EXPECT_EQ(polhode(folder, "run s.toml --out r").code, 0);
}

TEST(CliRobust, FilesOnAFullDevice) {
  Folder folder;
  for (std::string const words :
       {"simulate free_body --integrator rk4 --h 0.1 --every 0.1 --t-end 1 --out /dev/full", "run default --dry-run"}) {
    Process process(folder.path, split(words), {}, "/dev/full");
    Result const result = process.finish();
    EXPECT_EQ(result.code, 5) << words;
    EXPECT_THAT(result.err, HasSubstr("No space left on device")) << words;
  }
}

TEST(CliRobust, AFolderThatCannotBeWritten) {
  Folder folder;
  folder.write("s.toml", "name = 's'\ntiming = { enabled = false }\n" + quick);
  Result const result = polhode(folder, "run s.toml --out /proc/polhode/r");
  EXPECT_EQ(result.code, 5);
  EXPECT_THAT(result.err, HasSubstr("/proc/polhode/r"));
  // A folder that is there, and in which not even root can make files.
  Result const sealed = polhode(folder, "run s.toml --out /proc/sys");
  EXPECT_EQ(sealed.code, 5);
  EXPECT_THAT(sealed.err, HasSubstr("/proc/sys/suite.toml: cannot be written"));
  if (::geteuid() == 0) GTEST_SKIP() << "root writes everywhere else";
  fs::create_directory(folder.path / "r");
  fs::permissions(folder.path / "r", fs::perms::owner_read | fs::perms::owner_exec);
  Result const denied = polhode(folder, "run s.toml --out r");
  EXPECT_EQ(denied.code, 5);
  EXPECT_THAT(denied.err, HasSubstr("Permission denied"));
  EXPECT_TRUE(fs::is_empty(folder.path / "r"));
  fs::permissions(folder.path / "r", fs::perms::owner_all);
}

// ---- Names ----------------------------------------------------------------------------------------------------------

/// Everything below `folder/inner` but what `allowed` begins with.
void expect_nothing_beside(Folder const& folder, std::string const& allowed) {
  for (auto const& [name, text] : folder.contents())
    EXPECT_TRUE(name == "inner" || name.starts_with("inner/" + allowed) || name.starts_with("inner/given")) << name;
}

TEST(CliRobust, ASuitesNameIsNoPath) {
  for (std::string const name : {"../../evil", "..", "/tmp/polhode-evil", ".lock", "a/../../b"}) {
    Folder folder;
    folder.write("inner/given.toml", "name = '" + name + "'\ntiming = { enabled = false }\n" + quick);
    Result const result = Process(folder.path / "inner", split("run given.toml")).finish();
    EXPECT_EQ(result.code, 0) << result.err;
    expect_nothing_beside(folder, "polhode-results");
    EXPECT_FALSE(fs::exists("/tmp/polhode-evil"));
    int made = 0;
    for (auto const& entry : fs::directory_iterator(folder.path / "inner/polhode-results"))
      made += entry.is_directory();
    EXPECT_EQ(made, 1) << name;
  }
}

TEST(CliRobust, AGraphFromElsewhereIsCopiedByItsName) {
  Folder folder;
  folder.write("graph.txt", "1 2 1\n2 3 1\n3 1 1\n");
  folder.write("inner/given.toml",
               "name = 'g'\ntiming = { enabled = false }\n[[sweep]]\nproblem = 'quaternion_sync'\nformulation = "
               "'quaternion'\nintegrator = 'rk4'\nh = 0.1\nt_end = 0.2\nreference = false\n"
               "set = { n = 3, graph = '../graph.txt' }\n");
  Result const result = Process(folder.path / "inner", split("run given.toml --out r")).finish();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(text_of(folder.path / "inner/r/graph.txt"), text_of(folder.path / "graph.txt"));
  // ... and goes along when folders are merged: without it the suite there could not be read.
  EXPECT_EQ(Process(folder.path / "inner", split("merge m r")).finish().code, 0);
  EXPECT_EQ(text_of(folder.path / "inner/m/graph.txt"), text_of(folder.path / "graph.txt"));
  EXPECT_EQ(Process(folder.path / "inner", split("check m")).finish().code, 3) << "no [[expect]] is all that is wrong";
}

TEST(CliRobust, AGraphDoesNotReplaceWhatARunWrites) {
  for (std::string const name : {"suite.toml", "catalogue.json", "run-1.jsonl"}) {
    Folder folder;
    folder.write(name, "1 2 1\n2 3 1\n3 1 1\n");
    folder.write("given.toml",
                 "name = 'g'\ntiming = { enabled = false }\n[[sweep]]\nproblem = 'quaternion_sync'\nintegrator = "
                 "'rk4'\nh = 0.1\nset = { n = 3, graph = '" +
                     name + "' }\n");
    Result const result = polhode(folder, "run given.toml --out r");
    EXPECT_EQ(result.code, 5);
    EXPECT_EQ(result.err,
              "polhode: given.toml:7: parameter graph: a result folder, where it is copied to, cannot hold "
              "a graph called '" +
                  name + "'; rename it, e.g. graph.txt\n");
    EXPECT_FALSE(fs::exists(folder.path / "r"));
  }
}

TEST(CliRobust, RecordsWithPathsForNamesStayInTheReport) {
  Folder folder;
  std::string const evil = "../../../evil/$(touch evil)`touch evil`|;'\"";
  fs::create_directories(folder.path / "inner/r");
  fs::create_directories(folder.path / "inner/report");
  {
    results::Writer writer(folder.path / "inner/r/run-1.jsonl", {{"build", "b"}, {"suite", evil}, {"utc", evil}});
    for (double const h : {0.1, 0.2, 0.4}) {
      results::Record record;
      record.of = {.problem = evil,
                   .variant = evil,
                   .formulation = evil,
                   .integrator = evil,
                   .policy = evil,
                   .h = h,
                   .rtol = {},
                   .atol = {},
                   .set = {{evil, {1}}},
                   .seed = 1,
                   .t_end = 1};
      record.cell = results::cell_id(record.of);
      record.build = "b";
      record.norm_drift_max = record.norm_drift_raw_max = h;
      record.attitude_error_max = record.attitude_error_end = h * h;
      record.evaluations = record.steps = int(10 / h);
      record.claims[evil] = {1, 2, evil};
      record.reference = evil;
      writer.series(
          {.cell = record.cell, .name = evil, .columns = {"t", evil}, .units = {"s", ""}, .rows = {{0, 1}, {1, 2}}});
      writer.run(record);
    }
  }
  for (std::string const words : {"report r --out report", "export r --format csv --out report/x.csv",
                                  "export r --format benchmark-json --out report/x.json", "merge report/merged r"}) {
    Result const result = Process(folder.path / "inner", split(words)).finish();
    bool const untimed = words.find("benchmark-json") != std::string::npos;
    EXPECT_EQ(result.code, untimed ? 3 : 0) << words << ": " << result.err;
  }
  for (auto const& [name, text] : folder.contents()) {
    EXPECT_TRUE(name == "inner" || name.starts_with("inner/r")) << name;
    EXPECT_EQ(name.find("touch"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace polhode::cli
