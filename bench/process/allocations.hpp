#pragma once
/// Counts what the hot path must not do.
#include <cstdint>

namespace polhode::bench {

/// How often this thread has called operator new since it started. 0 for ever where the counting operators are not
/// linked.
std::int64_t allocations_of_this_thread();
/// How many bytes it has asked for.
std::int64_t allocated_bytes_of_this_thread();

}  // namespace polhode::bench
