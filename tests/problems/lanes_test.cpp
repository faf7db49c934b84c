/// Lanes: every lane is what the scalar gives, to the last bit, in registers of any width; problems run over them.
#include "problems/lanes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "problems/free_body.hpp"
#include "problems/pd_slew.hpp"
#include "problems/tether_capture.hpp"
#include "tests/support/random_numbers.hpp"

namespace polhode {
namespace {

void expect_same(std::span<double const> lanes, std::span<double const> scalars) {
  for (std::size_t i = 0; i < lanes.size(); ++i)
    EXPECT_TRUE(lanes[i] == scalars[i] && std::signbit(lanes[i]) == std::signbit(scalars[i]))
        << "lane " << i << ": " << lanes[i] << ", " << scalars[i];
}

template <class L>
class LanesOf : public testing::Test {
 protected:
  /// Numbers of every size and sign, zeros among them.
  L random() {
    return L::of([&](int) {
      double const u = random_.uniform(-1, 1);
      return Real<L>(u < -0.9 ? (u < -0.95 ? -0.0 : 0.0) : std::ldexp(u, int(20 * random_.uniform(-1, 1))));
    });
  }
  L positive() { return abs_of(random()) + L(0x1p-20); }
  template <class F>
  static void expect_lanes(L const& got, F scalar) {
    std::array<double, L::count> lanes, scalars;
    for (int i = 0; i < L::count; ++i) {
      lanes[std::size_t(i)] = double(got[i]);
      scalars[std::size_t(i)] = double(Real<L>(scalar(i)));
    }
    expect_same(lanes, scalars);
  }
  test::Random random_{7};
};
// In this unit's registers, in narrower ones, in wider ones than it has; many lanes, few, floats.
using Kinds = testing::Types<Lanes<8>, Lanes<8, double, 64>, Lanes<4, double, 32>, Lanes<16, float, 32>>;
TYPED_TEST_SUITE(LanesOf, Kinds);

TYPED_TEST(LanesOf, ComputeAsScalarsDo) {
  using L = TypeParam;
  using T = Real<L>;
  static_assert(Scalar<L>);
  for (int repeat = 0; repeat < 50; ++repeat) {
    L const a = this->random(), b = this->random(), p = this->positive();
    T const c = b[0];
    this->expect_lanes(a + b, [&](int i) { return a[i] + b[i]; });
    this->expect_lanes(a - b, [&](int i) { return a[i] - b[i]; });
    this->expect_lanes(a * b, [&](int i) { return a[i] * b[i]; });
    this->expect_lanes(c * a, [&](int i) { return c * a[i]; });
    this->expect_lanes(a / p, [&](int i) { return a[i] / p[i]; });
    this->expect_lanes(-a, [&](int i) { return -a[i]; });
    this->expect_lanes(abs_of(a), [&](int i) { return std::fabs(a[i]); });
    this->expect_lanes(sqrt(p), [&](int i) { return std::sqrt(p[i]); });
    this->expect_lanes(floor(a), [&](int i) { return std::floor(a[i]); });
    this->expect_lanes(atan2(a, p), [&](int i) { return std::atan2(a[i], p[i]); });
    this->expect_lanes(nearest_whole(a), [&](int i) { return std::floor(a[i] + T(0.5)); });
    this->expect_lanes(max_of(a, b), [&](int i) { return a[i] < b[i] ? b[i] : a[i]; });
    this->expect_lanes(clamp(a, L(-p), p), [&](int i) { return clamp(a[i], -p[i], p[i]); });
    this->expect_lanes(sign_of(a), [&](int i) { return a[i] < 0 ? -1 : 1; });
    auto const exact = two_sum(a, b);
    this->expect_lanes(exact.rest, [&](int i) { return two_sum(a[i], b[i]).rest; });
    L d = a;
    d += b;
    d -= p;
    d *= a;
    this->expect_lanes(d, [&](int i) { return (a[i] + b[i] - p[i]) * a[i]; });
  }
}

TYPED_TEST(LanesOf, CompareAndSelectLaneByLane) {
  using L = TypeParam;
  using T = Real<L>;
  for (int repeat = 0; repeat < 50; ++repeat) {
    L const a = this->random(), b = L::of([&](int i) { return i % 2 == 0 ? a[i] : T(1) - a[i]; });
    for (int i = 0; i < L::count; ++i) {
      EXPECT_EQ((a < b)[i], a[i] < b[i]);
      EXPECT_EQ((a > b)[i], a[i] > b[i]);
      EXPECT_EQ((a <= b)[i], a[i] <= b[i]);
      EXPECT_EQ((a >= b)[i], a[i] >= b[i]);
      EXPECT_EQ((a == b)[i], a[i] == b[i]);
      EXPECT_EQ(((a < b) & (a == a))[i], a[i] < b[i]);
      EXPECT_EQ(((a < b) | (b < a))[i], a[i] != b[i]);
      EXPECT_EQ((!(a < b))[i], !(a[i] < b[i]));
    }
    this->expect_lanes(select(a < b, a, b), [&](int i) { return a[i] < b[i] ? a[i] : b[i]; });
    this->expect_lanes(select(a < b, T(3), T(-4)), [&](int i) { return a[i] < b[i] ? 3 : -4; });
  }
}

TYPED_TEST(LanesOf, SeeASingleLane) {
  using L = TypeParam;
  using T = Real<L>;
  T const none = std::numeric_limits<T>::quiet_NaN(), endless = std::numeric_limits<T>::infinity();
  EXPECT_TRUE(is_finite(L(T(1))));
  for (int i = 0; i < L::count; ++i) {
    L one(T(0));
    one.set(i, T(2));
    EXPECT_TRUE(any_of(L(T(1)) < one));
    EXPECT_FALSE(all_of(one < L(T(1))));
    EXPECT_FALSE(any_of(L(T(2)) < one));
    EXPECT_TRUE(all_of(one < L(T(3))));
    EXPECT_EQ(greatest_of(one), 2);
    EXPECT_EQ(sum_of(one), 2);
    for (T bad : {none, endless, -endless}) {
      one.set(i, bad);
      EXPECT_FALSE(is_finite(one));
    }
  }
}

TYPED_TEST(LanesOf, LoadAndStoreInOrder) {
  using L = TypeParam;
  using T = Real<L>;
  L const a = L::of([](int i) { return i + 1; });
  T numbers[L::count];
  a.store(numbers);
  for (int i = 0; i < L::count; ++i) EXPECT_EQ(numbers[i], T(i + 1));
  this->expect_lanes(L::load(numbers), [&](int i) { return numbers[i]; });
  EXPECT_EQ(sum_of(a), T(L::count * (L::count + 1) / 2));
}

/// |a - exact| in ulps of a.
double ulps(double a, Quad exact) {
  double const next = std::nextafter(std::fabs(a), 2.0) - std::fabs(a);
  return double(abs_of(Quad(Quad(a) - exact)) / Quad(next));
}

TEST(LanesFunctions, SineAndCosineAreWithinOneUlp) {
  using L = Lanes<8>;
  test::Random random(3);
  for (double width : {1e-9, 0.1, 1.0, 3.2, 50.0, 9e4}) {
    for (int repeat = 0; repeat < 2000; ++repeat) {
      L const x = L::of([&](int) { return random.uniform(-width, width); });
      L const s = sin(x), c = cos(x);
      for (int i = 0; i < L::count; ++i) {
        EXPECT_LE(ulps(s[i], sinq(Quad(x[i]))), 1.0) << x[i];
        EXPECT_LE(ulps(c[i], cosq(Quad(x[i]))), 1.0) << x[i];
      }
    }
  }
}

TEST(LanesFunctions, SineAndCosineOfGreatArgumentsAreTheLibrarys) {
  Lanes<4> const x = Lanes<4>::of([](int i) { return i == 2 ? 1e22 : i == 3 ? -1e7 : 0.25 * i; });
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(sin(x)[i], std::sin(x[i]));
    EXPECT_EQ(cos(x)[i], std::cos(x[i]));
  }
  EXPECT_FALSE(is_finite(sin(Lanes<4>(std::numeric_limits<double>::infinity()))));
}

TEST(LanesFunctions, TheExponentialMapIsThatOfScalarsNearAndFar) {
  using L = Lanes<4>;
  test::Random random(5);
  for (double size : {0.05, 3.0}) {
    for (int repeat = 0; repeat < 100; ++repeat) {
      auto const any = [&] { return L::of([&](int) { return random.uniform(-size, size); }); };
      Vec3<L> const u{any(), any(), any()}, w{any(), any(), any()};
      Quat<L> const q = exp_quaternion(u);
      Vec3<L> const d = dexpinv(u, w);
      for (int i = 0; i < L::count; ++i) {
        Vec3<double> const ui{u.x[i], u.y[i], u.z[i]}, wi{w.x[i], w.y[i], w.z[i]};
        Quat<double> const one = exp_quaternion(ui);
        Vec3<double> const rate = dexpinv(ui, wi);
        EXPECT_NEAR(q.x[i], one.x, 4e-16);
        EXPECT_NEAR(q.w[i], one.w, 4e-16);
        EXPECT_NEAR(d.x[i], rate.x, 2e-14);
        EXPECT_NEAR(d.z[i], rate.z, 2e-14);
      }
    }
  }
}

/// The field over lanes, in random states, is the scalar field of every lane to the last bit.
template <class L, bool fast, class D>
void expect_same_field(D const& definition) {
  auto const lanes = definition.template field<L, FlatQuaternion, fast>();
  auto const scalar = definition.template field<double, FlatQuaternion, fast>();
  test::Random random(11);
  for (int repeat = 0; repeat < 100; ++repeat) {
    auto const any = [&] { return L::of([&](int) { return random.uniform(-1, 1); }); };
    typename decltype(lanes)::State const x{{any(), any(), any(), any()}, {any(), any(), any()}};
    auto const v = lanes(L(0.5), x);
    for (int i = 0; i < L::count; ++i) {
      auto const vi = scalar(0.5, {{x.first.x[i], x.first.y[i], x.first.z[i], x.first.w[i]},
                                   {x.second.x[i], x.second.y[i], x.second.z[i]}});
      EXPECT_EQ(v.first.x[i], vi.first.x);
      EXPECT_EQ(v.second.x[i], vi.second.x);
      EXPECT_EQ(v.second.y[i], vi.second.y);
      EXPECT_EQ(v.second.z[i], vi.second.z);
    }
  }
}
TEST(LanesProblems, EveryLaneIsTheScalarField) {
  expect_same_field<Lanes<8>, true>(FreeBody(Choice{}));
  expect_same_field<Lanes<8, double, 64>, true>(FreeBody(Choice{}));
  expect_same_field<Lanes<4>, false>(FreeBody(Choice{}));
  expect_same_field<Lanes<8>, true>(PdSlew(Choice{}));  // turns its torque over with the sign of q_4
  expect_same_field<Lanes<8>, false>(PdSlew(Choice{}));
  expect_same_field<Lanes<4>, true>(TetherCapture(Choice{}));
}

}  // namespace
}  // namespace polhode
