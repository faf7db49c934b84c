#include "bench/process/signals.hpp"

#include <csignal>

namespace polhode::bench {

std::atomic<bool> interrupted = false;

void interruptible() {
  auto const note = [](int) { interrupted = true; };
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace polhode::bench
