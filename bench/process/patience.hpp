#pragma once
/// Work that may take minutes, with a word on stderr where it does.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <future>
#include <string>
#include <utility>

namespace polhode::bench {

/// Runs `work`, in a thread of its own, and returns what it returns. If it takes longer than `patience` it is said what
/// is going on: with the time so far on a terminal, otherwise in one line. What work throws is passed on.
template <class Work>
auto patiently(std::string const& what, Work&& work, std::chrono::milliseconds patience = std::chrono::seconds(3)) {
  using Clock = std::chrono::steady_clock;
  using std::chrono::seconds;
  auto const start = Clock::now();
  auto result = std::async(std::launch::async, std::forward<Work>(work));
  bool const terminal = isatty(STDERR_FILENO) != 0;
  bool said = false;
  while (result.wait_for(said ? seconds(1) : patience) != std::future_status::ready) {
    auto const passed = std::chrono::duration_cast<seconds>(Clock::now() - start).count();
    if (terminal)
      std::fputs(fmt::format("\r{}: {}:{:02}\033[K", what, passed / 60, passed % 60).c_str(), stderr);
    else if (!said)
      std::fputs(fmt::format("polhode: {}; this can take minutes\n", what).c_str(), stderr);
    said = true;
  }
  if (terminal && said) std::fputs("\r\033[K", stderr);
  return result.get();
}

}  // namespace polhode::bench
