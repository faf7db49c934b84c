/// The picture of one run: which panels its columns make, and that gnuplot draws them.
#include "report/render/trajectory.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "report/report.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double pi = std::numbers::pi;

/// A turn about (2, -1, 2)/3 from an attitude that is no identity, at 10 deg/s; the quaternion's norm drifts.
results::Series turn(std::size_t rows = 61) {
  results::Series s{"",
                    "history",
                    {"t", "q1", "q2", "q3", "q4", "wx", "wy", "wz", "alpha", "torque_x", "torque_y", "torque_z"},
                    {"s", "", "", "", "", "rad/s", "rad/s", "rad/s", "rad", "N m", "N m", "N m"},
                    {}};
  double const w = 10 * pi / 180;
  for (std::size_t i = 0; i < rows; ++i) {
    double const t = 60.0 * double(i) / double(rows - 1), half = w * t / 2, norm = 1 + 0.001 * t;
    double const x = 2.0 / 3 * std::sin(half), y = -1.0 / 3 * std::sin(half), z = 2.0 / 3 * std::sin(half),
                 s4 = std::cos(half);
    // times the start, (0.5, 0.5, 0.5, 0.5), from the left
    double const q1 = 0.5 * (s4 + x + y - z), q2 = 0.5 * (s4 - x + y + z), q3 = 0.5 * (s4 + x - y + z),
                 q4 = 0.5 * (s4 - x - y - z);
    s.rows.push_back({t, norm * q1, norm * q2, norm * q3, norm * q4, w, 0, -w, 0.1, 1, 2, 3});
  }
  return s;
}

std::vector<std::string> labels_of(Figure const& figure) {
  std::vector<std::string> labels;
  for (Panel const& panel : figure.panels) labels.push_back(panel.y.label);
  return labels;
}

TEST(TrajectoryFigure, PanelsFollowFromTheColumns) {
  Figure const figure = trajectory_figure(turn(), "title");
  EXPECT_THAT(labels_of(figure), ElementsAre("q1 q2 q3 (x y z), q4 (scalar)", "angle from the start [deg]",
                                             "body rate [deg/s]", "alpha [rad]", "torque [N m]"));
  ASSERT_EQ(figure.panels[4].curves.size(), 3u);
  EXPECT_EQ(figure.panels[4].curves[1].label, "y") << "as the rate about that axis: one entry of the legend";
  EXPECT_EQ(figure.panels[3].curves.at(0).label, "") << "the axis says it";
  EXPECT_EQ(figure.panels[0].title, "title");
}

TEST(TrajectoryFigure, TheAngleIsOfTheNormalisedTurnAndOfTheShorterWay) {
  Figure const figure = trajectory_figure(turn(), "");
  auto const& points = figure.panels[1].curves.at(0).points;
  ASSERT_EQ(points.size(), 61u);
  for (Point const& p : points) {
    double const full = std::fmod(10 * p.x, 360), angle = std::min(full, 360 - full);
    EXPECT_NEAR(p.y, angle, 1e-5) << p.x;
  }
  EXPECT_NEAR(figure.panels[2].curves.at(0).points[5].y, 10, 1e-12) << "rates in deg/s";
}

TEST(TrajectoryFigure, BodiesShareThePanels) {
  results::Series s{"", "history", {"t"}, {"s"}, {{0}, {1}}};
  for (int body = 1; body <= 10; ++body) {
    for (auto const* name : {"q1", "q2", "q3", "q4", "wx", "wy", "wz"}) {
      s.columns.push_back(fmt::format("b{}.{}", body, name));
      s.units.emplace_back();
      for (auto& row : s.rows) row.push_back(name == std::string("q4") ? 1 : 0);
    }
  }
  Figure const figure = trajectory_figure(s, "");
  EXPECT_THAT(labels_of(figure), ElementsAre("angle from the start [deg]", "|body rate| [deg/s]"));
  EXPECT_EQ(figure.panels[0].curves.size(), 8u) << "the first eight";
  EXPECT_EQ(figure.panels[0].curves[1].label, "b2");
}

TEST(TrajectoryFigure, WithoutAnAttitudeThereAreOnlyItsOwnColumns) {
  results::Series const s{"", "history", {"t", "y1", "y2", "y3"}, {"s", "", "", ""}, {{0, 1, 2, 3}, {1, 2, 3, 4}}};
  Figure const figure = trajectory_figure(s, "");
  EXPECT_THAT(labels_of(figure), ElementsAre("y"));
  EXPECT_EQ(figure.panels[0].curves.size(), 3u);
}

TEST(TrajectoryFigure, LongRunsAreThinnedAndKeepTheirEnd) {
  Figure const figure = trajectory_figure(turn(50001), "");
  auto const& points = figure.panels[0].curves[0].points;
  EXPECT_LE(points.size(), 2100u);
  EXPECT_EQ(points.back().x, 60);
}

TEST(TrajectoryFigure, GnuplotDrawsIt) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not installed";
  Folder const folder;
  fs::create_directories(folder.path);
  plot_trajectory(turn(), "it's a turn", folder.path / "turn.svg");
  std::string const svg = slurp(folder.path / "turn.svg");
  EXPECT_TRUE(is_well_formed(svg));
  EXPECT_THAT(svg, HasSubstr("body rate [deg/s]"));
  EXPECT_TRUE(fs::exists(folder.path / "turn.svg"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path), {}), 1) << "nothing else is left";
  EXPECT_THROW(plot_trajectory(turn(), "", folder.path / "missing" / "turn.svg"), ReportError);
}

TEST(TrajectoryFigure, ARunWithoutRowsIsNotDrawn) {
  EXPECT_THROW(plot_trajectory({"", "history", {"t"}, {"s"}, {}}, "", "x.svg"), ReportError);
}

}  // namespace
}  // namespace polhode::report
