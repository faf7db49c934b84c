#pragma once
/// How items are dealt out to the ranks of a job; see Ranks::distribute.
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>

#include "bench/job/channel.hpp"

namespace polhode::bench {

/// Item k, done: bytes.
using Work = std::function<std::string(std::int64_t)>;
/// Takes what came of item k.
using Deliver = std::function<void(std::int64_t, std::string)>;

/// The manager's part. Returns the first failure, if any; nobody has an item then, and all workers listen.
std::exception_ptr deal_out(Channel& channel, std::int64_t count, Work const& work, Deliver const& deliver,
                            std::atomic<bool>& stop);

/// A worker's part: does what it is given until the manager says that all is done. False if it says that the job has
/// ended.
bool serve(Channel& channel, Work const& work, std::atomic<bool>& stop);

}  // namespace polhode::bench
