#include "bench/score/import.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "bench/cell/measure.hpp"

namespace polhode::bench {
namespace {

constexpr int comparisons = 100'000;  ///< with the reference, at most: it takes microseconds
constexpr std::size_t sampled = 200;  ///< rows on which other readings are tried
constexpr double doubtful = 1e-3;     ///< errors from here on make one try [rad, or of the greatest rate]
constexpr double far_better = 10;     ///< an error this many times smaller is worth a remark
constexpr double degree = std::numbers::pi / 180;

Layout layout_of(PreparedCell const& prepared) {
  ProblemInFormulation const problem = prepared.problem->in("quaternion");
  return std::visit([]<Space M>(std::unique_ptr<Erased<M>> const&) { return bench::layout_of<M>(); }, problem);
}

/// "b2." of "b2.q1".
std::string_view prefix_of(std::string_view name) {
  bool const of_many = name.starts_with('b') && name.find('.') != std::string_view::npos;
  return of_many ? name.substr(0, name.find('.') + 1) : std::string_view{};
}

/// One row as bodies.
std::vector<BodySight> bodies_of(std::span<double const> row, Layout const& layout, Reading const& reading) {
  std::vector<BodySight> bodies;
  for (auto next = row.begin(); next != row.end();) {
    BodySight body;
    auto const take = [&](auto& v) { std::decay_t<decltype(v)>::each([&](Quad& a) { a = *next++; }, v); };
    if (layout.attitude) {
      take(body.q);
      body.drift = double(Quad(dot(body.q, body.q) - 1));
      if (reading.scalar_first) body.q = {body.q.y, body.q.z, body.q.w, body.q.x};
      if (reading.inertial_to_body) body.q = conj(body.q);
    }
    if (layout.rate) take(body.omega);
    if (layout.attitude && reading.degrees) body.omega = Quad(degree) * body.omega;
    if (layout.position) take(body.position), take(body.velocity);
    bodies.push_back(body);
  }
  return bodies;
}

// --- Would another reading fit better? -------------------------------------------------------------------------------

std::string flags_of(Reading const& reading, Reading const& given) {
  std::string text;
  auto const add = [&](char const* flag) { text += (text.empty() ? "" : " ") + std::string(flag); };
  if (reading.scalar_first != given.scalar_first) add(reading.scalar_first ? "--scalar first" : "--scalar last");
  if (reading.inertial_to_body != given.inertial_to_body)
    add(reading.inertial_to_body ? "--map inertial-to-body" : "--map body-to-inertial");
  if (reading.degrees != given.degrees) add(reading.degrees ? "--rate-unit deg/s" : "--rate-unit rad/s");
  return text;
}

/// Some rows of a trajectory beside the exact states.
class Trial {
 public:
  Trial(TrajectoryTable const& table, std::size_t points, Layout const& layout, Reference const& reference)
      : table_(table), layout_(layout), scale_(reference.largest_rate()) {
    std::size_t const stride = std::max<std::size_t>(1, points / sampled);
    for (std::size_t i = 0; i < points; i += stride) {
      rows_.push_back(i);
      exact_.push_back(reference.at(table.times[i]));
    }
  }
  /// The greatest attitude error of a reading [rad].
  double attitude_error(Reading const& reading) const {
    return worst(reading, [](BodySight const& body, QuadBody const& exact) { return angle_between(exact.q, body.q); });
  }
  /// The greatest rate error, relative to the greatest rate; in_space: the rates taken as components in inertial axes.
  double rate_error(Reading const& reading, bool in_space) const {
    double const scale = scale_ > 0 ? scale_ : 1;
    return worst(reading,
                 [&](BodySight const& body, QuadBody const& exact) {
                   auto const omega = in_space ? to_inertial(conj(normalised(exact.q)), body.omega) : body.omega;
                   return length(omega - exact.omega);
                 }) /
           scale;
  }

 private:
  double worst(Reading const& reading, std::function<Quad(BodySight const&, QuadBody const&)> const& error) const {
    double most = 0;
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      std::vector<BodySight> const bodies = bodies_of(table_.row(rows_[k]), layout_, reading);
      for (std::size_t i = 0; i < bodies.size(); ++i) most = std::max(most, double(error(bodies[i], exact_[k][i])));
    }
    return most;
  }

  TrajectoryTable const& table_;
  Layout layout_;
  double scale_;
  std::vector<std::size_t> rows_;
  std::vector<QuadState> exact_;
};

/// A remark if another order or map fits far better.
std::string remark_on_attitude(Trial const& trial, Reading const& given, double error) {
  Reading best = given;
  double least = std::numeric_limits<double>::infinity();
  for (bool const scalar_first : {false, true})
    for (bool const inertial_to_body : {false, true}) {
      Reading reading = given;
      reading.scalar_first = scalar_first;
      reading.inertial_to_body = inertial_to_body;
      double const its_error = trial.attitude_error(reading);
      if (its_error < least) least = its_error, best = reading;
    }
  if (best == given || !(least * far_better < error)) return {};
  return fmt::format("the trajectory fits far better if read with {}: attitude error {:.2g} rad instead of {:.2g} rad",
                     flags_of(best, given), least, error);
}

std::string remark_on_rates(Trial const& trial, Reading const& given, double error) {
  for (bool const in_space : {false, true})
    for (bool const degrees : {given.degrees, !given.degrees}) {
      Reading reading = given;
      reading.degrees = degrees;
      double const its_error = trial.rate_error(reading, in_space);
      if (!(its_error * far_better < error)) continue;
      std::string const flags = flags_of(reading, given);
      if (!in_space)
        return fmt::format("the rates fit far better if read with {}: relative error {:.2g} instead of {:.2g}", flags,
                           its_error, error);
      return fmt::format(
          "the rates fit far better as components in inertial axes{}{}: relative error {:.2g} instead of "
          "{:.2g}; body axes are wanted",
          flags.empty() ? "" : " with ", flags, its_error, error);
    }
  return {};
}

/// Is the first row, if it is at 0 s, where the problem begins?
std::string remark_on_start(TrajectoryTable const& table, Layout const& layout, Reading const& reading,
                            Reference const& reference) {
  if (table.times[0] != 0 || !layout.attitude) return {};
  constexpr double equal = 1e-6;
  QuadState const exact = reference.at(0);
  std::vector<BodySight> const bodies = bodies_of(table.row(0), layout, reading);
  double apart = 0, rates = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    apart = std::max(apart, double(angle_between(exact[i].q, bodies[i].q)));
    if (layout.rate) rates = std::max(rates, double(length(bodies[i].omega - exact[i].omega)));
  }
  if (apart < equal && rates < equal * std::max(1e-3, reference.largest_rate())) return {};
  return fmt::format(
      "at 0 s the file is {:.2g} rad and {:.2g} rad/s from where the problem begins, which --set changes", apart,
      rates);
}

void add_remarks(Score& score, TrajectoryTable const& table, Layout const& layout, UsableReference const& usable,
                 Reading const& reading) {
  auto const add = [&](std::string const& remark) {
    if (!remark.empty()) score.remarks.push_back(remark);
  };
  double const error = score.record.attitude_error_max.value_or(0);
  double const rate_error = score.record.rate_error_max.value_or(0);
  if (error < doubtful && rate_error < doubtful) return;
  Trial const trial(table, score.points, layout, usable.reference);
  std::size_t const before = score.remarks.size();
  if (error >= doubtful) add(remark_on_attitude(trial, reading, error));
  if (layout.attitude && layout.rate && rate_error >= doubtful) add(remark_on_rates(trial, reading, rate_error));
  if (score.remarks.size() > before) return;
  add(remark_on_start(table, layout, reading, usable.reference));
  if (error > 1 && score.remarks.size() == before)
    add("no other reading fits better: are the problem, its --variant and its parameters (--set) those of the file?");
}

}  // namespace

ColumnNames columns_to_import(PreparedCell const& prepared) {
  std::vector<Column> const state = layout_of(prepared).columns();
  ColumnNames names;
  std::string last_body = "-";
  for (Column const& column : columns_of(prepared)) {
    std::string_view const prefix = prefix_of(column.name);
    std::string const base = column.name.substr(prefix.size());
    bool const required = std::ranges::any_of(state, [&](Column const& part) { return part.name == base; });
    (required ? names.required : names.optional).push_back(column.name);
    if (!required || prefix == last_body) continue;
    last_body = prefix;
    for (char const* s : {"s1", "s2", "s3"}) names.optional.push_back(last_body + s);
  }
  return names;
}

Score score(TrajectoryTable const& table, PreparedCell const& prepared, UsableReference const* reference,
            Reading const& reading) {
  Score score;
  score.remarks = table.remarks;
  Layout const layout = layout_of(prepared);
  double const horizon = prepared.cell.t_end;
  score.points = std::size_t(std::ranges::upper_bound(table.times, horizon) - table.times.begin());
  if (score.points == 0)
    throw TrajectoryError(fmt::format("{}: no row until {:g} s, the end of what is scored", table.file, horizon));
  if (score.points < table.rows())
    score.remarks.push_back(fmt::format("{} row(s) after {:g} s are left out", table.rows() - score.points, horizon));
  score.begin = table.times[0];
  score.end = table.times[score.points - 1];

  Metrics metrics(reference, prepared.problem->torque_free() ? prepared.problem->body() : nullptr, score.end, {},
                  comparisons);
  for (std::size_t i = 0; i < score.points; ++i) {
    std::vector<BodySight> const bodies = bodies_of(table.row(i), layout, reading);
    for (BodySight const& body : bodies)
      if (!(dot(body.q, body.q) > 0))
        throw TrajectoryError(
            fmt::format("{}:{}: q1 to q4 are all 0; a quaternion has length 1", table.file, table.lines[i]));
    metrics.see({.t = table.times[i], .bodies = bodies});
  }
  results::Record& record = score.record;
  record.of = prepared.cell;
  metrics.fill(record);
  if (reference) {
    record.reference = reference->id;
    record.reference_bar = reference->bar;
  }
  constexpr double no_quaternion = 0.1;
  if (record.norm_drift_max.value_or(0) > no_quaternion)
    score.remarks.push_back(
        fmt::format("|q.q - 1| reaches {:.2g}: are q1 to q4 the quaternion?", *record.norm_drift_max));
  if (record.attitude_error_max.value_or(0) > 1) record.status = results::Status::inaccurate;
  if (reference) add_remarks(score, table, layout, *reference, reading);
  return score;
}

std::string json_text(Score const& score) {
  results::Record const& record = score.record;
  nlohmann::ordered_json json{
      {"schema", results::schema}, {"status", results::name_of(record.status)}, {"points", score.points}};
  auto const add = [&](char const* name, std::optional<double> const& value) {
    json[name] = nullptr;
    if (value && std::isfinite(*value)) json[name] = *value;
  };
  add("attitude_error_max", record.attitude_error_max);
  add("attitude_error_end", record.attitude_error_end);
  add("rate_error_max", record.rate_error_max);
  add("norm_drift_max", record.norm_drift_max);
  add("energy_drift_max", record.energy_drift_max);
  add("momentum_drift_max", record.momentum_drift_max);
  add("momentum_direction_max", record.momentum_direction_max);
  add("reference_bar", record.reference_bar);
  json["remarks"] = score.remarks;
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string score_text(Score const& score, std::string const& file, std::string const& problem) {
  results::Record const& record = score.record;
  std::string text = fmt::format("{} against {}: {} points from {:g} s to {:g} s\n", file, problem, score.points,
                                 score.begin, score.end);
  auto const line = [&](char const* name, std::optional<double> const& value, std::string const& unit) {
    if (value) text += fmt::format("  {:<26} {:>10.3g} {}\n", name, *value, unit);
  };
  constexpr double arcseconds = 3600 / degree;
  double const in_arcseconds = record.attitude_error_max.value_or(0) * arcseconds;
  line("attitude error, greatest", record.attitude_error_max, fmt::format("rad = {:.3g} arcsec", in_arcseconds));
  line("attitude error, at the end", record.attitude_error_end, "rad");
  line("rate error, greatest", record.rate_error_max, "of the greatest rate");
  line("norm drift, greatest", record.norm_drift_max, "|q.q - 1|");
  line("energy drift", record.energy_drift_max, "of the first row's");
  line("momentum drift", record.momentum_drift_max, "of the first row's");
  line("direction of momentum", record.momentum_direction_max, "rad from the first row's");
  line("reference is good to", record.reference_bar, "rad");
  return text + fmt::format("  {:<26} {:>10}\n", "status", results::name_of(record.status));
}

}  // namespace polhode::bench
