/// Records in other files: CSV and Google Benchmark JSON.
#include "results/export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "results/run_name.hpp"
#include "tests/results/made_up_record.hpp"

namespace polhode::results {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

Record record_of(std::string const& integrator, double h, std::string const& build = "b") {
  Record record = test::made_up_record(integrator, h, build);
  record.norm_drift_max = 1.0 / 3 * 1e-15;
  record.cpu_time_s = CpuTime{2.5e-5, 2.25e-5, 3e-5, 5, {2.5e-5, 2.25e-5, 3e-5, 2.625e-5, 2.375e-5}};
  return record;
}

/// The fields of a CSV text, by RFC 4180.
std::vector<std::vector<std::string>> parse_csv(std::string const& text) {
  std::vector<std::vector<std::string>> rows(1, {""});
  bool inside = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    bool const doubled = inside && c == '"' && i + 1 < text.size() && text[i + 1] == '"';
    if (doubled) {
      rows.back().back() += '"';
      ++i;
    } else if (c == '"') {
      inside = !inside;
    } else if (!inside && c == ',') {
      rows.back().emplace_back();
    } else if (!inside && c == '\n') {
      rows.push_back({""});
    } else {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

TEST(ExportCsv, EveryFieldReadsBack) {
  Record record = record_of("rk4", 0.1);
  record.of.set["inertia"] = {0.6, 0.8, 1};
  record.cell = cell_id(record.of);
  record.status = Status::diverged;
  record.reason = "not finite, at \"t\" = 3 s\nand later";
  record.claims["alpha"] = {1.5, {}, "reproduced"};
  auto const rows = parse_csv(csv_text({record, record_of("gauss2", 0.2)}));
  ASSERT_EQ(rows.size(), 3u);
  Json json = to_json(record);
  json.erase("schema");
  json.erase("kind");
  ASSERT_EQ(rows[0].size(), json.size());
  ASSERT_EQ(rows[1].size(), json.size());
  std::size_t column = 0;
  for (auto const& [name, value] : json.items()) {
    EXPECT_EQ(rows[0][column], name);
    std::string const& text = rows[1][column++];
    if (value.is_null()) {
      EXPECT_EQ(text, "") << name;
    } else if (value.is_string()) {
      EXPECT_EQ(text, value.get<std::string>()) << name;
    } else {
      EXPECT_EQ(Json::parse(text), value) << name;
    }
  }
  EXPECT_EQ(rows[2].size(), json.size());
}

TEST(ExportCsv, WithoutRecordsThereIsAHeader) {
  EXPECT_THAT(csv_text({}), testing::StartsWith("cell,build,problem,variant,"));
}

// --- Google Benchmark ------------------------------------------------------------------------------------------------

Contents contents_of(std::vector<Record> records) {
  Contents contents;
  contents.metas = {{{"build", "b"}, {"utc", "2024-01-01T00:00:00Z"}, {"version", "0.1.0"}, {"cpus_available", "2"}}};
  contents.records = std::move(records);
  return contents;
}

TEST(ExportBenchmark, HasWhatCompareReads) {
  Json const json = Json::parse(benchmark_json_text(contents_of({record_of("rk4", 0.1)})));
  EXPECT_EQ(json.at("context").at("date"), "2024-01-01T00:00:00Z");
  EXPECT_EQ(json.at("context").at("num_cpus"), 2);
  Json const& rows = json.at("benchmarks");
  ASSERT_EQ(rows.size(), 6u) << "five repetitions and their median";
  std::string const name = "free_body//quaternion/rk4/none/h=0.1";
  double const samples[] = {25000, 22500, 30000, 26250, 23750};  // ns
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(rows[i].at("name"), name);
    EXPECT_EQ(rows[i].at("run_name"), name);
    EXPECT_EQ(rows[i].at("run_type"), "iteration");
    EXPECT_EQ(rows[i].at("repetitions"), 5);
    EXPECT_EQ(rows[i].at("repetition_index"), i);
    EXPECT_EQ(rows[i].at("time_unit"), "ns");
    EXPECT_DOUBLE_EQ(rows[i].at("cpu_time").get<double>(), samples[i]);
    EXPECT_DOUBLE_EQ(rows[i].at("real_time").get<double>(), samples[i]);
    EXPECT_EQ(rows[i].at("steps"), 500);
  }
  Json const& median = rows[5];
  EXPECT_EQ(median.at("name"), name + "_median");
  EXPECT_EQ(median.at("run_name"), name);
  EXPECT_EQ(median.at("run_type"), "aggregate");
  EXPECT_EQ(median.at("aggregate_name"), "median");
  EXPECT_FALSE(median.contains("repetition_index"));
  EXPECT_DOUBLE_EQ(median.at("cpu_time").get<double>(), 25000);
  EXPECT_DOUBLE_EQ(median.at("cpu_time_low").get<double>(), 22500);
  EXPECT_DOUBLE_EQ(median.at("cpu_time_high").get<double>(), 30000);
}

TEST(ExportBenchmark, OlderFilesHaveTheMedianAlone) {
  Record record = record_of("rk4", 0.1);
  record.cpu_time_s->samples.clear();
  Json const rows = Json::parse(benchmark_json_text(contents_of({record}))).at("benchmarks");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("run_type"), "iteration");
  EXPECT_DOUBLE_EQ(rows[0].at("cpu_time").get<double>(), 25000);
  EXPECT_EQ(rows[1].at("run_type"), "aggregate");
}

TEST(ExportBenchmark, NamesAreUnique) {
  std::vector<Record> records;
  auto const add = [&](std::function<void(Cell&)> const& change) {
    Record record = record_of("rk4", 0.1);
    change(record.of);
    record.cell = cell_id(record.of);
    records.push_back(record);
  };
  add([](Cell&) {});
  add([](Cell& cell) { cell.t_end = 60; });
  add([](Cell& cell) { cell.policy = "project"; });
  add([](Cell& cell) { cell.seed = 2; });
  add([](Cell& cell) { cell.set["inertia"] = {1, 2, 2.5}; });
  add([](Cell& cell) {
    cell.h.reset();
    cell.rtol = 1e-6;
    cell.atol = 1e-8;
  });
  std::set<std::string> names;
  Json const json = Json::parse(benchmark_json_text(contents_of(records)));
  for (Json const& benchmark : json.at("benchmarks")) names.insert(benchmark.at("run_name").get<std::string>());
  std::string const common = "free_body//quaternion/rk4/";
  EXPECT_THAT(names, ElementsAre(common + "none/h=0.1/inertia=1,2,2.5", common + "none/h=0.1/seed=2",
                                 common + "none/h=0.1/t_end=50", common + "none/h=0.1/t_end=60",
                                 common + "none/rtol=1e-06,atol=1e-08", common + "project/h=0.1"));
}

TEST(ExportBenchmark, WhatWasNotTimedOrIsOlderIsLeftOut) {
  Record untimed = record_of("rk4", 0.2);
  untimed.cpu_time_s.reset();
  auto const contents = contents_of({record_of("rk4", 0.1), untimed, record_of("rk4", 0.1, "older")});
  EXPECT_EQ(Json::parse(benchmark_json_text(contents)).at("benchmarks").size(), 6u) << "one run";
  EXPECT_EQ(left_out_of_benchmarks(contents), 2u);
}

}  // namespace
}  // namespace polhode::results
