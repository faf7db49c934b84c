#pragma once
/// What the ranks of a job say to each other. The manager is rank 0; the others are workers and speak to it alone.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <optional>
#include <string>
#include <utility>

#include "bench/job/channel.hpp"

namespace polhode::bench {

enum class Word : char {
  arrived,  ///< to the manager: my step is done
  failed,   ///< to the manager: kind and text of an exception. To all: the job has ended
  go,       ///< to all: everybody arrived; what was dealt out is done
  bytes,    ///< to all: from the manager
  item,     ///< to a worker: do number k
  done,     ///< to the manager: number k, and what came of it
  stop      ///< to the manager, and to all: no more
};

/// 9 bytes and the text.
struct Note {
  Word word = Word::go;
  std::int64_t k = 0;
  std::string text{};
};

/// A note and its sender.
struct Heard {
  int from = 0;
  Note note{};
};

void send(Channel& channel, int to, Note const& note);
/// From the manager to all workers.
void send_all(Channel& channel, Note const& note);
/// What has come, if anything.
std::optional<Heard> hear(Channel& channel);
/// The next note; waits for it. A `stop` that came too late for what it was to stop is passed over.
Heard await(Channel& channel);

/// An exception as a note, and again as an exception: with what decides the exit code, and its text.
Note note_of(std::exception_ptr const& failure);
std::exception_ptr failure_of(Heard const& failed);

/// Pauses that grow: who waits for long need not be quick, and must leave the processor to who works.
class Patience {
 public:
  std::chrono::microseconds next() {
    return std::exchange(pause_, std::min(2 * pause_, std::chrono::microseconds(1000)));
  }
  void reset() { pause_ = shortest; }

 private:
  static constexpr std::chrono::microseconds shortest{20};
  std::chrono::microseconds pause_ = shortest;
};

}  // namespace polhode::bench
