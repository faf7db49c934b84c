#pragma once
/// Magnus methods: the attitude under prescribed body rates, as gyros deliver them. The rotation vector of a step is a
/// quadrature of the rates and of their commutators, which are what strapdown navigation calls coning terms.
/// Use where rates depend on time alone; there they need no stages, and one exponential per step.
/// Sources: Iserles & Norsett (1999), Phil. Trans. R. Soc. A 357, 983; Blanes, Casas, Oteo & Ros (2009), Physics
/// Reports 470, 151, sec. 5.4; mirrored for body rates
#include <array>

#include "integrators/integrator.hpp"

namespace polhode {

/// A field that depends on time alone, if prescribed_rates() is true.
template <class P>
concept PrescribedRates = Problem<P> && requires(P const& p) {
  { p.prescribed_rates() } -> std::same_as<bool>;
};

/// Rates at s Gauss points; order 2s.
template <int s>
  requires(s == 2 || s == 3)
struct Magnus {
  template <Problem P>
    requires(PrescribedRates<P> && !P::Space::flat)
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    return Fixed<Magnus, P>(*this, p, control, policy);
  }

  template <Space M>
  struct Frame {
    std::array<Chart<M>, s> k;
    Chart<M> u;
    Velocity<M> v;
    void fit(Point<M> const& x) {
      for (Chart<M>& rate : k) rate = shaped_like<Chart<M>>(x);
      u = shaped_like<Chart<M>>(x);
      v = shaped_like<Velocity<M>>(x);
    }
  };
  template <Space M>
  using Memory = NoMemory;

  template <Problem P, class M = typename P::Space, class S = typename M::Scalar, class R = Real<S>>
  POLHODE_INLINE void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>& frame, NoMemory&) const {
    auto& k = frame.k;
    R const half = R(0.5) * h, apart = s == 2 ? h / (R(2.0) * sqrt(R(3.0))) : h * sqrt(R(15.0)) / R(10.0);
    R const last = half + apart;
    slope(p, S(t + (half - apart)), x, frame.v, k[0]);
    if constexpr (s == 3) slope(p, S(t + half), x, frame.v, k[1]);
    slope(p, S(t + last), x, frame.v, k[s - 1]);
    displace<M>(
        x,
        [&](auto& u, auto const& at) POLHODE_LAMBDA {
          if constexpr (s == 2)
            add(u, turn(h, at(k[0]), at(k[1])));
          else
            add(u, turn(h, at(k[0]), at(k[1]), at(k[2])));
        },
        frame.u, x);
  }

 private:
  /// The rotation vector of a step of h with rates w1, w2 [rad/s].   Iserles & Norsett (1999), order 4
  template <class R, class S>
  static POLHODE_INLINE Vec3<S> turn(R const& h, Vec3<S> const& w1, Vec3<S> const& w2) {
    R const coning = h * h * sqrt(R(3.0)) / R(12.0);
    return R(0.5) * h * (w1 + w2) + coning * cross(w1, w2);
  }
  /// The same with three rates.   Blanes, Casas, Oteo & Ros (2009), order 6; body rates turn every commutator around
  template <class R, class S>
  static POLHODE_INLINE Vec3<S> turn(R const& h, Vec3<S> const& w1, Vec3<S> const& w2, Vec3<S> const& w3) {
    R const first = h * sqrt(R(15.0)) / R(3.0), second = h * R(10.0) / R(3.0);
    Vec3<S> const a1 = h * w2, a2 = first * (w3 - w1), a3 = second * ((w3 - w2) + (w1 - w2));
    Vec3<S> const c1 = cross(a2, a1);
    Vec3<S> const c2 = R(-1.0) / R(60.0) * cross(R(2.0) * a3 + c1, a1);
    Vec3<S> const c3 = R(1.0) / R(240.0) * cross(a2 + c2, c1 - R(20.0) * a1 - a3);
    return a1 + R(1.0) / R(12.0) * a3 + c3;
  }
};

/// order 4, 2 evaluations, 1 exponential per step
struct Magnus4 : Magnus<2> {
  static constexpr MethodInfo info{.name = "magnus4",
                                   .family = Family::lie_group,
                                   .order = 4,
                                   .needs = Needs::prescribed_rates,
                                   .preserves = keeps_norm | is_symmetric,
                                   .source = "Iserles & Norsett (1999), Phil. Trans. R. Soc. A 357, 983",
                                   .pitfall = "for rates that depend on time alone"};
};

/// order 6, 3 evaluations, 1 exponential per step
struct Magnus6 : Magnus<3> {
  static constexpr MethodInfo info{.name = "magnus6",
                                   .family = Family::lie_group,
                                   .order = 6,
                                   .needs = Needs::prescribed_rates,
                                   .preserves = keeps_norm | is_symmetric,
                                   .source = "Blanes, Casas, Oteo & Ros (2009), Physics Reports 470, 151, sec. 5.4",
                                   .pitfall = "for rates that depend on time alone"};
};

}  // namespace polhode
