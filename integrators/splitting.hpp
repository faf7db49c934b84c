#pragma once
/// Splitting of a rigid body under torque into flows that are known: the free body, or turns that make it up, and kicks
/// by the torque, which change the angular momentum alone. Symmetric compositions raise the order.
///
/// Use under torques of a potential over long times, where the energy error stays bounded; for free bodies dmv10 and
/// exact are better.
///
/// Sources: McLachlan (1993), Phys. Rev. Lett. 71, 3043; Reich (1994), Physica D 76, 375 (three rotations);
/// Dullweber, Leimkuhler & McLachlan (1997), J. Chem. Phys. 107, 5840 (symmetric top and rotation);
/// Celledoni, Faso, Safstrom & Zanna (2008), SIAM J. Sci. Comput. 30, 2084 (exact free flow and kicks);
/// Hairer, Lubich & Wanner, Geometric Numerical Integration, II.5, VII.5
#include "integrators/rigid_motion.hpp"
#include "problems/exact.hpp"

namespace polhode {

// ---- Compositions ---------------------------------------------------------------------------------------------------
// A step is  chi_(alpha_1 h), chi*_(alpha_2 h), chi_(alpha_3 h), ... one after the other, chi being all flows in turn
// and chi* the same backwards. Coefficients of A B A splittings become such alpha:  a_1 = alpha_1, b_1 = alpha_1 +
// alpha_2, a_2 = alpha_2 + alpha_3, ...   McLachlan (1995), SIAM J. Sci. Comput. 16, 151

/// order 2, 1 kick
struct Strang {
  static constexpr int order = 2;
  static constexpr std::string_view source = "Strang (1968)";
  template <class R>
  static std::array<R, 2> coefficients() {
    return {R(0.5), R(0.5)};
  }
};

/// order 4, 3 kicks; one of them backwards.   Yoshida (1990), Phys. Lett. A 150, 262; Suzuki (1990)
struct Yoshida4 {
  static constexpr int order = 4;
  static constexpr std::string_view source = "Yoshida (1990), Phys. Lett. A 150, 262";
  template <class R>
  static std::array<R, 6> coefficients() {
    Quad const outer = Quad(0.5) / (2 - cbrtq(Quad(2))), inner = Quad(0.5) - 2 * outer;
    R const w1 = R(outer), w0 = R(inner);
    return {w1, w1, w0, w0, w1, w1};
  }
};

/// order 4, 6 kicks, small error constants: S6 of order 4.   Blanes & Moan (2002), J. Comput. Appl. Math. 142, 313,
/// table 2. a_1, a_2, a_3 as printed, to 15 digits; b_1 and b_2 made to meet the order conditions to any precision.
struct BlanesMoan4 {
  static constexpr int order = 4;
  static constexpr std::string_view source = "Blanes & Moan (2002), J. Comput. Appl. Math. 142, 313 (S6, order 4)";
  /// a_1 .. a_7 and b_1 .. b_6.
  struct Splitting {
    std::array<Quad, 7> a;
    std::array<Quad, 6> b;
  };
  static Splitting splitting() {
    Quad const unit = 1 / Quad(1e16);
    Quad const a1 = 792036964311957 * unit, a2 = 3531729060497740 * unit, a3 = -420650803577195 * unit;
    Quad const a4 = 1 - 2 * (a1 + a2 + a3);
    Splitting s{{a1, a2, a3, a4, a3, a2, a1}, {}};
    Quad guess = -Quad(0.143851773179818), next = guess + Quad(1e-10);
    Quad f = residual(s, guess);
    for (int sweep = 0; sweep < 6; ++sweep) {  // secants
      Quad const g = residual(s, next);
      if (g == f) break;
      Quad const better = next - g * (next - guess) / (g - f);
      guess = next;
      f = g;
      next = better;
    }
    residual(s, next);
    return s;
  }
  template <class R>
  static std::array<R, 12> coefficients() {
    Splitting const s = splitting();
    std::array<R, 12> alpha;
    Quad last = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      Quad const first = s.a[i] - last;
      last = s.b[i] - first;
      alpha[2 * i] = R(first);
      alpha[2 * i + 1] = R(last);
    }
    return alpha;
  }

 private:
  /// sum a_i d_i^2 - 1/3 for this b_2, d_i the sum of the b before a_i; b_1 is such that sum b_i c_i^2 = 1/3, c_i the
  /// sum of the a before b_i. Symmetry does the rest of order 4.
  static Quad residual(Splitting& s, Quad const& b2) {
    std::array<Quad, 3> node;  // c_i^2 + c_(7-i)^2
    Quad c = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      c += s.a[i];
      node[i] = c * c + (1 - c) * (1 - c);
    }
    Quad const third = Quad(1) / 3;
    Quad const b1 = (third - b2 * node[1] - (Quad(0.5) - b2) * node[2]) / (node[0] - node[2]);
    Quad const b3 = Quad(0.5) - b1 - b2;
    s.b = {b1, b2, b3, b3, b2, b1};
    Quad d = 0, sum = 0;
    for (std::size_t i = 0; i < 7; ++i) {
      sum += s.a[i] * d * d;
      if (i < 6) d += s.b[i];
    }
    return sum - third;
  }
};

// ---- Flows of the free body -----------------------------------------------------------------------------------------
// chi is  outer, inner  and then the kick. middle(a, b) is  inner(a), inner_back(b)  with nothing in between.

/// H = sum L_k^2 / (2 I_k): a turn about each principal axis.
template <class R>
struct ThreeRotations {
  static constexpr bool exact = false;
  static constexpr std::string_view source = "McLachlan (1993), Phys. Rev. Lett. 71, 3043";
  PrincipalAxes<R> body;

  template <class M>
  void outer(Point<M>& x, Motion<M>& motion, R const& h) const {
    motion.turn(body, x, Turn<S<M>>::by({h * (motion.momentum.x / S<M>(body.moments().x)), S<M>(0.0), S<M>(0.0)}));
  }
  template <class M>
  void inner(Point<M>& x, Motion<M>& motion, R const& h) const {
    about_y(x, motion, h);
    about_z(x, motion, h);
  }
  template <class M>
  void inner_back(Point<M>& x, Motion<M>& motion, R const& h) const {
    about_z(x, motion, h);
    about_y(x, motion, h);
  }
  template <class M>
  void middle(Point<M>& x, Motion<M>& motion, R const& a, R const& b) const {
    about_y(x, motion, a);
    about_z(x, motion, a + b);
    about_y(x, motion, b);
  }

 private:
  template <class M>
  using S = typename M::Scalar;
  template <class M>
  void about_y(Point<M>& x, Motion<M>& motion, R const& h) const {
    motion.turn(body, x, Turn<S<M>>::by({S<M>(0.0), h * (motion.momentum.y / S<M>(body.moments().y)), S<M>(0.0)}));
  }
  template <class M>
  void about_z(Point<M>& x, Motion<M>& motion, R const& h) const {
    motion.turn(body, x, Turn<S<M>>::by({S<M>(0.0), S<M>(0.0), h * (motion.momentum.z / S<M>(body.moments().z))}));
  }
};

/// H = |L|^2 / (2 I_mid) + sum (1 / I_k - 1 / I_mid) L_k^2 / 2: a symmetric top, whose two turns commute, and one turn
/// that is small if two moments are near, and none if they are equal: then the flow is exact.
template <class R>
class SymmetricAndRotation {
 public:
  static constexpr bool exact = false;
  static constexpr std::string_view source = "Dullweber, Leimkuhler & McLachlan (1997), J. Chem. Phys. 107, 5840";
  PrincipalAxes<R> body;

  explicit SymmetricAndRotation(PrincipalAxes<R> const& axes) : body(axes) {
    Vec3<R> const& I = body.moments();
    R const low = least(I.x, least(I.y, I.z)), high = max_of(I.x, max_of(I.y, I.z));
    middle_ = max_of(least(I.x, I.y), least(max_of(I.x, I.y), I.z));
    R const excess_low = (middle_ - low) / (low * middle_), excess_high = (middle_ - high) / (high * middle_);
    bool const rest_is_low = excess_low < -excess_high;
    // Of equal moments any may be called the least or the greatest.
    Vec3<R> const is_low{R(I.x == low), R(I.x != low && I.y == low), R(I.x != low && I.y != low)};
    Vec3<R> const is_high{R(I.z != high && I.y != high), R(I.z != high && I.y == high), R(I.z == high)};
    rest_ = rest_is_low ? excess_low * is_low : excess_high * is_high;
    top_ = rest_is_low ? excess_high * is_high : excess_low * is_low;
  }

  template <class M>
  void outer(Point<M>& x, Motion<M>& motion, R const& h) const {
    about(x, motion, h, rest_);
  }
  template <class M>
  void inner(Point<M>& x, Motion<M>& motion, R const& h) const {
    using S = typename M::Scalar;
    motion.turn(body, x, Turn<S>::by(R(h / middle_) * motion.momentum));
    about(x, motion, h, top_);
  }
  template <class M>
  void inner_back(Point<M>& x, Motion<M>& motion, R const& h) const {
    inner<M>(x, motion, h);
  }
  template <class M>
  void middle(Point<M>& x, Motion<M>& motion, R const& a, R const& b) const {
    inner<M>(x, motion, a + b);
  }

 private:
  static R least(R const& a, R const& b) { return b < a ? b : a; }
  template <class M>
  void about(Point<M>& x, Motion<M>& motion, R const& h, Vec3<R> const& excess) const {
    using S = typename M::Scalar;
    Vec3<S> const& L = motion.momentum;
    motion.turn(body, x, Turn<S>::by({(h * excess.x) * L.x, (h * excess.y) * L.y, (h * excess.z) * L.z}));
  }

  R middle_;
  Vec3<R> rest_, top_;  ///< 1 / I_k - 1 / I_mid of one axis [1/(kg m^2)], 0 of the others
};

/// The closed form.
template <class R>
struct ExactFlow {
  static constexpr bool exact = true;
  static constexpr std::string_view source = "Celledoni, Faso, Safstrom & Zanna (2008), SIAM J. Sci. Comput. 30, 2084";
  PrincipalAxes<R> body;

  template <class M>
  void outer(Point<M>& x, Motion<M>& motion, R const& h) const {
    Quat<R> const here{R(0.0), R(0.0), R(0.0), R(1.0)};
    ExactFreeBody<R> const free(body.moments(), here, body.rate(motion.momentum));
    motion.turn(body, x, Turn<R>::by_quaternion(free.at(h).first));
  }
  template <class M>
  void inner(Point<M>&, Motion<M>&, R const&) const {}
  template <class M>
  void inner_back(Point<M>&, Motion<M>&, R const&) const {}
  template <class M>
  void middle(Point<M>&, Motion<M>&, R const&, R const&) const {}
};

// ---- The method -----------------------------------------------------------------------------------------------------

/// Symmetric composition of free flow and kicks. Time stands still during a kick, the attitude too. A torque that
/// depends on the body rate changes during its kick: the kick is then a step of Kutta's method, whose error, O(h^5), is
/// within the order but not symmetric. So keeps and symmetry are those of torques of attitude and time alone.
/// Evaluations of the torque per step: one a kick, four if it depends on the rate, none of a free body.
template <template <class> class Free, class Composition>
struct Splitting {
  static constexpr MethodInfo info_of(std::string_view name) {
    return {.name = name,
            .family = Family::splitting,
            .order = Composition::order,
            .needs = Needs::rigid_body,
            .preserves = keeps_norm | (Free<double>::exact ? keeps_energy : 0u) | keeps_momentum |
                         keeps_momentum_direction | is_symplectic | is_symmetric,
            .source = Composition::order == 2 ? Free<double>::source : Composition::source,
            .pitfall = "a torque that depends on the body rate costs four evaluations a kick, and the symmetry"};
  }

  template <class R>
  struct Method {
    Free<R> free;
    decltype(Composition::template coefficients<R>()) alpha = Composition::template coefficients<R>();

    template <Space M>
    using Memory = Motion<M>;
    template <Space M>
    struct Frame {};

    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    void step(P const& p, S const& t, R const& h, Point<M>& x, Frame<M>&, Motion<M>& motion) const {
      constexpr std::size_t size = std::tuple_size_v<decltype(alpha)>;
      motion.open(free.body, x);
      R now(0.0);
      free.template outer<M>(x, motion, h * alpha[0]);
      for (std::size_t i = 0; i < size; i += 2) {
        R const a = h * alpha[i], b = h * alpha[i + 1];
        now += a;
        if (p.torque_free()) {
          free.template middle<M>(x, motion, a, b);
        } else {
          free.template inner<M>(x, motion, a);
          kick(p, S(t + now), R(a + b), x, motion);
          free.template inner_back<M>(x, motion, b);
        }
        now += b;
        free.template outer<M>(x, motion, i + 2 < size ? R(b + h * alpha[i + 2]) : b);
      }
      motion.close(free.body, x);
    }

   private:
    template <Problem P, class M = typename P::Space, class S = typename M::Scalar>
    void kick(P const& p, S const& t, R const& h, Point<M>& x, Motion<M>& motion) const {
      PrincipalAxes<R> const& body = free.body;
      auto const torque = [&](Vec3<S> const& L) {
        x.second = body.to_body(body.rate(L));
        return body.to_principal(p.torque(t, x));
      };
      Vec3<S> const L = motion.momentum, k1 = torque(L);
      if (!p.torque_feels_rate()) return motion.accelerate(h * k1);
      R const half = R(0.5) * h;
      Vec3<S> const k2 = torque(L + half * k1), k3 = torque(L + half * k2), k4 = torque(L + h * k3);
      motion.accelerate(R(h / R(6.0)) * (k1 + R(2.0) * (k2 + k3) + k4));
    }
  };

  template <RigidBodyProblem P>
  auto bind(P const& p, FixedStep control, NormPolicy policy) const {
    using R = Real<typename P::Space::Scalar>;
    return Fixed<Method<R>, P>(Method<R>{Free<R>{PrincipalAxes<R>(p.inertia_matrix())}}, p, control, policy);
  }
};

/// Three rotations about the principal axes and the kick, composed after Strang (1968): order 2.
struct SplitStrang : Splitting<ThreeRotations, Strang> {
  static constexpr MethodInfo info = info_of("split_strang");
};
/// The same by Yoshida (1990): order 4.
struct SplitYoshida4 : Splitting<ThreeRotations, Yoshida4> {
  static constexpr MethodInfo info = info_of("split_yoshida4");
};
/// The same by Blanes & Moan (2002), S6: order 4.
struct SplitBm4 : Splitting<ThreeRotations, BlanesMoan4> {
  static constexpr MethodInfo info = info_of("split_bm4");
};
/// A symmetric top, a rotation for the rest, and the kick, after Strang: order 2.
struct SplitSrStrang : Splitting<SymmetricAndRotation, Strang> {
  static constexpr MethodInfo info = info_of("split_sr_strang");
};
/// The same by Blanes & Moan: order 4.
struct SplitSrBm4 : Splitting<SymmetricAndRotation, BlanesMoan4> {
  static constexpr MethodInfo info = info_of("split_sr_bm4");
};
/// The free body in closed form between kicks of the torque, after Strang: order 2, exact without a torque.
struct ExactKicks : Splitting<ExactFlow, Strang> {
  static constexpr MethodInfo info = info_of("exact_kicks");
};
/// The same by Blanes & Moan: order 4.
struct ExactKicks4 : Splitting<ExactFlow, BlanesMoan4> {
  static constexpr MethodInfo info = info_of("exact_kicks4");
};

}  // namespace polhode
