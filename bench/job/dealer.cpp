#include "bench/job/dealer.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "bench/job/notes.hpp"

namespace polhode::bench {
namespace {

using namespace std::chrono_literals;
using Microseconds = std::chrono::microseconds;

/// What came of an item.
struct Outcome {
  std::int64_t k = 0;
  std::string bytes{};
  std::exception_ptr failure{};
};

/// A thread that does one item at a time, so that the caller's thread can listen meanwhile.
class Hand {
 public:
  explicit Hand(Work const& work) : work_(work), thread_([this](std::stop_token const& end) { serve(end); }) {}

  bool busy() const { return busy_; }
  void give(std::int64_t k) {
    busy_ = true;
    {
      std::lock_guard const lock(mutex_);
      item_ = k;
    }
    changed_.notify_all();
  }
  /// What the hand has finished; it is then free. Waits up to `patience` for it.
  std::optional<Outcome> take(Microseconds patience) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [this] { return outcome_.has_value(); });
    if (!outcome_) return {};
    busy_ = false;
    return std::exchange(outcome_, std::nullopt);
  }

 private:
  void serve(std::stop_token const& end) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, end, [this] { return item_.has_value(); })) {
      Outcome outcome{*std::exchange(item_, std::nullopt)};
      lock.unlock();
      try {
        outcome.bytes = work_(outcome.k);
      } catch (...) {
        outcome.failure = std::current_exception();
      }
      lock.lock();
      outcome_ = std::move(outcome);
      changed_.notify_all();
    }
  }

  Work const& work_;
  bool busy_ = false;  ///< as the caller sees it
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<std::int64_t> item_;
  std::optional<Outcome> outcome_;
  std::jthread thread_;  ///< the last member: it is joined before the others go
};

/// The manager.
class Dealer {
 public:
  Dealer(Channel& channel, std::int64_t count, Work const& work, Deliver const& deliver, std::atomic<bool>& stop)
      : channel_(channel), count_(count), deliver_(deliver), stop_(stop), hand_(work) {
    for (int rank = channel.size(); rank-- > 0;) free_.push_back(rank);
  }

  /// Returns the first failure, if any; no item is in anybody's hand then.
  std::exception_ptr run() {
    for (;;) {
      if (stop_ && !std::exchange(stop_told_, true)) send_all(channel_, {Word::stop});
      deal();
      if (in_hands_ == 0 && (stop_ || due_ == count_)) return failure_;
      while (auto heard = hear(channel_)) {
        take(std::move(*heard));
        deal();
      }
      if (auto outcome = hand_.take(hand_.busy() ? 100us : 20us)) returned(0, std::move(*outcome));
    }
  }

 private:
  void deal() {
    std::int64_t const window = std::max<std::int64_t>(1024, std::int64_t{16} * channel_.size());
    for (; !stop_ && !free_.empty() && next_ < std::min(count_, due_ + window); ++next_) {
      int const rank = free_.back();
      free_.pop_back();
      ++in_hands_;
      if (rank == 0)
        hand_.give(next_);
      else
        send(channel_, rank, {Word::item, next_});
    }
  }
  void take(Heard heard) {
    Note& note = heard.note;
    if (note.word == Word::stop) stop_ = true;
    if (note.word == Word::failed) returned(heard.from, {.failure = failure_of(heard)});
    if (note.word == Word::done) returned(heard.from, {note.k, std::move(note.text)});
  }
  void returned(int from, Outcome outcome) {
    --in_hands_;
    free_.push_back(from);
    if (outcome.failure) fail(outcome.failure);
    if (stop_) return;
    early_.emplace(outcome.k, std::move(outcome.bytes));
    try {
      for (auto first = early_.begin(); first != early_.end() && first->first == due_; first = early_.begin(), ++due_) {
        std::string bytes = std::move(first->second);
        early_.erase(first);
        deliver_(due_, std::move(bytes));
      }
    } catch (...) {
      fail(std::current_exception());
    }
  }
  void fail(std::exception_ptr const& failure) {
    if (!failure_) failure_ = failure;
    stop_ = true;
  }

  Channel& channel_;
  std::int64_t count_, next_ = 0, due_ = 0;  ///< items in all; the next to deal out; the next to deliver
  Deliver const& deliver_;
  std::atomic<bool>& stop_;
  bool stop_told_ = false;
  std::exception_ptr failure_;
  std::vector<int> free_;  ///< ranks with nothing to do
  std::int64_t in_hands_ = 0;
  std::map<std::int64_t, std::string> early_;
  Hand hand_;
};

}  // namespace

std::exception_ptr deal_out(Channel& channel, std::int64_t count, Work const& work, Deliver const& deliver,
                            std::atomic<bool>& stop) {
  return Dealer(channel, count, work, deliver, stop).run();
}

bool serve(Channel& channel, Work const& work, std::atomic<bool>& stop) {
  Hand hand(work);
  bool stop_told = false;
  for (Patience patience;;) {
    if (auto const heard = hear(channel)) {
      Note const& note = heard->note;
      if (note.word == Word::failed) return false;
      if (note.word == Word::go) return true;
      if (note.word == Word::stop) stop = stop_told = true;
      if (note.word == Word::item) hand.give(note.k);
      patience.reset();
      continue;
    }
    auto outcome = hand.take(hand.busy() ? Microseconds(5ms) : patience.next());
    // Told before what came of the item: it may be half.
    if (stop && !std::exchange(stop_told, true)) send(channel, 0, {Word::stop});
    if (outcome && outcome->failure) send(channel, 0, note_of(outcome->failure));
    if (outcome && !outcome->failure) send(channel, 0, {Word::done, outcome->k, std::move(outcome->bytes)});
  }
}

}  // namespace polhode::bench
