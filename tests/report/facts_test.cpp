// What the report's sections stand on: the arrangement of records, numbers in words, escaping.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "report/facts.hpp"
#include "report/located.hpp"
#include "report/render/render.hpp"
#include "report/text.hpp"
#include "tests/report/samples.hpp"

namespace polhode::report {
namespace {

using namespace samples;

TEST(Facts, VariantWordsAndRivals) {
  EXPECT_TRUE(has_word("case1,g1,as_printed", "g1"));
  EXPECT_FALSE(has_word("case1,g1", "case"));
  EXPECT_FALSE(has_word("", ""));
  EXPECT_EQ(without_word("case1,g1", "case1"), "g1");
  for (auto const* rival : {"odeint_rk4", "cvode_bdf", "arkode_erk4", "gsl_rk8pd", "ida"}) EXPECT_TRUE(is_rival(rival));
  for (auto const* own : {"rk4", "gauss2", "idaho", ""}) EXPECT_FALSE(is_rival(own));
}

TEST(Facts, EveryIntegratorHasItsOwnLook) {
  Contents c;
  for (int i = 0; i < 16; ++i) {
    c.records.push_back(made("free_body", "", {fmt::format("{}m{}", i < 4 ? "gsl_" : "", i), 2, 1e-4, 2, 0}, 0.1));
  }
  Facts const facts(c);
  std::set<std::pair<int, bool>> looks;
  for (Record const& r : c.records) {
    Style const style = facts.style_of(r.of);
    EXPECT_LT(style.index, 16);  // as many as there are colours
    looks.emplace(style.index, style.open);
  }
  EXPECT_EQ(looks.size(), 16U);
}

TEST(Facts, WhoRanOnMostProblemsHasAColourOfItsOwn) {
  Contents c;
  for (int i = 0; i < 20; ++i) {
    bool const everywhere = i >= 17;
    for (auto const* problem : {"free_body", "heavy_top"}) {
      if (everywhere || problem[0] == 'f')
        c.records.push_back(made(problem, "", {fmt::format("m{:02}", i), 2, 1, 2, 0}, 0.1));
    }
  }
  c.records.push_back(made("heavy_top", "", {"ida", 2, 1, 2, 0}, 0.1));
  Facts const facts(c);
  auto const index = [&](std::string const& name) {
    results::Cell cell;
    cell.integrator = name;
    return facts.style_of(cell).index;
  };
  EXPECT_EQ(index("m17"), 0);
  EXPECT_EQ(index("m19"), 2);
  EXPECT_EQ(index("m00"), 3);
  EXPECT_EQ(index("ida"), 20);
}

TEST(Facts, AParameterOfOneNumberNeedsNoBrackets) {
  Contents c;
  c.records.push_back(made("quaternion_sync", "protocol7", {"m", 2, 1, 2, 0}, 0.1));
  c.records[0].of.set = {{"n", {100}}, {"omega0", {1, 2, 3}}};
  EXPECT_EQ(Facts(c).instances.at(0).label, "quaternion_sync protocol7, n = 100, omega0 = (1 2 3), 50 s");
}

TEST(Facts, HeadlinesComeFirst) {
  Contents c;
  for (auto const* name : {"a_problem", "pd_slew", "free_body"}) {
    c.records.push_back(made(name, "", {"m", 2, 1e-4, 2, 0}, 0.1));
  }
  c.records.push_back(made("tether_capture", "case1,g1,coupled", {"m", 2, 1e-4, 2, 0}, 0.1));
  c.records.push_back(made("tether_capture", "case1,g1", {"m", 2, 1e-4, 2, 0}, 0.1));
  Facts const facts(c);
  std::vector<std::string> order;
  for (Instance const& i : facts.instances) order.push_back(i.like().problem + i.like().variant);
  EXPECT_EQ(order, (std::vector<std::string>{"free_body", "pd_slew", "tether_capturecase1,g1", "a_problem",
                                             "tether_capturecase1,g1,coupled"}));
  EXPECT_FALSE(facts.instances[0].comparable());
}

TEST(Facts, TheCommonStepIsTheBestCoveredNearATenth) {
  std::set<std::string> const four{"a", "b", "c", "d"}, three{"a", "b", "c"}, two{"a", "b"};
  EXPECT_EQ(common_step({{0.05, four}, {0.1, three}, {0.2, three}}), 0.1);
  EXPECT_EQ(common_step({{0.05, four}, {0.1, two}}), 0.05);
  EXPECT_FALSE(common_step({}));
}

TEST(Facts, OrdersAreThoseOfTheResults) {
  Contents c;
  for (double const h : {0.0125, 0.025, 0.05, 0.1, 0.2}) {
    c.records.push_back(made("free_body", "", {"m", 4, 3e-3, 2, 0}, h));
  }
  c.records[0].attitude_error_end = 3e-13;  // round-off
  c.records[4].attitude_error_end = 0.2;    // before the leading term rules
  Facts const facts(c);
  auto const order = order_of(facts.instances.at(0).sweeps().at(0));
  ASSERT_TRUE(order.fit && order.fit->half_width);
  EXPECT_NEAR(order.fit->slope, 4, 1e-12);
  EXPECT_EQ(order.fit->points, 3U);
  EXPECT_EQ(order.fit->h_low, 0.025);
  EXPECT_EQ(order.fit->h_high, 0.1);
  EXPECT_EQ(slope_of(*order.fit), "4.00");
}

TEST(Facts, CostIsInterpolatedBetweenNeighbours) {
  Contents c;
  for (double const h : {0.1, 0.2, 0.4}) c.records.push_back(made("free_body", "", {"m", 2, 1e-4, 2, 0}, h));
  Facts const facts(c);
  auto const costs = ranking(facts.instances.at(0), 2e-6, Measure::evaluations);  // h = .1414: 50 / h * 2 evaluations
  ASSERT_EQ(costs.size(), 1U);
  EXPECT_TRUE(costs[0].interpolated);
  EXPECT_NEAR(costs[0].value, 707.1, 0.1);
  EXPECT_EQ(costs[0].measured, 1000);
  EXPECT_EQ(ranking(facts.instances.at(0), 1e-14, Measure::evaluations).size(), 0U);
}

TEST(Facts, ALaterBuildReplacesARun) {
  Contents c;
  c.records = {made("free_body", "", {"m", 2, 1, 2, 0}, 0.1), made("free_body", "", {"m", 2, 2, 2, 0}, 0.1)};
  c.records[1].build = "b2";
  Facts const facts(c);
  ASSERT_EQ(facts.runs.size(), 1U);
  EXPECT_EQ(facts.runs[0]->build, "b2");
  EXPECT_EQ(facts.superseded, 1U);
}

TEST(Text, Escapes) {
  EXPECT_EQ(escape_markdown("a|b*c_d [e](f) <g>"), "a|b\\*c_d [e\\](f) &lt;g&gt;");
  EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  EXPECT_EQ(one_line("a\nb\xff\xc0\x80"), "a b\uFFFD\uFFFD\uFFFD");
  Table const table{
      "t", "", {{"a,b"}, {"c"}}, {{Entry("=1+1"), Entry("1.5", "1.5000001")}, {Entry("x\"y"), Entry(absent)}}};
  EXPECT_EQ(to_csv(table), "\"a,b\",c\n'=1+1,1.5000001\n\"x\"\"y\",\n");
}

TEST(Text, NumbersAndLists) {
  EXPECT_EQ(significant(5.0312e-10), "5.03e-10");
  EXPECT_EQ(significant(NAN), absent);
  EXPECT_EQ(duration(1.234e-5), "12.3 µs");
  EXPECT_EQ(angle(1e-9), "1e-9 rad (0.000206 arcsec)");
  EXPECT_EQ(listed({"a", "b", "c"}), "a, b and c");
  EXPECT_EQ(listed({"a", "b", "c"}, "or"), "a, b or c");
  EXPECT_EQ(shortened({"a", "b", "c", "d"}, 3), "a, b and 2 others");
}

TEST(Figures, AFigureWithoutDataHasNoPoints) {
  Figure figure;
  figure.panels = {Panel{{"x"}, {"y"}, {Curve{"empty", {}, {}}}}};
  EXPECT_FALSE(has_points(figure));
  figure.panels[0].curves[0].points.push_back({1, 2});
  EXPECT_TRUE(has_points(figure));
}

}  // namespace
}  // namespace polhode::report
