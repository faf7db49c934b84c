#pragma once
/// Work in child processes: what aborts, overflows its stack or never comes back takes nobody else down.
#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

namespace polhode::bench {

/// What became of a piece of work.
struct Ended {
  std::string text;  ///< what it returned
  std::string
      died;  ///< how its process ended instead: "SIGSEGV", "exit code 3", "exception: ..."; empty if it returned
  bool late = false;  ///< it was killed for using up its time
};

/// Runs work(0) ... work(count - 1), each in a process of its own, at most `processes` at a time.
///   begin(i)    in this process, before the child starts
///   work(i)     in the child; what it returns goes through a pipe. An exception ends the child
///   done(i, e)  in this process, in the order in which they end
/// limit [s] of wall time each, 0 for none. Once `stop` is set, children are killed and nothing more is done.
/// To be called while the process has one thread: a child has no other, and would wait for their locks for ever.
/// Throws std::system_error if no process can be made; what begin or done throw is passed on, children killed.
void in_children(std::size_t count, int processes, double limit, std::atomic<bool> const& stop,
                 std::function<void(std::size_t)> const& begin, std::function<std::string(std::size_t)> const& work,
                 std::function<void(std::size_t, Ended const&)> const& done);

}  // namespace polhode::bench
