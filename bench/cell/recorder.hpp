#pragma once
/// What the harness writes down of a run, step by step: its history and its metrics; and what makes a run end early.
#include <algorithm>
#include <optional>
#include <vector>

#include "bench/cell/cell.hpp"
#include "bench/cell/measure.hpp"
#include "bench/process/clock.hpp"

namespace polhode::bench {

/// Thrown by a watch when a run has used up its time.
struct Timeout {};

/// Looks at the clock, and whether the run is to stop, now and then: a step may be shorter than a look.
class Deadline {
 public:
  explicit Deadline(Limits const& limits) : stop_(limits.stop), limit_(limits.timeout) {}
  /// Throws Interrupted or Timeout.
  void check() {
    if (++calls_ % 256 != 0) return;
    if (stop_ && *stop_) throw Interrupted{};
    if (limit_.passed()) throw Timeout{};
  }

 private:
  std::atomic<bool> const* stop_;
  TimeLimit limit_;
  std::int64_t calls_ = 0;
};

/// Thrown by a watch when steps have become so short that the run would take hours.
struct Stalled {};

/// Sees that a run gets on: a method that chooses its steps, or equal steps that end on one located event after the
/// other.
class Pace {
 public:
  Pace(double t_end, std::optional<double> h)
      : least_(double(window) * t_end / std::max(most_steps, h ? 10 * t_end / *h : 0)) {}
  /// Throws Stalled if at the pace of the last 2^16 steps the horizon would take more than 2e7 (and than ten times the
  /// equal steps that it has).
  void check(double t) {
    if (++steps_ % window != 0) return;
    if (t - last_ < least_) throw Stalled{};
    last_ = t;
  }

 private:
  static constexpr std::int64_t window = 1 << 16;
  static constexpr double most_steps = 2e7;
  double least_, last_ = 0;
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
        pace_(prepared.cell.t_end, prepared.cell.h),
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

  void multiplier(Vec3<double> const& lambda) override { multiplier_ = widened(lambda); }

  double reached = 0;  ///< the time of the last accepted step [s]

 private:
  Sight sight(double t, Point<M> const& x, Projections const& projections) {
    bodies_.clear();
    each_body<M>(x, [&]<class Body>(Point<Body> const& body) { bodies_.push_back(sight_of<Body>(body)); });
    return {.t = t, .bodies = bodies_, .raw_defect = projections.raw_defect, .multiplier = multiplier_};
  }
  void keep(double t, Point<M> const& x) {
    std::vector<double> row;
    if (history_.columns.size() > own_columns_) add_state(t, x, row);
    row.resize(row.size() + own_columns_);
    problem_.show(t, x, std::span(row).last(own_columns_));
    history_.times.push_back(t);
    history_.rows.push_back(std::move(row));
  }
  /// Every body as `simulate` shows it; of attitudes alone the rates are no state: the field commands them.
  void add_state(double t, Point<M> const& x, std::vector<double>& row) {
    if constexpr (attitudes_alone) {
      Velocity<M> commands = shaped_like<Velocity<M>>(x);
      problem_(t, x, commands);
      for (int i = 0; i < x.count(); ++i) show_body<typename M::Factor>(x[i], &commands[i], row);
    } else {
      each_body<M>(x, [&]<class Body>(Point<Body> const& body) { show_body<Body>(body, nullptr, row); });
    }
  }
  static constexpr bool attitudes_alone = [] {
    if constexpr (PowerSpace<M>) return Attitude<typename M::Factor>;
    return false;
  }();

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
  std::optional<Vec3<Quad>> multiplier_;
};

}  // namespace polhode::bench
