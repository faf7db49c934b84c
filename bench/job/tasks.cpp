#include "bench/job/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <unordered_map>

#include "bench/cell/reference.hpp"

namespace polhode::bench {
namespace {

std::string path_of(results::Cell const& cell) {
  return fmt::format("{}/{}/{}/{}/{}", cell.problem, cell.variant, cell.formulation, cell.integrator, cell.policy);
}

Task task_of(SuiteCell const& wanted, std::string const& suite) {
  Task task;
  try {
    task.prepared = prepare(wanted.cell);
  } catch (UsageError const& error) {
    throw SuiteError(fmt::format("suite '{}': {}", suite, error.what()));
  }
  task.prepared.reference = wanted.reference;
  task.id = results::cell_id(task.prepared.cell);
  task.keep_history = std::ranges::find(wanted.tags, "history") != wanted.tags.end();
  return task;
}

/// A rough guess [s]: what a measured step, a reference and a timed cell take on a machine of today.
double expected_time(std::vector<Task> const& tasks, Timing const& timing, int processors) {
  constexpr double per_step = 4e-6, per_reference = 0.5, adaptive_steps = 1000;
  double accuracy = 0, timed = 0;
  std::set<std::string> subjects;
  for (Task const& task : tasks) {
    if (!task.prepared.refusal.empty()) continue;
    results::Cell const& cell = task.prepared.cell;
    accuracy += per_step * (cell.h ? cell.t_end / *cell.h : adaptive_steps);
    if (timing.enabled) timed += 1.4 * timing.min_time * timing.repetitions;  // and its calibration
    subjects.insert(reference_subject(task.prepared.physics));
  }
  return (accuracy + per_reference * double(subjects.size())) / processors + timed;
}

}  // namespace

std::vector<Task> tasks_of(Suite const& suite, std::string const& filter) {
  std::regex pattern;
  try {
    pattern = std::regex(filter);
  } catch (std::regex_error const& error) {
    throw UsageError(fmt::format("--filter {}: not a regular expression: {}", quote(filter), error.what()));
  }
  std::vector<Task> tasks;
  std::unordered_map<std::string, std::size_t> places;
  for (SuiteCell const& wanted : suite.cells) {
    if (!filter.empty() && !std::regex_search(path_of(wanted.cell), pattern)) continue;
    Task made = task_of(wanted, suite.name);
    // A cell with the horizon written out and one that takes the default are the same.
    auto const [place, is_new] = places.try_emplace(made.id, tasks.size());
    if (is_new) {
      tasks.push_back(std::move(made));
    } else {
      Task& known = tasks[place->second];
      known.prepared.reference |= made.prepared.reference;
      known.keep_history |= made.keep_history;
    }
  }
  if (tasks.empty())
    throw NothingSelected(filter.empty()
                              ? fmt::format("suite '{}' has no cells", suite.name)
                              : fmt::format("--filter {} matches no cell of suite '{}'", quote(filter), suite.name));
  return tasks;
}

void take_shard(std::vector<Task>& tasks, int shard, int shards) {
  if (shards <= 1) return;
  std::size_t const all = tasks.size();
  std::vector<Task> kept;
  for (std::size_t i = std::size_t(shard - 1); i < all; i += std::size_t(shards)) kept.push_back(std::move(tasks[i]));
  tasks = std::move(kept);
  if (tasks.empty()) throw NothingSelected(fmt::format("shard {}/{} of {} cells is empty", shard, shards, all));
}

std::set<std::string> warnings_of(std::vector<Task> const& tasks) {
  std::set<std::string> warnings;
  for (Task const& task : tasks)
    if (std::string const warning = task.prepared.problem->warning(); !warning.empty())
      warnings.insert(task.prepared.cell.problem + ": " + warning);
  return warnings;
}

void say_what_would_run(std::vector<Task> const& tasks, Timing const& timing, int processors) {
  for (Task const& task : tasks) {
    results::Cell const& cell = task.prepared.cell;
    std::string const control = cell.h ? fmt::format("h={:g}", *cell.h) : fmt::format("rtol={:g}", *cell.rtol);
    fmt::print("{} {} {}{}\n", task.id, path_of(cell), control,
               task.prepared.refusal.empty() ? "" : "  refused: " + task.prepared.refusal);
  }
  int const seconds = int(std::lround(expected_time(tasks, timing, processors)));
  fmt::print("{} cells, about {} min {} s\n", tasks.size(), seconds / 60, seconds % 60);
}

}  // namespace polhode::bench
