#pragma once
/// Which vector registers a kernel is compiled for, and which this machine has: one binary for every x86-64.
#include "problems/lanes.hpp"

namespace polhode {

/// Register sets that a kernel can be compiled for beside each other; the value is their width in bytes.
enum class Registers { of_the_unit = register_bytes, avx2 = 32, avx512 = 64 };

// Calls between functions for different registers must not pass lanes by value. In a kernel everything is inlined, but
// only when the unit is optimised; what is marked noinline takes references. Under the sanitizers one set is enough:
// each takes g++ a minute. clang 16 does not know these names of sets.
#if defined(__x86_64__) && !defined(__SSE3__) && defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
inline constexpr bool chooses_registers = true;
#define POLHODE_TARGET(arch) [[gnu::target(arch)]]
// At the end of a function with a target of its own. g++ 12 may forget to clear the upper halves, and then all code for
// narrow registers runs at a third of its speed until somebody does.
#define POLHODE_LEAVE_TARGET() __builtin_ia32_vzeroupper()
/// The widest that this machine and this unit know.
inline Registers widest_registers() {
  static Registers const widest = __builtin_cpu_supports("x86-64-v4")   ? Registers::avx512
                                  : __builtin_cpu_supports("x86-64-v3") ? Registers::avx2
                                                                        : Registers::of_the_unit;
  return widest;
}
#else  // a unit for a newer instruction set than every machine has uses that one
inline constexpr bool chooses_registers = false;
#define POLHODE_TARGET(arch)
#define POLHODE_LEAVE_TARGET() void()
/// The widest that this unit knows.
inline Registers widest_registers() {
  return Registers::of_the_unit;
}
#endif

}  // namespace polhode
