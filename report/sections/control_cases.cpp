#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "report/cases.hpp"
#include "report/sections/sections.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

using results::Record;
using results::Series;

/// Length of the arm from the centre of mass to the capture point, d = (-2, 0, 0) m in body axes.
constexpr double arm = 2;

using Row = std::vector<double>;

/// The histories of one gain set and sign, as pictures.
class Histories {
 public:
  Histories(Facts const& facts, CaseRuns const& cases, std::size_t n) : facts_(facts), n_(n) {
    int index = 0;
    for (auto const name : tether_capture().cases) {
      Record const* run = cases.find(name);
      Series const* series = run ? facts.series_of(*run, "history") : nullptr;
      if (series) shown_.push_back({fmt::format("case {}", name.back()), index, series, run});
      ++index;
    }
  }

  bool empty() const { return shown_.empty(); }

  /// "gauss2 (quaternion), h = 0.1 s", or what each case was run with.
  std::string sources() const {
    std::vector<std::string> words;
    std::set<std::string> runs;
    for (Shown const& s : shown_) {
      std::string const run = fmt::format("{}, {}", method_of(s.run->of), control_of(s.run->of));
      runs.insert(run);
      words.push_back(fmt::format("{}: {}", s.label, run));
    }
    return runs.size() == 1 ? *runs.begin() : fmt::format("{}", fmt::join(words, "; "));
  }

  /// A column against time, scaled to the unit of the label.
  Panel history_of(std::string_view column, std::string label, double factor) const {
    Panel panel{.x = {"t [s]"}, .y = {std::move(label)}};
    for (Shown const& s : shown_) {
      add_curve(panel, against_time(facts_, *s.run, column, s.label, style_of(s), {.factor = factor}));
    }
    return panel;
  }

  /// The capture point in orbital axes, C = A(q)^T d = R(q) d, seen along an axis.
  Panel track(std::size_t across, std::size_t up) const {
    static constexpr std::array names{"x", "y", "z"};
    Panel panel{
        .x = {fmt::format("{} [m]", names[across])}, .y = {fmt::format("{} [m]", names[up])}, .equal_scale = true};
    for (Shown const& s : shown_) {
      std::array<std::size_t, 4> q{};
      bool complete = true;
      for (std::size_t i = 0; i < 4; ++i) {
        auto const at = column_of(*s.series, fmt::format("q{}", i + 1));
        complete = complete && at;
        q[i] = at.value_or(0);
      }
      if (!complete) continue;
      auto const coordinate = [&](std::size_t axis) {
        return
            [&s, q, axis](Row const& row) { return capture_point(row[q[0]], row[q[1]], row[q[2]], row[q[3]])[axis]; };
      };
      add_curve(panel, curve_of(s.label, style_of(s), *s.series, coordinate(across), coordinate(up)));
    }
    if (panel.curves.empty()) return panel;
    std::array<double, 3> const target{-arm, 0, 0};
    Point const start = panel.curves.front().points.front();
    panel.curves.push_back({"start", {.index = 4, .line = false}, {start}});
    panel.curves.push_back({"target", {.index = 10, .line = false}, {{target[across], target[up]}}});
    return panel;
  }

  void add(Document& document, std::string_view what, std::string const& caption, std::vector<Panel> panels,
           int columns) const {
    std::erase_if(panels, [](Panel const& panel) { return panel.curves.empty(); });
    if (panels.empty()) {
      document.say(fmt::format("The histories hold no column for a figure of the {}.", what));
      return;
    }
    document.add(Figure{.name = fmt::format("control-{}-{}", n_, what),
                        .caption = caption,
                        .panels = std::move(panels),
                        .columns = columns});
  }

 private:
  struct Shown {
    std::string label;
    int index;
    Series const* series;
    Record const* run;
  };

  /// Each case has its own dash too: where two coincide both are seen.
  static Style style_of(Shown const& s) {
    static constexpr std::array dashes{Dash::solid, Dash::dashed, Dash::dotted};
    static constexpr std::array colours{3, 12, 2};
    return {.index = colours[static_cast<std::size_t>(s.index)],
            .dash = dashes[static_cast<std::size_t>(s.index)],
            .points = false};
  }

  /// First column of R(q) times -arm; q is scalar last and need not be exactly of length one.
  static std::array<double, 3> capture_point(double x, double y, double z, double w) {
    double const scale = -arm / (x * x + y * y + z * z + w * w);
    return {scale * (x * x - y * y - z * z + w * w), scale * 2 * (x * y + z * w), scale * 2 * (x * z - y * w)};
  }

  Facts const& facts_;
  std::size_t n_;
  std::vector<Shown> shown_;
};

}  // namespace

void add_control_cases(Document& document, Facts const& facts) {
  add_paper_head(document, facts, tether_capture());
  document.say(
      "The paper's figures 4 to 7: tether and thruster together (case 1), thruster below 5 deg and tether above "
      "(case 2), thruster alone (case 3). Each curve is the most accurate run that left a history.");
  std::size_t n = 0;
  for (CaseRuns const& cases : case_runs(facts, tether_capture())) {
    Histories const histories(facts, cases, n + 1);
    if (histories.empty()) continue;
    ++n;
    document.heading(3, cases.label);
    document.say(fmt::format("Runs shown: {}.", histories.sources()));
    double const degree = degrees(1);
    histories.add(document, "track",
                  "Track of the capture point C in orbital axes, seen along z, y and x (the paper's figure 4).",
                  {histories.track(0, 1), histories.track(0, 2), histories.track(1, 2)}, 2);
    histories.add(document, "angle", "Angle alpha between arm and tether (figure 5).",
                  {histories.history_of("alpha", "alpha [deg]", degree)}, 1);
    histories.add(
        document, "rates", "Body rates (figure 6).",
        {histories.history_of("wx", "omega x [deg/s]", degree), histories.history_of("wy", "omega y [deg/s]", degree),
         histories.history_of("wz", "omega z [deg/s]", degree)},
        1);
    histories.add(document, "energy", "Thruster effort E_c, the integral of M_u.M_u (figure 7).",
                  {histories.history_of("energy_c", "E_c [N^2 m^2 s]", 1)}, 1);
  }
  if (n == 0)
    document.say("The records hold no history of tether_capture's case1, case2 or case3, so there are no figures.");
}

}  // namespace polhode::report
