#pragma once
/// Vectors of numbers, one for each lane, as one vector of lanes.

namespace polhode {

/// The vector X over lanes whose lane i is of(i), a vector of numbers.
template <class X, class Of>
X from_lanes(int lanes, Of const& of) {
  X x{};
  for (int i = 0; i < lanes; ++i) X::each([&](auto& to, double from) { to.set(i, from); }, x, of(i));
  return x;
}

}  // namespace polhode
