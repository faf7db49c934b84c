#pragma once
/// Crouch-Grossman (CG) methods: every slope has an exponential of its own. Explicit, on a group by construction; many
/// exponentials, so commutator-free methods of the same order cost less.
/// Sources: Crouch & Grossman (1993), J. Nonlinear Science 3, 1; Owren & Marthinsen (1999), BIT 39, 116 (order
/// conditions); Jackiewicz, Marthinsen & Owren (2000), Adv. Comput. Math. 13, 405 (order 4)
#include "integrators/exponentials.hpp"

namespace polhode {

/// A decimal fraction with at most 34 digits, correctly rounded in quadruple precision: 0.25_quad.
template <char... text>
constexpr Quad operator""_quad() {
  Quad digits = 0, scale = 1;  // below 2^113 both are exact
  bool fraction = false;
  auto const take = [&](char c) {
    if (c == '.') {
      fraction = true;
    } else if (c != '\'') {
      digits = 10 * digits + (c - '0');
      if (fraction) scale = 10 * scale;
    }
  };
  (take(text), ...);
  return digits / scale;
}

/// The products of a matrix and weights: stage i by a_i1 k_1, a_i2 k_2, ..., the step by b_1 k_1, b_2 k_2, ...
template <int n>
constexpr auto crouch_grossman_products(Quad const (&a)[n][n], Quad const (&b)[n]) {
  std::array<ExponentialProduct<n, n>, std::size_t(n)> products{};
  for (std::size_t i = 0; i < n; ++i) {
    products[i].count = i + 1 < n ? int(i) + 1 : n;
    for (std::size_t j = 0; j < std::size_t(products[i].count); ++j)
      products[i].factor[j][j] = i + 1 < n ? a[i + 1][j] : b[j];
  }
  return products;
}

///   0     |
///   3/4   |   3/4
///   17/24 | 119/216  17/108
///         |  13/51    -2/3   24/17
struct Cg3Tableau {
  static constexpr int stages = 3;
  static constexpr bool keeps_second = false, one_slope_each = true;
  static constexpr Quad a[3][3] = {{}, {Quad(3) / 4}, {Quad(119) / 216, Quad(17) / 108}};
  static constexpr Quad b[3] = {Quad(13) / 51, Quad(-2) / 3, Quad(24) / 17};
  static constexpr Quad c[3] = {0, Quad(3) / 4, Quad(17) / 24};
  static constexpr auto product = crouch_grossman_products(a, b);
};

/// CG4a: fifteen coefficients under thirteen independent conditions. This is the solution nearest to the printed 16
/// digits.
struct Cg4Tableau {
  static constexpr int stages = 5;
  static constexpr bool keeps_second = false, one_slope_each = true;
  static constexpr Quad a[5][5] = {
      {},
      {0.8177227988124851838643834157678926_quad},
      {0.3199876375476426814096092583320559_quad, 0.0659864263556021873546032286771172_quad},
      {0.9214417194464946126029556144084633_quad, 0.4997857776773572986305806225233096_quad,
       -1.096998444837158207718266818441608_quad},
      {0.3552358559023322010541568194501043_quad, 0.2390958372307325695852991307465832_quad,
       1.391856572420324594286736990093610_quad, -1.109297939211346510584177249953430_quad}};
  static constexpr Quad b[5] = {0.1370831520630755370295947735714451_quad, -0.0183698531564020191126108877519883_quad,
                                0.7397813985370779989291436165101706_quad, -0.1907142565505888966977465770386736_quad,
                                0.3322195591068373798516190747090462_quad};
  static constexpr Quad c[5] = {0, a[1][0], a[2][0] + a[2][1], a[3][0] + a[3][1] + a[3][2],
                                a[4][0] + a[4][1] + a[4][2] + a[4][3]};
  static constexpr auto product = crouch_grossman_products(a, b);
};

/// order 3, 3 evaluations, 6 exponentials per step
struct CrouchGrossman3 : Exponentials<Cg3Tableau> {
  static constexpr MethodInfo info{.name = "cg3",
                                   .family = Family::lie_group,
                                   .order = 3,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Crouch & Grossman (1993), J. Nonlinear Science 3, 1",
                                   .pitfall = "a wrong coefficient hides on degenerate test problems"};
};

/// order 4, 5 evaluations, 15 exponentials per step
struct CrouchGrossman4 : Exponentials<Cg4Tableau> {
  static constexpr MethodInfo info{.name = "cg4",
                                   .family = Family::lie_group,
                                   .order = 4,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Jackiewicz, Marthinsen & Owren (2000), Adv. Comput. Math. 13, 405",
                                   .pitfall = "a wrong coefficient hides on degenerate test problems"};
};

}  // namespace polhode
