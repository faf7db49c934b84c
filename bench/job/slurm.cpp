#include "bench/job/slurm.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <regex>
#include <string_view>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {

namespace {

/// Whether a shell, sbatch and a file system take these characters for nothing but themselves.
bool plain(std::string const& text, char const* others) {
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    bool const letter = ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9');
    return letter || std::string_view(others).find(c) != std::string_view::npos;
  });
}

/// `name` for a job and its log.
std::string job_name(std::string const& name) {
  std::string text = "polhode-" + name;
  for (char& c : text)
    if (!plain(std::string(1, c), "-_")) c = '_';
  return text;
}

}  // namespace

std::string shell_word(std::string const& text) {
  if (plain(text, "-_./:=+,")) return text;
  std::string word = "'";
  for (char const c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string slurm_time(std::string const& time) {
  static std::regex const forms(R"((\d+-\d+(:\d\d){0,2})|(\d+(:\d\d){0,2}))");
  if (std::regex_match(time, forms)) return time;
  throw UsageError(fmt::format("--time {}: write minutes, M:S, H:M:S, D-H, D-H:M or D-H:M:S", quote(time)));
}

std::string slurm_script(SlurmJob const& job) {
  std::vector<std::string> words;
  for (std::string const& argument : job.command) words.push_back(shell_word(argument));
  std::string const name = job_name(job.name);
  std::vector<std::string> lines{"#!/bin/bash"};
  auto const add = [&](std::string line) { lines.push_back(std::move(line)); };
  add(job.array ? "# For sbatch. Each job of the array runs one shard; all write to one folder."
                : "# For sbatch. One job, whose ranks share the cells; each writes a file of its own to one folder.");
  add("# Submitted again, it goes on with what is not finished.");
  if (job.exclusive) add("# --exclusive: times are taken, and neighbours would spoil them.");
  add("#SBATCH --job-name=" + name);
  add(fmt::format("#SBATCH --output={}-{}.log", name, job.array ? "%A-%a" : "%j"));
  add(job.array ? fmt::format("#SBATCH --array=1-{}", job.parts) : fmt::format("#SBATCH --ntasks={}", job.parts));
  if (job.array) add("#SBATCH --ntasks=1");
  add("#SBATCH --cpus-per-task=1");
  if (!job.time.empty()) add(fmt::format("#SBATCH --time={}", job.time));
  if (job.exclusive) add("#SBATCH --exclusive");
  add("#SBATCH --requeue");
  add("set -euo pipefail");
  if (job.array)
    add(fmt::format(R"(exec {} --threads "${{SLURM_CPUS_ON_NODE:-1}}" --shard "$SLURM_ARRAY_TASK_ID/{}")",
                    fmt::join(words, " "), job.parts));
  else
    add(fmt::format(R"(exec mpirun -n {} {} --threads "${{SLURM_CPUS_PER_TASK:-1}}")", job.parts,
                    fmt::join(words, " ")));
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

}  // namespace polhode::bench
