/// Ranks that are threads of this process: what MPI carries elsewhere goes through queues here.
#include "bench/job/ranks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <deque>
#include <mutex>
#include <new>
#include <set>
#include <thread>
#include <vector>

#include "bench/input/vocabulary.hpp"

namespace polhode::bench {
namespace {

using namespace std::chrono_literals;

/// Everybody's letter boxes.
struct Post {
  explicit Post(int size) : boxes(std::size_t(size)) {}
  std::mutex mutex;
  std::vector<std::deque<Message>> boxes;
  int left = 0;  ///< ranks that took leave
};

class Queue final : public Channel {
 public:
  Queue(Post& post, int rank) : post_(post), rank_(rank) {}
  int rank() const override { return rank_; }
  int size() const override { return int(post_.boxes.size()); }
  int on_this_node() const override { return size(); }
  Traffic traffic() const override { return traffic_; }
  void send(int to, std::string const& bytes) override {
    std::lock_guard const lock(post_.mutex);
    post_.boxes[std::size_t(to)].push_back({rank_, bytes});
    ++traffic_.messages;
    traffic_.bytes += std::int64_t(bytes.size());
  }
  std::optional<Message> receive() override {
    std::lock_guard const lock(post_.mutex);
    auto& box = post_.boxes[std::size_t(rank_)];
    if (box.empty()) return {};
    Message message = std::move(box.front());
    box.pop_front();
    ++traffic_.messages;
    traffic_.bytes += std::int64_t(message.bytes.size());
    return message;
  }
  void leave() override {
    std::lock_guard const lock(post_.mutex);
    ++post_.left;
  }

 private:
  Post& post_;
  int rank_;
  Traffic traffic_;
};

/// What became of the ranks of a job.
struct Job {
  std::vector<std::string> ends;  ///< of each rank: "", "usage: ...", "elsewhere", ...
  int left = 0;                   ///< ranks that took leave
  std::size_t letters_unread = 0;
};

std::string end_of(std::function<void()> const& body) {
  try {
    body();
    return "";
  } catch (EndedElsewhere const&) {
    return "elsewhere";
  } catch (UsageError const& error) {
    return std::string("usage: ") + error.what();
  } catch (NothingSelected const& error) {
    return std::string("nothing: ") + error.what();
  } catch (std::bad_alloc const&) {
    return "memory";
  } catch (std::exception const& error) {
    return error.what();
  }
}

Job job(int size, std::function<void(Ranks&)> const& body) {
  Post post(size);
  Job job;
  job.ends.resize(std::size_t(size));
  {
    std::vector<std::jthread> ranks;
    for (int rank = 0; rank < size; ++rank)
      ranks.emplace_back([&, rank] {
        job.ends[std::size_t(rank)] = end_of([&] {
          Ranks here(std::make_unique<Queue>(post, rank));
          body(here);
        });
      });
  }
  job.left = post.left;
  for (auto const& box : post.boxes) job.letters_unread += box.size();
  return job;
}

std::vector<std::string> silent(int size) {
  return std::vector<std::string>(std::size_t(size));
}
/// The manager speaks, the others leave.
std::vector<std::string> told_once(int size, std::string const& what) {
  std::vector<std::string> ends(std::size_t(size), "elsewhere");
  ends.front() = what;
  return ends;
}

TEST(Ranks, AloneItDoesEverythingInOrder) {
  Ranks ranks(nullptr);
  std::vector<std::string> delivered;
  ranks.distribute(
      4, [](std::int64_t k) { return std::to_string(k * k); },
      [&](std::int64_t k, std::string const& bytes) { delivered.push_back(std::to_string(k) + ":" + bytes); });
  EXPECT_THAT(delivered, testing::ElementsAre("0:0", "1:1", "2:4", "3:9"));
  EXPECT_EQ(ranks.size(), 1);
  EXPECT_TRUE(ranks.manager());
}

TEST(Ranks, DeliverInOrderOnTheManagerWhateverTheirNumber) {
  for (int const size : {1, 2, 3, 7}) {
    std::vector<std::string> delivered;
    std::set<int> workers;
    std::mutex mutex;
    Job const done = job(size, [&](Ranks& ranks) {
      ranks.distribute(
          200,
          [&](std::int64_t k) {
            if (k % 5 == 0) std::this_thread::sleep_for(1ms);  // later ones overtake
            std::lock_guard const lock(mutex);
            workers.insert(ranks.rank());
            return "item " + std::to_string(k) + std::string(std::size_t(k), '.');
          },
          [&](std::int64_t k, std::string const& bytes) {
            EXPECT_EQ(ranks.rank(), 0);
            EXPECT_EQ(k, std::int64_t(delivered.size()));
            EXPECT_EQ(bytes, "item " + std::to_string(k) + std::string(std::size_t(k), '.'));
            delivered.push_back(bytes);
          });
    });
    EXPECT_EQ(done.ends, silent(size));
    EXPECT_EQ(delivered.size(), 200u) << size;
    EXPECT_EQ(workers.size(), std::size_t(size)) << "all work, the manager too";
    EXPECT_EQ(done.left, size);
    EXPECT_EQ(done.letters_unread, 0u);
  }
}

TEST(Ranks, EveryItemCostsTwoMessagesAndAnEndOne) {
  Traffic total;
  std::int64_t by_others = 0;
  job(3, [&](Ranks& ranks) {
    ranks.distribute(
        50,
        [&](std::int64_t) {
          std::this_thread::sleep_for(200us);
          return std::to_string(ranks.rank());
        },
        [&](std::int64_t, std::string const& rank) { by_others += rank != "0"; });
    if (ranks.manager()) total = ranks.traffic();
  });
  EXPECT_GT(by_others, 0);
  EXPECT_EQ(total.messages, 2 * by_others + 2);
  EXPECT_EQ(total.bytes, by_others * (9 + 9 + 1) + 2 * 9);
}

TEST(Ranks, WhatComesEarlyIsBounded) {
  std::int64_t furthest = 0;
  std::atomic<bool> first_may_end = false;
  std::mutex mutex;
  job(4, [&](Ranks& ranks) {
    ranks.distribute(
        5000,
        [&](std::int64_t k) {
          auto const patience = std::chrono::steady_clock::now() + 400ms;
          while (k == 0 && std::chrono::steady_clock::now() < patience) std::this_thread::sleep_for(1ms);
          if (k == 0) first_may_end = true;
          std::lock_guard const lock(mutex);
          if (!first_may_end) furthest = std::max(furthest, k);
          return std::string();
        },
        [](std::int64_t, std::string const&) {});
  });
  EXPECT_EQ(furthest, 1023);
}

TEST(Ranks, AFailureOfWorkIsToldOnceByTheManager) {
  for (int const failing : {0, 2}) {
    std::atomic<int> worked = 0;
    Job const done = job(4, [&](Ranks& ranks) {
      ranks.distribute(
          1000,
          [&](std::int64_t) -> std::string {
            ++worked;
            std::this_thread::sleep_for(500us);
            if (ranks.rank() == failing) throw UsageError("no such thing");
            return "";
          },
          [](std::int64_t, std::string const&) {});
    });
    EXPECT_EQ(done.ends, told_once(4, failing == 0 ? "usage: no such thing" : "usage: no such thing (rank 2)"));
    EXPECT_EQ(done.left, 4) << "all take leave: nobody waits";
    EXPECT_LT(worked, 100);
  }
}

TEST(Ranks, TheKindOfAFailureTravels) {
  auto const end_when = [](std::function<void()> const& fail) {
    return job(2,
               [&](Ranks& ranks) {
                 ranks.together([&] {
                   if (ranks.rank() == 1) fail();
                 });
               })
        .ends;
  };
  EXPECT_EQ(end_when([] { throw NothingSelected("none"); }), told_once(2, "nothing: none (rank 1)"));
  EXPECT_EQ(end_when([] { throw std::bad_alloc(); }), told_once(2, "memory"));
  EXPECT_EQ(end_when([] { throw std::runtime_error("disk full"); }), told_once(2, "disk full (rank 1)"));
  EXPECT_EQ(end_when([] { throw 1; }), told_once(2, "an unknown failure (rank 1)"));
}

TEST(Ranks, AFailureThatAllHaveIsTheManagersOwn) {
  Job const done = job(3, [](Ranks& ranks) { ranks.together([] { throw UsageError("unknown suite"); }); });
  EXPECT_EQ(done.ends, told_once(3, "usage: unknown suite"));
  EXPECT_EQ(done.left, 3);
}

TEST(Ranks, AFailureOfDeliveryEndsAll) {
  Job const done = job(3, [](Ranks& ranks) {
    ranks.distribute(
        100, [](std::int64_t) { return std::string(); },
        [](std::int64_t k, std::string const&) {
          if (k == 7) throw std::runtime_error("cannot write");
        });
  });
  EXPECT_EQ(done.ends, told_once(3, "cannot write"));
  EXPECT_EQ(done.left, 3);
}

TEST(Ranks, TheManagerMakesItAndAllGetIt) {
  std::atomic<int> made = 0;
  Job const done = job(3, [&](Ranks& ranks) {
    EXPECT_EQ(ranks.from_manager([&] {
      ++made;
      return std::string("\0list", 5);
    }),
              std::string("\0list", 5));
  });
  EXPECT_EQ(done.ends, silent(3));
  EXPECT_EQ(made, 1);

  Job const failed =
      job(3, [&](Ranks& ranks) { ranks.from_manager([]() -> std::string { throw UsageError("locked"); }); });
  EXPECT_EQ(failed.ends, told_once(3, "usage: locked"));
}

TEST(Ranks, ARequestToStopOnAnyRankStopsAll) {
  for (int const asked : {0, 2}) {
    std::int64_t delivered = 0;
    std::atomic<int> half = 0;
    std::vector<std::atomic<bool>> stop(3);
    Job const done = job(3, [&](Ranks& ranks) {
      std::atomic<bool>& mine = stop[std::size_t(ranks.rank())];
      ranks.distribute(
          100000,
          [&](std::int64_t k) {
            if (k > 20 && ranks.rank() == asked) mine = true;
            if (mine) ++half;
            std::this_thread::sleep_for(200us);
            return std::string(mine ? "half" : "whole");
          },
          [&](std::int64_t, std::string const& bytes) {
            EXPECT_EQ(bytes, "whole");
            ++delivered;
          },
          &mine);
      EXPECT_TRUE(mine) << "rank " << ranks.rank();
    });
    EXPECT_EQ(done.ends, silent(3));
    EXPECT_GE(half, 1);
    EXPECT_LT(delivered, 1000);
  }
}

TEST(Ranks, StepsMayFollowEachOther) {
  std::string delivered;
  Job const done = job(3, [&](Ranks& ranks) {
    for (int round = 0; round < 20; ++round) {
      ranks.together([] {});
      std::string const letter = ranks.from_manager([&] { return std::string(1, char('a' + round)); });
      ranks.distribute(
          3, [&](std::int64_t) { return letter; }, [&](std::int64_t, std::string const& bytes) { delivered += bytes; });
      ranks.distribute(
          0, [](std::int64_t) { return std::string("?"); },
          [&](std::int64_t, std::string const& bytes) { delivered += bytes; });
    }
  });
  EXPECT_EQ(done.ends, silent(3));
  EXPECT_EQ(delivered.substr(0, 9), "aaabbbccc");
  EXPECT_EQ(delivered.size(), 60u);
  EXPECT_EQ(done.letters_unread, 0u);
}

TEST(Ranks, WhoFailsOutsideOfACallDoesNotTakeLeave) {
  Job const done = job(2, [](Ranks& ranks) {
    ranks.together([] {});
    throw std::runtime_error("alone with this");
  });
  EXPECT_EQ(done.ends, std::vector<std::string>(2, "alone with this"));
  EXPECT_EQ(done.left, 0) << "the launcher then ends the others";
}

}  // namespace
}  // namespace polhode::bench
