#pragma once
/// Spacecraft turn to one attitude, each commanding its body rate from the quaternions of those that it hears.
/// Source: Meng, San & Zhang (2022), "Global attitude synchronization for networked spacecraft with quaternion-based
///         representations", Journal of Henan Normal University (Natural Science) 50(6), 1,
///         doi 10.16366/j.cnki.1000-2367.2022.06.001
/// Printed: graph, initial data, 20 s. The printed quaternions are not of unit length (|q|^2 - 1 = +.1711, -.0292,
/// -.0128, -.0097, -.0053): `normalized` divides by the norm, `recomputed` keeps the vector part, `raw` keeps all, and
/// then scalar parts stay .111 apart for ever, contrary to the paper's figures. Ours: `trap`, and craft in any number.
/// Protocol (13) sees the sign of a quaternion, which its attitude has not, and jumps where a scalar part crosses 0.
/// state   attitude of each craft, body to inertial axes; velocity: the commanded rates [rad/s, body]
#include "problems/controllers/synchronisation.hpp"
#include "problems/definition.hpp"
#include "problems/formulations.hpp"
#include "problems/graph.hpp"
#include "problems/history.hpp"
#include "problems/laplacian.hpp"
#include "problems/mrp.hpp"

namespace polhode {

/// The field: protocol (7), or (13) with one state event a craft: its scalar part is 0.   A  attitude
template <Scalar S, Attitude A>
struct SynchronisedCraft {
  using Space = Attitudes<A>;
  using State = Point<Space>;

  Graph graph;
  State start;
  bool signs;                          ///< protocol (13)
  std::vector<double> null_vector;     ///< left null vector of the Laplacian; empty: V is not shown
  std::vector<std::uint8_t> negative;  ///< sides, if held: 1 where the scalar part counts as negative
  bool holds_sides = false;

  void operator()(S const&, State const& x, Velocity<Space>& v) const {
    if (x.count() > most_in_cache)
      command<true>(x, v);
    else
      command<false>(x, v);
  }
  State initial() const { return start; }

  int state_events() const { return signs ? start.count() : 0; }
  void event_values(S const&, State const& x, std::span<S> g) const {
    for (int i = 0; i < state_events(); ++i) g[std::size_t(i)] = A::attitude(x[i]).w;
  }
  void take_sides(Real<S> const&, State const& x) {
    for (int i = 0; i < state_events(); ++i) negative[std::size_t(i)] = A::attitude(x[i]).w < S(0.0);
    holds_sides = true;
  }
  void cross(int k) { negative[std::size_t(k)] ^= 1; }

  /// disagreement, scalar_spread, scalar_min, and lyapunov if there is a null vector.
  void show(State const& x, std::span<double> out) const {
    double least = 1e300, most = -1e300, lyapunov = 0;
    for (int i = 0; i < x.count(); ++i) {
      double const scalar = double(A::attitude(x[i]).w);
      least = std::min(least, scalar);
      most = std::max(most, scalar);
      if (!null_vector.empty()) lyapunov += null_vector[std::size_t(i)] * (2 - 2 * scalar);
    }
    out[0] = disagreement(x);
    out[1] = most - least;
    out[2] = least;
    if (out.size() > 3) out[3] = lyapunov;
  }
  /// The largest |q_i - q_j| [1]. Above 200 craft twice the largest distance from the mean, which is linear in their
  /// number: never less than the exact value, and never more than twice it.
  static double disagreement(State const& x) {
    auto const apart = [](Quat<S> const& p, Quat<S> const& q) {
      Quat<S> d = p;
      add(d, S(-1.0), q);
      return double(sqrt(dot(d, d)));
    };
    int const n = x.count();
    double most = 0;
    if (n <= 200) {
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) most = std::max(most, apart(A::attitude(x[i]), A::attitude(x[j])));
      return most;
    }
    Quat<S> mean = zero<Quat<S>>();
    for (int i = 0; i < n; ++i) add(mean, S(1.0 / n), A::attitude(x[i]));
    for (int i = 0; i < n; ++i) most = std::max(most, apart(A::attitude(x[i]), mean));
    return 2 * most;
  }

 private:
  static constexpr int most_in_cache = 20'000;  ///< so many points fit into the second-level cache of a core

  /// scattered: whom a craft hears may be anywhere in memory, so those of craft to come are sent for. Of 10^5 craft a
  /// step of RK4 takes 0.75 to 0.95 of the time then, by how busy the third-level cache is; of few craft it would
  /// take 1.1.
  template <bool scattered>
  void command(State const& x, Velocity<Space>& v) const {
    constexpr int ahead = 16;
    for (int i = 0, n = x.count(); i < n; ++i) {
      if constexpr (scattered)
        if (i + ahead < n) graph.each_heard(i + ahead, [&](int j, double) { __builtin_prefetch(&x[j]); });
      Quat<S> const own = A::attitude(x[i]);
      Vec3<S> rate = zero<Vec3<S>>();
      if (signs) {
        bool const side = is_negative(i, own);
        graph.each_heard(i, [&](int j, double a) {
          Quat<S> const heard = A::attitude(x[j]);
          add(rate, protocol13<S>(Real<S>(a), own, heard, is_negative(j, heard) == side));
        });
      } else {
        graph.each_heard(i, [&](int j, double a) { add(rate, protocol7<S>(Real<S>(a), own, A::attitude(x[j]))); });
      }
      v[i] = rate;
    }
  }
  bool is_negative(int i, Quat<S> const& q) const { return holds_sides ? negative[std::size_t(i)] != 0 : q.w < S(0.0); }
};

/// The catalogue entry: graph, protocols, initial data, columns and claims of the synchronisation paper.
class QuaternionSync {
 public:
  explicit QuaternionSync(Choice const& choice)
      : signs_(choice.has("protocol13")),
        recomputed_(choice.has("recomputed")),
        raw_(choice.has("raw")),
        trap_(choice.has("trap")) {
    locate_events = !choice.has("unlocated");
    assign(parameters(), choice.set);
    bool const own_graph = choice.set.contains("graph");
    printed_ = n_ == 5 && !own_graph;
    check_counts();
    if (n_ != 5 && !own_graph) triples_.clear();  // drawn, not written
    int const n = int(n_);
    graph_ = triples_.empty() ? random_digraph(n, std::uint64_t(seed_)) : graph_of(triples_, n);
    require_positive_weights(graph_);
    require_strongly_connected(graph_);
    start_ = n_ == 5 ? given_attitudes() : random_attitudes(n);
    if (n <= most_for_null_vector) null_vector_ = left_null_vector(graph_);
  }

  static ProblemInfo const& info() {
    static ProblemInfo const facts{
        .name = "quaternion_sync",
        .summary = "spacecraft turn to one attitude by commanded rates, seeing the signs of quaternions",
        .source =
            "Meng, San & Zhang (2022), Journal of Henan Normal University (Natural Science) 50(6), 1, "
            "doi 10.16366/j.cnki.1000-2367.2022.06.001",
        .variants = {{"protocol7", "protocol13"}, {"normalized", "recomputed", "raw"}, {"", "trap"}, {"", "unlocated"}},
        .events = {"scalar parts reach 0 (protocol13)"},
        .claims = {{"lemma_1", "the least scalar part never decreases if none is negative: its greatest fall", {}, ""},
                   {"lyapunov_rise", "V = sum of p_i (2 - 2 eps_i) never increases: its greatest rise", {}, ""},
                   {"lyapunov_start", "V at 0 s; ours: 1.278598 (protocol7), 1.972655 (protocol13)", {}, ""},
                   {"lyapunov_end", "V at 20 s; ours: .267340 (protocol7), .272543 (protocol13)", {}, ""},
                   {"together", "quaternions stay within 1e-2; ours: from 11.58 s, 12.43 s (protocol13)", {}, "s"},
                   {"disagreement_end", "largest |q_i - q_j| at 20 s; ours: 2.609e-4, 3.810e-4 (protocol13)", {}, ""},
                   {"scalar_consensus", "scalar parts agree at the end, as in figures 1 and 2: within 1e-3", 0.0, ""},
                   {"crossing_1", "craft 5's scalar part reaches 0; ours: .2116516346", {}, "s"},
                   {"crossing_2", "craft 3's; ours: .4855026743", {}, "s"},
                   {"crossing_3", "craft 1's; ours: 1.0050253857", {}, "s"},
                   {"trap", "protocol7 leaves attitudes sqrt(2) apart: the greatest departure from that", {}, ""}},
        .driven = {"unlocated"}};
    return facts;
  }
  std::vector<Parameter> parameters() {
    return {
        {"graph", "", Rule::graph, triples_}, {"n", "", Rule::positive, n_}, {"seed", "", Rule::non_negative, seed_}};
  }

  double horizon = 20;        ///< [s]
  double sample_period = 0;   ///< continuous
  bool locate_events = true;  ///< methods stop where a scalar part crosses 0
  bool torque_free() const { return false; }
  /// The field jumps with the state.
  bool switches() const { return signs_; }
  /// Why a formulation cannot be; empty if it can.
  std::string refusal(std::string_view formulation) const {
    if (formulation == Mrp<double>::name) return raw_ ? "three numbers cannot keep the norm of raw quaternions" : "";
    if (formulation == FlatQuaternion<double>::name || formulation == S3<double>::name) return "";
    return "the law sees the sign of the quaternion, which this formulation has not";
  }
  using Formulations = AttitudesFormulations;
  using TimedFormulations = AttitudesFormulations;

  /// References in quadruple precision are for networks that fit into one.
  std::string no_reference() const {
    return start_.size() <= most_for_reference
               ? ""
               : "more than " + std::to_string(most_for_reference) + " craft: no reference in quadruple precision";
  }
  std::vector<Column> columns() const {
    std::vector<Column> list{{"disagreement", ""}, {"scalar_spread", ""}, {"scalar_min", ""}};
    if (!null_vector_.empty()) list.push_back({"lyapunov", ""});
    return list;
  }
  std::vector<ClaimResult> claims(History const& history) const;

  template <Scalar S, template <class> class A, bool>
  auto field() const {
    SynchronisedCraft<S, A<S>> craft{
        .graph = graph_, .start = {}, .signs = signs_, .null_vector = null_vector_, .negative = {}};
    craft.start = Point<Attitudes<A<S>>>(int(start_.size()));
    for (std::size_t i = 0; i < start_.size(); ++i) craft.start[int(i)] = A<S>::from_attitude(prepared<S>(start_[i]));
    craft.negative.assign(start_.size(), 0);
    return craft;
  }

 private:
  static constexpr int most_for_null_vector = 500;  ///< dense linear algebra
  static constexpr std::size_t most_for_reference = 20;

  void check_counts() const {
    if (n_ != std::floor(n_) || n_ < 2 || n_ > 1e6)
      throw ParameterError("parameter n: must be a whole number from 2 to 1e6");
    if (seed_ != std::floor(seed_) || seed_ > 0x1p53)
      throw ParameterError("parameter seed: must be a whole number from 0 to 2^53");
    if (n_ != 5 && (recomputed_ || raw_ || trap_))
      throw ParameterError("parameter n: variants recomputed, raw and trap are about 5 craft");
  }
  std::vector<Quat<double>> given_attitudes() const {
    if (trap_) {
      double const half = std::sqrt(0.5);  // `recomputed` or normalised in the scalar of the run
      std::vector<Quat<double>> craft(5, {0.3, -0.4, 0.5, half});
      craft[2].w = craft[4].w = -half;
      return craft;
    }
    std::vector<Quat<double>> craft{{.2934, -.1556, .7695, .6846},
                                    {-.2480, .3059, -.8761, .2194},
                                    {-.2558, -.7306, .5565, .2798},
                                    {.7631, -.3068, .3815, .4103},
                                    {-.5211, .0775, .8416, .0939}};
    if (signs_)
      for (std::size_t i : {0u, 2u, 4u}) craft[i].w = -craft[i].w;
    return craft;
  }
  /// Uniform on the sphere, before normalisation; for protocol (7) on its upper half, where it works.
  std::vector<Quat<double>> random_attitudes(int n) const {
    std::mt19937_64 bits(std::uint64_t(seed_) + (std::uint64_t(1) << 60));  // not the numbers that made the graph
    auto const uniform = [&] { return 2 * double(bits() >> 11) * 0x1p-53 - 1; };
    std::vector<Quat<double>> craft;
    craft.reserve(std::size_t(n));
    while (craft.size() < std::size_t(n)) {
      double const x = uniform(), y = uniform(), z = uniform(), w = uniform();
      Quat<double> const q{x, y, z, signs_ ? w : std::fabs(w)};
      double const square = dot(q, q);
      if (0.01 < square && square < 1) craft.push_back(q);
    }
    return craft;
  }
  /// An initial attitude in scalar S: with what was printed of it, and the norm that the variant wants.
  template <class S>
  Quat<S> prepared(Quat<double> const& given) const {
    Quat<S> q{S(given.x), S(given.y), S(given.z), S(given.w)};
    if (raw_) return q;
    if (!recomputed_) return normalised(q);
    q.w = sign_of(q.w) * sqrt(S(1.0) - dot(vec(q), vec(q)));
    return q;
  }

  bool signs_, recomputed_, raw_, trap_;
  bool printed_ = true;  ///< the paper's graph and craft
  std::vector<double> triples_{1, 2, 1, 1, 5, 1, 2, 3, 1, 2, 4, 1, 3, 4, 1, 4, 1, 1, 5, 4, 1};
  double n_ = 5, seed_ = 1;
  Graph graph_;
  std::vector<Quat<double>> start_;
  std::vector<double> null_vector_;
};

inline std::vector<ClaimResult> QuaternionSync::claims(History const& run) const {
  std::vector<ClaimResult> results;
  if (run.times.empty()) return results;
  constexpr double rounding = 1e-9;
  std::vector<double> const apart = run.column("disagreement"), least = run.column("scalar_min");
  bool const to_the_end = run.reaches(horizon);
  // Our own numbers (tests/problems/sync_test.cpp) hold for the paper's data, normalised.
  bool const known = printed_ && !recomputed_ && !raw_ && !trap_ && to_the_end;
  auto const against = [&](double value, double of_7, double of_13, double tolerance) -> std::optional<bool> {
    if (!known) return {};
    return std::fabs(value - (signs_ ? of_13 : of_7)) <= tolerance;
  };

  if (least.front() >= 0) {
    double const fall = history::fall(least);
    results.push_back({"lemma_1", fall, {}, fall <= rounding});
  }
  if (!null_vector_.empty()) {
    std::vector<double> const V = run.column("lyapunov");
    double const rise = history::rise(V);
    results.push_back({"lyapunov_rise", rise, {}, rise <= rounding});
    results.push_back({"lyapunov_start", V.front(), {}, against(V.front(), 1.278598, 1.972655, 1e-6)});
    if (to_the_end) results.push_back({"lyapunov_end", V.back(), {}, against(V.back(), .267340, .272543, 1e-5)});
  }
  if (trap_ && !signs_) {
    double most = 0;
    for (double value : apart) most = std::max(most, std::fabs(value - std::sqrt(2)));
    results.push_back({"trap", most, {}, most <= rounding});
    return results;
  }
  std::optional<double> const together = history::below_from(run.times, apart, 1e-2);
  results.push_back({"together", together, {}, together ? against(*together, 11.58, 12.43, 0.02) : false});
  constexpr std::array crossings{.2116516346, .4855026743, 1.0050253857};
  for (std::size_t k = 0; k < crossings.size() && known && signs_ && run.events.size() == crossings.size(); ++k)
    results.push_back(
        {"crossing_" + std::to_string(k + 1), run.events[k], {}, std::fabs(run.events[k] - crossings[k]) <= 1e-9});
  if (to_the_end) {
    double const spread = run.column("scalar_spread").back();
    results.push_back({"disagreement_end", apart.back(), {}, against(apart.back(), 2.609e-4, 3.810e-4, 2e-6)});
    results.push_back({"scalar_consensus", spread, 0.0, spread <= 1e-3});
  }
  return results;
}

}  // namespace polhode
