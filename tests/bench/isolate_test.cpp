// Work in child processes: whatever becomes of one, the others go on. And one writer for a result folder.
#include "bench/job/isolate.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <thread>

#include "results/file_name.hpp"
#include "results/folder_lock.hpp"
#include "results/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode {
namespace {

using bench::Ended;
using bench::in_children;

/// Recursion until the stack is used up; what it adds to the result keeps it from becoming a loop.
int overflow(int const volatile* depth) {
  int volatile here[1024];
  here[0] = *depth + 1;
  if (here[0] < 0) return 0;
  return overflow(here) + here[0];
}

std::string misbehave(std::size_t i) {
  int volatile start = 0;
  switch (i) {
    case 1:
      std::abort();
    case 2:
      return std::to_string(overflow(&start));
    case 3:
      ::raise(SIGKILL);
      break;
    case 4:
      throw std::runtime_error("no such luck");
    case 5:
      ::_exit(3);
    case 6:
      for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
    case 7:
      return std::string(1 << 20, 'x');  // more than a pipe holds
    default:
      break;
  }
  return "fine " + std::to_string(i);
}

#ifdef __SANITIZE_ADDRESS__
constexpr char const* overflowed = "exit code 1";  // the sanitizer hears it first
#else
constexpr char const* overflowed = "SIGSEGV";
#endif

TEST(Isolate, EachEndIsToldAndNobodyElseSuffers) {
  std::atomic<bool> const stop = false;
  for (int const processes : {1, 3}) {
    std::map<std::size_t, Ended> ended;
    std::vector<std::size_t> begun;
    in_children(
        9, processes, 5, stop, [&](std::size_t i) { begun.push_back(i); }, misbehave,
        [&](std::size_t i, Ended const& what) { EXPECT_TRUE(ended.emplace(i, what).second) << i; });
    EXPECT_THAT(begun, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
    ASSERT_EQ(ended.size(), 9U);
    std::map<std::size_t, std::string> const died{{1, "SIGABRT"},     {2, overflowed},
                                                  {3, "SIGKILL"},     {4, "exception: no such luck"},
                                                  {5, "exit code 3"}, {6, "SIGKILL"}};
    for (auto const& [i, what] : ended) {
      EXPECT_EQ(what.died, died.contains(i) ? died.at(i) : "") << i;
      EXPECT_EQ(what.late, i == 6) << i;
      if (!died.contains(i)) {
        EXPECT_EQ(what.text, misbehave(i)) << i;
      }
    }
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "no child is left";
  }
}

TEST(Isolate, StopKillsWhatRuns) {
  std::atomic<bool> stop = false;
  std::thread soon([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop = true;
  });
  int done = 0;
  in_children(
      3, 2, 0, stop, [](std::size_t) {}, [](std::size_t) { return misbehave(6); },
      [&](std::size_t, Ended const&) { ++done; });
  soon.join();
  EXPECT_EQ(done, 0);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
}

TEST(Isolate, TroubleInThisProcessKillsTheChildren) {
  std::atomic<bool> const stop = false;
  EXPECT_THROW(in_children(
                   4, 3, 0, stop,
                   [](std::size_t i) {
                     if (i == 2) throw std::runtime_error("disk full");
                   },
                   [](std::size_t) { return misbehave(6); }, [](std::size_t, Ended const&) {}),
               std::runtime_error);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
}

// ---- One writer -----------------------------------------------------------------------------------------------------

struct LockedFolder : testing::Test {
  polhode::test::TemporaryFolder folder;
  std::filesystem::path const path = folder.path;
};

TEST_F(LockedFolder, HasOneWriter) {
  using results::FolderLock;
  {
    FolderLock const mine(path);
    EXPECT_THROW(FolderLock{path}, results::StoreError);
    EXPECT_THROW(FolderLock(path, 1, 2), results::StoreError);
  }
  FolderLock const one(path, 1, 2), two(path, 2, 2);
  EXPECT_THROW(FolderLock(path, 1, 2), results::StoreError);
  EXPECT_THROW(FolderLock{path}, results::StoreError);
}

TEST_F(LockedFolder, IsFreeAfterAKill) {
  pid_t const child = ::fork();
  if (child == 0) {
    results::FolderLock const its(path);
    ::raise(SIGKILL);
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_NO_THROW(results::FolderLock{path});
}

TEST_F(LockedFolder, WithoutLeaveToWriteHoldsNothing) {
  EXPECT_NO_THROW(results::FolderLock{path / "not-there"});
}

TEST(FileName, IsNeverAPath) {
  using results::file_name_of;
  EXPECT_EQ(file_name_of("default"), "default");
  EXPECT_EQ(file_name_of("../../etc/passwd"), "_.._.._etc_passwd");
  EXPECT_EQ(file_name_of("/etc"), "_etc");
  for (std::string const bad : {"", ".", "..", ".lock"}) EXPECT_EQ(file_name_of(bad), "_" + bad);
  EXPECT_EQ(file_name_of(std::string("a\0b\nc", 5)), "a_b_c");
  EXPECT_EQ(file_name_of(std::string(1000, 'x')).size(), 200U);
}

}  // namespace
}  // namespace polhode
