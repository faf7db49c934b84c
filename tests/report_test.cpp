// The report, from made-up records: what is printed equals what is recorded, what is missing is said, and no name from
// a record escapes its place in Markdown, HTML, CSV or gnuplot's script.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "report/document.hpp"
#include "report/facts.hpp"
#include "report/render.hpp"
#include "report/report.hpp"
#include "report/text.hpp"
#include "tests/report_samples.hpp"

namespace polhode::report {
namespace {

namespace fs = std::filesystem;
using results::Contents;
using results::Record;
using results::Series;
using samples::full;
using samples::made;

/// A folder that goes with its test.
struct Folder {
  fs::path path =
      fs::path(testing::TempDir()) /
      fmt::format("polhode report's-{}-{}", ::getpid(), testing::UnitTest::GetInstance()->current_test_info()->name());
  Folder() { fs::remove_all(path); }
  ~Folder() {
    if (std::getenv("POLHODE_KEEP_REPORTS") == nullptr) fs::remove_all(path);
  }
};

std::string slurp(fs::path const& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

bool contains(std::string const& text, std::string_view what) {
  return text.find(what) != std::string::npos;
}

bool have_gnuplot() {
  std::istringstream path(std::getenv("PATH") != nullptr ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(path, folder, ':');) {
    if (fs::exists(fs::path(folder) / "gnuplot")) return true;
  }
  return false;
}

/// Enough of an XML reader to know that tags nest and close, and that no bare & or < stands in the text.
bool is_well_formed(std::string const& xml) {
  std::vector<std::string> open;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&') {
      auto const end = xml.find(';', i);
      if (end == std::string::npos || end - i > 8) return false;
    }
    if (xml[i] != '<') continue;
    auto const end = xml.find('>', i);
    if (end == std::string::npos) return false;
    std::string const tag = xml.substr(i + 1, end - i - 1);
    if (tag.find('<') != std::string::npos) return false;
    std::string const name = tag.substr(0, tag.find_first_of(" \t\n/", 1));
    if (tag.starts_with("/")) {
      if (open.empty() || "/" + open.back() != tag) return false;
      open.pop_back();
    } else if (!tag.starts_with("?") && !tag.starts_with("!") && !tag.ends_with("/")) {
      open.push_back(name);
    }
    i = end;
  }
  return open.empty();
}

/// Writes the report and returns its Markdown.
std::string markdown_of(Contents const& contents, fs::path const& out) {
  write_report(contents, out);
  return slurp(out / "report.md");
}

void expect_sound(fs::path const& out) {
  for (auto const* file : {"report.md", "report.html"}) {
    std::string const text = slurp(out / file);
    EXPECT_FALSE(text.empty());
    EXPECT_FALSE(contains(text, " nan")) << file;
    EXPECT_FALSE(contains(text, " inf ")) << file;
  }
  // The head holds meta elements, which HTML does not close.
  std::string const html = slurp(out / "report.html");
  EXPECT_TRUE(is_well_formed(html.substr(html.find("<body>"), html.find("</html>") - html.find("<body>"))));
}

TEST(Report, EmptyContentsSayWhatIsMissing) {
  Folder const folder;
  std::string const text = markdown_of({}, folder.path);
  expect_sound(folder.path);
  for (auto const* part : {"Which integrator keeps the norm cannot be said", "How accurate it is cannot be said",
                           "What it costs cannot be said", "The records hold no run at all", "There are no runs",
                           "The records say nothing about where"}) {
    EXPECT_TRUE(contains(text, part)) << part;
  }
  EXPECT_FALSE(contains(text, "|---")) << "no empty table";
  EXPECT_TRUE(fs::is_empty(folder.path / "figures"));
}

TEST(Report, SingleRecord) {
  Folder const folder;
  Contents c;
  c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 12, 2e-15}, 0.1));
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "Without projection gauss2 keeps the quaternion's norm"));
  EXPECT_TRUE(contains(text, "no run was made both with and without projection"));
  EXPECT_TRUE(contains(text, "no rival here does"));
  EXPECT_TRUE(contains(text, "No method has three such points"));
}

TEST(Report, OnlyFailures) {
  Folder const folder;
  Contents c;
  for (double const h : {0.1, 0.2}) {
    Record r = made("free_body", "", {"rk4", 4, 1, 4, 1e-3}, h);
    r.status = results::Status::refused;
    r.reason = "needs flat coordinates";
    r.attitude_error_max = NAN;
    c.records.push_back(r);
  }
  c.unfinished.push_back("0123456789abcdef");
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(
      text, "| refused | needs flat coordinates | free_body, 50 s | rk4 (quaternion) | 2 | h = 0.1 s; h = 0.2 s |"));
  EXPECT_TRUE(contains(text, "0123456789abcdef"));
}

TEST(Report, WithoutTimingsEvaluationsRank) {
  Folder const folder;
  Contents c = full();
  for (Record& r : c.records) r.cpu_time_s.reset();
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "number of evaluations, since nothing was timed"));
  EXPECT_TRUE(contains(text, "None of these runs was timed."));
}

TEST(Report, WithoutReferencesNothingIsRanked) {
  Folder const folder;
  Contents c = full();
  for (Record& r : c.records) {
    r.attitude_error_max = r.attitude_error_end = r.reference_bar = std::nullopt;
    r.reference.clear();
  }
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text, "How accurate it is cannot be said"));
  EXPECT_TRUE(contains(text, "No run here has a reference"));
  EXPECT_TRUE(contains(text, "No successful run with an attitude error"));
}

TEST(Report, FullSetPrintsWhatIsRecorded) {
  Folder const folder;
  Contents const c = full();
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(
      contains(text, "Without projection gauss1, gauss2 and gauss3 keep the quaternion's norm to better than 1e-13"));
  EXPECT_TRUE(contains(text,
                       "projection changes the attitude error measurably (by more than 10% and the reference's "
                       "bar) in none of"));
  EXPECT_TRUE(contains(text, "| rk4 | none | delivered | 8e-11 | 8e-11 | 8e-11 | 8e-11 | 8e-11 |"));
  EXPECT_TRUE(contains(text, "| rk4 | project | raw | 8e-11 | 8e-11 | 8e-11 | 8e-11 | 8e-11 |"));
  EXPECT_TRUE(contains(text, "| rk4 | project | delivered | 2.2e-16 | 2.2e-16 | 2.2e-16 | 2.2e-16 | 2.2e-16 |"));
  EXPECT_TRUE(contains(text, "| energy_c | thruster effort | N^2 m^2 s | 266.07 | – | reproduced | 32 of 32 |"));
  EXPECT_TRUE(contains(text, "| 0 | 266.07 | 324.94 | yes | case2 alpha_end | no |"));
  EXPECT_TRUE(contains(text, "| diverged | the state is not finite at t = 3 s |"));
  EXPECT_TRUE(contains(text, "| cpu | made-up | 1 |"));
  EXPECT_TRUE(contains(text, "| free_body, 50 s | rk4 | quaternion | none | 4.00 | 0.00 | 5 | 0.0125 | 0.2 |"));
  // Each row of the table of cheapest runs is a record at the printed precision.
  std::istringstream csv(slurp(folder.path / "tables" / "cheapest-1.csv"));
  std::string line;
  std::getline(csv, line);
  int rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    bool const found = std::ranges::any_of(c.records, [&](Record const& r) {
      return r.of.problem == "free_body" &&
             contains(line, fmt::format(",{},quaternion,{},h = {:g} s,{},", r.of.integrator, r.of.policy, *r.of.h,
                                        *r.attitude_error_max)) &&
             contains(line, fmt::format(",{},{},", *r.evaluations, r.cpu_time_s->median)) &&
             contains(text, fmt::format("| {} | {} | {} |", significant(*r.attitude_error_max),
                                        significant(arcseconds(*r.attitude_error_max)), *r.evaluations));
    });
    EXPECT_TRUE(found) << line;
  }
  EXPECT_GE(rows, 10);
}

TEST(Report, ARivalThatWinsIsNamed) {
  Folder const folder;
  Contents c;
  for (double const h : {0.05, 0.1}) {
    c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 12, 2e-15}, h));
    c.records.push_back(made("free_body", "", {"odeint_dopri5", 5, 5e-6, 6, 2e-12}, h));
  }
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "the rival odeint_dopri5 (quaternion) reaches 1e-6 rad")) << text.substr(0, 2000);
  EXPECT_TRUE(contains(text, "2 times less than the best own method gauss2 (quaternion)"));
}

TEST(Report, ThreeCasesAreJudgedTogether) {
  Contents c = full();
  for (Record& r : c.records) {
    for (auto& [name, claim] : r.claims) claim.verdict = "reproduced";
  }
  Folder const folder;
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "Every published claim is satisfied by tether_capture g1, 50 s."));
  // The order of the energies counts like a claim.
  for (Record& r : c.records) {
    if (r.of.variant == "case2,g1") r.claims["energy_c"].value = 300;
  }
  EXPECT_TRUE(contains(markdown_of(c, folder.path),
                       "satisfies every published claim: tether_capture g1, 50 s misses E2 &lt; E1 &lt; E3."));
  std::erase_if(c.records, [](Record const& r) { return r.of.variant == "case2,g1"; });
  EXPECT_TRUE(
      contains(markdown_of(c, folder.path),
               "are there for tether_capture g1, 50 s: whether everything published is satisfied cannot be judged."));
}

TEST(Report, TrackOfTheCapturePoint) {
  Contents c;
  c.records.push_back(made("tether_capture", "case1,g1", {"gauss2", 4, 5e-6, 12, 2e-15}, 0.1));
  Series s{c.records[0].cell, "history", {"t", "q1", "q2", "q3", "q4"}, {"s", "", "", "", ""}, {}};
  s.rows = {{0, 0.227, 0.383, 0.227, 0.866}, {0.1, 0, 0, 0, 1}};  // the paper's initial attitude, and the target
  c.series.push_back(s);
  Folder const folder;
  std::string const text = markdown_of(c, folder.path);
  std::string const csv = slurp(folder.path / "figures" / "control-1-track.csv");
  EXPECT_TRUE(contains(csv, "y [m] against x [m],case 1,-1.206")) << csv;
  EXPECT_TRUE(contains(csv, "z [m] against y [m],case 1,-1.134")) << csv;
  EXPECT_TRUE(contains(csv, "y [m] against x [m],case 1,-2,")) << csv;
  EXPECT_TRUE(contains(text, "no column for a figure of the angle"));
}

TEST(Report, FiguresAreWellFormed) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not on the PATH";
  Folder const folder;
  markdown_of(full(), folder.path);
  std::size_t pictures = 0;
  for (auto const& entry : fs::directory_iterator(folder.path / "figures")) {
    if (entry.path().extension() == ".log") ADD_FAILURE() << slurp(entry.path());
    if (entry.path().extension() != ".svg") continue;
    ++pictures;
    std::string const svg = slurp(entry.path());
    EXPECT_TRUE(is_well_formed(svg)) << entry.path();
    EXPECT_TRUE(contains(svg, "<path")) << entry.path();
    EXPECT_TRUE(fs::exists(fs::path(entry.path()).replace_extension(".csv")));
  }
  EXPECT_GE(pictures, 8U);
}

TEST(Report, WithoutGnuplotTheReportStillComes) {
  Folder const folder;
  std::string const before = std::getenv("PATH") != nullptr ? std::getenv("PATH") : "";
  ::setenv("PATH", "/nonexistent", 1);
  std::string const text = markdown_of(full(), folder.path);
  ::setenv("PATH", before.c_str(), 1);
  EXPECT_TRUE(contains(text, "The picture was not drawn: gnuplot is not on the PATH."));
  EXPECT_FALSE(contains(text, ".svg"));
  EXPECT_TRUE(fs::exists(folder.path / "figures" / "drift-1.csv"));
}

TEST(Report, HostileNamesStayText) {
  Folder const folder;
  fs::path const trap = folder.path / "trap";
  std::string const name = fmt::format(
      "a|b`touch {0}`*_<script>alert(1)</script>&\"'@x' ; system 'touch {0}' #\n## h\x01\xff", trap.string());
  Contents c = full();
  for (Record& r : c.records) {
    if (r.of.integrator == "rk4") r.of.integrator = name;
    if (r.of.integrator == "euler") r.reason = name;
  }
  for (Series& s : c.series) s.units.back() = name;
  c.metas.push_back({{name, name}});
  std::string const text = markdown_of(c, folder.path);
  EXPECT_FALSE(fs::exists(trap)) << "a name was executed";
  EXPECT_FALSE(contains(text, "\n## h"));
  EXPECT_FALSE(contains(text, "<script>"));
  EXPECT_FALSE(contains(slurp(folder.path / "report.html"), "<script>"));
  expect_sound(folder.path);
  if (!have_gnuplot()) return;
  EXPECT_TRUE(is_well_formed(slurp(folder.path / "figures" / "drift-1.svg")));
  EXPECT_TRUE(contains(slurp(folder.path / "figures" / "drift-1.svg"), "touch")) << "the name is shown as text";
}

TEST(Report, AnUnwritableFolderIsAnError) {
  Folder const folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "file") << "x";
  EXPECT_THROW(write_report({}, folder.path / "file"), ReportError);
}

TEST(Facts, VariantWordsAndRivals) {
  EXPECT_TRUE(has_word("case1,g1,as_printed", "g1"));
  EXPECT_FALSE(has_word("case1,g1", "case"));
  EXPECT_FALSE(has_word("", ""));
  EXPECT_EQ(without_word("case1,g1", "case1"), "g1");
  for (auto const* rival : {"odeint_rk4", "cvode_bdf", "arkode_erk4", "gsl_rk8pd", "ida"}) EXPECT_TRUE(is_rival(rival));
  for (auto const* own : {"rk4", "gauss2", "idaho", ""}) EXPECT_FALSE(is_rival(own));
}

TEST(Facts, OrderOfAnExactPowerLaw) {
  std::vector<std::pair<double, double>> points;
  for (double const h : {0.4, 0.2, 0.1, 0.05}) points.emplace_back(h, 3e-3 * std::pow(h, 4));
  auto const order = fit_order(points);
  ASSERT_TRUE(order && order->half_width);
  EXPECT_NEAR(order->slope, 4, 1e-12);
  EXPECT_LT(*order->half_width, 1e-6);
  EXPECT_FALSE(fit_order({{0.1, 1e-3}}));
  EXPECT_FALSE(fit_order({{0.1, 1e-3}, {0.1, 1e-4}}));
  points[0].second *= 2;
  EXPECT_GT(*fit_order(points)->half_width, 0.3);
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
