/// The verb ensemble as a user meets it: statistics that nobody's number of threads changes, samples that can be had
/// again, mistakes that are refused.
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

using Json = nlohmann::ordered_json;

Words capture(std::string const& verb) {
  return {verb,           "tether_capture",
          "--integrator", "rk4",
          "--h",          "0.05",
          "--seed",       "11",
          "--disperse",   "q0=so3()",
          "--disperse",   "omega0.x=normal(0.1745,0.05)",
          "--disperse",   "inertia.y=uniform(115,125)",
          "--disperse",   "k_pe=log_uniform(20,60)"};
}
Words with(Words words, Words const& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}
/// Without what differs from run to run.
Json lasting(std::string const& text) {
  Json json = Json::parse(text);
  json.erase("timing");
  json.erase("provenance");
  return json;
}
std::vector<std::string> fields(std::string const& line) {
  std::vector<std::string> all;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) all.push_back(field);
  return all;
}
std::vector<std::string> lines(std::string const& text) {
  std::vector<std::string> all;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) all.push_back(line);
  return all;
}

TEST(CliEnsemble, StatisticsDoNotDependOnThreads) {
  Folder folder;
  std::string const samples = "9000";  // more than one item of work
  Result const one = polhode(folder, with(capture("ensemble"), {"--samples", samples, "--threads", "1", "--json"}));
  Result const two =
      polhode(folder, with(capture("ensemble"), {"--samples", samples, "--threads", "2", "--out", "two", "--json"}));
  ASSERT_EQ(one.code, 0) << one.err;
  ASSERT_EQ(two.code, 0) << two.err;
  EXPECT_EQ(lasting(one.out).dump(), lasting(two.out).dump());
  EXPECT_EQ(lasting(text_of(folder.path / "two/ensemble.json")).dump(), lasting(one.out).dump());
  Json const json = Json::parse(one.out);
  EXPECT_EQ(json["kind"], "ensemble");
  EXPECT_EQ(json["in_lanes"], true);
  EXPECT_EQ(json["statistics"]["samples"], 9000);
  EXPECT_EQ(json["statistics"]["endings"]["ok"]["count"], 9000);
  for (auto const& [name, metric] : json["statistics"]["metrics"].items()) {
    std::int64_t counted = 0;
    for (Json const& bin : metric["histogram"]) counted += bin[2].get<std::int64_t>();
    EXPECT_EQ(counted, 9000) << name;
    double last = metric["min"]["value"];
    for (Json const& q : metric["quantiles"]) {
      EXPECT_LE(last, q["value"].get<double>()) << name;
      EXPECT_LE(q["low"].get<double>(), q["value"].get<double>()) << name;
      last = q["value"];
    }
    EXPECT_LE(last, metric["max"]["value"].get<double>()) << name;
    EXPECT_EQ(metric["worst"][0], metric["max"]) << name;
  }
}

/// The end state of a sample in --raw, and of `simulate --sample`, digit by digit: in lanes and alone.
TEST(CliEnsemble, ASampleIsReplayedToTheLastBit) {
  for (Words const& how : {Words{}, Words{"--variant", "case2"}, Words{"--formulation", "s3", "--integrator", "cf4"},
                           Words{"--integrator", "gauss2"}}) {
    Words base = capture("");
    base.erase(base.begin());
    if (std::ranges::find(how, "--integrator") != how.end())
      base.erase(base.begin() + 1, base.begin() + 3);  // that of `how` instead
    base = with(base, how);
    Folder folder;
    Result const all = polhode(folder, with(with({"ensemble"}, base), {"--samples", "40", "--raw", "raw.csv"}));
    ASSERT_EQ(all.code, 0) << all.err;
    std::vector<std::string> const rows = lines(text_of(folder.path / "raw.csv"));
    ASSERT_EQ(rows.size(), 41u);
    for (std::size_t const k : {0u, 17u, 39u}) {
      Result const one = polhode(folder, with(with({"simulate"}, base), {"--sample", std::to_string(k)}));
      ASSERT_EQ(one.code, 0) << one.err;
      std::vector<std::string> const row = fields(rows[k + 1]), end = fields(lines(one.out).back());
      ASSERT_GE(row.size(), 7u);
      ASSERT_GE(end.size(), 8u);
      EXPECT_EQ(row[0], std::to_string(k));
      EXPECT_EQ(std::vector(row.end() - 7, row.end()), std::vector(end.begin() + 1, end.begin() + 8)) << k;
    }
  }
}

TEST(CliEnsemble, SamplesThatFailAreCountedAndLieAboveTheOthers) {
  Folder folder;
  // A fifth of the samples asks for a negative gain: the rule's ends allow the mean alone.
  Result const result = polhode(
      folder, split("ensemble pd_slew --integrator rk4 --h 0.1 --samples 1000 --disperse k_p=normal(4,5) --json"));
  ASSERT_EQ(result.code, 0) << result.err;
  Json const json = Json::parse(result.out)["statistics"];
  std::int64_t const invalid = json["endings"]["invalid"]["count"];
  EXPECT_GT(invalid, 100);
  EXPECT_LT(invalid, 400);
  std::int64_t all = 0;
  for (auto const& [name, ending] : json["endings"].items()) all += ending["count"].get<std::int64_t>();
  EXPECT_EQ(all, 1000);
  EXPECT_EQ(json["metrics"]["final_rate"]["without"], invalid);
  EXPECT_TRUE(json["metrics"]["final_rate"]["quantiles"][2]["value"].is_null()) << "99% lies among the failed";
}

TEST(CliEnsemble, WhatDoesNotApplyIsAbsent) {
  Folder folder;
  Result const free = polhode(folder, split("ensemble free_body --integrator rk4 --h 0.1 --samples 50 --json"));
  ASSERT_EQ(free.code, 0) << free.err;
  Json const metrics = Json::parse(free.out)["statistics"]["metrics"];
  EXPECT_FALSE(metrics.contains("settle_time"));
  EXPECT_FALSE(metrics.contains("peak_torque"));
  EXPECT_TRUE(metrics.contains("norm_drift"));
  Result const many = polhode(
      folder, split("ensemble group_consensus --integrator rk4 --h 0.05 --t-end 1 --samples 3 --threads 2 --json"));
  ASSERT_EQ(many.code, 0) << many.err;
  EXPECT_EQ(Json::parse(many.out)["in_lanes"], false);
}

TEST(CliEnsemble, NonsenseIsRefusedBeforeAnythingIsWritten) {
  for (auto const& [words, right] : std::vector<std::pair<std::string, std::string>>{
           {"--h 0.05 --samples 0", "whole number from 1"},
           {"--h 0.05 --samples 10 --seed -1", "whole number"},
           {"--h 0.05 --samples 10 --threads 0", "from 1 to 1024"},
           {"--h 0.05 --samples 10 --settle 0", "greater than 0"},
           {"--h 0.05 --samples 10 --disperse q0=normal(0,1)", "q0=so3()"},
           {"--h 0.05 --samples 10 --disperse k_pe=uniform(-1,5)", "must not be negative"},
           {"--h 0.05 --samples 10 --disperse omgea0=normal(0,1)", "did you mean"},
           {"--h 0.05 --samples 10 --t-end 0.12", "--t-end 0.1"},
           {"--h 0.03 --samples 10", "would be right"},
           {"--h 0.05 --samples 10 --every 1", "leave --every out"},
           {"--rtol 1e-6 --samples 10", "give --h"}}) {
    Folder folder;
    Words const all = with(split("ensemble tether_capture --integrator rk4 --out out --raw raw.csv"), split(words));
    Result const result = polhode(folder, all);
    EXPECT_EQ(result.code, 2) << words << ": " << result.err;
    EXPECT_NE(result.err.find(right), std::string::npos) << words << ": " << result.err;
    EXPECT_TRUE(folder.contents().empty()) << words;
  }
  Folder folder;
  EXPECT_EQ(polhode(folder, "ensemble tether_capture --integrator odeint_rk4 --h 0.05 --samples 5").code, 2);
  EXPECT_EQ(polhode(folder, "simulate tether_capture --integrator rk4 --h 0.05 --seed 3").code, 2);
}

TEST(CliEnsemble, MemoryDoesNotGrowWithTheSamples) {
  Folder folder;
  auto const memory = [&](std::string const& samples) {
    Result const result =
        polhode(folder, with(capture("ensemble"), {"--samples", samples, "--threads", "1", "--json"}));
    EXPECT_EQ(result.code, 0) << result.err;
    return Json::parse(result.out)["timing"]["peak_memory_bytes"].get<double>();
  };
  double const few = memory("10000"), many = memory("60000");
  EXPECT_LT(few, 40 << 20) << "bytes";  // 15 MiB were measured: the program, its libraries, and the statistics
  EXPECT_LT(many, few + (2 << 20)) << "bytes";
}

}  // namespace
}  // namespace polhode::cli
