#include "bench/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <thread>

#include "bench/catalogue.hpp"
#include "bench/cell_result.hpp"
#include "bench/isolate.hpp"
#include "bench/progress.hpp"
#include "bench/provenance.hpp"
#include "bench/timing.hpp"
#include "results/file_name.hpp"
#include "results/folder_lock.hpp"
#include "results/store.hpp"

namespace polhode::bench {
namespace {

std::atomic<bool> interrupted = false;

/// Since 1970: files of records sort by it, as text, too.
std::int64_t nanoseconds_now() {
  auto const now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

struct Task {
  PreparedCell prepared;
  std::string id;
  bool keep_history = false;
  CellResult result;
  bool died = false;  ///< its process did
};

std::string path_of(results::Cell const& cell) {
  return fmt::format("{}/{}/{}/{}/{}", cell.problem, cell.variant, cell.formulation, cell.integrator, cell.policy);
}

std::vector<Task> prepare_all(Suite const& suite, std::string const& filter) {
  std::regex pattern;
  try {
    pattern = std::regex(filter);
  } catch (std::regex_error const& error) {
    throw UsageError(fmt::format("--filter {}: not a regular expression: {}", quote(filter), error.what()));
  }
  std::vector<Task> tasks;
  std::set<std::string> seen;
  for (SuiteCell const& wanted : suite.cells) {
    if (!filter.empty() && !std::regex_search(path_of(wanted.cell), pattern)) continue;
    Task task;
    try {
      task.prepared = prepare(wanted.cell);
    } catch (UsageError const& error) {
      throw SuiteError(fmt::format("suite '{}': {}", suite.name, error.what()));
    }
    task.prepared.reference = wanted.reference;
    task.id = results::cell_id(task.prepared.cell);
    task.keep_history = std::find(wanted.tags.begin(), wanted.tags.end(), "history") != wanted.tags.end();
    // A cell with the horizon written out and one that takes the default are the same.
    if (seen.insert(task.id).second) tasks.push_back(std::move(task));
  }
  if (tasks.empty())
    throw NothingSelected(filter.empty()
                              ? fmt::format("suite '{}' has no cells", suite.name)
                              : fmt::format("--filter {} matches no cell of suite '{}'", quote(filter), suite.name));
  return tasks;
}

/// Keeps every n-th cell, so that shards on equal suites are disjoint and together the whole.
void take_shard(std::vector<Task>& tasks, RunOptions const& options) {
  if (options.shards <= 1) return;
  std::size_t const all = tasks.size();
  std::vector<Task> kept;
  for (std::size_t i = std::size_t(options.shard - 1); i < all; i += std::size_t(options.shards))
    kept.push_back(std::move(tasks[i]));
  tasks = std::move(kept);
  if (tasks.empty())
    throw NothingSelected(fmt::format("shard {}/{} of {} cells is empty", options.shard, options.shards, all));
}

/// Drops the cells that the folder already holds from this build.
std::size_t skip_finished(std::vector<Task>& tasks, std::filesystem::path const& out, bool retry_failed) {
  results::Contents const contents = results::read(out);
  std::set<std::string> done;
  for (results::Record const& record : contents.records) {
    bool const good = record.status == results::Status::ok || record.status == results::Status::refused;
    if (record.build == build_id() && (good || !retry_failed)) done.insert(record.cell);
  }
  return std::erase_if(tasks, [&](Task const& task) { return done.contains(task.id); });
}

/// Threads of the accuracy pass.
int processors_of(RunOptions const& options) {
  return options.threads > 0 ? options.threads : std::max(1, int(std::thread::hardware_concurrency()));
}

/// One problem with one choice: its cells share a reference, and are timed against each other.
class Group {
 public:
  Group(std::vector<Task*> tasks, References& references, results::Writer& writer, Progress& progress)
      : tasks_(std::move(tasks)), references_(references), writer_(writer), progress_(progress) {}

  void run(Timing const& timing, RunOptions const& options) {
    results::Cell const& cell = tasks_.front()->prepared.cell;
    std::string const name = cell.variant.empty() ? cell.problem : cell.problem + " " + cell.variant;
    progress_.say(name + ": accuracy");
    if (options.isolate)
      measure_apart(options);
    else
      measure_all(options);
    if (interrupted) return;
    if (timing.enabled) {
      progress_.say(name + ": timing");
      time_all(timing);
    }
    if (interrupted) return;
    for (Task* task : tasks_) {
      for (results::Series const& series : task->result.series) writer_.series(series);
      writer_.run(task->result.record);
    }
  }

 private:
  void measure_all(RunOptions const& options) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr trouble;
    auto const work = [&] {
      for (std::size_t i = next++; i < tasks_.size() && !interrupted; i = next++) {
        Task& task = *tasks_[i];
        try {
          {
            std::lock_guard const lock(mutex);
            if (trouble) return;
            writer_.begin(task.id, build_id());
          }
          task.result = measured(task, options);
        } catch (Interrupted const&) {
          return;
        } catch (...) {
          std::lock_guard const lock(mutex);
          trouble = std::current_exception();
          return;
        }
        progress_.advance();
      }
    };
    std::vector<std::thread> helpers;
    for (int i = 1; i < processors_of(options); ++i) helpers.emplace_back(work);
    work();
    for (std::thread& helper : helpers) helper.join();
    if (trouble) std::rethrow_exception(trouble);
  }

  CellResult measured(Task const& task, RunOptions const& options) const {
    return result_of(measure(task.prepared, references_, build_id(), {options.timeout, &interrupted}),
                     task.keep_history);
  }

  /// The same with a process for each cell. There is no other thread then, and the references are made before.
  void measure_apart(RunOptions const& options) {
    constexpr double grace = 5;  // [s]: who hears the time limit has ended by then
    for (Task const* task : tasks_)
      if (task->prepared.refusal.empty()) references_.of(task->prepared);
    in_children(
        tasks_.size(), processors_of(options), options.timeout > 0 ? options.timeout + grace : 0, interrupted,
        [&](std::size_t i) { writer_.begin(tasks_[i]->id, build_id()); },
        [&](std::size_t i) { return to_text(measured(*tasks_[i], options)); },
        [&](std::size_t i, Ended const& ended) {
          Task& task = *tasks_[i];
          task.died = !ended.died.empty();
          task.result =
              task.died ? CellResult{.series = {}, .record = died(task, ended, options)} : cell_result_from(ended.text);
          progress_.advance();
        });
  }
  static results::Record died(Task const& task, Ended const& ended, RunOptions const& options) {
    results::Record record;
    record.cell = task.id;
    record.build = build_id();
    record.of = task.prepared.cell;
    record.status = ended.late ? results::Status::timeout : results::Status::crashed;
    record.reason = ended.late ? fmt::format("killed: no step ended within {:g} s of wall time", options.timeout)
                               : "its process ended: " + ended.died;
    return record;
  }

  void time_all(Timing const& timing) {
    std::vector<TimedCell> cells;
    std::vector<Task*> timed;
    for (Task* task : tasks_) {
      results::Cell const& cell = task->prepared.cell;
      results::Status const status = task->result.record.status;
      if (status != results::Status::ok && status != results::Status::inaccurate) {
        progress_.advance();
        continue;
      }
      cells.push_back(
          {task->id, task->prepared.problem->timed(cell.formulation, cell.integrator, task->prepared.plan)});
      timed.push_back(task);
    }
    double const part = 1.0 / timing.repetitions;
    std::vector<TimedResult> const results = time_cells(cells, timing, interrupted, [&] { progress_.advance(part); });
    for (std::size_t i = 0; i < timed.size(); ++i) {
      results::Record& record = timed[i]->result.record;
      record.cpu_time_s = results[i].cpu_time;
      if (results[i].allocations && record.steps && *record.steps > 0)
        record.allocations_per_step = double(*results[i].allocations) / double(*record.steps);
    }
  }

  std::vector<Task*> tasks_;
  References& references_;
  results::Writer& writer_;
  Progress& progress_;
};

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

void say_what_would_run(std::vector<Task> const& tasks, Timing const& timing, RunOptions const& options) {
  for (Task const& task : tasks) {
    results::Cell const& cell = task.prepared.cell;
    std::string const control = cell.h ? fmt::format("h={:g}", *cell.h) : fmt::format("rtol={:g}", *cell.rtol);
    fmt::print("{} {} {}{}\n", task.id, path_of(cell), control,
               task.prepared.refusal.empty() ? "" : "  refused: " + task.prepared.refusal);
  }
  int const seconds = int(std::lround(expected_time(tasks, timing, processors_of(options))));
  fmt::print("{} cells, about {} min {} s\n", tasks.size(), seconds / 60, seconds % 60);
}

void write_suite(std::filesystem::path const& file, std::string const& text) {
  errno = 0;
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw results::StoreError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

/// What users should know of their choices, each once.
std::set<std::string> warnings_of(std::vector<Task> const& tasks) {
  std::set<std::string> warnings;
  for (Task const& task : tasks)
    if (std::string const warning = task.prepared.problem->warning(); !warning.empty())
      warnings.insert(task.prepared.cell.problem + ": " + warning);
  return warnings;
}

}  // namespace

void warn(std::string const& warning) {
  if (!warning.empty()) std::fputs(fmt::format("polhode: warning: {}\n", warning).c_str(), stderr);
}

void interruptible() {
  auto const note = [](int) { interrupted = true; };
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of the write, with a name
}

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  if (!std::filesystem::is_directory(suites_folder())) return names;
  for (auto const& entry : std::filesystem::directory_iterator(suites_folder()))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

std::filesystem::path suite_file(std::string const& name_or_file) {
  std::filesystem::path const built_in = suites_folder() / (name_or_file + ".toml");
  bool const is_name = name_or_file.find_first_of("./") == std::string::npos;
  if (is_name && std::filesystem::exists(built_in)) return built_in;
  if (!is_name || std::filesystem::exists(name_or_file)) return name_or_file;
  throw UsageError(unknown("suite", name_or_file, suite_names()));
}

RunSummary run_suite(Suite const& suite, RunOptions const& options) {
  std::vector<Task> tasks = prepare_all(suite, options.filter);
  take_shard(tasks, options);
  RunSummary summary;
  summary.out =
      options.out.empty() ? std::filesystem::path("polhode-results") / results::file_name_of(suite.name) : options.out;
  summary.cells = tasks.size();
  if (options.dry_run) {
    say_what_would_run(tasks, suite.timing, options);
    return summary;
  }

  std::error_code error;
  std::filesystem::create_directories(summary.out, error);
  if (error) throw results::StoreError(fmt::format("{}: {}", summary.out.string(), error.message()));
  bool const alone = options.shards <= 1 || options.fresh;
  results::FolderLock const lock =
      alone ? results::FolderLock(summary.out) : results::FolderLock(summary.out, options.shard, options.shards);
  if (options.fresh) {
    for (auto const& entry : std::filesystem::directory_iterator(summary.out))
      if (entry.path().extension() == ".jsonl") std::filesystem::remove(entry.path());
    std::filesystem::remove(summary.out / results::catalogue_file);
  }
  summary.skipped = skip_finished(tasks, summary.out, options.retry_failed);
  if (tasks.empty()) return summary;
  write_suite(summary.out / "suite.toml", suite.text);
  results::write_catalogue(summary.out, catalogue_text());
  for (std::filesystem::path const& file : suite.files) {
    std::filesystem::path const copy = summary.out / file.filename();
    if (!std::filesystem::exists(copy) || !std::filesystem::equivalent(file, copy))
      std::filesystem::copy_file(file, copy, std::filesystem::copy_options::overwrite_existing);
  }

  results::Meta meta = provenance();
  meta["suite"] = suite.name;
  meta["suite_hash"] = results::hash_of(suite.text);
  meta["reference_methods"] = "Taylor series and 8-stage Gauss, float128";
  results::Writer writer(summary.out / fmt::format("run-{:020}-{}.jsonl", nanoseconds_now(), getpid()), meta);

  std::vector<std::string> order;
  std::map<std::string, std::vector<Task*>> groups;
  for (Task& task : tasks) {
    std::string const subject = reference_subject(task.prepared.physics);
    if (!groups.contains(subject)) order.push_back(subject);
    groups[subject].push_back(&task);
  }
  for (std::string const& warning : warnings_of(tasks)) warn(warning);
  References references(references_folder());
  Progress progress(tasks.size() * (suite.timing.enabled ? 2 : 1));
  for (std::string const& subject : order) {
    if (interrupted) break;
    Group(groups[subject], references, writer, progress).run(suite.timing, options);
    if (interrupted) break;
    for (Task* task : groups[subject]) {
      results::Status const status = task->result.record.status;
      summary.ok += status == results::Status::ok;
      summary.refused += status == results::Status::refused;
      summary.failed += status != results::Status::ok && status != results::Status::refused;
      summary.died += task->died;
      task->result = {};  // it is on disk
    }
  }
  summary.interrupted = interrupted;
  return summary;
}

}  // namespace polhode::bench
