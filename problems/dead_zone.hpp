#pragma once
/// A spacecraft follows a path to rest by a sliding law through actuators with a dead zone.
/// Source: Li, Chen, Chen & Zhang (2018), "Finite-time attitude control of spacecrafts with input dead-zone
///         nonlinearities", Journal of Harbin Institute of Technology 50(4), 21,
///         doi 10.11918/j.issn.0367-6234.201704116
/// Printed: inertia, disturbance, actuators, initial data, t_f = 50 and 80 s, the law. Reconstructed: the path's
/// polynomial, the gains (k = 5e-3: the printed rule needs 3.34e-3 with the inertia off by 20%), the inertia's error as
/// a factor 1 + p of the whole matrix, 50 s past t_f.
///
/// Errata: eqs. (6) and (19) lack the dots of derivatives; "|s_i| >= sigma_i" should be beta_i; G is not symmetric, and
/// its symmetric part is positive definite for |sigma| < 1 alone, which t_f = 80 s leaves; the strict bound |delta| <
/// .2 is attained; the last six numbers named delta are the breakpoints b. The printed path is not the smooth one that
/// condition 1 asks for: lambda'' jumps at t_f; `quintic` does not.
///
/// Fixed steps: the poles are -c and -k / beta. RK4 follows s up to h k / beta = 2.7 on `smooth` if they lie apart (n1,
/// n3). With the dead zone, whose slope reaches 1.48 m, s settles at wrong values from 1.88 on: RK4's factor beyond its
/// limit is positive. Past the limit of c the run is lost. On `printed` the closed loop slides in the gaps (Filippov):
/// the chatter does not vanish with the step, so assert bounds there, and orders on `smooth` or `continuous`.
///
/// state   attitude x omega [rad/s, body]
#include <algorithm>
#include <array>

#include "problems/controllers/dead_zone.hpp"
#include "problems/definition.hpp"
#include "problems/formulations.hpp"
#include "problems/history.hpp"
#include "problems/rigid_body.hpp"

namespace polhode {

/// (1 + p) J omega' = -(1 + p) omega x J omega + D(v) + tau_d, the law knowing J.   A  attitude
/// One time event, t_f. On `continuous` six state events, the kinks: k = 0, 1, 2 is v_x, v_y, v_z at the breakpoint on
/// the right, 3, 4, 5 on the left.
template <Scalar S, Attitude A>
struct DeadZoneBody {
  using Space = RigidBody<A>;
  using State = Point<Space>;

  DecayingPath<S> path;
  SlidingLaw<S> law;
  DeadZoneActuator<S> actuators;
  FullInertia<Real<S>> inertia;  ///< of the body over 1 + p: what the law knows
  Real<S> share;                 ///< 1 / (1 + p)
  State start;
  DeadZoneSides sides{};  ///< if held
  bool holds_sides = false;

  Velocity<Space> operator()(S const& t, State const& x) const {
    Vec3<S> const v = signals(t, x).v;
    Vec3<S> const torque =
        actuators.torque(v, holds_sides ? sides : DeadZoneActuator<S>::sides_of(v)) + dead_zone_disturbance(t);
    return {x.second, inertia.acceleration(x.second, share * torque)};
  }
  State initial() const { return start; }

  Vec3<S> sigma(S const& t, State const& x) const { return mrp_near(A::attitude(x.first), path(t).at); }
  SlidingSignals<S> signals(S const& t, State const& x) const {
    PathPoint<S> const wanted = path(t);
    return law(wanted, mrp_near(A::attitude(x.first), wanted.at), x.second);
  }
  /// v_x .. [N m], sliding_x .. [1/s], sigma_x .. [1]
  void show(S const& t, State const& x, std::span<double> out) const {
    SlidingSignals<S> const now = signals(t, x);
    for (Vec3<S> const& shown : {now.v, now.sliding, sigma(t, x)}) {
      double const numbers[] = {double(shown.x), double(shown.y), double(shown.z)};
      std::copy(std::begin(numbers), std::end(numbers), out.begin());
      out = out.subspan(3);
    }
  }

  std::vector<double> time_events() const { return {double(path.t_f)}; }
  /// On the cubic path v jumps at t_f: sides that are held must be taken anew.
  void enter_phase(Real<S> const& t) {
    path.arrived = Real<S>(1 - 1e-6) * path.t_f < t;  // a stop may be merged with an output time of other rounding
  }

  int state_events() const { return actuators.kind() == DeadZoneKind::continuous ? 6 : 0; }
  void event_values(S const& t, State const& x, std::span<S> g) const {
    Vec3<S> const v = signals(t, x).v;
    Vec3<DeadZoneAxis> const& axis = dead_zone_axes;
    S const values[] = {v.x - S(axis.x.right), v.y - S(axis.y.right), v.z - S(axis.z.right),
                        v.x - S(axis.x.left),  v.y - S(axis.y.left),  v.z - S(axis.z.left)};
    std::copy_n(std::begin(values), state_events(), g.begin());
  }
  /// From now on the sides are held, beginning with those of x: the signs of the functions, sgn(0) = +1.
  void take_sides(Real<S> const& t, State const& x) {
    if (state_events() == 0) return;  // nothing would ever change them
    std::array<S, 6> g;
    event_values(S(t), x, g);
    for (int k = 0; k < 6; ++k) beyond(k) = (g[std::size_t(k)] < S(0.0)) == (k >= 3);
    holds_sides = true;
  }
  /// Event k has happened.
  void cross(int k) { beyond(k) = !beyond(k); }

 private:
  /// The command lies on the far side of breakpoint k, seen from the gap.
  bool& beyond(int k) {
    bool* const flags[] = {&sides.right.x, &sides.right.y, &sides.right.z, &sides.left.x, &sides.left.y, &sides.left.z};
    return *flags[k];
  }
};

/// The catalogue entry: parameters, variants, columns and claims of the dead-zone paper.
class DeadZone {
 public:
  explicit DeadZone(Choice const& choice) {
    if (choice.has("continuous")) kind_ = DeadZoneKind::continuous;
    if (choice.has("smooth")) kind_ = DeadZoneKind::smooth;
    if (choice.has("quintic")) path_ = PathKind::quintic;
    if (choice.has("n1")) gains_ = {.c = 1, .beta = 5e-7};
    if (choice.has("n3")) gains_ = {.c = 10, .beta = 5e-6};
    if (choice.has("n4")) gains_ = {.c = 31.6, .beta = 1.58e-4};
    locate_events = !choice.has("unlocated");
    assign(parameters(), choice.set);
    if (!(inertia_error_ > -1)) throw ParameterError("parameter inertia_error: must be greater than -1");
    horizon = t_f_ + 50;
    describe_body();
  }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "dead_zone",
        .summary = "sliding law along a path to rest, through actuators with a dead zone",
        .source =
            "Li et al. (2018), Journal of Harbin Institute of Technology 50(4), 21, "
            "doi 10.11918/j.issn.0367-6234.201704116",
        .variants = {{"printed", "continuous", "smooth"},
                     {"cubic", "quintic"},
                     {"n2", "n1", "n3", "n4"},
                     {"", "unlocated"}},
        .events = {"end of the path", "breakpoints of the actuators"},
        .claims = {{"sigma_rest", "every |sigma_i| stays below 1e-6 from t_f on", {}, ""},
                   {"layer", "s never leaves the boundary layer: greatest |s_i| / beta below 1", {}, ""},
                   {"sigma_max", "the greatest |sigma|; above 1 the proof does not hold (see the errata)", {}, ""},
                   {"v_x_peak", "the command's greatest |v_x|", {}, "N m"},
                   {"v_y_peak", "the command's greatest |v_y|", {}, "N m"},
                   {"v_z_peak", "the command's greatest |v_z|", {}, "N m"},
                   {"chatter", "total variation of v, summed over the axes, at the steps taken", {}, "N m"}},
        .step = 0.005,  // K / beta = 100 1/s
        .driven = {"unlocated"},
        .pointing = angle_of_q};
    return facts;
  }
  std::vector<Parameter> parameters() {
    std::vector<Parameter> list;
    list.emplace_back("inertia", "kg m^2", Rule::inertia, nominal_.inertia);
    list.emplace_back("sigma0", "", Rule::finite, sigma0_);
    list.emplace_back("omega0", "rad/s", Rule::finite, nominal_.omega0);
    list.emplace_back("inertia_error", "", Rule::finite, inertia_error_);
    list.emplace_back("c", "1/s", Rule::positive, gains_.c);
    list.emplace_back("beta", "1/s", Rule::positive, gains_.beta);
    list.emplace_back("k_gain", "1/s^2", Rule::non_negative, gains_.k);
    list.emplace_back("t_f", "s", Rule::positive, t_f_);
    return list;
  }

  double horizon = 100;       ///< [s]; 50 s past t_f
  double sample_period = 0;   ///< continuous
  bool locate_events = true;  ///< methods stop at the kinks
  using TimedFormulations = Types<Formulation<FlatQuaternion>, Formulation<S3>, Formulation<Mrp>>;
  bool torque_free() const { return false; }
  /// There is one form of the inertia here, and `field` gives it for both: timed runs compile the fast one alone.
  bool principal() const { return true; }
  /// The field has kinks or jumps in the state.
  bool switches() const { return kind_ != DeadZoneKind::smooth; }
  /// Why no reference to many digits exists; empty if one does.
  std::string no_reference() const {
    return kind_ == DeadZoneKind::printed ? "slides in the actuators' gaps (Filippov)" : "";
  }
  std::vector<Column> columns() const {
    return {{"v_x", "N m"},       {"v_y", "N m"},  {"v_z", "N m"},  {"sliding_x", "1/s"}, {"sliding_y", "1/s"},
            {"sliding_z", "1/s"}, {"sigma_x", ""}, {"sigma_y", ""}, {"sigma_z", ""}};
  }
  std::vector<ClaimResult> claims(History const& history) const;

  /// The body that is controlled: its inertia is 1 + p times the nominal one.
  BodyParameters const& body() const { return body_; }
  template <Scalar S, template <class> class A, bool>
  auto field() const {
    using R = Real<S>;
    Vec3<S> const sigma = loaded<Vec3<S>>(sigma0_.data()), omega = nominal_.rate<S>();
    Vec3<DeadZoneAxis> const& axis = dead_zone_axes;
    Mat3<R> const J = nominal_.matrix<R>();
    return DeadZoneBody<S, A<S>>{.path = {path_, R(t_f_), sigma, mrp_rate(sigma, omega)},
                                 .law = SlidingLaw<S>(gains_, J, {axis.x.slope, axis.y.slope, axis.z.slope}),
                                 .actuators = DeadZoneActuator<S>(kind_),
                                 .inertia = FullInertia<R>(J),
                                 .share = R(1.0) / (R(1.0) + R(inertia_error_)),
                                 .start = {A<S>::from_attitude(quaternion_of_mrp(sigma)), omega}};
  }

 private:
  void describe_body() {
    Quat<double> const q = quaternion_of_mrp(loaded<Vec3<double>>(sigma0_.data()));
    body_ = nominal_;
    for (double& moment : body_.inertia) moment *= 1 + inertia_error_;
    body_.q0 = {q.x, q.y, q.z, q.w};
  }

  DeadZoneKind kind_ = DeadZoneKind::printed;
  PathKind path_ = PathKind::cubic;
  SlidingGains gains_;
  BodyParameters nominal_{.inertia = {950, 600, 360, 11, 5, 36}, .omega0 = {0.1, -0.3, 0.2}}, body_;
  std::vector<double> sigma0_{-0.128, 0.515, 0.128};
  double inertia_error_ = 0;  ///< p
  double t_f_ = 50;           ///< [s]
};

/// The paper's theorem (rest from t_f on, s in its layer) and what the path costs. Nothing from t_f on: no first claim.
inline std::vector<ClaimResult> DeadZone::claims(History const& history) const {
  auto const greatest = [&](std::string const& column, double from) {
    std::vector<double> const values = history.column(column);
    double most = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (history.times[i] >= from) most = std::max(most, std::fabs(values[i]));
    return most;
  };
  auto const greatest_of = [&](std::string const& vector, double from) {
    return std::max({greatest(vector + "_x", from), greatest(vector + "_y", from), greatest(vector + "_z", from)});
  };
  std::vector<double> const x = history.column("sigma_x"), y = history.column("sigma_y"), z = history.column("sigma_z");
  double farthest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) farthest = std::max(farthest, std::hypot(x[i], y[i], z[i]));

  std::vector<ClaimResult> results;
  if (history.reaches(t_f_)) {
    double const rest = greatest_of("sigma", t_f_ * (1 - 1e-9));  // times of outputs are rounded
    results.push_back({"sigma_rest", rest, {}, rest < 1e-6});
  }
  double const layer = greatest_of("sliding", 0) / gains_.beta;
  results.push_back({"layer", layer, {}, layer < 1});
  results.push_back({"sigma_max", farthest, {}, {}});
  for (char const* axis : {"v_x", "v_y", "v_z"})
    results.push_back({std::string(axis) + "_peak", greatest(axis, 0), {}, {}});
  double chatter = 0;
  for (char const* axis : {"v_x", "v_y", "v_z"}) chatter += history::total_variation(history.column(axis));
  results.push_back({"chatter", chatter, {}, {}});
  return results;
}

}  // namespace polhode
