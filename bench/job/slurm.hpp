#pragma once
/// Batch scripts for Slurm: the shards of a suite as a job array, or one job whose ranks share the cells.
#include <string>
#include <vector>

namespace polhode::bench {

/// What is to run, and where.
struct SlurmJob {
  std::string name;                  ///< of the suite; what Slurm would not take in it becomes _
  std::vector<std::string> command;  ///< polhode and its arguments, without --shard and --threads
  bool array = true;                 ///< shards, each a job of its own; else the ranks of one job
  int parts = 1;                     ///< how many
  std::string time{};                ///< limit, as sbatch takes it; empty: the partition's
  bool exclusive = false;            ///< nobody else on the node: times are taken
};

/// A script for sbatch. Arguments are quoted: nothing in them is taken for more than text.
std::string slurm_script(SlurmJob const& job);

/// Returns `time` if sbatch takes it: minutes, M:S, H:M:S, D-H, D-H:M or D-H:M:S. Throws UsageError.
std::string slurm_time(std::string const& time);

/// One word of a POSIX shell that means this very text.
std::string shell_word(std::string const& text);

}  // namespace polhode::bench
