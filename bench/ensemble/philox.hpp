#pragma once
/// Random numbers without a state: a function of a counter and a key.
#include <array>
#include <cstdint>

namespace polhode::bench {

/// Philox4x32-10: four random words for each counter under each key. Equal in all programs; tested against the known
/// answers of its authors' library, Random123.
/// Source: Salmon, Moraes, Dror & Shaw (2011), "Parallel random numbers: as easy as 1, 2, 3", SC '11, sec. 4.3
inline std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  constexpr std::uint64_t multiplier_0 = 0xD2511F53, multiplier_1 = 0xCD9E8D57;
  constexpr std::uint32_t weyl_0 = 0x9E3779B9, weyl_1 = 0xBB67AE85;
  constexpr int rounds = 10;
  for (int round = 0; round < rounds; ++round) {
    std::uint64_t const a = multiplier_0 * counter[0], b = multiplier_1 * counter[2];
    counter = {std::uint32_t(b >> 32) ^ counter[1] ^ key[0], std::uint32_t(b),
               std::uint32_t(a >> 32) ^ counter[3] ^ key[1], std::uint32_t(a)};
    key = {key[0] + weyl_0, key[1] + weyl_1};
  }
  return counter;
}

/// Two words as a number of 52 bits, uniform in (0, 1): neither end can come, so logarithms are finite.
inline double open_unit(std::uint32_t high, std::uint32_t low) {
  std::uint64_t const bits = (std::uint64_t(high) << 32 | low) >> 12;
  return (double(bits) + 0.5) * 0x1p-52;
}

}  // namespace polhode::bench
