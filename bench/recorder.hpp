#pragma once
/// What the harness writes down of a run, step by step: its history and its metrics; and what makes a run end early.
#include <chrono>
#include <vector>

#include "bench/cell.hpp"

namespace polhode::bench {

/// The state is shown beside the attitude that it describes.
template <class A>
constexpr bool shows_parameters = std::same_as<A, Mrp<double>> || std::same_as<A, MrpShadow<double>>;

/// Thrown by a watch when a run has used up its time.
struct Timeout {};

class Deadline {
 public:
  explicit Deadline(Limits const& limits)
      : stop_(limits.stop), limited_(limits.timeout > 0), end_(Clock::now() + to_ticks(limits.timeout)) {}
  void check() {
    if (++calls_ % 256 != 0) return;
    if (stop_ && *stop_) throw Interrupted{};
    if (limited_ && Clock::now() > end_) throw Timeout{};
  }

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::duration to_ticks(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  std::atomic<bool> const* stop_;
  bool limited_;
  Clock::time_point end_;
  std::int64_t calls_ = 0;
};

inline Quat<Quad> widened(Quat<double> const& q) {
  return {q.x, q.y, q.z, q.w};
}
inline Vec3<Quad> widened(Vec3<double> const& v) {
  return {v.x, v.y, v.z};
}

/// One body as the metrics see it: attitude and body rate apart.
template <Attitude A>
BodySight sight_of(Point<A> const& x, Vec3<double> const& omega) {
  BodySight seen{.q = widened(A::attitude(x)), .omega = widened(omega)};
  if constexpr (std::same_as<Point<A>, Quat<double>>)
    seen.drift = double(dot(seen.q, seen.q) - 1);
  else if constexpr (A::constrained)
    seen.drift = double(A::template Over<Quad>::defect({widened(x.e1), widened(x.e2), widened(x.e3)}));
  return seen;
}
/// Calls f(attitude space, attitude, body rate or null) for every body of a state.
template <SmallSpace M, class F>
void each_attitude(Point<M> const& x, F f) {
  f.template operator()<typename M::Factor>(x.first, &x.second);
}
template <PowerSpace M, class F>
void each_attitude(Point<M> const& x, F f) {
  for (int i = 0; i < x.count(); ++i)
    if constexpr (Attitude<typename M::Factor>)
      f.template operator()<typename M::Factor>(x[i], nullptr);
    else
      each_attitude<typename M::Factor>(x[i], f);
}

/// Thrown by a watch when a method's own steps have become so short that it would take hours.
struct Stalled {};

/// Sees that a method which chooses its steps gets on.
class Pace {
 public:
  Pace(double t_end, bool watched) : least_(double(window) * t_end / most_steps), watched_(watched) {}
  /// Throws Stalled if at the pace of the last 2^16 steps the horizon would take more than 2e7.
  void check(double t) {
    if (!watched_ || ++steps_ % window != 0) return;
    if (t - last_ < least_) throw Stalled{};
    last_ = t;
  }

 private:
  static constexpr std::int64_t window = 1 << 16;
  static constexpr double most_steps = 2e7;
  double least_, last_ = 0;
  bool watched_;
  std::int64_t steps_ = 0;
};

/// Collects the history, and the metrics if they are wanted: at samples and output times, and in measured runs without
/// samples at the steps that are taken.
template <Space M>
class Recorder final : public Watch<M> {
 public:
  Recorder(Erased<M> const& problem, PreparedCell const& prepared, Metrics* metrics, History& history,
           Limits const& limits)
      : problem_(problem),
        own_columns_(prepared.problem->columns().size()),
        metrics_(metrics),
        history_(history),
        deadline_(limits),
        pace_(prepared.cell.t_end, prepared.cell.rtol.has_value()),
        t_end_(prepared.cell.t_end),
        keeps_steps_(metrics && !(prepared.schedule.sample_period > 0) && !prepared.problem->info().claims.empty()) {}

  void at_stop(Stop const& stop, Point<M> const& x) override {
    if (stop.time == 0 && metrics_) metrics_->see(sight(0, x, {}));
    if (stop.sample || stop.output) keep(stop.time, x);
  }
  void after_step(double t, Point<M> const& x, Projections const& projections) override {
    deadline_.check();
    pace_.check(t);
    reached = t;
    if (metrics_) metrics_->see(sight(t, x, projections));
    if (!keeps_steps_ || t < next_row_ || t >= t_end_) return;
    keep(t, x);
    next_row_ = t + t_end_ / rows_kept * (1 - 1e-9);
  }

  double reached = 0;  ///< the time of the last accepted step [s]

 private:
  Sight sight(double t, Point<M> const& x, Projections const& projections) {
    bodies_.clear();
    each_attitude<M>(x, [&]<class A>(Point<A> const& attitude, Vec3<double> const* omega) {
      bodies_.push_back(sight_of<A>(attitude, omega ? *omega : Vec3<double>{0, 0, 0}));
    });
    return {.t = t, .bodies = bodies_, .raw_defect = projections.raw_defect};
  }
  void keep(double t, Point<M> const& x) {
    std::vector<double> row;
    if (history_.columns.size() > own_columns_) add_state(t, x, row);
    row.resize(row.size() + own_columns_);
    problem_.show(t, x, std::span(row).last(own_columns_));
    history_.times.push_back(t);
    history_.rows.push_back(std::move(row));
  }
  /// Attitude, rate and, where they are the state, modified Rodrigues parameters of every body. Rates that are no state
  /// are those that the field commands.
  void add_state(double t, Point<M> const& x, std::vector<double>& row) {
    Velocity<M> commands = shaped_like<Velocity<M>>(x);
    if constexpr (PowerSpace<M>) problem_(t, x, commands);
    int body = 0;
    each_attitude<M>(x, [&]<class A>(Point<A> const& attitude, Vec3<double> const* omega) {
      Quat<double> const q = A::attitude(attitude);
      row.insert(row.end(), {q.x, q.y, q.z, q.w});
      if constexpr (requires { commands[body].x; }) omega = &commands[body++];
      row.insert(row.end(), {omega->x, omega->y, omega->z});
      if constexpr (shows_parameters<A>) row.insert(row.end(), {attitude.x, attitude.y, attitude.z});
    });
  }

  Erased<M> const& problem_;
  std::size_t own_columns_;
  Metrics* metrics_;
  History& history_;
  Deadline deadline_;
  Pace pace_;
  double t_end_, next_row_ = 0;
  bool keeps_steps_;  ///< measured runs without samples: claims want a history, methods are not to stop for it
  static constexpr int rows_kept = 20'000;
  std::vector<BodySight> bodies_;
};

}  // namespace polhode::bench
