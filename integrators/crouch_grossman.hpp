#pragma once
/// Crouch-Grossman (CG) methods: every slope has an exponential of its own. Explicit, on a group by construction; many
/// exponentials, so commutator-free methods of the same order cost less.
/// Sources: Crouch & Grossman (1993), J. Nonlinear Science 3, 1; Owren & Marthinsen (1999), BIT 39, 116 (order
/// conditions); Jackiewicz, Marthinsen & Owren (2000), Adv. Comput. Math. 13, 405 (order 4)
#include "integrators/exponentials.hpp"
#include "integrators/tableaus.hpp"

namespace polhode {

/// The products of a matrix and weights: stage i by a_i1 k_1, a_i2 k_2, ..., the step by b_1 k_1, b_2 k_2, ...
template <class C, std::size_t n>
constexpr auto crouch_grossman_products(C const (&a)[n][n], C const (&b)[n]) {
  std::array<ExponentialProduct<n, n>, n> products{};
  for (std::size_t i = 0; i < n; ++i) {
    bool const is_step = i + 1 == n;
    products[i].count = int(is_step ? n : i + 1);
    for (std::size_t j = 0; j < std::size_t(products[i].count); ++j)
      products[i].factor[j][j] = (is_step ? b[j] : a[i + 1][j]).template as<Quad>();
  }
  return products;
}
/// The nodes c of a matrix: the sums of its rows.
template <class C, std::size_t n>
constexpr std::array<Quad, n> nodes_of(C const (&a)[n][n]) {
  std::array<Quad, n> c{};
  for (std::size_t i = 0; i < n; ++i)
    for (C const& entry : a[i]) c[i] += entry.template as<Quad>();
  return c;
}

///   0     |
///   3/4   |   3/4
///   17/24 | 119/216  17/108
///         |  13/51    -2/3   24/17
struct Cg3Tableau {
  static constexpr int stages = 3;
  static constexpr bool keeps_second = false, one_slope_each = true;
  static constexpr Ratio a[3][3] = {{}, {{3, 4}}, {{119, 216}, {17, 108}}};
  static constexpr Ratio b[3] = {{13, 51}, {-2, 3}, {24, 17}};
  static constexpr auto c = nodes_of(a);
  static constexpr auto product = crouch_grossman_products(a, b);
};

/// CG4a: fifteen coefficients under thirteen independent conditions. This is the solution nearest to the printed 16
/// digits.
struct Cg4Tableau {
  static constexpr int stages = 5;
  static constexpr bool keeps_second = false, one_slope_each = true;
  static constexpr Decimal a[5][5] = {{},
                                      {0.8177227988124851838643834157678926_q},
                                      {0.3199876375476426814096092583320559_q, 0.0659864263556021873546032286771172_q},
                                      {0.9214417194464946126029556144084633_q, 0.4997857776773572986305806225233096_q,
                                       -1.096998444837158207718266818441608_q},
                                      {0.3552358559023322010541568194501043_q, 0.2390958372307325695852991307465832_q,
                                       1.391856572420324594286736990093610_q, -1.109297939211346510584177249953430_q}};
  static constexpr Decimal b[5] = {0.1370831520630755370295947735714451_q, -0.0183698531564020191126108877519883_q,
                                   0.7397813985370779989291436165101706_q, -0.1907142565505888966977465770386736_q,
                                   0.3322195591068373798516190747090462_q};
  static constexpr auto c = nodes_of(a);
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
