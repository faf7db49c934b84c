#include "bench/process/allocations.hpp"

#include <cstdlib>
#include <new>

namespace {

thread_local std::int64_t count = 0, bytes = 0;

void note(std::size_t size) {
  ++count;
  bytes += std::int64_t(size);
}
void* allocate(std::size_t size) {
  note(size);
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}

}  // namespace

// The replaceable operators of the whole program, every form, so that each new meets its own delete.
void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void* operator new(std::size_t size, std::nothrow_t const&) noexcept {
  note(size);
  return std::malloc(size > 0 ? size : 1);
}
void* operator new[](std::size_t size, std::nothrow_t const&) noexcept {
  note(size);
  return std::malloc(size > 0 ? size : 1);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::nothrow_t const&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::nothrow_t const&) noexcept {
  std::free(memory);
}

namespace polhode::bench {

std::int64_t allocations_of_this_thread() {
  return count;
}
std::int64_t allocated_bytes_of_this_thread() {
  return bytes;
}

}  // namespace polhode::bench
