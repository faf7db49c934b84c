#pragma once
/// Several numbers that are computed with at once, one in each lane of the vector registers: bodies of a fleet, stages
/// of a method. A problem's source runs over them unchanged, if it selects where it could branch.
///
/// Every operation is IEEE's in every lane, so lanes give what scalars give, to the last bit, whatever the registers;
/// only sin and cos are polynomials of their own, within 1 ulp.
#include <cstdint>
#include <cstring>
#include <limits>

#include "problems/arctangent.hpp"
#include "problems/scalar.hpp"

namespace polhode {

/// Width of the widest vector register that this unit's instruction set has [bytes].
#if defined(__AVX512F__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

namespace detail {
template <class T>
struct LaneInteger;
template <>
struct LaneInteger<double> {
  using type = std::int64_t;
};
template <>
struct LaneInteger<float> {
  using type = std::int32_t;
};

/// How n numbers lie in registers of at most `bytes`.
template <int n, class T, int bytes>
struct LaneLayout {
  static constexpr int in_part = n * int(sizeof(T)) < bytes ? n : bytes / int(sizeof(T));
  static constexpr int parts = n / in_part;
  static_assert(parts * in_part == n && (in_part & (in_part - 1)) == 0, "lanes fill their registers");
  using Integer = typename LaneInteger<T>::type;
  typedef T Part __attribute__((vector_size(in_part * sizeof(T))));
  typedef Integer MaskPart __attribute__((vector_size(in_part * sizeof(T))));
};

/// The result of f(its register, corresponding registers of `of`): by reference, for the ABI of vectors depends on
/// flags.
template <class R, class F, class... L>
POLHODE_INLINE R by_parts(F&& f, L const&... of) {
  R r;
  if constexpr (R::Layout::parts == 1)
    f(r.part[0], of.part[0]...);
  else
    unroll<R::Layout::parts>([&](auto i) POLHODE_LAMBDA { f(r.part[i], of.part[i]...); });
  return r;
}
}  // namespace detail

/// One truth in each lane.
template <int n, class T, int bytes>
struct LaneMask {
  using Layout = detail::LaneLayout<n, T, bytes>;
  typename Layout::MaskPart part[Layout::parts];  ///< 0 or -1

  POLHODE_INLINE bool operator[](int lane) const { return part[lane / Layout::in_part][lane % Layout::in_part] != 0; }

  friend POLHODE_INLINE LaneMask operator&(LaneMask const& a, LaneMask const& b) {
    return detail::by_parts<LaneMask>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x & y; }, a, b);
  }
  friend POLHODE_INLINE LaneMask operator|(LaneMask const& a, LaneMask const& b) {
    return detail::by_parts<LaneMask>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x | y; }, a, b);
  }
  friend POLHODE_INLINE LaneMask operator!(LaneMask const& a) {
    return detail::by_parts<LaneMask>([](auto& r, auto const& x) POLHODE_LAMBDA { r = ~x; }, a);
  }
};

/// n numbers. Comparisons give masks, which do not convert to bool: a branch on lanes does not compile.
///   n      a power of 2
///   bytes  of one register; a kernel for another instruction set than its unit's says which
template <int n, class T = double, int bytes = register_bytes>
struct Lanes {
  using Layout = detail::LaneLayout<n, T, bytes>;
  using Mask = LaneMask<n, T, bytes>;
  using Part = typename Layout::Part;
  static constexpr int count = n, parts = Layout::parts, in_part = Layout::in_part;

  Part part[parts];

  Lanes() = default;
  /// x in every lane.
  POLHODE_INLINE Lanes(T x) {
    // By way of integers: in a kernel for another instruction set than its unit's, g++ 12 would store the filled vector
    // lane by lane. (An asm against that hides constants from the optimiser, too.)
    using Bits = typename Layout::MaskPart;
    typename Layout::Integer bits;
    std::memcpy(&bits, &x, sizeof x);
    Part const filled = Part(bits - Bits{});
    unroll<parts>([&](auto i) POLHODE_LAMBDA { part[i] = filled; });
  }
  POLHODE_INLINE Lanes(double x) requires(!std::same_as<T, double>) : Lanes(T(x)) {}

  /// Lane i is f(i).
  template <class F>
  static POLHODE_INLINE Lanes of(F&& f) {
    Lanes r;
    unroll<n>([&](auto i) POLHODE_LAMBDA { r.part[i / in_part][i % in_part] = T(f(int(i))); });
    return r;
  }
  /// The n numbers from `from` on, and back.
  static POLHODE_INLINE Lanes load(T const* from) {
    Lanes r;
    std::memcpy(r.part, from, sizeof r.part);
    return r;
  }
  POLHODE_INLINE void store(T* to) const { std::memcpy(to, part, sizeof part); }

  POLHODE_INLINE T operator[](int lane) const { return part[lane / in_part][lane % in_part]; }
  POLHODE_INLINE void set(int lane, T x) { part[lane / in_part][lane % in_part] = x; }

  friend POLHODE_INLINE Lanes operator+(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Lanes>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x + y; }, a, b);
  }
  friend POLHODE_INLINE Lanes operator-(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Lanes>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x - y; }, a, b);
  }
  friend POLHODE_INLINE Lanes operator*(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Lanes>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x * y; }, a, b);
  }
  // With a number the same everywhere: spread in the operation itself, which stays cheap in such kernels.
  friend POLHODE_INLINE Lanes operator+(T const& c, Lanes const& b) {
    return detail::by_parts<Lanes>([&](auto& r, auto const& y) POLHODE_LAMBDA { r = c + y; }, b);
  }
  friend POLHODE_INLINE Lanes operator+(Lanes const& a, T const& c) { return c + a; }
  friend POLHODE_INLINE Lanes operator-(T const& c, Lanes const& b) {
    return detail::by_parts<Lanes>([&](auto& r, auto const& y) POLHODE_LAMBDA { r = c - y; }, b);
  }
  friend POLHODE_INLINE Lanes operator-(Lanes const& a, T const& c) {
    return detail::by_parts<Lanes>([&](auto& r, auto const& x) POLHODE_LAMBDA { r = x - c; }, a);
  }
  friend POLHODE_INLINE Lanes operator*(T const& c, Lanes const& b) {
    return detail::by_parts<Lanes>([&](auto& r, auto const& y) POLHODE_LAMBDA { r = c * y; }, b);
  }
  friend POLHODE_INLINE Lanes operator*(Lanes const& a, T const& c) { return c * a; }
  friend POLHODE_INLINE Lanes operator/(T const& c, Lanes const& b) {
    return detail::by_parts<Lanes>([&](auto& r, auto const& y) POLHODE_LAMBDA { r = c / y; }, b);
  }
  friend POLHODE_INLINE Lanes operator/(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Lanes>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x / y; }, a, b);
  }
  friend POLHODE_INLINE Lanes operator-(Lanes const& a) {
    return detail::by_parts<Lanes>([](auto& r, auto const& x) POLHODE_LAMBDA { r = -x; }, a);
  }
  POLHODE_INLINE Lanes& operator+=(Lanes const& b) { return *this = *this + b; }
  POLHODE_INLINE Lanes& operator-=(Lanes const& b) { return *this = *this - b; }
  POLHODE_INLINE Lanes& operator*=(Lanes const& b) { return *this = *this * b; }

  friend POLHODE_INLINE Mask operator<(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Mask>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x < y; }, a, b);
  }
  friend POLHODE_INLINE Mask operator>(Lanes const& a, Lanes const& b) { return b < a; }
  friend POLHODE_INLINE Mask operator<=(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Mask>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x <= y; }, a, b);
  }
  friend POLHODE_INLINE Mask operator>=(Lanes const& a, Lanes const& b) { return b <= a; }
  friend POLHODE_INLINE Mask operator==(Lanes const& a, Lanes const& b) {
    return detail::by_parts<Mask>([](auto& r, auto const& x, auto const& y) POLHODE_LAMBDA { r = x == y; }, a, b);
  }

  /// a where the mask is set, else b.
  friend POLHODE_INLINE Lanes select(Mask const& mask, Lanes const& a, Lanes const& b) {
    return detail::by_parts<Lanes>(
        [](auto& r, auto const& m, auto const& x, auto const& y) POLHODE_LAMBDA { r = m ? x : y; }, mask, a, b);
  }
  friend POLHODE_INLINE Lanes abs_of(Lanes const& a) {
    Lanes r;
    unroll<parts>([&](auto i) POLHODE_LAMBDA {
      using Bits = typename Layout::MaskPart;
      constexpr auto all_but_sign = std::numeric_limits<typename Layout::Integer>::max();
      r.part[i] = Part(Bits(a.part[i]) & (Bits{} + all_but_sign));
    });
    return r;
  }
  /// Lane by lane, as the function of scalars. The loop is one that g++ vectorises.
  template <class F>
  friend POLHODE_INLINE Lanes each_lane(Lanes const& a, F f) {
    alignas(bytes) T in[n], out[n];
    a.store(in);
    for (int i = 0; i < n; ++i) out[i] = f(in[i]);
    return load(out);
  }
  friend POLHODE_INLINE Lanes sqrt(Lanes const& a) {
    return each_lane(a, [](T x) POLHODE_LAMBDA { return std::sqrt(x); });
  }
  friend POLHODE_INLINE Lanes floor(Lanes const& a) {
    return each_lane(a, [](T x) POLHODE_LAMBDA { return std::floor(x); });
  }
  friend POLHODE_INLINE Lanes nearest_whole(Lanes const& a) { return floor(a + Lanes(T(0.5))); }
  friend Lanes atan2(Lanes const& y, Lanes const& x) {
    return of([&](int i) { return std::atan2(y[i], x[i]); });
  }
  friend POLHODE_INLINE bool is_finite(Lanes const& a) { return all_of(a - a == Lanes(0.0)); }
};

template <int n, class T, int bytes>
struct ScalarTraits<Lanes<n, T, bytes>> {
  using Real = T;
  static constexpr bool short_series = ScalarTraits<T>::short_series;
  static constexpr bool flattened = true;
};

/// Lanes of numbers that are the same everywhere: a where the mask is set, else b.
template <int n, class T, int bytes>
POLHODE_INLINE Lanes<n, T, bytes> select(LaneMask<n, T, bytes> const& mask, T const& a, T const& b) {
  using L = Lanes<n, T, bytes>;
  return select(mask, L(a), L(b));
}

/// True in every lane; in some lane.
template <int n, class T, int bytes>
POLHODE_INLINE bool all_of(LaneMask<n, T, bytes> const& mask) {
  return !any_of(!mask);
}
template <int n, class T, int bytes>
POLHODE_INLINE bool any_of(LaneMask<n, T, bytes> const& mask) {
  using Layout = detail::LaneLayout<n, T, bytes>;
  typename Layout::MaskPart joined = mask.part[0];
  unroll<Layout::parts - 1>([&](auto i) POLHODE_LAMBDA { joined |= mask.part[i + 1]; });
  typename Layout::Integer some = 0;
  unroll<Layout::in_part>([&](auto i) POLHODE_LAMBDA { some |= joined[int(i)]; });
  return some != 0;
}
/// The sum over lanes, by halves.
template <int n, class T, int bytes>
POLHODE_INLINE T sum_of(Lanes<n, T, bytes> const& a) {
  T sum[n];
  a.store(sum);
  for (int half = n / 2; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
  return sum[0];
}
/// The greatest lane.
template <int n, class T, int bytes>
POLHODE_INLINE T greatest_of(Lanes<n, T, bytes> const& a) {
  T most = a[0];
  unroll<n - 1>([&](auto i) POLHODE_LAMBDA { most = max_of(most, a[i + 1]); });
  return most;
}

namespace detail {
/// Both from one reduction of the argument: the nearest multiple k of pi/2 is taken off in three parts, the rest goes
/// into polynomials of least error.   Source: Cody & Waite (1980); polynomials of FDLIBM (Sun Microsystems, 1993)
template <int n, int bytes>
struct SinCosLanes {
  using L = Lanes<n, double, bytes>;
  L sin, cos;
  static constexpr double farthest = 1e5;  ///< beyond which the parts of pi/2 are too short

  explicit POLHODE_INLINE SinCosLanes(L const& x) {
    constexpr double to_whole = 0x1.8p52;  // added, it rounds to a whole number
    L const shifted = x * 0.63661977236758134308 + to_whole, k = shifted - to_whole;
    L const first = x - k * 1.57079632673412561417, second = k * 6.07710050630396597660e-11;
    L const head = first - second;
    L const taken = k * 2.02226624879595063154e-21 - ((first - head) - second);
    L const r = head - taken, tail = (head - r) - taken;  // r + tail to more digits than one number has
    L const z = r * r;
    L const odd_part =
        polynomial_of(z, 1.58969099521155010221e-10, -2.50507602534068634195e-08, 2.75573137070700676789e-06,
                      -1.98412698298579493134e-04, 8.33333333332248946124e-03);
    L const odd = r - ((z * (0.5 * tail - z * r * odd_part) - tail) - z * r * -1.66666666666666324348e-01);
    L const half = 0.5 * z, rest = 1.0 - half;
    L const even_part =
        polynomial_of(z, -1.13596475577881948265e-11, 2.08757232129817482790e-09, -2.75573143513906633035e-07,
                      2.48015872894767294178e-05, -1.38888888888741095749e-03, 4.16666666666666019037e-02);
    L const even = rest + ((1.0 - rest) - half + (z * z * even_part - r * tail));
    // The quadrant is in the last bits of the shifted number.
    unroll<L::parts>([&](auto i) POLHODE_LAMBDA {
      using Bits = typename L::Layout::MaskPart;
      Bits const quadrant = Bits(shifted.part[i]), odd_one = (quadrant & 1) != 0;
      Bits const sign_of_sin = (quadrant & 2) << 62, sign_of_cos = ((quadrant + 1) & 2) << 62;
      auto const s = odd_one ? even.part[i] : odd.part[i], c = odd_one ? odd.part[i] : even.part[i];
      sin.part[i] = typename L::Part(Bits(s) ^ sign_of_sin);
      cos.part[i] = typename L::Part(Bits(c) ^ sign_of_cos);
    });
  }
  template <class... C>
  static POLHODE_INLINE L polynomial_of(L const& z, C... c) {
    L r = 0.0 * z;
    ((r = r * z + c), ...);
    return r;
  }
};
}  // namespace detail

/// Within 1 ulp; of great arguments the library's, lane by lane.
template <int n, int bytes>
POLHODE_INLINE Lanes<n, double, bytes> sin(Lanes<n, double, bytes> const& x) {
  using Pair = detail::SinCosLanes<n, bytes>;
  using L = typename Pair::L;
  if (any_of(!(abs_of(x) < L(Pair::farthest)))) [[unlikely]]
    return L::of([&](int i) { return std::sin(x[i]); });
  return Pair(x).sin;
}
template <int n, int bytes>
POLHODE_INLINE Lanes<n, double, bytes> cos(Lanes<n, double, bytes> const& x) {
  using Pair = detail::SinCosLanes<n, bytes>;
  using L = typename Pair::L;
  if (any_of(!(abs_of(x) < L(Pair::farthest)))) [[unlikely]]
    return L::of([&](int i) { return std::cos(x[i]); });
  return Pair(x).cos;
}
/// In each lane what arctangent() of doubles gives.
template <int n, int bytes>
POLHODE_INLINE Lanes<n, double, bytes> arctangent(Lanes<n, double, bytes> const& y, Lanes<n, double, bytes> const& x) {
  auto const ordinary = detail::ordinary_point(y, x);
  Lanes<n, double, bytes> angle = detail::ordinary_arctangent(y, x);
  if (any_of(!ordinary)) [[unlikely]]
    for (int i = 0; i < n; ++i)
      if (!ordinary[i]) angle.set(i, std::atan2(y[i], x[i]));
  return angle;
}

}  // namespace polhode
