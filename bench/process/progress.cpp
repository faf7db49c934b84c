#include "bench/process/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace polhode::bench {

Progress::Progress(std::size_t total)
    : terminal_(isatty(STDERR_FILENO) != 0),
      total_(double(total)),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_) {}

Progress::~Progress() {
  if (terminal_ && total_ > 0) std::fputs("\r\033[K", stderr);
}

void Progress::say(std::string what) {
  std::lock_guard const lock(mutex_);
  what_ = std::move(what);
  draw(true);
}

void Progress::advance(double parts) {
  std::lock_guard const lock(mutex_);
  done_ = std::min(done_ + parts, total_);
  draw(false);
}

void Progress::draw(bool always) {
  if (!terminal_ || !(total_ > 0)) return;
  auto const now = std::chrono::steady_clock::now();
  if (!always && now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  constexpr int width = 24;
  double const share = done_ / total_;
  int const full = int(share * width);
  double const elapsed = std::chrono::duration<double>(now - start_).count();
  std::string left;
  if (share > 0.02 && share < 1) {
    int const seconds = int(std::lround(elapsed * (1 - share) / share));
    left = fmt::format("  {}:{:02} left", seconds / 60, seconds % 60);
  }
  // \033[K clears what a longer line left behind.
  std::string const line = fmt::format("\r[{:#<{}}{:.<{}}] {:3.0f}%{}  {}\033[K", "", full, "", width - full,
                                       100 * share, left, what_.substr(0, 60));
  std::fputs(line.c_str(), stderr);
}

}  // namespace polhode::bench
