#include "bench/job/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "bench/job/group.hpp"
#include "bench/job/result_folder.hpp"
#include "bench/job/tasks.hpp"
#include "bench/process/data.hpp"
#include "bench/process/progress.hpp"
#include "bench/process/provenance.hpp"
#include "bench/process/signals.hpp"
#include "results/file_name.hpp"
#include "results/store.hpp"

namespace polhode::bench {
namespace {

/// Since 1970: files of records sort by it, as text, too.
std::int64_t nanoseconds_now() {
  auto const now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

/// What a rank tells the manager of a pack.
std::string to_text(RunSummary const& part) {
  return fmt::format("{} {} {} {}", part.ok, part.refused, part.failed, part.died);
}
void add(RunSummary& summary, std::string const& text) {
  RunSummary part;
  std::istringstream(text) >> part.ok >> part.refused >> part.failed >> part.died;
  summary.ok += part.ok;
  summary.refused += part.refused;
  summary.failed += part.failed;
  summary.died += part.died;
}

/// One run of a suite, as one rank sees it: all prepare the same cells, the manager keeps the folder, each writes a
/// file of its own.
class SuiteRun {
 public:
  SuiteRun(Suite const& suite, RunOptions const& options, Ranks& ranks)
      : suite_(suite), options_(options), timing_(suite.timing), ranks_(ranks) {
    int const processors = std::max(1, int(std::thread::hardware_concurrency()));
    if (options_.threads == 0) options_.threads = ranks.alone() ? processors : 1;
    // Ranks share a machine, or are on different ones: neither gives times that can be compared.
    if (!ranks.alone()) timing_.enabled = false;
  }

  RunSummary run() {
    ranks_.together([&] { prepare_cells(); });
    if (options_.dry_run) {
      if (ranks_.manager()) say_what_would_run(tasks_, timing_, ranks_.size() * options_.threads);
      return summary_;
    }
    std::optional<ResultFolder> folder;  // the manager's, for the job
    take_over(ranks_.from_manager([&] { return open_folder(folder); }));
    if (tasks_.empty()) return summary_;
    if (ranks_.manager())
      for (std::string const& warning : warnings_of(tasks_)) warn(warning);
    run_packs();
    summary_.interrupted = interrupted;
    return summary_;
  }

 private:
  /// The cells of the whole run.
  void prepare_cells() {
    if (options_.isolate && !ranks_.alone())
      throw UsageError("--isolate is for one process; under mpirun a rank that dies ends the job, and a rerun goes on");
    tasks_ = tasks_of(suite_, options_.filter);
    take_shard(tasks_, options_.shard, options_.shards);
    summary_.cells = tasks_.size();
    summary_.out = options_.out.empty() ? default_folder(suite_) : options_.out;
  }

  /// The manager's: returns when the run began, and a 1 or 0 for each cell: whether it is left to do.
  std::string open_folder(std::optional<ResultFolder>& folder) {
    folder.emplace(summary_.out, options_);
    std::set<std::string> const done = folder->finished(options_.retry_failed);
    std::string left;
    for (Task const& task : tasks_) left += done.contains(task.id) ? '0' : '1';
    if (left.find('1') != std::string::npos) folder->write_suite(suite_);
    return fmt::format("{:020} {}", nanoseconds_now(), left);
  }
  /// What the manager found: the same cells are left on all ranks.
  void take_over(std::string const& found) {
    auto const space = found.find(' ');
    begun_ = found.substr(0, space);
    std::size_t i = space + 1;
    std::vector<Task> left;
    for (Task& task : tasks_)
      if (found.at(i++) == '1') left.push_back(std::move(task));
    summary_.skipped = tasks_.size() - left.size();
    tasks_ = std::move(left);
  }

  /// The groups. Of several ranks each gets at least four packs on average, so that all are busy to the end; a group
  /// is split for no more than that, as each rank that works on it makes its reference.
  std::vector<std::vector<Task*>> packed() {
    std::vector<std::vector<Task*>> packs;
    std::map<std::string, std::size_t> pack_of;  // by what its cells have in common
    std::size_t const wanted = 4 * std::size_t(ranks_.size());
    std::size_t const fair = std::max((tasks_.size() + wanted - 1) / wanted, std::size_t(options_.threads));
    std::size_t const limit = ranks_.alone() ? tasks_.size() : fair;
    for (Task& task : tasks_) {
      auto const [place, is_new] = pack_of.try_emplace(reference_subject(task.prepared.physics), packs.size());
      if (!is_new && packs[place->second].size() >= limit) place->second = packs.size();
      if (place->second == packs.size()) packs.emplace_back();
      packs[place->second].push_back(&task);
    }
    return packs;
  }

  void run_packs() {
    std::vector<std::vector<Task*>> const packs = packed();
    References references(references_folder());
    std::optional<results::Writer> writer;  // a rank that gets nothing to do leaves no file
    // Alone, cells are shown as they end; of several ranks the manager shows what it hears of.
    Progress cells(ranks_.alone() ? tasks_.size() * (timing_.enabled ? 2 : 1) : 0);
    Progress heard(ranks_.alone() || !ranks_.manager() ? 0 : tasks_.size());
    auto const work = [&](std::int64_t k) {
      if (!writer) writer.emplace(file_of_records(), meta());
      std::vector<Task*> const& pack = packs[std::size_t(k)];
      Group(pack, {options_, timing_, !ranks_.alone(), references, *writer, cells, interrupted}).run();
      return to_text(counted(pack));
    };
    auto const deliver = [&](std::int64_t k, std::string const& counts) {
      add(summary_, counts);
      heard.advance(double(packs[std::size_t(k)].size()));
    };
    ranks_.distribute(std::int64_t(packs.size()), work, deliver, &interrupted);
  }

  std::filesystem::path file_of_records() const {
    std::string const who = ranks_.alone() ? std::to_string(getpid()) : fmt::format("rank{:05}", ranks_.rank());
    return summary_.out / fmt::format("run-{}-{}.jsonl", begun_, who);
  }
  results::Meta meta() const {
    results::Meta meta = provenance();
    meta["suite"] = suite_.name;
    meta["suite_hash"] = results::hash_of(suite_.text);
    if (std::string const file = path_in_repository(suite_.file); !file.empty()) meta["suite_file"] = file;
    meta["reference_methods"] = "Taylor series and 8-stage Gauss, float128";
    if (ranks_.alone()) return meta;
    meta["rank"] = std::to_string(ranks_.rank());
    meta["ranks"] = std::to_string(ranks_.size());
    meta["ranks_on_node"] = std::to_string(ranks_.on_this_node());
    meta["timing_valid"] = "false";
    return meta;
  }

  /// Statuses of a pack that is on disk.
  static RunSummary counted(std::vector<Task*> const& pack) {
    RunSummary part;
    for (Task* task : pack) {
      results::Status const status = task->result.record.status;
      part.ok += status == results::Status::ok;
      part.refused += status == results::Status::refused;
      part.failed += status != results::Status::ok && status != results::Status::refused;
      part.died += task->died;
      task->result = {};
    }
    return part;
  }

  Suite const& suite_;
  RunOptions options_;
  Timing timing_;
  Ranks& ranks_;
  std::vector<Task> tasks_;
  std::string begun_;  ///< [ns] since 1970
  RunSummary summary_;
};

}  // namespace

std::filesystem::path default_folder(Suite const& suite) {
  return std::filesystem::path("polhode-results") / results::file_name_of(suite.name);
}

RunSummary run_suite(Suite const& suite, RunOptions const& options, Ranks& ranks) {
  return SuiteRun(suite, options, ranks).run();
}

}  // namespace polhode::bench
