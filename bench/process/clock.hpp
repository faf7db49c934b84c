#pragma once
/// Clocks: processor time as it passes, and limits of wall time.
#include <chrono>
#include <ctime>

namespace polhode::bench {

/// What a clock of POSIX shows [s]: CLOCK_PROCESS_CPUTIME_ID is the processor time of all threads together,
/// CLOCK_THREAD_CPUTIME_ID that of this one.
inline double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// So much wall time from now on.
class TimeLimit {
 public:
  /// [s]; 0 for none, as is what the clock cannot count: 30 years.
  explicit TimeLimit(double seconds) : limited_(seconds > 0 && seconds < 1e9) {
    if (limited_)
      end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  bool passed() const { return limited_ && Clock::now() > end_; }

 private:
  using Clock = std::chrono::steady_clock;
  bool limited_;
  Clock::time_point end_{};
};

}  // namespace polhode::bench
