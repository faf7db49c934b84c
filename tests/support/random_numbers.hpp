#pragma once
/// Seeded random numbers and attitudes for tests: the same on every machine, which <random>'s distributions are not.
#include <cstdint>
#include <random>

#include "problems/attitude.hpp"

namespace polhode::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  double uniform(double low, double high) { return low + (high - low) * double(bits_() >> 11) * 0x1p-53; }
  /// Uniform in the cube [-size, size]^3.
  Vec3<double> vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
  Vec3<double> direction() {
    for (;;) {
      Vec3<double> const v = vector(1);
      double const size = length(v);
      if (0.1 < size && size < 1) return (1 / size) * v;
    }
  }
  /// Uniform on the unit sphere, to round-off.
  Quat<double> attitude() {
    for (;;) {
      Quat<double> const q{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      double const size = std::sqrt(dot(q, q));
      if (0.1 < size && size < 1) return scaled(1 / size, q);
    }
  }

 private:
  std::mt19937_64 bits_;
};

/// The same vector in another scalar.
template <class To, class From>
Vec3<To> in(Vec3<From> const& v) {
  return {To(v.x), To(v.y), To(v.z)};
}
template <class To, class From>
Quat<To> in(Quat<From> const& q) {
  return {To(q.x), To(q.y), To(q.z), To(q.w)};
}
template <class To, class From>
Mat3<To> in(Mat3<From> const& m) {
  return {in<To>(m.e1), in<To>(m.e2), in<To>(m.e3)};
}

}  // namespace polhode::test
