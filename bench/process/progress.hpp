#pragma once
/// A progress bar on stderr, when that is a terminal; otherwise silent.
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace polhode::bench {

/// Thread-safe. The bar shows parts done of all, what is going on, and the time left by the pace so far.
class Progress {
 public:
  explicit Progress(std::size_t total);
  ~Progress();
  Progress(Progress const&) = delete;
  Progress& operator=(Progress const&) = delete;
  /// What is going on now, e.g. "tether_capture case1,g1: accuracy".
  void say(std::string what);
  /// `parts` more are done.
  void advance(double parts = 1);

 private:
  void draw(bool always);

  std::mutex mutex_;
  bool terminal_;
  double done_ = 0, total_;
  std::string what_;
  std::chrono::steady_clock::time_point start_, drawn_;
};

}  // namespace polhode::bench
