#pragma once
/// Ctrl-C and its like: a run ends between cells, an ensemble between samples, and what is on disk stays.
#include <atomic>

namespace polhode::bench {

/// Somebody asked this process to end: by a signal, or from another rank.
extern std::atomic<bool> interrupted;
/// From now on SIGINT and SIGTERM set it, and a limit on the size of files is an error of the write, with a name.
void interruptible();

}  // namespace polhode::bench
