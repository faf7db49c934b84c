#pragma once
/// The states of runs as the harness sees them, whatever space they live on: body by body, in quadruple precision.
#include <string>
#include <vector>

#include "problems/definition.hpp"
#include "problems/mrp.hpp"

namespace polhode::bench {

/// One body in quadruple precision: attitude (body to inertial), body rate [rad/s], and where it moves in space,
/// position [m] and velocity [m/s] of the centre of mass in inertial axes. What a state has not is left as it is here.
struct QuadBody {
  Quat<Quad> q{0, 0, 0, 1};
  Vec3<Quad> omega{};  ///< of a state without attitude: its three numbers
  Vec3<Quad> position{}, velocity{};
};
/// One or many.
using QuadState = std::vector<QuadBody>;

/// Which of these parts the state of a body has.
struct Layout {
  bool attitude = true;
  bool rate = true;  ///< false where rates are commands and no state
  bool position = false;

  bool operator==(Layout const&) const = default;
  int size() const { return (attitude ? 4 : 0) + (rate ? 3 : 0) + (position ? 6 : 0); }
  /// Names and units of the parts, in storage order.
  std::vector<Column> columns() const {
    std::vector<Column> list;
    auto const add = [&](std::string const& unit, auto... names) { (list.push_back({names, unit}), ...); };
    if (attitude) add("", "q1", "q2", "q3", "q4");
    if (attitude && rate) add("rad/s", "wx", "wy", "wz");
    if (!attitude && rate) add("", "y1", "y2", "y3");
    if (position) add("m", "x", "y", "z");
    if (position) add("m/s", "vx", "vy", "vz");
    return list;
  }
};

/// Three plain numbers: a point of R^3 that describes no attitude.
template <class M>
concept Triple = SmallSpace<M> && !Attitude<M> && std::same_as<Point<M>, Vec3<typename M::Scalar>>;

/// The layout of a body on M, or of each of many.
template <Space M>
constexpr Layout layout_of() {
  if constexpr (Attitude<M>)
    return {.rate = false};
  else if constexpr (Triple<M>)
    return {.attitude = false};
  else if constexpr (PowerSpace<M>)
    return layout_of<typename M::Factor>();
  else
    return {.position = !Attitude<typename M::Factor>};
}

/// Components in storage order, body after body, and back.
inline std::vector<Quad> numbers(QuadState const& state, Layout const& layout) {
  std::vector<Quad> all;
  for (QuadBody const& body : state) {
    auto const add = [&](auto const& v) { std::decay_t<decltype(v)>::each([&](Quad a) { all.push_back(a); }, v); };
    if (layout.attitude) add(body.q);
    if (layout.rate) add(body.omega);
    if (layout.position) add(body.position);
    if (layout.position) add(body.velocity);
  }
  return all;
}
inline QuadState state_of(std::vector<Quad> const& numbers, Layout const& layout) {
  QuadState state;
  for (auto next = numbers.begin(); next != numbers.end();) {
    QuadBody body;
    auto const take = [&](auto& v) { std::decay_t<decltype(v)>::each([&](Quad& a) { a = *next++; }, v); };
    if (layout.attitude) take(body.q);
    if (layout.rate) take(body.omega);
    if (layout.position) take(body.position);
    if (layout.position) take(body.velocity);
    state.push_back(body);
  }
  return state;
}

inline Quat<Quad> widened(Quat<double> const& q) {
  return {q.x, q.y, q.z, q.w};
}
inline Vec3<Quad> widened(Vec3<double> const& v) {
  return {v.x, v.y, v.z};
}
inline Mat3<Quad> widened(Mat3<double> const& m) {
  return {widened(m.e1), widened(m.e2), widened(m.e3)};
}

/// One body of a run, and how far it is from the constraint of its attitude.
struct BodySight : QuadBody {
  double drift = 0;       ///< for quaternions signed, q.q - 1
  Mat3<Quad> rotation{};  ///< of a body that moves in space: the matrix of its attitude as the problem sees it
};
template <SmallSpace M>
BodySight sight_of(Point<M> const& x) {
  BodySight seen;
  if constexpr (Triple<M>) {
    seen.omega = widened(x);
  } else if constexpr (Attitude<M>) {
    seen.q = widened(M::attitude(x));
    if constexpr (std::same_as<Point<M>, Quat<double>>)
      seen.drift = double(dot(seen.q, seen.q) - 1);
    else if constexpr (M::constrained)
      seen.drift = double(M::template Over<Quad>::defect(widened(x)));
  } else if constexpr (Attitude<typename M::Factor>) {
    seen = sight_of<typename M::Factor>(x.first);
    seen.omega = widened(x.second);
  } else {
    seen = sight_of<typename M::Factor>(x.first);
    seen.position = widened(x.second.first);
    seen.velocity = widened(x.second.second);
    if constexpr (std::same_as<std::decay_t<decltype(x.first.first)>, Mat3<double>>)
      seen.rotation = widened(x.first.first);
    else
      seen.rotation = matrix(seen.q);
  }
  return seen;
}
/// Calls f(space, point) for every body of a state.
template <Space M, class F>
void each_body(Point<M> const& x, F f) {
  if constexpr (PowerSpace<M>)
    for (int i = 0; i < x.count(); ++i) f.template operator()<typename M::Factor>(x[i]);
  else
    f.template operator()<M>(x);
}

/// The attitude space of a body's state.
template <class M>
struct AttitudeOf {
  using type = M;
};
template <class A, class B>
struct AttitudeOf<Product<A, B>> : AttitudeOf<A> {};
/// The state is shown beside the attitude that it describes.
template <class M>
constexpr bool shows_parameters = std::same_as<typename AttitudeOf<M>::type, Mrp<double>> ||
                                  std::same_as<typename AttitudeOf<M>::type, MrpShadow<double>>;

/// Names and units of what a row of `simulate` shows of one body on M.
template <SmallSpace M>
std::vector<Column> shown_columns() {
  Layout layout = layout_of<M>();
  layout.rate = true;  // commands are shown, too
  std::vector<Column> list = layout.columns();
  if constexpr (shows_parameters<M>)
    for (char const* name : {"s1", "s2", "s3"}) list.push_back({name, ""});
  return list;
}
/// The numbers of that row, added to it. `command` is the body rate where it is no state.
template <SmallSpace M>
void show_body(Point<M> const& x, Vec3<double> const* command, std::vector<double>& row) {
  auto const add = [&](auto const& v) { std::decay_t<decltype(v)>::each([&](double a) { row.push_back(a); }, v); };
  if constexpr (Triple<M>) {
    add(x);
  } else if constexpr (Attitude<M>) {
    add(M::attitude(x));
    add(*command);
    if constexpr (shows_parameters<M>) add(x);
  } else if constexpr (Attitude<typename M::Factor>) {
    show_body<typename M::Factor>(x.first, &x.second, row);
  } else {
    show_body<typename M::Factor>(x.first, command, row);
    add(x.second);
  }
}

}  // namespace polhode::bench
