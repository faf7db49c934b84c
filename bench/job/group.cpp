#include "bench/job/group.hpp"

#include <fmt/format.h>

#include <exception>
#include <mutex>
#include <thread>

#include "bench/cell/timing.hpp"
#include "bench/process/provenance.hpp"

namespace polhode::bench {

void Group::run() {
  results::Cell const& cell = tasks_.front()->prepared.cell;
  std::string const name = cell.variant.empty() ? cell.problem : cell.problem + " " + cell.variant;
  around_.progress.say(name + ": accuracy");
  if (around_.options.isolate)
    measure_apart();
  else
    measure_all();
  if (around_.interrupted) return;
  if (around_.timing.enabled && !around_.at_once) {
    around_.progress.say(name + ": timing");
    time_all();
  }
  if (around_.interrupted) return;
  if (around_.at_once) return;
  for (Task const* task : tasks_) record(*task);
}

void Group::record(Task const& task) {
  for (results::Series const& series : task.result.series) around_.writer.series(series);
  around_.writer.run(task.result.record);
}

CellResult Group::measured(Task const& task) const {
  return result_of(
      measure(task.prepared, around_.references, build_id(), {around_.options.timeout, &around_.interrupted}),
      task.keep_history);
}

void Group::measure_all() {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr trouble;
  auto const work = [&] {
    for (std::size_t i = next++; i < tasks_.size() && !around_.interrupted; i = next++) {
      Task& task = *tasks_[i];
      try {
        {
          std::lock_guard const lock(mutex);
          if (trouble) return;
          around_.writer.begin(task.id, build_id());
        }
        task.result = measured(task);
        std::lock_guard const lock(mutex);
        if (around_.at_once) record(task);
      } catch (Interrupted const&) {
        return;
      } catch (...) {
        std::lock_guard const lock(mutex);
        trouble = std::current_exception();
        return;
      }
      around_.progress.advance();
    }
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < around_.options.threads; ++i) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  if (trouble) std::rethrow_exception(trouble);
}

/// The same with a process for each cell. There is no other thread then, and the references are made before.
void Group::measure_apart() {
  RunOptions const& options = around_.options;
  constexpr double grace = 5;  // [s]: who hears the time limit has ended by then
  for (Task const* task : tasks_)
    if (task->prepared.refusal.empty()) around_.references.of(task->prepared);
  in_children(
      tasks_.size(), around_.options.threads, options.timeout > 0 ? options.timeout + grace : 0, around_.interrupted,
      [&](std::size_t i) { around_.writer.begin(tasks_[i]->id, build_id()); },
      [&](std::size_t i) { return to_text(measured(*tasks_[i])); },
      [&](std::size_t i, Ended const& ended) {
        Task& task = *tasks_[i];
        task.died = !ended.died.empty();
        task.result = task.died ? CellResult{.series = {}, .record = died(task, ended)} : cell_result_from(ended.text);
        around_.progress.advance();
      });
}

results::Record Group::died(Task const& task, Ended const& ended) const {
  if (ended.late)
    return unmeasured(task.prepared, build_id(), results::Status::timeout,
                      fmt::format("killed: no step ended within {:g} s of wall time", around_.options.timeout));
  return unmeasured(task.prepared, build_id(), results::Status::crashed, "its process ended: " + ended.died);
}

void Group::time_all() {
  Timing const& timing = around_.timing;
  std::vector<TimedCell> cells;
  std::vector<Task*> timed;
  for (Task* task : tasks_) {
    results::Cell const& cell = task->prepared.cell;
    results::Status const status = task->result.record.status;
    if (status != results::Status::ok && status != results::Status::inaccurate) {
      around_.progress.advance();
      continue;
    }
    cells.push_back({task->id, task->prepared.problem->timed(cell.formulation, cell.integrator, task->prepared.plan)});
    timed.push_back(task);
  }
  double const part = 1.0 / timing.repetitions;
  std::vector<TimedResult> const results =
      time_cells(cells, timing, around_.interrupted, [&] { around_.progress.advance(part); });
  for (std::size_t i = 0; i < timed.size(); ++i) {
    results::Record& record = timed[i]->result.record;
    record.cpu_time_s = results[i].cpu_time;
    if (results[i].allocations && record.steps && *record.steps > 0)
      record.allocations_per_step = double(*results[i].allocations) / double(*record.steps);
  }
}

}  // namespace polhode::bench
