#include "bench/job/slurm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {
namespace {

TEST(Slurm, WordsMeanThemselves) {
  EXPECT_EQ(shell_word("plain/path-1.toml"), "plain/path-1.toml");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("two words"), "'two words'");
  EXPECT_EQ(shell_word("it's $(date) `x` \"y\" \\ ; & *"), R"('it'\''s $(date) `x` "y" \ ; & *')");
  EXPECT_EQ(shell_word("~"), "'~'");
  EXPECT_EQ(shell_word("a\nb"), "'a\nb'");
}

TEST(Slurm, TimesAreThoseOfSbatch) {
  for (char const* good : {"90", "5:00", "1:30:00", "2-12", "2-12:30", "2-12:30:15"}) EXPECT_EQ(slurm_time(good), good);
  for (char const* bad : {"", "1h", "1:2:3:4", "-5", "1:00\n#SBATCH --uid=0", "5:0", "1-", "90 # x"})
    EXPECT_THROW(slurm_time(bad), UsageError) << bad;
}

TEST(Slurm, AnArrayHasAShardForEachOfItsJobs) {
  EXPECT_EQ(slurm_script({.name = "mine",
                          .command = {"/usr/bin/polhode", "run", "it's.toml"},
                          .parts = 8,
                          .time = "1:00:00",
                          .exclusive = true}),
            R"(#!/bin/bash
# For sbatch. Each job of the array runs one shard; all write to one folder.
# Submitted again, it goes on with what is not finished.
# --exclusive: times are taken, and neighbours would spoil them.
#SBATCH --job-name=polhode-mine
#SBATCH --output=polhode-mine-%A-%a.log
#SBATCH --array=1-8
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --time=1:00:00
#SBATCH --exclusive
#SBATCH --requeue
set -euo pipefail
exec /usr/bin/polhode run 'it'\''s.toml' --threads "${SLURM_CPUS_ON_NODE:-1}" --shard "$SLURM_ARRAY_TASK_ID/8"
)");
}

TEST(Slurm, RanksAreTasksOfOneJob) {
  std::string const script =
      slurm_script({.name = "mine", .command = {"polhode", "run", "mine.toml"}, .array = false, .parts = 64});
  EXPECT_THAT(script, testing::HasSubstr("#SBATCH --ntasks=64\n"));
  EXPECT_THAT(script, testing::HasSubstr("\nexec mpirun -n 64 polhode run mine.toml "));
  EXPECT_THAT(script, testing::Not(testing::HasSubstr("--array")));
  EXPECT_THAT(script, testing::Not(testing::HasSubstr("--time")));
}

TEST(Slurm, ANameAddsNoLineAndNoDirective) {
  std::string const script = slurm_script({.name = "a b\n#SBATCH --uid=0 %j", .command = {"polhode"}, .parts = 2});
  EXPECT_THAT(script, testing::HasSubstr("#SBATCH --job-name=polhode-a_b__SBATCH_--uid_0__j\n"));
}

}  // namespace
}  // namespace polhode::bench
