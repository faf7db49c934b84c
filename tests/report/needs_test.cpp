// Which method for which need: the rule of each row chooses, foils are never chosen, and where the records hold nothing
// to choose from, the row says so.
#include "report/facts.hpp"
#include "report/text.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;

/// The row of a need in the Markdown, cell by cell.
std::vector<std::string> row_of(std::string const& text, std::string const& need) {
  auto const start = text.find("\n| " + need + " |");
  if (start == std::string::npos) return {};
  std::istringstream line(text.substr(start + 2, text.find('\n', start + 1) - start - 2));
  std::vector<std::string> entries;
  for (std::string entry; std::getline(line, entry, '|');) {
    // an escaped bar belongs to its entry
    if (!entries.empty() && entries.back().ends_with("\\")) {
      entries.back() += "|" + entry;
    } else {
      entries.push_back(entry);
    }
  }
  for (std::string& entry : entries) {
    auto const first = entry.find_first_not_of(' ');
    entry = first == std::string::npos ? "" : entry.substr(first, entry.find_last_not_of(' ') - first + 1);
  }
  return entries;
}

std::string needs_of(Contents const& contents) {
  Folder const folder;
  return markdown_of(contents, folder.path);
}

TEST(Needs, TheCheapestRunThatServesIsTaken) {
  Contents c;
  for (double const h : {0.05, 0.1, 0.2}) {
    c.records.push_back(made("pd_slew", "plain", {"rk4", 4, 1.1e-5, 4, 1e-10}, h));         // 1.1e-9 rad at h = 0.1 s
    c.records.push_back(made("pd_slew", "plain", {"dopri5", 5, 1e-5, 6, 1e-10}, h));        // 3.2e-9 at h = 0.2 s
    c.records.push_back(made("pd_slew", "plain", {"odeint_rk4", 4, 1.1e-5, 5, 1e-10}, h));  // rk4, and dearer
    c.records.push_back(made("pd_slew", "delayed", {"cf4", 4, 1e-9, 1, 1e-10}, h));         // another loop
  }
  auto const row = row_of(needs_of(c), "smooth loop");
  ASSERT_EQ(row.size(), 9U);
  EXPECT_EQ(row[1], "pd_slew plain, 50 s: 1e-9 rad at the least cost");
  // Dopri5: 3000 evaluations at h = 0.1 s, of 1e-10 rad; 1500 at 0.2 s, of 3.2e-9: 1e-9 rad costs 1893, 37.9 µs. Rk4
  // costs 2048 there, 41 µs, and Odeint's 2560.
  EXPECT_EQ(row[2], "dopri5 (quaternion), h = 0.1 s");
  EXPECT_EQ(row[3], "1e-10");
  EXPECT_EQ(row[4], "1e-10");
  EXPECT_EQ(row[5], "60 µs");
  EXPECT_EQ(row[6], "37.9 µs");
  EXPECT_EQ(row[7], "rk4 (quaternion), h = 0.05 s: × 1.08");
  EXPECT_EQ(row[8], "odeint_rk4 (quaternion), h = 0.05 s: × 1.35");
}

TEST(Needs, ALongMotionNeedsWhatIsKept) {
  Contents c;
  auto const add = [&](Method const& m, double energy, double t_end) {
    Record r = run_of("free_body", "", m, 0.1, t_end);
    r.energy_drift_max = r.momentum_drift_max = energy;
    c.records.push_back(r);
  };
  for (double const t_end : {50.0, 1000.0}) {
    add({"rk4", 4, 1e-6, 4, 1e-11}, 1e-12, t_end);            // cheap, and drifts
    add({"gauss4", 8, 1e-3, 24, 2e-16}, 1e-16, t_end);        // keeps all
    add({"gauss2_tol6", 4, 1e-6, 7, 2e-16}, 1e-16, t_end);    // a foil
    add({"odeint_rkf78", 8, 1e-3, 30, 2e-16}, 1e-16, t_end);  // a rival that does
  }
  auto const row = row_of(needs_of(c), "long free motion");
  ASSERT_EQ(row.size(), 9U);
  EXPECT_TRUE(row[1].starts_with("free_body, 1000 s: ")) << row[1];
  EXPECT_EQ(row[2], "gauss4 (quaternion), h = 0.1 s");
  EXPECT_EQ(row[7], "odeint_rkf78 (quaternion), h = 0.1 s: × 1.25");
  EXPECT_EQ(row[8], row[7]);
}

TEST(Needs, ARivalThatWinsIsTaken) {
  Contents c;
  for (double const h : {0.05, 0.1}) {
    c.records.push_back(made("tether_capture", "case1,g1", {"gauss2", 4, 5e-6, 12, 2e-15}, h));
    c.records.push_back(made("tether_capture", "case1,g1", {"odeint_dopri5", 5, 5e-6, 6, 2e-12}, h));
  }
  auto const row = row_of(needs_of(c), "sampled control");
  ASSERT_EQ(row.size(), 9U);
  EXPECT_EQ(row[2], "odeint_dopri5 (quaternion), h = 0.1 s");
  EXPECT_EQ(row[8], "it is one; best of ours gauss2 (quaternion), h = 0.1 s: × 2");
}

TEST(Needs, SlidingAndSizeAreJudgedWithoutAReference) {
  Contents c;
  auto const add = [&](std::string const& problem, std::string const& variant, Method const& m, bool borne_out) {
    Record r = run_of(problem, variant, m, 0.1, 40, {{"layer", 0.1}});
    if (!borne_out) r.claims["layer"].verdict = "not reproduced";
    r.attitude_error_max = r.reference_bar = std::nullopt;
    r.cpu_time_s.reset();
    if (problem == "quaternion_sync") {
      r.of.set["n"] = {1000};
      r.bodies = 1000;
    }
    c.records.push_back(r);
  };
  add("dead_zone", "printed,cubic,n2", {"lie_euler", 1, 1, 1, 0}, false);
  add("dead_zone", "printed,cubic,n2", {"rk4", 4, 1, 4, 0}, true);
  add("dead_zone", "printed,cubic,n2", {"odeint_rk4", 4, 1, 5, 0}, true);
  add("quaternion_sync", "protocol7", {"rk4", 4, 1, 4, 1e-6}, true);
  add("quaternion_sync", "protocol7", {"cf4", 4, 1, 5, 1e-15}, true);
  std::string const text = needs_of(c);
  auto row = row_of(text, "sliding mode");
  ASSERT_EQ(row.size(), 9U);
  EXPECT_EQ(row[2], "rk4 (quaternion), h = 0.1 s");
  EXPECT_EQ(row[3], absent);
  EXPECT_EQ(row[5], "2000 evaluations");
  EXPECT_EQ(row[8], "odeint_rk4 (quaternion), h = 0.1 s: × 1.25");
  row = row_of(text, "large fleets");
  ASSERT_EQ(row.size(), 9U);
  EXPECT_EQ(row[2], "cf4 (quaternion), h = 0.1 s");
  EXPECT_EQ(row[7], "nobody else serves");
  EXPECT_EQ(row[8], "none serves");
  EXPECT_EQ(row_of(text, "fleets").at(2), "These records cannot say: they hold no such run.");
}

TEST(Needs, NothingIsRecommendedWithoutACompetition) {
  Contents c;
  c.records.push_back(made("pd_slew", "plain", {"rk4", 4, 1e-5, 4, 1e-10}, 0.1));
  EXPECT_EQ(row_of(needs_of(c), "smooth loop").at(2), "These records cannot say: nothing to compare with rk4.");
  c.records.push_back(made("pd_slew", "plain", {"dopri5", 5, 1, 6, 1e-10}, 0.1));
  c.records.front().attitude_error_max = 1e-3;
  EXPECT_EQ(row_of(needs_of(c), "smooth loop").at(2),
            "These records cannot say: none of 2 integrators has a run that serves.");
  for (Record& r : c.records) r.status = results::Status::diverged;
  EXPECT_EQ(row_of(needs_of(c), "smooth loop").at(2), "These records cannot say: no such run ended well.");
}

TEST(Needs, FoilsAreKnown) {
  for (auto const* foil : {"gauss2_sweeps1", "gauss2_sweeps2", "gauss2_tol6"}) EXPECT_TRUE(is_foil(foil)) << foil;
  for (auto const* sound : {"gauss2", "gauss8_lawson_sweeps6", "rk4"}) EXPECT_FALSE(is_foil(sound)) << sound;
}

}  // namespace
}  // namespace polhode::report
