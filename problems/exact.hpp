#pragma once
/// The free rigid body in closed form: attitude and body rate at any time, as exact as the scalar (double or Quad).
/// The body rate is Jacobi's sn, cn, dn of time. The attitude has three parts, from the body outwards:
///   1. the shortest turn that takes the angular momentum L from where it is in the body to the dominant axis, the axis
///      that L never leaves by 90 degrees: never singular;
///   2. a turn about L by chi,   chi' = (2 E + |L| |omega_3|) / (|L| + |L_3|),   3 the dominant axis;
///   3. a constant turn, which the initial attitude fixes.
/// chi is a secular rate times t and a periodic part, the argument of a theta function.
///
/// Use it as a witness against methods, for very long times, and for the exact flow inside a splitting. Not for a body
/// under torque. No branch of the motion is left out: both sides of the separatrix, on it and near it, two or three
/// equal moments, rest, spins about any principal axis.
/// Errors: a few units of round-off times (1 + |L| t / least moment) [rad], no worse near the separatrix: what is small
/// there is computed without cancellation, in Quad for double.
///
/// Sources: Landau & Lifshitz, Mechanics, sec. 37 (rates, and the precession by theta functions);
/// van Zon & Schofield (2007), J. Comput. Phys. 225, 145 (both as an algorithm);
/// Celledoni, Faso, Safstrom & Zanna (2008), SIAM J. Sci. Comput. 30, 2084; DLMF 20, 22.
#include <algorithm>
#include <array>
#include <cstddef>

#include "problems/attitude.hpp"
#include "problems/elliptic.hpp"

namespace polhode {

/// The path of the angular momentum in body axes, as unit vector l(u), u = start + frequency t:
///   l_first = amplitude_1 cn(u | m),   l_middle = amplitude_2 sn(u | m),   l_dominant = amplitude_3 dn(u | m)
/// The middle moment is between the others; L goes round the dominant axis (or, on the separatrix, turns over once).
/// Source: Landau & Lifshitz, Mechanics, sec. 37, in an order of axes that every branch shares
template <Scalar S>
struct Polhode {
  std::size_t first, middle, dominant;
  S momentum;                                          ///< |L| [N m s]
  std::array<S, 3> amplitude{S(0.0), S(0.0), S(0.0)};  ///< signed; of first, middle, dominant [1]
  S m{0.0}, m1{1.0};                                   ///< parameter of the elliptic functions, and 1 - m
  S frequency{0.0};                                    ///< [1/s]
  S start{0.0};                                        ///< u at t = 0
  S sense{1.0};                                        ///< 1 if the dominant moment is the greatest, -1 if the least
  S turning{0.0};                                      ///< chi' at u = 0 [rad/s]

  Polhode(std::array<S, 3> const& J, std::array<S, 3> const& omega) {
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return J[a] < J[b]; });
    auto const [low, mid, high] = order;
    middle = mid;
    S const excess = above_separatrix(J, omega, order);
    bool const about_high = J[low] == J[mid] || (J[mid] != J[high] && !(excess < S(0.0)));
    dominant = about_high ? high : low;
    first = about_high ? low : high;
    sense = S(about_high ? 1.0 : -1.0);

    Vec3<S> const L{J[first] * omega[first], J[middle] * omega[middle], J[dominant] * omega[dominant]};
    momentum = length(L);
    bool const rests = !(S(0.0) < momentum);
    Vec3<S> const l = rests ? Vec3<S>{S(0.0), S(1.0), S(0.0)} : S(S(1.0) / momentum) * L;
    bool const spins_about_middle = l.x * l.x == S(0.0) && l.z * l.z == S(0.0);
    if (spins_about_middle) {
      amplitude[1] = l.y;
      start = S(0.5) * elliptic::pi<S>;  // sn = 1, for ever
      turning = momentum / J[middle];
      return;
    }

    // |1/J_a - 1/J_b|. In bodies with two equal moments the dominant axis is the third one.
    auto const gap = [&](std::size_t a, std::size_t b) { return abs_of(S(J[a] - J[b])) / (J[a] * J[b]); };
    S const outer = gap(first, dominant), inner = gap(middle, dominant), rest = gap(first, middle);
    bool const sphere = !(S(0.0) < outer), round = !(S(0.0) < rest);
    S const square = sphere ? S(1.0) : S(inner / outer);  // (amplitude_1 / amplitude_2)^2
    S const lift = sphere ? S(0.0) : S(rest / outer);
    S const a1_squared = l.x * l.x + square * l.y * l.y, a3_squared = l.z * l.z + lift * l.y * l.y;
    S const a1 = sqrt(a1_squared), a3 = sqrt(a3_squared);
    frequency = momentum * a3 * sqrt(outer * inner);
    if (!round) {
      m = least(S(1.0), S(a1_squared * rest / (a3_squared * inner)));
      m1 = least(S(1.0), S(abs_of(excess) / (J[middle] * inner) / (momentum * momentum * a3_squared)));
    }
    bool const right_handed = (middle + 3 - first) % 3 == 1;
    S const sign = sense * S(right_handed ? 1.0 : -1.0) * sign_of(l.x) * sign_of(l.z);
    amplitude = {sign_of(l.x) * a1, sign * a1 / sqrt(square), sign_of(l.z) * a3};
    if (S(0.0) < a1)
      start = elliptic::argument_of(S(l.y / amplitude[1]), S(abs_of(l.x) / a1), round ? S(1.0) : S(abs_of(l.z) / a3));
    turning = momentum * (a1_squared / J[first] + (a3_squared + a3) / J[dominant]) / (S(1.0) + a3);
  }

 private:
  static S least(S const& a, S const& b) { return b < a ? b : a; }
  /// |L|^2 - 2 E J_middle: positive if L goes round the axis of the greatest moment, negative if round that of the
  /// least, 0 on the separatrix. Near it doubles cancel, so it is found in Quad.
  static S above_separatrix(std::array<S, 3> const& J, std::array<S, 3> const& omega,
                            std::array<std::size_t, 3> const& order) {
    auto const [low, mid, high] = order;
    auto const part = [&](std::size_t a) { return Quad(J[a]) * omega[a] * omega[a] * (Quad(J[a]) - J[mid]); };
    return S(part(high) + part(low));
  }
};

/// The periodic part of chi: chi = rate t - 2 sense Theta(u),   Theta(u) = arg theta_4(pi (u + i y) / (2 K), q^2),
/// q the nome of m, dn(2 i K' - i y | m) = -1 / amplitude_3. It is odd and has period 2 K.
/// Why: |L| + |L_3| = |alpha|^2 up to a factor, where alpha, a Cayley-Klein parameter, is a quotient of theta functions
/// on the lattice (2 K, 4 i K') of dn with its zero where dn = -1 / amplitude_3 and poles whose argument is constant.
/// For K > 2 K' the same function by Jacobi's transformation (DLMF 20.7.33), so five terms serve every modulus.
template <Scalar S>
class PrecessionWave {
 public:
  /// Theta = angle + arg(re + i im).
  struct Value {
    S angle{0.0}, re{1.0}, im{0.0};
  };

  PrecessionWave(Polhode<S> const& path, elliptic::Jacobi<S> const& jacobi) {
    if (!(S(0.0) < path.m)) return;
    S const a1 = abs_of(path.amplitude[0]), a3 = abs_of(path.amplitude[2]), root = sqrt(path.m);
    S const size = sqrt(a1 * a1 + path.m * a3 * a3);
    S const y = elliptic::argument_of(S(a1 / size), S(root * a3 / size), S(root / size));
    S const other = elliptic::complete(path.m);  // K'
    if (jacobi.endless() || S(2.0) * other < jacobi.quarter_period())
      transform(y, other, jacobi);
    else
      expand(y, other, jacobi.quarter_period());
  }

  /// dTheta/du at u = 0.
  S const& slope() const { return slope_; }
  bool transformed() const { return transformed_; }
  /// Of sine and cosine of pi u / (2 K). Only if not transformed().
  POLHODE_INLINE Value at_phase(S const& sine, S const& cosine) const {
    S const s = S(2.0) * sine * cosine, c = (cosine - sine) * (cosine + sine);
    S sn = s, cn = c;
    Value value;
    for (std::size_t n = 0; n < size_; ++n) {
      value.re += even_[n] * cn;
      value.im += odd_[n] * sn;
      S const next = cn * c - sn * s;
      sn = sn * c + cn * s;
      cn = next;
    }
    return value;
  }
  /// The number that at_decay wants, of |u| <= K.
  POLHODE_INLINE S decay(S const& u) const { return elliptic::exp(S(-(decay_rate_ * abs_of(u)))); }
  /// Of u in [-K, K] and decay(u). Only if transformed().
  POLHODE_INLINE Value at_decay(S const& u, S const& decay) const {
    S up(1.0), down = decay;
    Value value{.angle = drift_ * u, .re = S(0.0)};
    for (std::size_t n = 0; n < size_; ++n) {
      value.re += even_[n] * (up + down);
      value.im += odd_[n] * (up - down);
      if (n + 1 == size_) break;
      up = up / decay;
      down = down * decay;
    }
    value.im = value.im * sign_of(u);
    return value;
  }

 private:
  static constexpr std::size_t most = 8;

  /// theta_4 = 1 + sum (-1)^n q^(2 n^2) ((g^n + g^-n) cos 2nz + i (g^n - g^-n) sin 2nz),   g = exp(-pi y / K), z real.
  void expand(S const& y, S const& other, S const& K) {
    S const q = elliptic::exp(S(-elliptic::pi<S> * other / K)), g = elliptic::exp(S(-elliptic::pi<S> * y / K));
    S const square = q * q, step = square * square;
    S weight(-1.0), factor = square, up(1.0);  // (-1)^n q^(2 n^2), and the factor that leads to the next
    S value(1.0), change(0.0);
    while (size_ < most) {
      weight = weight * factor;
      factor = factor * step;
      up = up / g;
      S const plus = weight * (S(1.0) / up + up), minus = weight * (S(1.0) / up - up);
      if (abs_of(plus) < S(0.1) * elliptic::epsilon<S>) break;
      even_[size_] = plus;
      odd_[size_] = minus;
      ++size_;
      value += plus;
      change += S(2.0 * double(size_)) * minus;
      weight = -weight;
    }
    slope_ = S(0.5) * elliptic::pi<S> / K * change / value;
  }
  /// theta_2(v, p) = sum p^(n(n+1)) cos (2n+1)v,   v = alpha - i beta, p = exp(-pi K / (2 K')),
  /// alpha = pi y / (4 K'), beta = pi u / (4 K'); and a drift of the angle. Divided by exp |beta| / 2.
  void transform(S const& y, S const& other, elliptic::Jacobi<S> const& jacobi) {
    transformed_ = true;
    S const per = S(0.25) * elliptic::pi<S> / other, alpha = per * y;
    decay_rate_ = S(2.0) * per;
    S p(0.0);
    if (!jacobi.endless()) {
      p = elliptic::exp(S(-decay_rate_ * jacobi.quarter_period()));
      drift_ = -(alpha / jacobi.quarter_period());
    }
    S weight(1.0), factor = p * p, greatest(1.0);  // p^(n(n+1)); p^(n^2), which it grows to at |u| = K
    S value(0.0), change(0.0);
    for (S power(1.0); size_ < most && S(0.1) * elliptic::epsilon<S> < greatest;) {
      S const k(2.0 * double(size_) + 1.0);
      even_[size_] = weight * cos(S(k * alpha));
      odd_[size_] = weight * sin(S(k * alpha));
      value += even_[size_];
      change += k * odd_[size_];
      ++size_;
      weight = weight * factor;
      factor = factor * p * p;
      greatest = greatest * power * p;
      power = power * p * p;
    }
    slope_ = drift_ + per * change / value;
  }

  bool transformed_ = false;
  std::size_t size_ = 0;
  std::array<S, most> even_{}, odd_{};
  S slope_{0.0}, drift_{0.0}, decay_rate_{0.0};
};

/// The motion of a free rigid body with principal moments along the body's x, y, z, in any order.
/// params  principal > 0 [kg m^2];  q0 body -> inertial;  omega0 [rad/s, body]
/// q(t) has the norm of q0: a unit q0 is the caller's business.
template <Scalar S>
class ExactFreeBody {
 public:
  /// attitude (first) x omega [rad/s, body] (second)
  using State = Pair<Quat<S>, Vec3<S>>;

  ExactFreeBody(Vec3<S> const& principal, Quat<S> const& q0, Vec3<S> const& omega0)
      : path_({principal.x, principal.y, principal.z}, {omega0.x, omega0.y, omega0.z}),
        jacobi_(path_.m, path_.m1),
        wave_(path_, jacobi_),
        half_rate_(S(0.5) * path_.turning + path_.sense * path_.frequency * wave_.slope()),
        per_moment_{path_.momentum / principal.x, path_.momentum / principal.y, path_.momentum / principal.z} {
    fixed_ = q0 * conj(turned(S(0.0)).first);
  }

  /// The state at time t [s], which may be negative.
  State at(S const& t) const {
    auto const [q, l] = turned(t);
    return {fixed_ * q, {l.x * per_moment_.x, l.y * per_moment_.y, l.z * per_moment_.z}};
  }

  Polhode<S> const& path() const { return path_; }

 private:
  /// Parts 1 and 2 of the attitude, a unit quaternion; and the direction of L in body axes.
  POLHODE_INLINE State turned(S const& t) const {
    S u = path_.start + path_.frequency * t;
    S const halves = jacobi_.half_periods(u);
    bool const odd = halves != S(2.0) * elliptic::nearest_integer(S(S(0.5) * halves));
    if (!jacobi_.endless()) {
      S const quarter = jacobi_.quarter_period();
      u = clamp(S(u - halves * (S(2.0) * quarter)), S(-quarter), quarter);
    }

    elliptic::Sncndn<S> j;
    typename PrecessionWave<S>::Value wave;
    if (jacobi_.endless()) {
      S const decay = wave_.decay(u);
      j = jacobi_.at_decay(decay, sign_of(u));
      wave = wave_.at_decay(u, decay);
    } else {
      S const phase = jacobi_.phase(u), sine = sin(phase), cosine = cos(phase);
      j = jacobi_.at_phase(sine, cosine);
      wave = wave_.transformed() ? wave_.at_decay(u, wave_.decay(u)) : wave_.at_phase(sine, cosine);
    }
    S const flip(odd ? -1.0 : 1.0);
    std::array<S, 3> l;
    l[path_.first] = path_.amplitude[0] * (flip * j.cn);
    l[path_.middle] = path_.amplitude[1] * (flip * j.sn);
    l[path_.dominant] = path_.amplitude[2] * j.dn;

    // e^(i chi / 2) = e^(i angle) (re - i sense im), up to its length
    S const angle = half_rate_ * t - path_.sense * wave.angle;
    S const c = cos(angle), s = sin(angle), im = -(path_.sense * wave.im);
    return {turn(l, S(c * wave.re - s * im), S(s * wave.re + c * im)), {l[0], l[1], l[2]}};
  }
  /// The turn about e by chi after the shortest turn from l to e, e the dominant axis on l's side; c : s are cosine and
  /// sine of chi / 2 up to a factor.
  POLHODE_INLINE Quat<S> turn(std::array<S, 3> const& l, S const& c, S const& s) const {
    std::size_t const k = path_.dominant, a = (k + 1) % 3, b = (k + 2) % 3;
    S const side = sign_of(path_.amplitude[2]), w = S(1.0) + abs_of(l[k]);
    S const norm = sqrt((c * c + s * s) * (l[a] * l[a] + l[b] * l[b] + w * w)), over = S(1.0) / norm;
    S const x = c * over, y = s * over;
    std::array<S, 3> v;
    v[a] = y * l[a] + side * x * l[b];
    v[b] = y * l[b] - side * x * l[a];
    v[k] = side * y * w;
    return {v[0], v[1], v[2], x * w};
  }

  Polhode<S> path_;
  elliptic::Jacobi<S> jacobi_;
  PrecessionWave<S> wave_;
  S half_rate_;         ///< secular rate of chi / 2 [rad/s]
  Vec3<S> per_moment_;  ///< |L| / principal [rad/s]
  Quat<S> fixed_{S(0.0), S(0.0), S(0.0), S(1.0)};
};

}  // namespace polhode
