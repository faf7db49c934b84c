/// The one file that knows MPI.
#include "bench/job/channel.hpp"

#ifdef POLHODE_HAS_MPI
#include <mpi.h>

#include <limits>
#include <stdexcept>
#endif

namespace polhode::bench {

#ifdef POLHODE_HAS_MPI
namespace {

/// MPI's own error handler ends the job: a call that returns has succeeded.
class MpiChannel final : public Channel {
 public:
  MpiChannel() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm node;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
    MPI_Comm_size(node, &on_this_node_);
    MPI_Comm_free(&node);
    // Another thread works while this one listens.
    if (provided < MPI_THREAD_FUNNELED) throw std::runtime_error("MPI cannot be used beside threads here");
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int on_this_node() const override { return on_this_node_; }
  Traffic traffic() const override { return traffic_; }

  void send(int to, std::string const& bytes) override {
    if (bytes.size() > std::size_t(std::numeric_limits<int>::max()))
      throw std::length_error("more than 2 GiB in one message between ranks");
    MPI_Send(bytes.data(), int(bytes.size()), MPI_CHAR, to, tag, MPI_COMM_WORLD);
    note(bytes);
  }
  std::optional<Message> receive() override {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &there, &status);
    if (there == 0) return {};
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    Message message{status.MPI_SOURCE, std::string(std::size_t(size), '\0')};
    MPI_Recv(message.bytes.data(), size, MPI_CHAR, message.from, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    note(message.bytes);
    return message;
  }
  void leave() override { MPI_Finalize(); }

 private:
  static constexpr int tag = 1;
  void note(std::string const& bytes) {
    ++traffic_.messages;
    traffic_.bytes += std::int64_t(bytes.size());
  }

  int rank_ = 0, size_ = 1, on_this_node_ = 1;
  Traffic traffic_;
};

}  // namespace

std::unique_ptr<Channel> mpi_channel() {
  return std::make_unique<MpiChannel>();
}

std::string mpi_version() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = {};
  int length = 0;
  MPI_Get_library_version(text, &length);
  std::string const all(text, std::size_t(length));
  return all.substr(0, all.find_first_of(",\n"));
}
#else
std::unique_ptr<Channel> mpi_channel() {
  return nullptr;
}

std::string mpi_version() {
  return {};
}
#endif

}  // namespace polhode::bench
