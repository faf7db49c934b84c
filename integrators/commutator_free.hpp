#pragma once
/// Commutator-free (CF) methods: products of exponentials of combined slopes, no dexp^-1. Explicit, on a group by
/// construction. Use where the attitude must remain an attitude and steps are large; they keep the norm, not the
/// energy. Source: Celledoni, Marthinsen & Owren (2003), Future Generation Computer Systems 19, 341
#include "integrators/exponentials.hpp"

namespace polhode {

///   0   |
///   1/3 | 1/3
///   2/3 |  0  2/3
///       | 1/3                from the start, which is the second point
///       | -1/12  0  3/4
struct Cf3Tableau {
  static constexpr int stages = 3;
  static constexpr bool keeps_second = true, one_slope_each = false;
  static constexpr Quad c[3] = {0, Quad(1) / 3, Quad(2) / 3};
  static constexpr ExponentialProduct<3, 1> product[3] = {
      {false, 1, {{{Quad(1) / 3}}}}, {false, 1, {{{0, Quad(2) / 3}}}}, {true, 1, {{{Quad(-1) / 12, 0, Quad(3) / 4}}}}};
};

///   0   |
///   1/2 |  1/2
///   1/2 |   0    1/2
///   1   |  1/2                  from the start, which is the second point
///       | -1/2    0     1
///       |  1/4   1/6   1/6 -1/12
///       | -1/12  1/6   1/6  1/4
struct Cf4Tableau {
  static constexpr int stages = 4;
  static constexpr bool keeps_second = true, one_slope_each = false;
  static constexpr Quad c[4] = {0, Quad(1) / 2, Quad(1) / 2, 1};
  static constexpr ExponentialProduct<4, 2> product[4] = {{false, 1, {{{Quad(1) / 2}}}},
                                                          {false, 1, {{{0, Quad(1) / 2}}}},
                                                          {true, 1, {{{Quad(-1) / 2, 0, 1}}}},
                                                          {false,
                                                           2,
                                                           {{{Quad(1) / 4, Quad(1) / 6, Quad(1) / 6, Quad(-1) / 12},
                                                             {Quad(-1) / 12, Quad(1) / 6, Quad(1) / 6, Quad(1) / 4}}}}};
};

/// order 3, 3 evaluations, 3 exponentials per step: the first half of the step is the second stage
struct CommutatorFree3 : Exponentials<Cf3Tableau> {
  static constexpr MethodInfo info{.name = "cf3",
                                   .family = Family::lie_group,
                                   .order = 3,
                                   .needs = Needs::group,
                                   .preserves = keeps_norm,
                                   .source = "Celledoni, Marthinsen & Owren (2003)"};
};

/// order 4, 4 evaluations, 5 exponentials per step
struct CommutatorFree4 : Exponentials<Cf4Tableau> {
  static constexpr MethodInfo info{
      .name = "cf4",
      .family = Family::lie_group,
      .order = 4,
      .needs = Needs::group,
      .preserves = keeps_norm,
      .source = "Celledoni, Marthinsen & Owren (2003)",
      .pitfall = "the order of the two last exponentials depends on the frame of the rates"};
};

}  // namespace polhode
