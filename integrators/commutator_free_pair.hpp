#pragma once
/// Adaptive steps on a group: the commutator-free pair of orders 4 and 3, its error measured in the chart around the
/// new point. Use where the attitude must remain an attitude and the time scale changes; it keeps the norm, not the
/// energy. Sources: Curry & Owren (2019), Numerical Algorithms 82, 1359 (variable steps); the pair as in Celledoni,
/// Cokaj, Leone, Murari & Owren (2022), Int. J. Comput. Math. 99, 58
#include "integrators/commutator_free.hpp"
#include "integrators/step_control.hpp"

namespace polhode {

///   0   |
///   1/2 |  1/2
///   1/2 |   0    1/2
///   1   |  1/2                        from the start, which is the second point
///       | -1/2    0     1
///   3/4 |   0    3/4
///       |  1/4   1/6   1/6 -1/12      order 4: cf4
///       | -1/12  1/6   1/6  1/4
///       |  1/3                        order 3
///       | -1/9   1/3    0     0   4/9
struct Cf43Tableau {
  static constexpr int stages = 5, order = 4;
  static constexpr bool keeps_second = true, one_slope_each = false;
  static constexpr Quad c[5] = {0, Quad(1) / 2, Quad(1) / 2, 1, Quad(3) / 4};
  static constexpr ExponentialProduct<5, 2> product[6] = {
      {false, 1, {{{Quad(1) / 2}}}},
      {false, 1, {{{0, Quad(1) / 2}}}},
      {true, 1, {{{Quad(-1) / 2, 0, 1}}}},
      {false, 1, {{{0, Quad(3) / 4}}}},
      {false,
       2,
       {{{Quad(1) / 4, Quad(1) / 6, Quad(1) / 6, Quad(-1) / 12},
         {Quad(-1) / 12, Quad(1) / 6, Quad(1) / 6, Quad(1) / 4}}}},
      {false, 2, {{{Quad(1) / 3}, {Quad(-1) / 9, Quad(1) / 3, 0, 0, Quad(4) / 9}}}}};
};

/// order 4, error estimate of order 3; 5 evaluations, 8 exponentials an accepted step, an evaluation less if rejected
struct CommutatorFreeAdaptive {
  static constexpr MethodInfo info{
      .name = "cf_adaptive",
      .family = Family::lie_group,
      .needs = Needs::group,
      .preserves = keeps_norm,
      .source =
          "Curry & Owren (2019), Numer. Algorithms 82, 1359; Celledoni et al. (2022), Int. J. Comput. Math. 99, 58",
      .pitfall = "a tolerance bounds the local error, not the attitude error; relative to 1 rad of rotation"};
  static constexpr int order = 4;
  static constexpr StepRule rule{.memory = 0.04};
  static constexpr bool first_same_as_last = false, two_estimates = false;

  template <Problem P>
    requires(!P::Space::flat)
  auto bind(P const& p, Adaptive control, NormPolicy policy) const {
    return Controlled<CommutatorFreeAdaptive, P>(*this, p, control, policy);
  }

  template <Space M>
  using Frame = typename Exponentials<Cf43Tableau>::template Frame<M>;

  /// One trial step from x, whose slope is frame.k[0]; writes the new point and, in the chart around it, how far the
  /// solution of order 3 is from it.
  template <Problem P, class M = typename P::Space, class R = Real<typename M::Scalar>>
  void attempt(P const& p, R const& t, R const& h, Point<M> const& x, Frame<M>& frame, Point<M>& y, Chart<M>&,
               Chart<M>& error) const {
    using Method = Exponentials<Cf43Tableau>;
    using Body = typename BodyOf<M>::type;
    Method::stages(p, typename M::Scalar(t), h, x, frame);
    Method::template move<M, 4>(x, h, frame, y);
    Method::template move<M, 5>(x, h, frame, frame.y);
    for_each_body<M>(x, [&](auto const& at) {
      Chart<Body> const centre = Body::centre(at(y));
      at(error) = Body::local(at(y), at(frame.y));
      add(at(error), R(-1.0), centre);
    });
  }
};

}  // namespace polhode
