/// The report's section on ensembles, from a file as the verb writes it; files that are none.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "report/sections/sections.hpp"
#include "report/text.hpp"
#include "results/ensemble_file.hpp"

namespace polhode::report {
namespace {

using Json = nlohmann::ordered_json;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// 2000 samples; 40 never settle.
Json file() {
  results::EnsembleStatistics statistics({{"settle_time", "s"}, {"norm_drift", ""}, {"constant", ""}}, 3);
  for (std::int64_t k = 0; k < 2000; ++k) {
    bool const settles = k % 50 != 7;
    statistics.add(k, settles ? "ok" : "never_settled",
                   {settles ? 20 + 0.005 * double(k) : infinity, std::pow(10, -15 + 0.003 * double(k)), 1});
  }
  return {{"schema", results::schema},
          {"kind", "ensemble"},
          {"command", "polhode ensemble some_problem --seed 3"},
          {"replay", "polhode simulate some_problem --seed 3 --sample K"},
          {"problem", "some_problem"},
          {"variant", "case1"},
          {"formulation", "quaternion"},
          {"integrator", "rk4"},
          {"policy", "none"},
          {"h", 0.05},
          {"t_end", 50.0},
          {"disperse", {"q0=so3()"}},
          {"settle_angle", 0.0174532925},
          {"in_lanes", true},
          {"statistics", statistics.json()},
          {"timing",
           {{"seconds", 2.5},
            {"threads", 2},
            {"ranks", 1},
            {"body_steps_per_second", 8e7},
            {"share_of_plain_rk4", 0.4},
            {"peak_memory_bytes", 1 << 24}}},
          {"provenance", results::to_json(results::Meta{{"cpu", "some"}})}};
}

Document section_of(results::Contents const& contents) {
  Facts const facts(contents);
  Document document;
  add_ensembles(document, facts);
  return document;
}
template <class T>
std::vector<T> all_of_kind(Document const& document) {
  std::vector<T> found;
  for (Block const& block : document.blocks)
    if (auto const* one = std::get_if<T>(&block)) found.push_back(*one);
  return found;
}

TEST(ReportEnsembles, QuantilesStandWithTheirIntervals) {
  results::Contents contents;
  contents.ensemble = results::ensemble_from(file().dump());
  auto const tables = all_of_kind<Table>(section_of(contents));
  ASSERT_EQ(tables.size(), 2u);
  auto const& row = tables[0].rows.at(0);
  EXPECT_EQ(row[0].text, "settle_time");
  EXPECT_NEAR(std::stod(row[3].text), 25, 0.3) << "the median";
  EXPECT_NE(row[3].text.find('['), std::string::npos);
  EXPECT_NE(row[5].text.find(absent), std::string::npos) << "2% never settle: 99% lies beyond all that do";
  EXPECT_EQ(row.back().text, "40");
  auto const& worst = tables[1].rows;
  EXPECT_EQ(worst[0][1].text.substr(0, 5), "1999 ");
  EXPECT_EQ(worst.back()[0].text, "never_settled");
}
TEST(ReportEnsembles, HistogramsHoldAllSamples) {
  results::Contents contents;
  contents.ensemble = results::ensemble_from(file().dump());
  auto const figures = all_of_kind<Figure>(section_of(contents));
  ASSERT_EQ(figures.size(), 1u);
  ASSERT_EQ(figures[0].panels.size(), 2u) << "a constant has none";
  EXPECT_FALSE(figures[0].panels[0].x.log);
  EXPECT_TRUE(figures[0].panels[1].x.log);
  for (std::size_t i = 0; i < 2; ++i) {
    double sum = 0;
    auto const& points = figures[0].panels[i].curves[0].points;
    for (std::size_t k = 0; k < points.size(); k += 2) sum += points[k].y;
    EXPECT_NEAR(sum, i == 0 ? 0.98 : 1, 1e-9);
  }
}
TEST(ReportEnsembles, WithoutAFileThereIsNoSection) {
  EXPECT_TRUE(section_of({}).blocks.empty());
}
TEST(EnsembleFile, WhatIsNoneIsRefused) {
  EXPECT_THROW(results::ensemble_from("{"), std::invalid_argument);
  EXPECT_THROW(results::ensemble_from("[]"), std::invalid_argument);
  EXPECT_THROW(results::ensemble_from(std::string(100, '[')), std::invalid_argument);
  for (std::string const member : {"schema", "kind", "statistics", "timing", "command", "disperse"}) {
    Json broken = file();
    broken[member] = nullptr;
    EXPECT_THROW(results::ensemble_from(broken.dump()), std::invalid_argument) << member;
    broken.erase(member);
    EXPECT_THROW(results::ensemble_from(broken.dump()), std::invalid_argument) << member;
  }
  Json broken = file();
  broken["statistics"]["metrics"]["norm_drift"]["worst"][0] = nullptr;
  EXPECT_THROW(results::ensemble_from(broken.dump()), std::invalid_argument);
}

}  // namespace
}  // namespace polhode::report
