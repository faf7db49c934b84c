#include "bench/cell/reference.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>

#include "integrators/gauss.hpp"
#include "problems/exact.hpp"

namespace polhode::bench {
namespace {

constexpr double tolerance = 1e-34;  // of the last terms: below the rounding of the sum

/// The Taylor series of one problem, from segment to segment.
template <Space M>
class Expansion {
 public:
  Expansion(Erased<M>& field, std::string const& name, double t_end) : field_(field), name_(name), t_end_(t_end) {
    std::vector<Series> start(std::size_t(size_of(field.initial())));
    store(field.initial(), start.data());
    for (Series const& component : start) state_.push_back(component[0]);
    values_.resize(std::size_t(field.state_events()));
  }
  std::vector<Quad> const& state() const { return state_; }

  void at_stop(Stop const& stop) {
    std::vector<Series> const constants(state_.begin(), state_.end());
    Quad const t(stop.time);
    if (stop.sample) field_.sample(t, point(constants));
    if (stop.jump) field_.enter_phase(t);
    if (values_.empty() || !(stop.time == 0 || stop.sample || stop.jump)) return;
    field_.take_sides(t, point(constants));
    field_.event_values(Series(t), point(constants), std::span(values_));
    sides_.clear();
    for (Series const& value : values_) sides_.push_back(sign_of(value[0]));
  }
  /// The next segment from t, at most to `next`: shorter where the series or a side of the field ends; t moves.
  TaylorSegment<Quad, 32> segment(Quad& t, Quad const& next, std::vector<double>& event_times) {
    auto segment = expand<Quad, 32>(field_, state_, t, Quad(next - t), tolerance);
    bool const useful = segment.h > 1e-9 * t_end_ || segment.h >= next - t;
    if (!useful)
      throw Uncertified(
          fmt::format("{}: the Taylor series has no useful radius of convergence at t = {} s", name_, double(t)));
    bool const arrived = segment.h >= next - t;
    std::vector<int> const crossed = first_events(segment);
    for (std::size_t i = 0; i < state_.size(); ++i) state_[i] = segment.component[i].at(segment.h);
    t = arrived && crossed.empty() ? next : t + segment.h;
    for (int const k : crossed) {
      field_.cross(k);
      sides_[std::size_t(k)] = -sides_[std::size_t(k)];
      event_times.push_back(double(t));
    }
    return segment;
  }

 private:
  Point<M> point(std::vector<Series> const& components) const {
    Point<M> x = field_.initial();
    load(x, components.data());
    return x;
  }
  /// The functions that change sides first within the segment, which is cut off there.
  std::vector<int> first_events(TaylorSegment<Quad, 32>& segment) {
    if (values_.empty()) return {};
    Series time(segment.t);
    time.degree = segment.component.front().degree;
    time[1] = Quad(1.0);
    field_.event_values(time, point(segment.component), std::span(values_));
    constexpr int pieces = 32;
    Quad first = segment.h;
    std::vector<int> crossed;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      auto const value = [&](Quad const& s) { return Quad(sides_[k] * values_[k].at(s)); };
      for (int i = 1; i <= pieces; ++i) {
        Quad const a = segment.h * (i - 1) / pieces, b = segment.h * i / pieces;
        Quad const fb = value(b);
        if (!(fb < 0)) continue;
        Quad const zero = zero_between(a, b, value(a), fb, Quad(1e-33) * max_of(segment.t, segment.h), value);
        constexpr double together = 1e-25;  // [s]
        if (zero < first - together) crossed.clear();
        if (zero < first + together) crossed.push_back(int(k));
        first = zero < first ? zero : first;
        break;
      }
    }
    segment.h = first;
    return crossed;
  }

  Erased<M>& field_;
  std::string name_;
  double t_end_;
  std::vector<Quad> state_;
  std::vector<Series> values_;  ///< of the switching functions
  std::vector<Quad> sides_;     ///< the signs that they have now
};

}  // namespace

Reference Reference::solve(ChosenProblem const& problem, Schedule const& schedule) {
  std::vector<Stop> const stops = stops_of(schedule);
  Reference reference;
  reference.t_end_ = schedule.t_end;
  SeriesProblem const in_series = problem.as_series();
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        reference.layout_ = layout_of<M>();
        Expansion<M> expansion(*field, problem.info().name, schedule.t_end);
        auto const note_rate = [&] {
          for (QuadBody const& body : state_of(expansion.state(), reference.layout_))
            reference.largest_rate_ = std::max(reference.largest_rate_, double(length(body.omega)));
        };
        note_rate();
        for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
          expansion.at_stop(stops[k]);
          for (Quad t = stops[k].time; t < Quad(stops[k + 1].time);) {
            reference.segments_.push_back(expansion.segment(t, stops[k + 1].time, reference.event_times_));
            note_rate();
          }
        }
      },
      in_series);
  return reference;
}

QuadState Reference::at(double t) const {
  auto const after = std::upper_bound(segments_.begin(), segments_.end(), Quad(t),
                                      [](Quad time, auto const& segment) { return time < segment.t; });
  auto const& segment = after == segments_.begin() ? *after : *(after - 1);
  std::vector<Quad> values;
  for (auto const& component : segment.component) values.push_back(component.at(Quad(t) - segment.t));
  return state_of(values, layout_);
}

std::string reference_subject(results::Cell const& cell) {
  std::string text =
      fmt::format("problem={};variant={};t_end={:.17g};seed={}", cell.problem, cell.variant, cell.t_end, cell.seed);
  for (auto const& [name, values] : cell.set) text += fmt::format(";{}={:.17g}", name, fmt::join(values, ","));
  return text;
}

std::string reference_id(results::Cell const& cell) {
  return results::hash_of(reference_subject(cell));
}

namespace {

/// How far two states are apart: the greatest angle between the attitudes of the same body [rad]; without attitudes,
/// the greatest distance of the rates.
double distance_between(QuadState const& a, QuadState const& b, Layout const& layout) {
  Quad most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = max_of(most, layout.attitude ? angle_between(a[i].q, b[i].q) : length(a[i].omega - b[i].omega));
  return double(most);
}

/// Keeps the states at stops.
template <Space M>
struct KeepStops {
  static constexpr bool each_step = false;
  std::vector<QuadState>& states;

  void at_stop(Stop const&, Point<M> const& x) {
    std::vector<Quad> values(std::size_t(size_of(x)));
    store(x, values.data());
    states.push_back(state_of(values, layout_of<M>()));
  }
};

/// States of the same problem at its stops, by 8-stage Gauss on S3 with `divisions` steps from stop to stop.
std::vector<QuadState> solve_by_gauss(ChosenProblem const& problem, Schedule const& schedule, int divisions) {
  std::vector<Stop> const stops = stops_of(schedule);
  double const h = (stops[1].time - stops[0].time) / divisions;
  std::vector<QuadState> states;
  QuadProblem const in_quad = problem.in_quad();
  std::visit(
      [&]<Space M>(std::unique_ptr<Erased<M>> const& field) {
        auto stepper = Gauss<8>{}.bind(*field, FixedStep{h}, NormPolicy::none);
        Point<M> x = field->initial();
        if (RunLoop(*field, stepper, h, true).go(x, stops, KeepStops<M>{states}) != Status::ok)
          throw Uncertified(fmt::format("{}: Gauss in quadruple precision diverged after t = {} s", problem.info().name,
                                        stops[states.size() - 1].time));
      },
      in_quad);
  return states;
}

/// The state of a problem that has a closed form, as a function of time [s]: its own, or that of a free body in
/// principal axes. Empty for any other problem, and for initial data or signs that belong to no physical body.
std::function<QuadState(Quad)> closed_form_of(ChosenProblem const& problem) {
  if (problem.closed_form(0)) return [&](Quad t) { return QuadState{{.omega = *problem.closed_form(t)}}; };
  BodyParameters const* body = problem.body();
  if (!body || !problem.torque_free() || !body->principal() || body->coriolis_sign != 1 || body->raw_q0) return {};
  Vec3<Quad> const moments{body->inertia[0], body->inertia[1], body->inertia[2]};
  ExactFreeBody<Quad> const exact(moments, body->attitude<Quad>(), body->rate<Quad>());
  return [exact](Quad t) { return QuadState{{.q = exact.at(t).first}}; };
}

constexpr double good_enough = 1e-28;  // [rad]; a reference may be worse, but then no finer step helps
constexpr int most_halvings = 7;

/// Empty if the method diverges: its fixed point needs h times the Lipschitz constant below 1.
std::vector<QuadState> try_gauss(ChosenProblem const& problem, Schedule const& schedule, int divisions) {
  try {
    return solve_by_gauss(problem, schedule, divisions);
  } catch (Uncertified const&) {
    return {};
  }
}

/// The greatest distance of two solutions; infinite if one of them is missing.
double greatest_distance(std::vector<QuadState> const& a, std::vector<QuadState> const& b, Layout const& layout) {
  if (a.empty() || b.empty()) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, distance_between(a[k], b[k], layout));
  return most;
}

}  // namespace

Certificate certify(results::Cell const& cell, ChosenProblem const& problem, Schedule const& schedule,
                    Reference const& reference) {
  Certificate certificate{.id = reference_id(cell), .subject = reference_subject(cell)};
  Layout const layout = certificate.layout = reference.layout();
  Schedule watched = schedule;
  if (!(watched.sample_period > 0)) watched.output_period = schedule.t_end / 100;
  std::vector<Stop> const stops = stops_of(watched);
  // A turn of 0.15 rad a step brings order 16 to 33 digits; stiff loops need smaller steps still.
  double const longest = std::max(0.5, schedule.t_end / 300);
  double const h = std::min(longest, 0.15 / std::max(reference.largest_rate(), 1e-3));
  int divisions = int(std::ceil((stops[1].time - stops[0].time) / h - 1e-9));
  std::vector<QuadState> coarse = try_gauss(problem, watched, divisions),
                         fine = try_gauss(problem, watched, 2 * divisions);
  for (int halvings = 0; halvings < most_halvings && !(greatest_distance(coarse, fine, layout) < good_enough);
       ++halvings) {
    divisions *= 2;
    coarse = std::move(fine);
    fine = try_gauss(problem, watched, 2 * divisions);
  }
  if (fine.empty() || coarse.empty())
    throw Uncertified(
        fmt::format("{}: Gauss in quadruple precision diverges at every step size tried; the problem is "
                    "too stiff for a certified reference",
                    problem.info().name));
  std::size_t const every = std::max<std::size_t>(1, (stops.size() - 1) / 50);
  for (std::size_t k = 0; k < stops.size(); ++k) {
    QuadState const here = reference.at(stops[k].time);
    certificate.disagreement = std::max(certificate.disagreement, distance_between(here, fine[k], layout));
    certificate.halving = std::max(certificate.halving, distance_between(coarse[k], fine[k], layout));
    if (k % every != 0 && k + 1 != stops.size()) continue;
    certificate.times.push_back(stops[k].time);
    certificate.states.push_back(here);
  }
  certificate.bar = std::max(certificate.disagreement, certificate.halving);
  if (auto const exact = closed_form_of(problem)) {
    double worst = 0;
    for (std::size_t k = 0; k < certificate.times.size(); ++k)
      worst = std::max(worst, distance_between(certificate.states[k], exact(certificate.times[k]), layout));
    certificate.closed_form = worst;
    certificate.bar = std::max(certificate.bar, worst);
  }
  return certificate;
}

namespace {

/// Throws ReferenceError if the stored states, as far as it goes, are further from `reference` than the bar allows.
void check_fresh(Certificate const& certificate, Reference const& reference, std::filesystem::path const& file) {
  // Round-off of two builds differs: a hundred units in the last place of quadruple precision are no disagreement.
  double const room = std::max(10 * certificate.bar, 1e-30);
  for (std::size_t k = 0; k < certificate.times.size() && certificate.times[k] <= reference.t_end(); ++k) {
    double const apart =
        distance_between(certificate.states[k], reference.at(certificate.times[k]), certificate.layout);
    if (apart <= room) continue;
    throw ReferenceError(
        fmt::format("{}: stale: at t = {} s it is {:.1e} rad from the solution of today's problem; make "
                    "it anew with `polhode reference`",
                    file.string(), certificate.times[k], apart));
  }
}

}  // namespace

std::shared_ptr<UsableReference const> obtain(results::Cell const& cell, ChosenProblem const& problem,
                                              Schedule const& schedule, std::filesystem::path const& folder,
                                              double whole) {
  auto usable = std::make_shared<UsableReference>();
  usable->reference = Reference::solve(problem, schedule);
  results::Cell longer = cell;
  longer.t_end = whole;
  for (results::Cell const* known : {&cell, static_cast<results::Cell const*>(&longer)}) {
    usable->id = reference_id(*known);
    std::filesystem::path const file = folder / (usable->id + ".json");
    if (known->t_end < cell.t_end || !std::filesystem::exists(file)) continue;
    Certificate const certificate = load(file);
    check_fresh(certificate, usable->reference, file);
    usable->bar = certificate.bar;
    return usable;
  }
  usable->id = reference_id(cell);
  usable->bar = certify(cell, problem, schedule, usable->reference).bar;
  return usable;
}

}  // namespace polhode::bench
