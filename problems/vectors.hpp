#pragma once
/// Small vectors with named members: g++ 12 keeps them in registers, arrays and expression templates it does not.
/// A vector type has one law: V::each(f, a, b, ...) calls f on corresponding components, in storage order.
#include "problems/scalar.hpp"

namespace polhode {

/// Three components in one frame.
template <class S>
struct Vec3 {
  S x, y, z;
  static constexpr int size = 3;
  template <class F, class... V>
  static POLHODE_INLINE void each(F&& f, V&&... v) {
    f(v.x...);
    f(v.y...);
    f(v.z...);
  }
};

/// Quaternion, scalar last, Hamilton product.
template <class S>
struct Quat {
  S x, y, z, w;
  static constexpr int size = 4;
  template <class F, class... V>
  static POLHODE_INLINE void each(F&& f, V&&... v) {
    f(v.x...);
    f(v.y...);
    f(v.z...);
    f(v.w...);
  }
};

/// 3 x 3 matrix by columns.
template <class S>
struct Mat3 {
  Vec3<S> e1, e2, e3;
  static constexpr int size = 9;
  template <class F, class... V>
  static POLHODE_INLINE void each(F&& f, V&&... v) {
    Vec3<S>::each(f, v.e1...);
    Vec3<S>::each(f, v.e2...);
    Vec3<S>::each(f, v.e3...);
  }
};

/// A pair of vectors as one.
template <class A, class B>
struct Pair {
  A first;
  B second;
  static constexpr int size = A::size + B::size;
  template <class F, class... V>
  static POLHODE_INLINE void each(F&& f, V&&... v) {
    A::each(f, v.first...);
    B::each(f, v.second...);
  }
};

/// u += c k.
template <class V, class C>
POLHODE_INLINE void add(V& u, C const& c, V const& k) {
  V::each([&](auto& a, auto const& b) POLHODE_LAMBDA { a += c * b; }, u, k);
}
/// u += k.
template <class V>
POLHODE_INLINE void add(V& u, V const& k) {
  V::each([&](auto& a, auto const& b) POLHODE_LAMBDA { a += b; }, u, k);
}
/// u = c k.
template <class V, class C>
POLHODE_INLINE void assign_scaled(V& u, C const& c, V const& k) {
  V::each([&](auto& a, auto const& b) POLHODE_LAMBDA { a = c * b; }, u, k);
}
/// u = c u.
template <class V, class C>
POLHODE_INLINE void scale(V& u, C const& c) {
  V::each([&](auto& a) POLHODE_LAMBDA { a = c * a; }, u);
}
/// c k.
template <class V, class C>
POLHODE_INLINE V scaled(C const& c, V const& k) {
  V u;
  assign_scaled(u, c, k);
  return u;
}
/// Every component of u becomes `value`.
template <class V>
POLHODE_INLINE void fill(V& u, double value) {
  V::each([&](auto& a) POLHODE_LAMBDA { a = std::decay_t<decltype(a)>(value); }, u);
}
template <class V>
POLHODE_INLINE V zero() {
  V u;
  fill(u, 0.0);
  return u;
}
/// Greatest |a - b| over components.
template <class S, class V>
POLHODE_INLINE S distance(V const& u, V const& v) {
  S m(0.0);
  V::each([&](auto const& a, auto const& b) POLHODE_LAMBDA { m = max_of(m, abs_of(S(a - b))); }, u, v);
  return m;
}
/// Greatest |a| over components.
template <class S, class V>
POLHODE_INLINE S largest(V const& u) {
  S m(0.0);
  V::each([&](auto const& a) POLHODE_LAMBDA { m = max_of(m, abs_of(a)); }, u);
  return m;
}
template <class V>
bool all_finite(V const& v) {
  bool good = true;
  V::each([&](auto const& a) { good = good && is_finite(a); }, v);
  return good;
}
/// Components in storage order, and back.
template <class V, class S>
POLHODE_INLINE void store(V const& v, S* out) {
  V::each([&](auto const& a) POLHODE_LAMBDA { *out++ = a; }, v);
}
template <class V, class S>
POLHODE_INLINE void load(V& v, S const* in) {
  V::each([&](auto& a) POLHODE_LAMBDA { a = *in++; }, v);
}
/// The vector of the components from `in` on, in its own precision.
template <class V, class S>
V loaded(S const* in) {
  V v;
  V::each([&](auto& a) { a = std::remove_reference_t<decltype(a)>(*in++); }, v);
  return v;
}

template <class S>
POLHODE_INLINE Vec3<S> operator+(Vec3<S> const& a, Vec3<S> const& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class S>
POLHODE_INLINE Vec3<S> operator-(Vec3<S> const& a, Vec3<S> const& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class C, class S>
POLHODE_INLINE Vec3<S> operator*(C const& c, Vec3<S> const& a) {
  return {c * a.x, c * a.y, c * a.z};
}
template <class S>
POLHODE_INLINE S dot(Vec3<S> const& a, Vec3<S> const& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
POLHODE_INLINE S length(Vec3<S> const& a) {
  return sqrt(dot(a, a));
}
template <class S>
POLHODE_INLINE Vec3<S> cross(Vec3<S> const& a, Vec3<S> const& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
POLHODE_INLINE S dot(Quat<S> const& p, Quat<S> const& q) {
  return p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w;
}

/// m v.   R  S, or the type of its parameters
template <class R, class S>
POLHODE_INLINE Vec3<S> operator*(Mat3<R> const& m, Vec3<S> const& v) {
  return {m.e1.x * v.x + m.e2.x * v.y + m.e3.x * v.z, m.e1.y * v.x + m.e2.y * v.y + m.e3.y * v.z,
          m.e1.z * v.x + m.e2.z * v.y + m.e3.z * v.z};
}
/// m^T v.
template <class S>
POLHODE_INLINE Vec3<S> transposed_times(Mat3<S> const& m, Vec3<S> const& v) {
  return {dot(m.e1, v), dot(m.e2, v), dot(m.e3, v)};
}
template <class S>
POLHODE_INLINE Mat3<S> operator*(Mat3<S> const& a, Mat3<S> const& b) {
  return {a * b.e1, a * b.e2, a * b.e3};
}
/// m^T m, symmetric.
template <class S>
Mat3<S> gram(Mat3<S> const& m) {
  return {transposed_times(m, m.e1), transposed_times(m, m.e2), transposed_times(m, m.e3)};
}

}  // namespace polhode
