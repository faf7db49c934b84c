#pragma once
/// The built command as a user meets it: started in a fresh folder, without a shell, under a time limit; its output,
/// its messages and its exit code are kept apart.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "bench/process/machine.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::cli {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

using Folder = test::TemporaryFolder;
using test::text_of;

struct Result {
  int code = -1;  ///< the exit code; 128 + n when a signal n ended it
  std::string out, err;
  long memory = 0;  ///< the most that was resident at once, as far as it was seen [kB]
};

/// `words` separated by spaces; '' is an empty one.
inline Words split(std::string const& words) {
  Words all;
  for (std::size_t from = 0; from < words.size();) {
    std::size_t const to = std::min(words.find(' ', from), words.size());
    std::string const word = words.substr(from, to - from);
    if (!word.empty()) all.push_back(word == "''" ? "" : word);
    from = to + 1;
  }
  return all;
}

/// One process: started by the constructor, waited for by finish(), killed if still there at the end.
class Process {
 public:
  /// `out` and `err` replace the files in which the output is caught; `environment` is added: {"NAME=value"}. `program`
  /// is looked for in $PATH.
  Process(fs::path const& folder, Words words, Words environment = {}, fs::path const& out = {},
          fs::path const& err = {}, std::string const& program = POLHODE_BINARY) {
    words.insert(words.begin(), program);
    for (char** entry = environ; *entry != nullptr; ++entry)
      if (!std::string(*entry).starts_with("POLHODE_DATA=")) environment.emplace_back(*entry);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    auto const open = [&](int descriptor, fs::path const& file, int flags) {
      posix_spawn_file_actions_addopen(&actions, descriptor, file.c_str(), flags, 0600);
    };
    open(STDIN_FILENO, "/dev/null", O_RDONLY);
    open(STDOUT_FILENO, out.empty() ? caught_.path / "out" : out, O_WRONLY | O_CREAT);
    open(STDERR_FILENO, err.empty() ? caught_.path / "err" : err, O_WRONLY | O_CREAT | O_NOCTTY);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    int const error =
        posix_spawnp(&pid_, program.c_str(), &actions, nullptr, pointers(words).data(), pointers(environment).data());
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) throw std::system_error(error, std::generic_category(), program);
  }
  ~Process() {
    if (pid_ == 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Process(Process const&) = delete;
  Process& operator=(Process const&) = delete;

  void signal(int number) const { ::kill(pid_, number); }
  pid_t pid() const { return pid_; }

  Result finish(std::chrono::seconds limit = std::chrono::seconds(60)) {
    auto const end = std::chrono::steady_clock::now() + limit;
    int status = 0;
    long memory = 0;  // not that of wait4: it has the size of who started the process in it
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (std::chrono::steady_clock::now() > end) throw std::runtime_error("polhode takes longer than the time limit");
      std::string const peak = bench::entry_of(fs::path("/proc") / std::to_string(pid_) / "status", "VmHWM");
      memory = std::max(memory, std::atol(peak.c_str()));
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    pid_ = 0;
    return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), text_of(caught_.path / "out"),
            text_of(caught_.path / "err"), memory};
  }

 private:
  static std::vector<char*> pointers(Words& words) {
    std::vector<char*> all;
    for (std::string& word : words) all.push_back(word.data());
    all.push_back(nullptr);
    return all;
  }

  Folder caught_;
  pid_t pid_ = 0;
};

inline Result polhode(Folder const& folder, Words const& words, Words const& environment = {}) {
  return Process(folder.path, words, environment).finish();
}
inline Result polhode(Folder const& folder, std::string const& words, Words const& environment = {}) {
  return polhode(folder, split(words), environment);
}

}  // namespace polhode::cli
