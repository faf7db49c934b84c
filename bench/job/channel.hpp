#pragma once
/// How the ranks of a job reach each other.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace polhode::bench {

/// Bytes from a rank.
struct Message {
  int from = 0;
  std::string bytes{};
};

/// What went through a channel, both ways.
struct Traffic {
  std::int64_t messages = 0, bytes = 0;
  double cpu_time = 0;  ///< of the thread that listens, while items were dealt out [s]
};

/// Messages arrive whole, and those of one sender to one receiver in order. Used by one thread.
class Channel {
 public:
  virtual ~Channel() = default;
  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// Ranks on this machine, this one included.
  virtual int on_this_node() const = 0;
  /// May wait until the receiver takes it.
  virtual void send(int to, std::string const& bytes) = 0;
  /// What has come, from whoever; never waits.
  virtual std::optional<Message> receive() = 0;
  virtual Traffic traffic() const = 0;
  /// The end, for all ranks. A channel that is destroyed without it is a rank that died: the launcher ends the others.
  virtual void leave() = 0;
};

/// The ranks of this MPI job (MPI_THREAD_FUNNELED); null if this binary was built without MPI.
std::unique_ptr<Channel> mpi_channel();
/// "Open MPI 4.1.4"; empty if this binary was built without MPI.
std::string mpi_version();

}  // namespace polhode::bench
