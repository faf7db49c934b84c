// The report, from made-up records: what is printed equals what is recorded, what is missing is said, and no name from
// a record escapes its place in Markdown, HTML, CSV or gnuplot's script.
#include <algorithm>
#include <cmath>
#include <set>

#include "report/render/render.hpp"
#include "report/text.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

namespace fs = std::filesystem;
using namespace samples;

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
  EXPECT_TRUE(contains(text, "Without projection gauss2 keeps |q.q - 1| within 2e-15."));
  EXPECT_TRUE(contains(text, "no run was made both with and without projection"));
  EXPECT_TRUE(contains(text, "(gauss2; no rival does)"));
  EXPECT_TRUE(contains(text, "No method has two such points"));
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
  EXPECT_TRUE(contains(text, "evaluations are counted where nothing was timed"));
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
      contains(text,
               "Without projection gauss1, gauss2, gauss3 and gauss4 keep |q.q - 1| within 3e-15; the others "
               "drift, worst gauss2_sweeps1 (7e-6): the visible violation of Xu et al. (2017) means too few sweeps."));
  EXPECT_TRUE(contains(text,
                       "On free_body, 50 s, at h = 0.1 s gauss2 points within 5e-10 rad (0.000103 arcsec); projection "
                       "cures the norm, not "
                       "the attitude: gauss2_sweeps1 is off by 0.0002 rad without it and 0.0002 rad with it."));
  EXPECT_TRUE(contains(text, "| gauss2_sweeps1 | quaternion | 7e-6 | 2.2e-16 |"));
  EXPECT_TRUE(contains(text, "| rk4 | none | delivered | 8e-11 | 8e-11 | 8e-11 | 8e-11 | 8e-11 |"));
  EXPECT_TRUE(contains(text, "| rk4 | project | raw | 8e-11 | 8e-11 | 8e-11 | 8e-11 | 8e-11 |"));
  EXPECT_TRUE(contains(text, "| rk4 | project | delivered | 2.2e-16 | 2.2e-16 | 2.2e-16 | 2.2e-16 | 2.2e-16 |"));
  EXPECT_TRUE(contains(text, "| 1 | energy_c | thruster effort E1 | – | N^2 m^2 s | 266.1: yes |"));
  EXPECT_TRUE(contains(text, "| order of the thruster efforts | – |  | 0, 266.1, 324.9: yes |"));
  EXPECT_TRUE(contains(text, "| diverged | the state is not finite at t = 3 s |"));
  EXPECT_TRUE(contains(text, "| cpu | made-up | 1 |"));
  EXPECT_TRUE(contains(text, "| free_body, 50 s | rk4 | quaternion | none | 4.00 | &lt; 0.01 | 5 | 0.0125 | 0.2 |"));
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
             contains(text, fmt::format("| {} | {} |", significant(*r.attitude_error_max), *r.evaluations));
    });
    EXPECT_TRUE(found) << line;
  }
  EXPECT_GE(rows, 10);
}

TEST(Report, WhoKeepsTheNormByAccuracyAloneIsToldApart) {
  Folder const folder;
  Contents c;
  for (auto const* name : {"gauss2", "rkf78"})
    c.records.push_back(made("free_body", "", {name, 4, 5e-6, 12, 2e-15}, 0.1));
  c.catalogue["gauss2"].preserves = {"norm"};
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "Without projection gauss2 and rkf78 keep |q.q - 1| within 2e-15."))
      << "the catalogue does not know rkf78";
  c.catalogue["rkf78"].preserves = {};
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "within 2e-15 (rkf78 by accuracy, not by construction)."));
}

TEST(Report, ARivalThatWinsIsNamed) {
  Folder const folder;
  Contents c;
  for (double const h : {0.05, 0.1}) {
    c.records.push_back(made("free_body", "", {"gauss2", 4, 5e-6, 12, 2e-15}, h));
    c.records.push_back(made("free_body", "", {"odeint_dopri5", 5, 5e-6, 6, 2e-12}, h));
  }
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "(rival odeint_dopri5; ours 2 and 2 times that)")) << text.substr(0, 2000);
}

TEST(Report, ThreeCasesAreJudgedTogether) {
  Contents c = full();
  for (Record& r : c.records) {
    for (auto& [name, claim] : r.claims) claim.verdict = "reproduced";
  }
  Folder const folder;
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "Every published claim is satisfied by g1."));
  // The order of the energies counts like a claim.
  for (Record& r : c.records) {
    if (r.of.variant == "case2,g1") r.claims["energy_c"].value = 300;
  }
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "satisfies every published claim: g1 misses E2 &lt; E1 &lt; E3."));
  std::erase_if(c.records, [](Record const& r) { return r.of.variant == "case2,g1"; });
  EXPECT_TRUE(contains(markdown_of(c, folder.path),
                       "are there for g1: whether everything published is satisfied cannot be judged."));
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

TEST(Report, ThePageHasItsOwnColoursAndEveryIdOnce) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not on the PATH";
  Folder const folder;
  markdown_of(full(), folder.path);
  std::string const page = slurp(folder.path / "report.html");
  std::string const body = page.substr(page.find("<main>"), page.find("</main>") - page.find("<main>"));
  EXPECT_TRUE(contains(body, "var(--curve-0)"));
  // letters and the first curve, as gnuplot writes them
  for (auto const* fixed : {"rgb(51,51,51)", "rgb( 86, 180, 233)", "\"black\""})
    EXPECT_FALSE(contains(body, fixed)) << fixed << " is lost in the dark";
  std::set<std::string> ids;
  for (auto at = body.find(" id="); at != std::string::npos; at = body.find(" id=", at + 1)) {
    std::string const id = body.substr(at + 5, body.find(body[at + 4], at + 5) - at - 5);
    EXPECT_TRUE(ids.insert(id).second) << id;
  }
  EXPECT_TRUE(ids.contains("table-drift-1") && ids.contains("figure-drift-1"));
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

TEST(Report, ApostrophesInARow) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not on the PATH";
  Folder const folder;
  fs::create_directories(folder.path);
  for (auto const* label : {"'", "''", "a''b", "'''a'''", "a'b", "it''s '' so"}) {
    Figure figure;
    figure.name = "quotes";
    figure.panels.push_back({{label}, {label}, {{label, {}, {{1, 2}, {2, 3}}}}, false, 0, label});
    draw(figure, folder.path);
    ASSERT_TRUE(figure.svg) << label << ": " << figure.why_not << slurp(folder.path / "quotes.log");
    // The two axes' labels, the title and the legend's entry.
    std::string const shown = std::string(label) + "</t";
    std::size_t found = 0;
    for (auto at = figure.svg->find(shown); at != std::string::npos; at = figure.svg->find(shown, at + 1)) ++found;
    EXPECT_GE(found, 4U) << label;
  }
}

TEST(Report, ALegendLongerThanItsPanelIsWhole) {
  if (!have_gnuplot()) GTEST_SKIP() << "gnuplot is not on the PATH";
  Folder const folder;
  fs::create_directories(folder.path);
  Figure figure{.name = "long"};
  figure.panels.push_back({{"x"}, {"y"}});
  for (int i = 0; i < 30; ++i)
    figure.panels[0].curves.push_back({fmt::format("curve{:02}", i), {.index = i}, {{1, 2}, {2, 3}}});
  draw(figure, folder.path);
  ASSERT_TRUE(figure.svg) << figure.why_not;
  for (int i = 0; i < 30; ++i) EXPECT_TRUE(contains(*figure.svg, fmt::format(">curve{:02}</t", i))) << i;
}

TEST(Report, AnUnwritableFolderIsAnError) {
  Folder const folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "file") << "x";
  EXPECT_THROW(write_report({}, folder.path / "file"), ReportError);
}

}  // namespace
}  // namespace polhode::report
