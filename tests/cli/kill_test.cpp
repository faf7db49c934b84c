// `run` stopped again and again, at random instants: what it acknowledged stays, and it ends where an undisturbed run
// does.
#include "tests/cli/stopping.hpp"

namespace polhode::cli::stopping {
namespace {

/// Kills at random instants; every line that was ever seen stays, and the end is that of a run in one go.
void kills_lose_nothing(int wanted, unsigned seed) {
  Folder folder;
  Whole const whole(folder);
  ASSERT_FALSE(testing::Test::HasFailure());
  std::mt19937 random(seed);
  std::map<std::string, int> phases;
  int kills = 0;
  for (int number = 0; kills < wanted && number < 4 * wanted; ++number) {  // a busy machine misses many
    Life life(folder, whole, number);
    while (kills < wanted) {
      Result const result = life.stop(SIGKILL, random);
      if (testing::Test::HasFailure()) return;
      if (result.code == 0) break;  // it was faster
      ASSERT_EQ(result.code, 128 + SIGKILL) << result.err;
      ++kills;
      ++phases[life.phase()];
      life.note_stop();
    }
    life.finish();
    ASSERT_FALSE(testing::Test::HasFailure()) << "after " << kills << " kills";
  }
  EXPECT_EQ(kills, wanted);
  for (std::string const phase : {"accuracy", "timing", "records"}) {
    EXPECT_GT(phases[phase], 0) << "no kill in: " << phase;
    testing::Test::RecordProperty(phase, phases[phase]);
  }
}

TEST(CliKill, FiftyKillsLoseNothing) {
  kills_lose_nothing(50, 2024);
}
TEST(FullCliKill, TwoHundredKillsLoseNothing) {
  if (std::getenv("POLHODE_FULL") == nullptr) GTEST_SKIP() << "minutes; POLHODE_FULL=1 runs it";
  kills_lose_nothing(200, 4711);
}

TEST(CliKill, InterruptsEndSoonAndResume) {
  Folder folder;
  Whole const whole(folder);
  ASSERT_FALSE(HasFailure());
  std::mt19937 random(7);
  int interrupts = 0;
  for (int number = 0; interrupts < 10 && number < 40; ++number) {
    Life life(folder, whole, number);
    while (interrupts < 10) {
      Seconds wait{};
      Result const result = life.stop(SIGINT, random, &wait);
      if (HasFailure()) return;
      if (result.code == 0) break;
      ++interrupts;
      EXPECT_EQ(result.code, 130);
      EXPECT_LT(wait.count(), 2);
      if (!result.err.empty())  // else the signal came before the command had read its arguments
        EXPECT_EQ(result.err, "polhode: interrupted; the same command goes on from here\n");
      else
        EXPECT_EQ(life.phase(), "start");
      life.note_stop();
    }
    life.finish();
    ASSERT_FALSE(HasFailure()) << "after " << interrupts << " interrupts";
  }
  EXPECT_EQ(interrupts, 10);
}

/// Sends SIGINT when `begun` cells have begun, and 0.3 s later; [s] until it ends.
double wait_after_interrupt(std::string const& text, std::size_t begun) {
  Folder folder;
  folder.write("slow.toml", "name = 'slow'\n" + text);
  Process process(folder.path, split("run slow.toml --out r"));
  auto const late = Clock::now() + std::chrono::seconds(20);
  while (held_in(complete_lines(folder.path / "r")).begun.size() < begun && Clock::now() < late)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  auto const start = Clock::now();
  process.signal(SIGINT);
  EXPECT_EQ(process.finish().code, 130);
  return Seconds(Clock::now() - start).count();
}

TEST(CliKill, InterruptEndsATimingPassSoon) {
  EXPECT_LT(wait_after_interrupt("[timing]\nmin_time = 0.2\nrepetitions = 5\n[[sweep]]\nproblem = 'free_body'\n"
                                 "formulation = 'quaternion'\nintegrator = 'rk4'\nh = [0.1, 0.2, 0.5, 1]\nt_end = 2\n",
                                 4),
            2);
}

TEST(CliKill, InterruptEndsALongCellSoon) {
  EXPECT_LT(wait_after_interrupt("[timing]\nenabled = false\n[[sweep]]\nproblem = 'free_body'\n"
                                 "formulation = 'quaternion'\nintegrator = 'gauss4'\nh = 2e-5\n",
                                 1),
            2);
}

}  // namespace
}  // namespace polhode::cli::stopping
