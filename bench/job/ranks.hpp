#pragma once
/// The ranks of one job: processes that mpirun or srun started together, or this process alone. One of them, rank 0,
/// manages: it deals out work and gathers what comes of it. It works, too, so that N ranks keep N cores busy.
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "bench/job/channel.hpp"
#include "bench/job/dealer.hpp"

namespace polhode::bench {

/// Another rank ended the job, and says why: this one leaves without a word, and with success.
struct EndedElsewhere : std::exception {
  char const* what() const noexcept override { return "another rank ended the job"; }
};

/// All calls are collective: every rank of the job makes them, in the same order. What one rank throws inside of one
/// ends that call on all: the manager throws the same (UsageError, NothingSelected, std::bad_alloc, else
/// std::runtime_error, with the text), the others EndedElsewhere. So a mistake is told once, and nobody waits for ever.
class Ranks {
 public:
  /// Joins the ranks that the launcher started; alone without a launcher, and MPI is then never touched. To be called
  /// once. Throws UsageError if there are several and this binary was built without MPI.
  static Ranks of_this_job();
  /// Ranks that reach each other through `channel`; null: alone.
  explicit Ranks(std::unique_ptr<Channel> channel);
  /// Takes leave of the others, once all are there.
  ~Ranks();  // NOLINT(bugprone-exception-escape)
  Ranks(Ranks const&) = delete;
  Ranks& operator=(Ranks const&) = delete;

  int rank() const { return channel_ ? channel_->rank() : 0; }
  int size() const { return channel_ ? channel_->size() : 1; }
  bool manager() const { return rank() == 0; }
  bool alone() const { return size() == 1; }
  /// How many of them, this one included, share this machine.
  int on_this_node() const { return channel_ ? channel_->on_this_node() : 1; }
  /// What this rank sent and received, and what dealing it cost: who manages too many ranks has no time for more.
  Traffic traffic() const;

  /// Every rank does `step`; returns when all have.
  void together(std::function<void()> const& step);
  /// The manager makes it, all get it.
  std::string from_manager(std::function<std::string()> const& make);

  /// Items 0 <= k < count are dealt out, one at a time, to whoever is free; `work(k)` runs on some rank (or here, when
  /// alone) and returns bytes; `deliver(k, bytes)` is called on the manager only, in ORDER of k. What comes early is
  /// kept; no item is dealt that is further ahead of the first missing one than a window of max(1024, 16 size()).
  /// With several ranks `work` runs in a thread of its own, one at a time, while the manager delivers in the caller's.
  /// Once `stop` is set, on any rank, it is set on all: nothing more is dealt, and what work returns from then on is
  /// not delivered. It is also set when a rank fails. Work that takes long should look at it.
  void distribute(std::int64_t count, Work const& work, Deliver const& deliver, std::atomic<bool>* stop = nullptr);

 private:
  /// On the manager: everybody may go on, or has to end.
  void end_for_all(std::exception_ptr const& failure);
  /// On a worker: what the manager says, once it says that all may go on.
  std::string word_of_manager();
  [[noreturn]] void leave_quietly();

  std::unique_ptr<Channel> channel_;
  int unwinding_;                ///< exceptions in flight at the start
  bool ended_together_ = false;  ///< an exception is known to all
  double cpu_time_ = 0;          ///< see Traffic
};

/// Whether mpirun or srun started this process: its streams then go through theirs, whatever they seem to be.
bool launched();
/// Whether the launcher's environment says that this is the first rank, or there is no launcher: who may speak before
/// the ranks have met.
bool speaks_for_the_job();

}  // namespace polhode::bench
