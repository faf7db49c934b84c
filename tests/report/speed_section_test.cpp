// Who is first, and by how much: from made-up records whose answers are known, with losses, failures and missing times.
#include <nlohmann/json.hpp>

#include "report/sections/speed.hpp"
#include "tests/report/fixture.hpp"

namespace polhode::report {
namespace {

using namespace samples;

/// A run on free_body of 50 s with that error and that time.
Record timed(std::string name, double control, double error, double seconds, bool adaptive_steps = false) {
  Record r = made("free_body", "", {std::move(name), 4, 1, 1, 1e-15}, control);
  if (adaptive_steps) r = adaptive(r, control);
  r.attitude_error_max = error;
  r.cpu_time_s = results::CpuTime{seconds, 0.9 * seconds, 1.1 * seconds, 5};
  return r;
}
/// Errors h^4 and times 1e-6 / h: ours; the rival is so many times slower.
Contents race(double rival_slower) {
  Contents c;
  for (double const h : {0.1, 0.05, 0.025, 0.0125, 0.0005}) {
    c.records.push_back(timed("rk4", h, std::pow(h, 4), 1e-6 / h));
    c.records.push_back(timed("odeint_rk4", h, std::pow(h, 4), rival_slower * 1e-6 / h));
  }
  c.metas.push_back({{"cpu_model", "made-up"}, {"cpu_mhz", "2400"}, {"flags", "-O3"}});
  return c;
}
Race const& race_to(std::vector<Race> const& races, double target, bool adaptive_steps) {
  for (Race const& one : races)
    if (one.target == target && one.adaptive == adaptive_steps) return one;
  throw std::out_of_range("no such race");
}

TEST(SpeedTarget, IsInterpolatedBetweenEqualStepsAndNotBetweenTolerances) {
  Contents c = race(2);
  Facts const facts(c);
  std::optional<Cost> const cost = time_to(facts.instances.front().sweeps().front(), 1e-6);
  ASSERT_TRUE(cost);
  EXPECT_TRUE(cost->interpolated);
  EXPECT_EQ(cost->run->of.h, 0.025) << "the cheapest run that really reaches it: 0.05^4 is 6.25e-6";
  EXPECT_NEAR(cost->value, 1e-6 / std::pow(1e-6, 0.25), 1e-18);
  EXPECT_NEAR(cost->low, 0.9 * cost->value, 1e-18);
  EXPECT_NEAR(cost->high, 1.1 * cost->value, 1e-18);

  Contents a;
  for (double const rtol : {1e-5, 1e-7, 1e-9}) a.records.push_back(timed("dop853", rtol, rtol, 1e-8 / rtol, true));
  Facts const loose(a);
  std::optional<Cost> const found = time_to(loose.instances.front().sweeps().front(), 1e-6);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->interpolated);
  EXPECT_EQ(found->value, 1e-8 / 1e-7);
  EXPECT_EQ(found->run->of.rtol, 1e-7);
}

TEST(SpeedTarget, NeedsARunThatEndedWellAndWasTimed) {
  Contents c;
  c.records = {timed("rk4", 0.1, 1e-7, 1), timed("rk4", 0.05, 1e-8, 2), timed("rk4", 0.025, 1e-9, 4)};
  c.records[0].status = results::Status::diverged;
  c.records[1].cpu_time_s.reset();
  auto const at = [&](double target) {
    Facts const facts(c);
    return time_to(facts.instances.front().sweeps().front(), target);
  };
  EXPECT_EQ(at(1e-6)->value, 4) << "the first failed, the second was not timed";
  EXPECT_FALSE(at(1e-12)) << "never reached";
  c.records[2].cpu_time_s->median = NAN;
  EXPECT_FALSE(at(1e-6)) << "a time that is no number is none";
  c.records[2].cpu_time_s = results::CpuTime{4, 4, 4, 1};
  c.records[2].reference_bar = 1e-5;
  EXPECT_FALSE(at(1e-6)) << "the reference cannot tell";
}

TEST(SpeedRace, TheFirstIsTheFirstOfItsKindOfControl) {
  Contents c = race(2);
  for (double const rtol : {1e-6, 1e-9, 1e-12}) {
    c.records.push_back(timed("dop853", rtol, rtol / 2, 1e-9, true));  // before all equal steps
    c.records.push_back(timed("gsl_rk8pd", rtol, rtol / 2, 1e-10, true));
  }
  Facts const facts(c);
  auto const races = races_of(facts);
  ASSERT_EQ(races.size(), 6U);
  Race const& equal = race_to(races, 1e-9, false);
  EXPECT_EQ(equal.own()->run->of.integrator, "rk4");
  EXPECT_EQ(equal.rival()->run->of.integrator, "odeint_rk4");
  EXPECT_EQ(equal.rival("GSL"), nullptr) << "it runs adaptively alone here";
  EXPECT_EQ(equal.first(), First::ours);
  Estimate const ratio = quotient(*equal.rival(), *equal.own());
  EXPECT_NEAR(ratio.value, 2, 1e-12);
  EXPECT_NEAR(ratio.low, 2 * 0.9 / 1.1, 1e-12);
  EXPECT_NEAR(ratio.high, 2 * 1.1 / 0.9, 1e-12);
  Race const& adaptive_race = race_to(races, 1e-9, true);
  EXPECT_EQ(adaptive_race.first(), First::rival);
  EXPECT_EQ(adaptive_race.rival()->run->of.integrator, "gsl_rk8pd");
  EXPECT_EQ(race_to(races, 1e-12, false).first(), First::ours);
}

TEST(SpeedRace, OverlapDecidesNothingAndAbsenceDoes) {
  Contents close = race(1.1);
  EXPECT_EQ(race_to(races_of(Facts(close)), 1e-6, false).first(), First::undecided);
  Contents c = race(2);
  std::erase_if(c.records, [](Record const& r) { return r.of.integrator == "rk4" && *r.of.h < 0.0125; });
  std::vector<Race> const races = races_of(Facts(c));
  EXPECT_EQ(race_to(races, 1e-12, false).first(), First::rival) << "none of ours arrives";
  std::erase_if(c.records, [](Record const& r) { return *r.of.h < 0.0125; });
  EXPECT_EQ(race_to(races_of(Facts(c)), 1e-12, false).first(), First::nobody);
}

TEST(SpeedRace, AClosedFormRacesWithNobody) {
  Contents c = race(2);
  c.records.push_back(timed("exact", 50, 1e-15, 1e-7));
  EXPECT_EQ(race_to(races_of(Facts(c)), 1e-9, false).own()->run->of.integrator, "rk4");
  c.catalogue["exact"].family = "gauss";
  c.catalogue["rk4"].family = "exact";
  EXPECT_EQ(race_to(races_of(Facts(c)), 1e-9, false).own()->run->of.integrator, "exact") << "as the catalogue has it";
}

TEST(SpeedSection, ALossIsARowAndASentenceLikeAWin) {
  Folder const folder;
  Contents c = race(2);
  for (double const rtol : {1e-6, 1e-9}) {
    c.records.push_back(timed("dop853", rtol, rtol / 2, 3e-9 / rtol, true));
    c.records.push_back(timed("gsl_rk8pd", rtol, rtol / 2, 1e-9 / rtol, true));
  }
  std::string const text = markdown_of(c, folder.path);
  expect_sound(folder.path);
  EXPECT_TRUE(contains(text,
                       "Equal steps, 3 comparisons: one of ours is first in 3 (free_body, 50 s to 1e-6 rad; "
                       "free_body, 50 s to 1e-9 rad; free_body, 50 s to 1e-12 rad)."));
  EXPECT_TRUE(contains(text,
                       "Adaptive steps, 3 comparisons: a rival is first in 2 (free_body, 50 s to 1e-6 rad; "
                       "free_body, 50 s to 1e-9 rad); nobody arrives in 1 (free_body, 50 s to 1e-12 rad)."));
  EXPECT_TRUE(contains(text,
                       "| free_body, 50 s | 1e-6 | rival | dop853 (quaternion) | rtol = 1e-6, atol = 1e-6 | "
                       "5e-7 | 3 ms | gsl_rk8pd (quaternion) | rtol = 1e-6, atol = 1e-6 | 5e-7 | 1 ms | 0.333 | "
                       "0.273 to 0.407 |"));
  EXPECT_TRUE(contains(text, "| free_body, 50 s | 1e-12 | nobody arrives | none arrives |"));
  EXPECT_TRUE(contains(text, "| free_body, 50 s | adaptive | rival: gsl_rk8pd, 3 (2.45 to 3.67) |"));
  EXPECT_TRUE(contains(text, "| adaptive | gsl_rk8pd | GSL | 1 ms | 1 s | never | 5e-10 | 2 | 0 |"));
  EXPECT_TRUE(contains(text, "| clock [MHz] | 2400 |"));
  EXPECT_TRUE(contains(text, "| governor | not told |"));
}

TEST(SpeedSection, AClosedFormStandsBesideTheBestRival) {
  Folder const folder;
  Contents c = race(2);
  c.records.push_back(timed("exact", 50, 1e-15, 1e-7));
  c.records.push_back(timed("exact", 25, 1e-15, 2e-7));
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "| free_body, 50 s | exact (quaternion) | 1e-15 | 100 ns | odeint_rk4 | 1e-12 | 2 ms |"))
      << "interpolated: 2 * 1e-6 / 1e-3 s";
}

TEST(SpeedSection, TheTablesHoldTheRecordsNumbers) {
  Folder const folder;
  Contents c = race(2);
  c.records[0].cpu_time_s->median = 1.2345678e-5;
  c.records[0].attitude_error_max = 9.8765e-7;
  markdown_of(c, folder.path);
  std::string const csv = slurp(folder.path / "tables" / "speed-fixed.csv");
  EXPECT_TRUE(contains(csv, "1e-06,ours,rk4 (quaternion),h = 0.1 s,9.8765e-07,1.2345678e-05,"));
  std::string const text = slurp(folder.path / "report.md");
  EXPECT_TRUE(contains(text, "| 9.88e-7 | 12.3 µs |"));
  EXPECT_TRUE(contains(slurp(folder.path / "tables" / "speed-fixed.tex"), "12.3"));
}

TEST(SpeedSection, FailedAndUntimedRunsAreCalledSo) {
  Folder const folder;
  Contents c = race(2);
  c.records.push_back(timed("verner98", 1, 1e-10, 1));
  c.records.back().cpu_time_s.reset();
  c.records.push_back(timed("verner98", 2, 1, 1));
  c.records.back().status = results::Status::diverged;
  std::string const text = markdown_of(c, folder.path);
  EXPECT_TRUE(contains(text, "| equal steps | verner98 | own | not timed | not timed | never | 1e-10 | 2 | 1 |"));
}

TEST(SpeedSection, WithoutTimesItSaysSo) {
  Folder const folder;
  Contents c = race(2);
  for (Record& r : c.records) r.cpu_time_s.reset();
  EXPECT_TRUE(contains(markdown_of(c, folder.path), "so nothing can be said of who is faster"));
}

}  // namespace
}  // namespace polhode::report
