#pragma once
/// One step of Gauss collocation in a frame that turns with the body, its stages in lanes.
///
/// With e(t) the rotation at the constant rate m, the mean body rate of the step as the last one predicts it, the
/// attitude is q = p e and
///   p' = 1/2 p (e (omega - m) e^-1),   omega' = the field's
/// p hardly moves, so a fixed point finds the stages of (p, omega) in few sweeps, however far the body turns. That is
/// the integrating factor of Lawson, in the space's own kinematics. p' is p times a vector, so collocation keeps |p|;
/// omega is plain Gauss: energy and |L| of a free body stay.
/// Damping: where the field answers omega by -lambda omega, lambda a mean over axes, the sweeps solve for that part. A
/// field that may do so feels the attitude, too: there p begins from the omega that is expected.
///
/// Accuracy: the tail, the size of the slopes' last Legendre coefficient, falls as h^s, and the error of a step is
/// about error_per_tail times its square: measured on a free body and on a slew, within a factor of 3 from 1e-6 to
/// 1e-14.
///
/// Sources: Lawson (1967), SIAM J. Numer. Anal. 4, 372; van der Houwen & Sommeijer (1990), J. Comput. Appl. Math. 29,
/// 111 (iterated Runge-Kutta, a stage on each processor); Hairer, Lubich & Wanner, II.1.3, VIII.6; coefficients and
/// sums as in gauss_stages.hpp.
#include <array>

#include "integrators/gauss_tableau.hpp"
#include "integrators/registers.hpp"
#include "problems/lanes_field.hpp"

namespace polhode {

/// Coefficients of s stages in lanes: [j][i] is what slope j gives to stage i.
template <int s>
struct LaneTableau {
  using Row = std::array<double, std::size_t(s)>;
  using Matrix = std::array<Row, std::size_t(s)>;

  alignas(64) Matrix mu, beyond;  ///< beyond[j][k] as in GaussCoefficients
  alignas(64) Row b, c;
  double half_of_last;   ///< 1 / (2 b_s)
  alignas(64) Row tail;  ///< sum_j tail_j L_j is h times the slopes' coefficient of Legendre's polynomial s - 1

  LaneTableau() {
    GaussMu<double> const table(s);
    half_of_last = 0.5 / table.b[s - 1];
    for (std::size_t j = 0; j < s; ++j) {
      b[j] = table.b[j];
      c[j] = table.c[j];
      double before = 1, now = 2 * c[j] - 1;
      for (int k = 1; k + 1 < s; ++k) {
        double const next = ((2 * k + 1) * (2 * c[j] - 1) * now - k * before) / (k + 1);
        before = now;
        now = next;
      }
      tail[j] = (2 * s - 1) * now;
      for (std::size_t i = 0; i < s; ++i) {
        mu[j][i] = table.mu[i][j];
        beyond[j][i] = table.beyond[j][i];
      }
    }
  }
  static LaneTableau const& get() {
    static LaneTableau const table;
    return table;
  }
};

/// The error of a step [rad] over the square of its tail: see above.
template <int s>
inline constexpr double error_per_tail = s == 8 ? 5e-4 : 5e-3;

/// What a step leaves for the next: its increments of omega, what rounding took from omega, and the mean damping.
template <int s>
struct LawsonMemory {
  using Matrix = typename LaneTableau<s>::Matrix;

  alignas(64) std::array<std::array<double, std::size_t(s)>, 3> slopes;  ///< L_j = h b_j omega'_j
  Vec3<double> carry;
  double last_step;                                           ///< [s]; 0: there is none
  double damping;                                             ///< lambda [1/s]; negative: not known
  double greatest_tail, greatest_rate;                        ///< since a restart: the tail squared, the rate [rad/s]
  double damped_for = 0;                                      ///< lambda h of the matrices
  alignas(64) Matrix damped;                                  ///< (1 + lambda a h)^-1 a, [j][i] as in LaneTableau
  alignas(64) std::array<double, std::size_t(s)> damped_one;  ///< (1 + lambda a h)^-1 (1, ..., 1)
  std::int64_t iterations = 0;
  bool unconverged;

  LawsonMemory() { restart(); }
  void restart() {
    fill(carry, 0.0);
    last_step = 0;
    damping = -1;
    greatest_tail = greatest_rate = 0;
    unconverged = false;
  }
};

/// When a stage iteration ends: with its error below `goal`, in radians and as a part of the rate.
struct SweepRule {
  double goal = 0x1p-62;     ///< far below the rounding of one step: what is left of it is the same in every step
  bool to_accuracy = false;  ///< as a part of the greatest rate since a restart
  double part = 0;           ///< > 0: below this part of the greatest error of a step since a restart is enough
  int sweeps = 0;            ///< > 0: after exactly so many sweeps, two more where a step knows nothing of one before
};

/// One body's state on flat quaternions.
using BodyPoint = Point<RigidBody<FlatQuaternion<double>>>;

/// One step of Gauss in a co-rotating frame, its s stages in the lanes of one pack of registers of `bytes` bytes.
template <int s, int bytes>
struct LawsonStep {
  using L = Lanes<s, double, bytes>;
  using V = Vec3<L>;
  using Q = Quat<L>;
  using Table = LaneTableau<s>;
  using Memory = LawsonMemory<s>;
  static constexpr int most_sweeps = 60;

  /// What a step gave.
  struct Result {
    BodyPoint x;
    Vec3<double> carry;
    bool solved;
    double tail;  ///< rotation [rad], rate as a part of the rate that the rule says
    alignas(64) std::array<std::array<double, std::size_t(s)>, 3> slopes;
  };

  /// One step from x; the memory is what the last one left. The step touches what the memory knows of the run alone.
  template <class Field>
  static POLHODE_INLINE Result step(Field const& field, bool damps, double t, double h, BodyPoint const& x,
                                    Memory& memory, SweepRule const& rule, bool wants_tail) {
    Table const& table = Table::get();
    L const hb = h * L::load(table.b.data()), hc = h * L::load(table.c.data()), stage_times = t + hc;
    Q const q0{L(x.first.x), L(x.first.y), L(x.first.z), L(x.first.w)};
    V const w0{L(x.second.x), L(x.second.y), L(x.second.z)};
    double const ratio = memory.last_step > 0 ? h / memory.last_step : 1e300;
    bool const knows = ratio < 3;
    V w, mean;
    if (knows)
      extrapolate(table, memory, ratio, x, w, mean);
    else
      begin(field, damps, t, h, hc, q0, w0, memory, w, mean);
    double const damped = memory.damping * h;
    bool const shifts = damps && damped > 0.25;
    // Those of a step about as long serve as well: they steer the sweeps, and no more. After a restart they are the
    // step's own, so that a run repeats itself to the last bit.
    double const off = knows ? 0.25 * memory.damped_for : 0.0;
    if (shifts && !(std::fabs(damped - memory.damped_for) <= off)) make_damped(table, damped, memory);

    L const turning = sqrt(dot(mean, mean) + 1e-300);
    Q const e = frame_of(mean, turning, hc);
    Mat3<L> const full = matrix(e), turn{0.5 * full.e1, 0.5 * full.e2, 0.5 * full.e3};

    Columns mu, damped_mu{};  // in registers
    unroll<s>([&](auto j) POLHODE_LAMBDA { mu.of[j] = (h * table.b[j]) * L::load(table.mu[j].data()); });
    if (shifts) unroll<s>([&](auto j) POLHODE_LAMBDA { damped_mu.of[j] = L::load(memory.damped[j].data()); });
    alignas(64) double K[3][s], Kp[4][s];
    double const rate = abs_of(x.second.x) + abs_of(x.second.y) + abs_of(x.second.z);
    memory.greatest_rate = max_of(memory.greatest_rate, rate);
    L const per_rate = 1.0 / (turning + (rule.to_accuracy ? memory.greatest_rate : rate));
    L const tail_weights = hb * L::load(table.tail.data());
    double const enough = rule.part * error_per_tail<s>;
    double goal = max_of(rule.goal, enough * memory.greatest_tail);
    Vec3<double> const begun = x.second + memory.carry;
    Q p = q0;
    if (damps) {
      V const u = turn * (w - mean);
      for (int i = 0; i < 2; ++i) {
        store(turned_by(p, u), Kp);
        p = added(mu, x.first, Kp);
      }
    }
    V dw;
    bool solved = rule.sweeps > 0;
    int const most = rule.sweeps > 0 ? rule.sweeps + (knows ? 0 : 2) : most_sweeps;
    double before = 1e300;
    int sweep = 0;
    for (; sweep < most;) {
      auto const v = field(stage_times, typename RigidBody<FlatQuaternion<L>>::Point{product(p, e), w});
      dw = v.second;
      V w_next;
      if (shifts) [[unlikely]] {
        L const one = L::load(memory.damped_one.data());
        store(h * dw + memory.damped_for * w, K);
        w_next = {begun.x * one + times(damped_mu, K[0]), begun.y * one + times(damped_mu, K[1]),
                  begun.z * one + times(damped_mu, K[2])};
      } else {
        store(dw, K);
        w_next = {begun.x + times(mu, K[0]), begun.y + times(mu, K[1]), begun.z + times(mu, K[2])};
      }
      // Rates are of the newest omega: what the torque feels of the attitude then converges twice as fast.
      store(turned_by(p, turn * (w_next + ((v.first - w) - mean))), Kp);
      Q const p_next = added(mu, x.first, Kp);
      ++sweep;
      if (rule.sweeps == 0) {
        L const change =
            max_of(max_of(max_of(abs_of(p_next.x - p.x), abs_of(p_next.y - p.y)),
                          max_of(abs_of(p_next.z - p.z), abs_of(p_next.w - p.w))),
                   per_rate * max_of(max_of(abs_of(w_next.x - w.x), abs_of(w_next.y - w.y)), abs_of(w_next.z - w.z)));
        double const now = greatest_of(change);
        double const left = sweep > 1 && now < before ? now * (now / before) : now;
        if (rule.part > 0 && sweep == 3) {  // the tail is right to a tenth
          memory.greatest_tail = max_of(memory.greatest_tail, square_tail(tail_weights, dw, Kp, per_rate[0]));
          goal = max_of(goal, enough * memory.greatest_tail);
        }
        // At rest, as well, where only rounding errors move it.
        solved = left <= goal || (now <= 0x1p-46 && before <= 2 * now);
        if (solved || !(now < 1e3)) break;
        before = now;
      }
      p = p_next;
      w = w_next;
    }
    memory.iterations += sweep;

    Result result;
    result.solved = solved;
    if (wants_tail) result.tail = std::sqrt(square_tail(tail_weights, dw, Kp, per_rate[0]));
    (hb * dw.x).store(result.slopes[0].data());
    (hb * dw.y).store(result.slopes[1].data());
    (hb * dw.z).store(result.slopes[2].data());
    for (auto& row : Kp) (hb * L::load(row)).store(row);
    Quat<double> const moved{x.first.x + total(Kp[0]), x.first.y + total(Kp[1]), x.first.z + total(Kp[2]),
                             x.first.w + total(Kp[3])};
    // Nodes are symmetric: the first turn and the last are the whole.
    double const c1 = e.w[0], c2 = e.w[s - 1];
    auto const sine = [&](L const& part) POLHODE_LAMBDA { return part[0] * c2 + c1 * part[s - 1]; };
    double const cosine = c1 * c2 - ((e.x[0] * e.x[s - 1] + e.y[0] * e.y[s - 1]) + e.z[0] * e.z[s - 1]);
    Quat<double> const end{sine(e.x), sine(e.y), sine(e.z), cosine};
    // What rounding leaves of |end| = 1 would be the same every step: it is taken out.
    double const shrink = 0.5 * norm_excess(end);
    Quat<double> const turned = moved * end;
    result.x.first = {turned.x - shrink * turned.x, turned.y - shrink * turned.y, turned.z - shrink * turned.z,
                      turned.w - shrink * turned.w};
    Vec3<double>::each(
        [&](double& to, double& rest, double from, double lost_before, auto const& slopes) POLHODE_LAMBDA {
          auto const sum = two_sum(from, total(slopes.data()) + lost_before);
          to = sum.sum;
          rest = sum.rest;
        },
        result.x.second, result.carry, x.second, memory.carry, as_vector(result.slopes));
    return result;
  }

 private:
  /// Turns at rate `mean` for the times hc: half-angles up to pi/2 by Taylor's series in their squares, which are not
  /// waited for as long as sin and cos; farther ones by those.
  static POLHODE_INLINE Q frame_of(V const& mean, L const& turning, L const& hc) {
    L const half = 0.5 * hc, z = (half * half) * dot(mean, mean);
    if (z[s - 1] < 2.5) [[likely]] {
      L const z2 = z * z, z4 = z2 * z2, z8 = z4 * z4;
      std::array<L, 3> const powers{z2, z4, z8};
      L const scale = half * series<1, 0, 12>(z, powers);
      return {scale * mean.x, scale * mean.y, scale * mean.z, series<0, 0, 12>(z, powers)};
    }
    detail::SinCosLanes<s, bytes> const far(turning * half);
    L const scale = far.sin / turning;
    return {scale * mean.x, scale * mean.y, scale * mean.z, far.cos};
  }
  /// sum_k (-z)^k / (2k + odd)! from k = first on, `count` terms over z^first, by halves.
  template <int odd, int first, int count>
  static POLHODE_INLINE L series(L const& z, std::array<L, 3> const& powers) {
    constexpr auto coefficient = [](int k) {
      double c = 1;
      for (int i = 2; i <= 2 * k + odd; ++i) c /= i;
      return k % 2 == 0 ? c : -c;
    };
    if constexpr (count == 2) {
      return coefficient(first) + coefficient(first + 1) * z;
    } else {
      constexpr int low = count > 8 ? 8 : count / 2;
      return series<odd, first, low>(z, powers) + powers[low == 2   ? 0
                                                         : low == 4 ? 1
                                                                    : 2] *
                                                      series<odd, first + low, count - low>(z, powers);
    }
  }
  /// p e, its sums by halves.
  static POLHODE_INLINE Q product(Q const& p, Q const& e) {
    return {(p.w * e.x + p.x * e.w) + (p.y * e.z - p.z * e.y), (p.w * e.y + p.y * e.w) + (p.z * e.x - p.x * e.z),
            (p.w * e.z + p.z * e.w) + (p.x * e.y - p.y * e.x), (p.w * e.w - p.x * e.x) - (p.y * e.y + p.z * e.z)};
  }
  template <class T>
  static POLHODE_INLINE Vec3<T> as_vector(std::array<T, 3> const& a) {
    return {a[0], a[1], a[2]};
  }
  /// The sum by halves.
  static POLHODE_INLINE double total(double const* k) {
    if constexpr (s == 8)
      return ((k[0] + k[4]) + (k[2] + k[6])) + ((k[1] + k[5]) + (k[3] + k[7]));
    else
      return (k[0] + k[2]) + (k[1] + k[3]);
  }
  template <class Matrix>
  static POLHODE_INLINE Q added(Matrix const& mu, Quat<double> const& q, double const (&Kp)[4][s]) {
    return {q.x + times(mu, Kp[0]), q.y + times(mu, Kp[1]), q.z + times(mu, Kp[2]), q.w + times(mu, Kp[3])};
  }
  static POLHODE_INLINE double square_tail(L const& weights, V const& dw, double const (&Kp)[4][s], double per_rate) {
    auto const part = [&](L const& slopes) POLHODE_LAMBDA { return sum_of(weights * slopes); };
    double const a = part(L::load(Kp[0])), b = part(L::load(Kp[1])), c = part(L::load(Kp[2])), d = part(L::load(Kp[3]));
    double const u = part(dw.x), v = part(dw.y), z = part(dw.z);
    return 4 * (a * a + b * b + c * c + d * d) + per_rate * per_rate * (u * u + v * v + z * z);
  }
  /// p (v, 0).
  static POLHODE_INLINE Q turned_by(Q const& p, V const& v) {
    return {(p.w * v.x + p.y * v.z) - p.z * v.y, (p.w * v.y + p.z * v.x) - p.x * v.z,
            (p.w * v.z + p.x * v.y) - p.y * v.x, -((p.x * v.x + p.y * v.y) + p.z * v.z)};
  }
  /// Lanes that are to be read one by one, in memory: g++ 12 would take them out of registers by shuffles, which takes
  /// longer.
  template <class Vector, class Rows>
  static POLHODE_INLINE void store(Vector const& lanes, Rows& rows) {
    double* to = rows[0];
    Vector::each([&](L const& a) POLHODE_LAMBDA { a.store(to), to += s; }, lanes);
    asm("" : "+m"(rows));
  }
  struct Columns {
    L of[s];
    POLHODE_INLINE L const& operator[](std::size_t j) const { return of[j]; }
  };
  static POLHODE_INLINE L const& column(L const& in_registers) { return in_registers; }
  static POLHODE_INLINE L column(typename Table::Row const& in_memory) { return L::load(in_memory.data()); }
  /// sum_j m_j k_j, by halves.
  template <class Matrix>
  static POLHODE_INLINE L times(Matrix const& m, double const* k) {
    auto const term = [&](std::size_t j) POLHODE_LAMBDA { return k[j] * column(m[j]); };
    if constexpr (s == 8)
      return ((term(0) + term(4)) + (term(2) + term(6))) + ((term(1) + term(5)) + (term(3) + term(7)));
    else
      return (term(0) + term(2)) + (term(1) + term(3));
  }
  /// omega at the stages by the last step's polynomial; and in the middle of the step by its last slope, for of the
  /// frame's rate no more is asked, and it is waited for.
  static POLHODE_INLINE void extrapolate(Table const& table, Memory const& memory, double ratio, BodyPoint const& x,
                                         V& w, V& mean) {
    L const z = ratio * L::load(table.c.data());
    double const to_middle = ratio * table.half_of_last;
    auto const ahead = [&](std::size_t axis, double from, L& at_stages, L& at_middle) POLHODE_LAMBDA {
      auto const& slopes = memory.slopes[axis];
      at_middle = L(from + to_middle * slopes[s - 1]);
      alignas(64) double power[1][s];
      times(table.beyond, slopes.data()).store(power[0]);
      L sum = power[0][s - 1] * z;
      unroll<s - 1>([&](auto k) POLHODE_LAMBDA { sum = (sum + power[0][s - 2 - k]) * z; });
      at_stages = from + sum;
    };
    ahead(0, x.second.x, w.x, mean.x);
    ahead(1, x.second.y, w.y, mean.y);
    ahead(2, x.second.z, w.z, mean.z);
  }
  /// The same from the slope at x alone, and the mean damping there: from one evaluation, a direction in each lane.
  template <class Field>
  static POLHODE_INLINE void begin(Field const& field, bool damps, double t, double h, L const& hc, Q const& q0,
                                   V const& w0, Memory& memory, V& w, V& mean) {
    double const nudge = 0x1p-20 * (1.0 + abs_of(w0.x[0]) + abs_of(w0.y[0]) + abs_of(w0.z[0]));
    auto const in_lane = [&](int lane) POLHODE_LAMBDA {
      return L::of([&](int i) POLHODE_LAMBDA { return damps && i == lane ? nudge : 0.0; });
    };
    auto const v = field(L(t), typename RigidBody<FlatQuaternion<L>>::Point{
                                   q0, V{w0.x + in_lane(1), w0.y + in_lane(2), w0.z + in_lane(3)}});
    Vec3<double> const slope{v.second.x[0], v.second.y[0], v.second.z[0]};
    if (damps && memory.damping < 0) {
      double const sum = (v.second.x[1] - slope.x) + (v.second.y[2] - slope.y) + (v.second.z[3] - slope.z);
      memory.damping = max_of(0.0, -sum / (3 * nudge));
    }
    double const lambda = damps ? memory.damping : 0.0;
    L const reach = hc / (1.0 + (0.5 * lambda) * hc), middle(0.5 * h / (1 + lambda * h / 3));
    w = {w0.x + slope.x * reach, w0.y + slope.y * reach, w0.z + slope.z * reach};
    mean = {w0.x + slope.x * middle, w0.y + slope.y * middle, w0.z + slope.z * middle};
  }
  /// memory.damped for lambda h, by Gauss and Jordan on columns, for the two matrices commute; the one that is inverted
  /// is near 1, so the diagonal serves as pivots.
  static POLHODE_INLINE void make_damped(Table const& table, double lambda_h, Memory& memory) {
    alignas(64) typename Table::Matrix left;
    auto& right = memory.damped;
    for (std::size_t j = 0; j < s; ++j) {
      L const column = table.b[j] * L::load(table.mu[j].data());
      column.store(right[j].data());
      (lambda_h * column).store(left[j].data());
      left[j][j] += 1;
    }
    for (std::size_t k = 0; k < s; ++k) {
      double const scale = 1 / left[k][k];
      L const pivot_left = scale * L::load(left[k].data()), pivot_right = scale * L::load(right[k].data());
      for (std::size_t j = 0; j < s; ++j) {
        double const factor = left[j][k];
        (L::load(left[j].data()) - factor * pivot_left).store(left[j].data());
        (L::load(right[j].data()) - factor * pivot_right).store(right[j].data());
      }
      pivot_left.store(left[k].data());
      pivot_right.store(right[k].data());
    }
    L sum = L::load(right[0].data());
    for (std::size_t j = 1; j < s; ++j) sum = sum + L::load(right[j].data());
    (1.0 - lambda_h * sum).store(memory.damped_one.data());
    memory.damped_for = lambda_h;
  }
};

}  // namespace polhode
