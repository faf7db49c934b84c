// The command under mpirun: results do not depend on the number of ranks, a rank that dies costs nothing that was
// acknowledged, and what goes wrong is told once, with its exit code.
#include <gmock/gmock.h>

#include "tests/cli/stopping.hpp"

namespace polhode::cli::stopping {
namespace {

/// 2 groups, 36 cells, some of them refused, of about 20 ms each: long enough to be killed in.
std::string const ranked_suite =
    "name = 'ranked'\n[timing]\nenabled = false\n"
    "[[sweep]]\nproblem = 'free_body'\nformulation = ['quaternion', 's3']\n"
    "integrator = ['rk4', 'gauss2', 'cf4']\nh = [0.0004, 0.0005, 0.00025]\nt_end = [1, 2]\n";

Words under_mpirun(int ranks, std::string const& command) {
  Words words = split("--allow-run-as-root --oversubscribe -n");
  words.push_back(std::to_string(ranks));
  words.emplace_back(POLHODE_BINARY);
  for (std::string const& word : split(command)) words.push_back(word);
  return words;
}
Result mpirun(Folder const& folder, Words const& words) {
  return Process(folder.path, words, {}, {}, {}, "mpirun").finish(std::chrono::seconds(120));
}
Result mpirun(Folder const& folder, int ranks, std::string const& command) {
  return mpirun(folder, under_mpirun(ranks, command));
}

int count(std::string const& text, std::string const& word) {
  int times = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++times;
  return times;
}

std::map<std::string, Json> runs_in(fs::path const& folder) {
  return held_in(complete_lines(folder)).runs;
}

/// Skips, with the reason, where there is nothing to test; else a folder with the suite and its run by one process.
class CliMpi : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Folder empty;
    std::string const doctor = polhode(empty, "doctor").out;
    if (doctor.find("Open MPI") == std::string::npos) why_not = "this polhode is built without Open MPI";
    if (std::system("mpirun --version > /dev/null 2>&1") != 0) why_not = "there is no mpirun";
    if (!why_not.empty()) return;
    shared = new Folder;
    shared->write("ranked.toml", ranked_suite);
    Result const alone = polhode(*shared, "run ranked.toml --out alone");
    ASSERT_EQ(alone.code, 0) << alone.err;
    whole = runs_in(shared->path / "alone");
    said = alone.out.substr(std::string("alone").size());
    ASSERT_EQ(whole.size(), 36U);
  }
  static void TearDownTestSuite() { delete shared; }
  void SetUp() override {
    if (!why_not.empty()) GTEST_SKIP() << why_not;
    folder.write("ranked.toml", ranked_suite);
  }
  static inline std::string why_not;
  static inline Folder* shared = nullptr;
  static inline std::map<std::string, Json> whole;
  static inline std::string said;  ///< what it printed, after the name of the folder
  Folder folder;
};

TEST_F(CliMpi, ResultsAreThoseOfOneProcessBitForBit) {
  for (int const ranks : {1, 2, 4}) {
    std::string const out = "r" + std::to_string(ranks);
    Result const result = mpirun(folder, ranks, "run ranked.toml --out " + out);
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(result.out, out + said);
    EXPECT_EQ(runs_in(folder.path / out), whole) << ranks << " ranks";
    Files const files = complete_lines(folder.path / out);
    EXPECT_LE(files.size(), std::size_t(ranks));
    if (ranks == 1) continue;
    EXPECT_GE(files.size(), 2U) << "a file for each rank that worked";
    for (auto const& [name, text] : files) {
      Json const meta = lines_of(text).front();
      EXPECT_EQ(meta.at("ranks"), std::to_string(ranks));
      EXPECT_EQ(meta.at("ranks_on_node"), std::to_string(ranks));
      EXPECT_EQ(meta.at("timing_valid"), "false");
      EXPECT_NE(meta.at("host"), "");
      for (Json const& line : lines_of(text)) EXPECT_TRUE(line.value("cpu_time_s", Json()).is_null()) << line;
    }
  }
  EXPECT_EQ(polhode(folder, "merge all r2").code, 0);
  EXPECT_EQ(runs_in(folder.path / "all"), whole);
  Result const idle = mpirun(folder, 3, "run ranked.toml --out r2");
  EXPECT_EQ(idle.out, "r2: 36 cells: 0 ok, 0 refused, 0 failed, 36 already done\n") << idle.err;
}

TEST_F(CliMpi, StatisticsOfAnEnsembleAreThoseOfOneProcessBitForBit) {
  // 3 items of 8192 samples, the last one short.
  std::string const command =
      "ensemble pd_slew --integrator rk4 --h 0.05 --t-end 10 --samples 20000 --seed 5 --disperse omega0=normal(0,0.05)";
  auto const in = [&](std::string const& out) { return " --out " + out + " --raw " + out + ".csv"; };
  auto const told = [&](std::string const& out) {
    Json all = Json::parse(text_of(folder.path / out / "ensemble.json"));
    for (std::string const key : {"timing", "provenance"}) EXPECT_EQ(all.erase(key), 1U);
    return all;
  };
  ASSERT_EQ(polhode(folder, command + in("alone") + " --threads 2").code, 0);
  for (int const ranks : {1, 2, 4}) {
    std::string const out = "r" + std::to_string(ranks);
    Result const result = mpirun(folder, ranks, command + in(out) + " --threads 1");
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(told(out), told("alone")) << ranks << " ranks";
    EXPECT_EQ(text_of(folder.path / (out + ".csv")), text_of(folder.path / "alone.csv")) << ranks << " ranks";
  }
}

TEST_F(CliMpi, MistakesAreToldOnceWithTheirExitCode) {
  folder.write("bad.toml", "name = 'bad'\n[[sweep]]\nproblem = 'free_body'\nintegrator = 'rk5'\nh = 0.1\n");
  struct Mistake {
    std::string command;
    int code;
    std::string message;
  };
  for (Mistake const& mistake :
       {Mistake{"run --frobnicate", 2, "polhode: unknown flag '--frobnicate'"},
        Mistake{"run ranked.toml --filter zzz", 3, "matches no cell"}, Mistake{"run bad.toml", 5, "bad.toml:4: "}}) {
    Result const result = mpirun(folder, 3, mistake.command);
    EXPECT_EQ(result.code, mistake.code) << mistake.command << result.err;
    EXPECT_EQ(count(result.err, "polhode: "), 1) << result.err;
    EXPECT_EQ(count(result.err, mistake.message), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }
}

TEST_F(CliMpi, AFailureOfOneRankEndsAll) {
  Words words = under_mpirun(1, "run ranked.toml --out r");
  words.emplace_back(":");
  for (std::string const& word : under_mpirun(2, "run ranked.toml --out nowhere/r")) words.push_back(word);
  Result const result = mpirun(folder, words);
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_EQ(count(result.err, "polhode: "), 1) << result.err;
  EXPECT_EQ(count(result.err, "cannot open: No such file or directory (rank "), 1) << result.err;
}

// ---- Ranks that die -------------------------------------------------------------------------------------------------

/// The ranks that a launcher has started: its children, whichever of its threads made them, once they are polhode.
std::vector<pid_t> ranks_of(pid_t launcher) {
  std::vector<pid_t> ranks;
  std::error_code gone;
  for (auto const& thread : fs::directory_iterator("/proc/" + std::to_string(launcher) + "/task", gone)) {
    std::istringstream in(text_of(thread.path() / "children"));
    for (pid_t child = 0; in >> child;)
      if (fs::read_symlink("/proc/" + std::to_string(child) + "/exe", gone) == POLHODE_BINARY) ranks.push_back(child);
  }
  return ranks;
}

/// Starts 4 ranks and kills one of them, once a random part of all records is there. False if they were faster.
bool kill_one_of_four(Folder const& folder, std::mt19937& random, Files& seen) {
  Process job(folder.path, under_mpirun(4, "run ranked.toml --out r"), {}, {}, {}, "mpirun");
  std::size_t const wanted = held_in(seen).runs.size() + random() % 20;
  auto const late = Clock::now() + std::chrono::seconds(60);
  bool started = false;
  while (held_in(complete_lines(folder.path / "r")).runs.size() < wanted && Clock::now() < late) {
    bool const there = !ranks_of(job.pid()).empty();
    if (started && !there) break;
    started = there;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(random() % 20));
  seen = complete_lines(folder.path / "r");  // acknowledged, whatever happens now
  std::vector<pid_t> const ranks = ranks_of(job.pid());
  if (!ranks.empty()) ::kill(ranks.at(random() % ranks.size()), SIGKILL);
  return job.finish(std::chrono::seconds(60)).code != 0;
}

void kills_of_ranks_lose_nothing(int wanted, unsigned seed, std::map<std::string, Json> const& whole) {
  std::mt19937 random(seed);
  int kills = 0;
  for (int life = 0; kills < wanted && life < 4 * wanted; ++life) {
    Folder folder;
    folder.write("ranked.toml", ranked_suite);
    Files seen;
    for (int times = 0; times < 2 && kills < wanted; ++times) {
      if (!kill_one_of_four(folder, random, seen)) break;
      ++kills;
      Files const now = complete_lines(folder.path / "r");
      for (auto const& [name, text] : seen)
        EXPECT_TRUE(now.contains(name) && now.at(name).starts_with(text)) << name << " lost lines";
      for (auto const& [cell, run] : held_in(now).runs) EXPECT_EQ(run, whole.at(cell));
      seen = now;
    }
    int const ranks = 1 + life % 4;  // any number
    Result const rest = mpirun(folder, ranks, "run ranked.toml --out r");
    EXPECT_EQ(rest.code, 0) << rest.err;
    EXPECT_EQ(runs_in(folder.path / "r"), whole) << "after " << kills << " kills, by " << ranks << " ranks";
    EXPECT_TRUE(results::read(folder.path / "r").unfinished.empty());
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_EQ(kills, wanted);
}

TEST_F(CliMpi, AKilledRankLosesNothing) {
  kills_of_ranks_lose_nothing(1, 2025, whole);
}
TEST_F(CliMpi, ManyKilledRanksLoseNothing) {
  if (std::getenv("POLHODE_FULL") == nullptr) GTEST_SKIP() << "minutes; POLHODE_FULL=1 runs it";
  kills_of_ranks_lose_nothing(20, 4712, whole);
}

TEST_F(CliMpi, AnInterruptEndsAllAndTheRestIsDoneLater) {
  Process job(folder.path, under_mpirun(2, "run ranked.toml --out r"), {}, {}, {}, "mpirun");
  auto const late = Clock::now() + std::chrono::seconds(60);
  while (complete_lines(folder.path / "r").empty() && Clock::now() < late)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  // One rank hears it, as from a scheduler; the others hear of it from that one.
  std::vector<pid_t> const ranks = ranks_of(job.pid());
  ASSERT_EQ(ranks.size(), 2U);
  ::kill(ranks.back(), SIGTERM);
  Result const result = job.finish();
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_EQ(count(result.err, "polhode: interrupted; the same command goes on from here\n"), 1) << result.err;
  EXPECT_LT(runs_in(folder.path / "r").size(), whole.size());
  EXPECT_EQ(mpirun(folder, 2, "run ranked.toml --out r").code, 0);
  EXPECT_EQ(runs_in(folder.path / "r"), whole);
}

// ---- Schedulers -----------------------------------------------------------------------------------------------------

TEST(CliSlurm, ThePrintedScriptIsOneForBash) {
  Folder folder;
  std::string const suite = "it's $(touch broken) a suite.toml";
  folder.write(suite, ranked_suite);
  for (Words const& kind : {Words{}, Words{"--shards", "5"}, Words{"--ranks", "3", "--time", "1:30:00"}}) {
    Words words{"run", suite, "--print-slurm", "--filter", "rk4|\"`touch broken`|'"};
    words.insert(words.end(), kind.begin(), kind.end());
    Result const script = polhode(folder, words);
    ASSERT_EQ(script.code, 0) << script.err;
    folder.write("job.sh", script.out);
    // mpirun and polhode are played by a function that shows its words.
    std::string const rehearsed = "cd '" + folder.path.string() +
                                  "'; bash -n job.sh && sed 's/^exec /printf \"%s\\\\n\" /' job.sh > rehearsal.sh && "
                                  "SLURM_ARRAY_TASK_ID=2 bash rehearsal.sh > words";
    ASSERT_EQ(std::system(rehearsed.c_str()), 0);
    std::string const said = text_of(folder.path / "words");
    EXPECT_THAT(said, testing::HasSubstr("\n" + (folder.path / suite).string() + "\n"));
    EXPECT_THAT(said, testing::HasSubstr("\n" + words[4] + "\n"));
    EXPECT_FALSE(fs::exists(folder.path / "broken")) << "what is quoted is never run";
  }
}

TEST(CliSlurm, TheShardsOfTheArrayAreTheWhole) {
  Folder folder;
  folder.write("ranked.toml", ranked_suite);
  EXPECT_EQ(polhode(folder, "run ranked.toml --out whole").code, 0);
  folder.write("job.sh", polhode(folder, "run ranked.toml --out parts --print-slurm --shards 3").out);
  for (std::string const shard : {"1", "2", "3"}) {
    std::string const job = "cd '" + folder.path.string() + "' && SLURM_ARRAY_TASK_ID=" + shard + " bash job.sh > log";
    ASSERT_EQ(std::system(job.c_str()), 0);
  }
  EXPECT_EQ(runs_in(folder.path / "parts"), runs_in(folder.path / "whole"));
}

/// Submits the printed script, waits for it, and compares with a run by hand.
void runs_under_slurm(std::string const& flags) {
  if (std::system("sinfo > /dev/null 2>&1") != 0) GTEST_SKIP() << "no Slurm answers here; bench/README.md sets one up";
  Folder folder;
  folder.write("ranked.toml", ranked_suite);
  EXPECT_EQ(polhode(folder, "run ranked.toml --out whole").code, 0);
  folder.write("job.sh", polhode(folder, "run ranked.toml --out parts --print-slurm --time 5 " + flags).out);
  std::string const submit = "cd '" + folder.path.string() +
                             "' && OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 sbatch --wait job.sh";
  EXPECT_EQ(std::system((submit + " > log 2>&1").c_str()), 0) << text_of(folder.path / "log");
  EXPECT_EQ(runs_in(folder.path / "parts"), runs_in(folder.path / "whole"));
  if (!testing::Test::HasFailure()) return;
  for (auto const& entry : fs::directory_iterator(folder.path))
    if (entry.path().extension() == ".log") ADD_FAILURE() << text_of(entry.path());
}

TEST(CliSlurm, AnArrayRunsUnderSlurm) {
  runs_under_slurm("--shards 2");
}
TEST(CliSlurm, RanksRunUnderSlurm) {
  runs_under_slurm("--ranks 2");
}

TEST(CliSlurm, FlagsThatDoNotFitAreRefused) {
  Folder folder;
  folder.write("short.toml", suite);
  for (std::string const flags : {"--ranks 3", "--print-slurm --shards 0", "--print-slurm --ranks 1.5",
                                  "--print-slurm --time soon", "--print-slurm --shard 1/2", "--print-slurm --fresh"}) {
    Result const result = polhode(folder, "run short.toml " + flags);
    EXPECT_EQ(result.code, 2) << flags << result.err;
    EXPECT_EQ(result.out, "");
  }
}

}  // namespace
}  // namespace polhode::cli::stopping
