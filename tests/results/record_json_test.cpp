// The record as JSON, and back.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>

#include "results/record.hpp"
#include "tests/results/record_samples.hpp"

namespace {

using namespace polhode::results;
using namespace polhode::results::test;
using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

std::string const full_text =
    R"({"schema":1,"kind":"run","cell":"CELL","build":"b0","problem":"tether_capture","variant":"case2,g1",)"
    R"("formulation":"s3","integrator":"cf4","policy":"project","h":0.1,"rtol":1e-06,"atol":1e-09,)"
    R"("set":{"inertia":[0.5,0.85,1.0],"rho":[0.25]},"seed":-7,"t_end":50.0,"status":"max_steps",)"
    R"("reason":"a \"quoted\"\nreason","steps":1,"rejected":2,"evaluations":9007199254740993,"jacobians":4,)"
    R"("iterations":5,"controller_calls":6,"events_located":7,"projections":8,"norm_drift_raw_max":0.5,)"
    R"("norm_drift_max":1.5,"norm_drift_final":-2.5,"norm_drift_rms":3.5,"norm_growth_exponent":4.5,)"
    R"("projection_work":5.5,"attitude_error_max":6.5,"attitude_error_end":7.5,"attitude_error_l2":8.5,)"
    R"("rate_error_max":9.5,"rate_error_end":10.5,"energy_drift_max":11.5,"momentum_drift_max":12.5,)"
    R"("momentum_direction_max":13.5,"position_defect_max":14.5,"velocity_defect_max":15.5,)"
    R"("acceleration_defect_max":16.5,"multiplier_error_max":17.5,"reference":"ref","reference_bar":1e-30,)"
    R"("claims":{"alpha":{"value":0.1,"published":0.2,"verdict":"not reproduced"},)"
    R"("statement":{"value":1.0,"published":null,"verdict":"reproduced"}},)"
    R"("cpu_time_s":{"median":1.25,"low":1.0,"high":1.5,"repetitions":5},"allocations_per_step":14.5,"bodies":5})";

std::string expected_full_text() {
  std::string text = full_text;
  return text.replace(text.find("CELL"), 4, full_record().cell);
}

Json through_text(Json const& json) {
  return Json::parse(json.dump());
}

// --- Runs ------------------------------------------------------------------------------------------------------------

TEST(Record, IsWrittenInTheOrderOfTheSchema) {
  EXPECT_EQ(to_json(full_record()).dump(), expected_full_text());
}

TEST(Record, FullRecordReadsBack) {
  Record const back = record_from_json(Json::parse(expected_full_text()));
  EXPECT_EQ(to_json(back).dump(), expected_full_text());
  EXPECT_EQ(back.evaluations, 9007199254740993);
  EXPECT_EQ(back.status, Status::max_steps);
  EXPECT_EQ(back.of.seed, -7);
  EXPECT_EQ(back.of.set.at("inertia"), (std::vector<double>{0.5, 0.85, 1.0}));
  EXPECT_EQ(back.claims.at("alpha").published, 0.2);
  EXPECT_FALSE(back.claims.at("statement").published);
  EXPECT_EQ(back.cpu_time_s->repetitions, 5);
  EXPECT_EQ(cell_id(back.of), back.cell);
}

TEST(Record, OrderOfTheKeysInTheFileDoesNotMatter) {
  nlohmann::json const sorted = nlohmann::json::parse(expected_full_text());
  EXPECT_EQ(to_json(record_from_json(sorted)).dump(), expected_full_text());
}

TEST(Record, EmptyRecordReadsBack) {
  Record const empty;
  Json const json = to_json(empty);
  EXPECT_EQ(to_json(record_from_json(through_text(json))).dump(), json.dump());
}

struct IsOptional {
  template <class T>
  static bool empty(std::optional<T> const& value) {
    return !value;
  }
  template <class T>
  static bool empty(T const&) {
    return false;
  }
};

TEST(Record, EmptyOptionalsAreNullBothWays) {
  Json const json = through_text(to_json(Record{}));
  Record const back = record_from_json(json);
  int optionals = 0;
  for_each_field(back, [&](std::string const& name, std::string const&, auto const& member) {
    EXPECT_EQ(json.at(name).is_null(), IsOptional::empty(member)) << name;
    optionals += IsOptional::empty(member);
  });
  EXPECT_EQ(optionals, 33);
}

struct SetTo {
  double number;
  void operator()(std::optional<double>& member) const { member = number; }
  void operator()(std::optional<CpuTime>& member) const { member = CpuTime{number, number, number, 1}; }
  void operator()(std::map<std::string, Claim>& member) const { member["c"] = Claim{number, number, "v"}; }
  void operator()(std::map<std::string, std::vector<double>>& member) const { member["p"] = {number, number}; }
  void operator()(double& member) const { member = number; }
  template <class T>
  void operator()(T&) const {}
};

Record with_all_numbers(double number) {
  Record record;
  for_each_field(record, [&](std::string const&, std::string const&, auto& member) { SetTo{number}(member); });
  record.cell = cell_id(record.of);
  return record;
}

TEST(Record, NonFiniteNumbersAreNull) {
  for (double const number : {nan, inf, -inf}) {
    Record const record = with_all_numbers(number);
    std::string const text = to_json(record).dump();
    EXPECT_NE(text.find("\"h\":null"), std::string::npos);
    EXPECT_NE(text.find("\"set\":{\"p\":[null,null]}"), std::string::npos);
    EXPECT_NE(text.find("\"t_end\":null"), std::string::npos);
    EXPECT_NE(text.find("\"claims\":{\"c\":{\"value\":null,\"published\":null,\"verdict\":\"v\"}}"), std::string::npos);
    EXPECT_NE(text.find("\"median\":null,\"low\":null,\"high\":null,\"repetitions\":1"), std::string::npos);

    Record const back = record_from_json(Json::parse(text));
    EXPECT_EQ(to_json(back).dump(), text);
    EXPECT_FALSE(back.of.h);
    EXPECT_TRUE(std::isnan(back.of.t_end));
    EXPECT_TRUE(std::isnan(back.of.set.at("p").at(1)));
    EXPECT_EQ(cell_id(back.of), record.cell);
  }
}

void expect_same_bits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b));
}

TEST(Record, DoublesReadBackExactly) {
  std::vector<double> numbers{
      0.0, -0.0, 0.1, 1.0 / 3, 1e22, 1e23, 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308};
  std::mt19937_64 random(1);
  while (numbers.size() < 2000) {
    double const number = std::bit_cast<double>(random());
    if (std::isfinite(number)) numbers.push_back(number);
  }
  for (double const number : numbers) {
    Record const back = record_from_json(through_text(to_json(with_all_numbers(number))));
    expect_same_bits(*back.of.h, number);
    expect_same_bits(back.of.t_end, number);
    expect_same_bits(back.of.set.at("p").at(0), number);
    expect_same_bits(*back.attitude_error_max, number);
    expect_same_bits(*back.claims.at("c").value, number);
    expect_same_bits(back.cpu_time_s->median, number);
  }
}

TEST(Record, IntegersReadBackExactly) {
  for (std::int64_t const number :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    Record record;
    record.of.seed = number;
    record.steps = number;
    Record const back = record_from_json(through_text(to_json(record)));
    EXPECT_EQ(back.of.seed, number);
    EXPECT_EQ(back.steps, number);
  }
}

TEST(Record, SetMayBeASingleNumber) {
  Json json = to_json(full_record());
  json["set"]["rho"] = 1;
  EXPECT_EQ(record_from_json(json).of.set.at("rho"), std::vector<double>{1.0});
}

TEST(Record, WholeNumbersMayStandForDoubles) {
  Json json = to_json(full_record());
  json["h"] = 2;
  EXPECT_EQ(record_from_json(json).of.h, 2.0);
}

TEST(Record, MalformedInputIsNamed) {
  struct Case {
    std::function<void(Json&)> spoil;
    std::string message;
  };
  std::string const missing = ": missing; every field must be there, null where it does not apply";
  std::vector<Case> const cases{
      {[](Json& j) { j = Json::array(); }, "record: array; must be an object"},
      {[](Json& j) { j.erase("schema"); }, "schema" + missing},
      {[](Json& j) { j["schema"] = 2; }, "schema: 2; must be 1"},
      {[](Json& j) { j["schema"] = "1"; }, "schema: \"1\"; must be 1"},
      {[](Json& j) { j.erase("kind"); }, "kind" + missing},
      {[](Json& j) { j["kind"] = "meta"; }, "kind: \"meta\"; must be \"run\" here"},
      {[](Json& j) { j["kind"] = "jog"; }, "kind: \"jog\"; must be one of meta, begin, series, run"},
      {[](Json& j) { j["kind"] = nullptr; }, "kind: null; must be one of meta, begin, series, run"},
      {[](Json& j) { j["cell"] = nullptr; }, "cell: null; must be a string"},
      {[](Json& j) { j["problem"] = 3; }, "problem: 3; must be a string"},
      {[](Json& j) { j["h"] = "0.1"; }, "h: \"0.1\"; must be a number or null"},
      {[](Json& j) { j["set"] = nullptr; }, "set: null; must be an object of arrays of numbers"},
      {[](Json& j) { j["set"]["rho"] = "x"; }, "set.rho: \"x\"; must be an array of numbers"},
      {[](Json& j) { j["set"]["inertia"][2] = true; }, "set.inertia[2]: boolean; must be a number or null"},
      {[](Json& j) { j["seed"] = nullptr; }, "seed: null; must be an integer of 64 bits"},
      {[](Json& j) { j["seed"] = 9223372036854775808u; }, "seed: 9223372036854775808; must be an integer of 64 bits"},
      {[](Json& j) { j["t_end"] = false; }, "t_end: boolean; must be a number or null"},
      {[](Json& j) { j["status"] = 0; }, "status: 0; must be a string"},
      {[](Json& j) { j["steps"] = 1.5; }, "steps: 1.5; must be an integer of 64 bits"},
      {[](Json& j) { j["claims"] = Json::array(); }, "claims: array; must be an object of claims"},
      {[](Json& j) { j["claims"]["alpha"] = 1; }, "claims.alpha: 1; must be an object"},
      {[](Json& j) { j["claims"]["alpha"].erase("verdict"); }, "claims.alpha.verdict" + missing},
      {[](Json& j) { j["claims"]["alpha"]["value"] = "1"; }, "claims.alpha.value: \"1\"; must be a number or null"},
      {[](Json& j) { j["claims"]["alpha"]["odd"] = 1; },
       "claims.alpha.odd: unknown field; must be one of value, published, verdict"},
      {[](Json& j) { j["cpu_time_s"] = 1.0; }, "cpu_time_s: 1.0; must be an object"},
      {[](Json& j) { j["cpu_time_s"].erase("low"); }, "cpu_time_s.low" + missing},
      {[](Json& j) { j["cpu_time_s"]["repetitions"] = 4294967296; },
       "cpu_time_s.repetitions: 4294967296; must be an integer of 32 bits"},
      {[](Json& j) { j["cpu_time_s"]["mean"] = 1; },
       "cpu_time_s.mean: unknown field; must be one of median, low, high, repetitions"},
  };
  for (Case const& c : cases) {
    Json json = to_json(full_record());
    c.spoil(json);
    EXPECT_EQ(message_of([&] { record_from_json(json); }), c.message);
  }
}

TEST(Record, EveryMissingFieldIsNamed) {
  Record const record = full_record();
  for_each_field(record, [&](std::string const& name, std::string const&, auto const&) {
    Json json = to_json(record);
    json.erase(name);
    // Younger than the schema: reads as null.
    if (name.ends_with("_defect_max") || name == "multiplier_error_max" || name == "bodies") {
      Json const again = to_json(record_from_json(json));
      EXPECT_TRUE(again.at(name).is_null()) << name;
      EXPECT_EQ(again.size(), json.size() + 1) << name;
      return;
    }
    EXPECT_EQ(message_of([&] { record_from_json(json); }),
              name + ": missing; every field must be there, null where it does not apply");
  });
}

TEST(Record, UnknownFieldIsNamedWithTheKnown) {
  Json json = to_json(full_record());
  std::string known;
  for (auto const& item : json.items()) known += (known.empty() ? "" : ", ") + item.key();
  json["stepz"] = 1;
  EXPECT_EQ(message_of([&] { record_from_json(json); }), "stepz: unknown field; must be one of " + known);
}

TEST(Record, ReadmeHasEveryFieldWithItsUnit) {
  std::ifstream file(std::string(POLHODE_SOURCE_DIR) + "/results/README.md");
  ASSERT_TRUE(file);
  std::stringstream text;
  text << file.rdbuf();
  std::string const readme = text.str();
  Record const record;
  std::size_t last = 0;
  for_each_field(record, [&](std::string const& name, std::string const& unit, auto const&) {
    std::string const row = fmt::format("\n| `{}` | {} |", name, unit.empty() ? "-" : unit);
    std::size_t const place = readme.find(row);
    ASSERT_NE(place, std::string::npos) << row;
    EXPECT_GT(place, last) << "not in the order of the schema:" << row;
    last = place;
  });
  for (int i = 0; i <= static_cast<int>(Status::refused); ++i) {
    std::string const row = fmt::format("\n| `{}` |", name_of(static_cast<Status>(i)));
    EXPECT_NE(readme.find(row), std::string::npos) << row;
  }
}

// --- The other kinds -------------------------------------------------------------------------------------------------

Series some_series() {
  return Series{"c", "drift", {"t", "drift"}, {"s", ""}, {{0.0, 0.1}, {1.0, nan}}};
}

TEST(Series, ReadsBack) {
  Json const json = to_json(some_series());
  EXPECT_EQ(json.dump(), R"({"schema":1,"kind":"series","cell":"c","name":"drift","columns":["t","drift"],)"
                         R"("units":["s",""],"rows":[[0.0,0.1],[1.0,null]]})");
  Series const back = series_from_json(through_text(json));
  EXPECT_EQ(to_json(back).dump(), json.dump());
  EXPECT_TRUE(std::isnan(back.rows.at(1).at(1)));
}

TEST(Series, MalformedInputIsNamed) {
  auto const spoilt = [](std::string const& field, Json value) {
    Json json = to_json(some_series());
    json[field] = std::move(value);
    return message_of([&] { series_from_json(json); });
  };
  EXPECT_EQ(spoilt("kind", "run"), "kind: \"run\"; must be \"series\" here");
  EXPECT_EQ(spoilt("columns", 1), "columns: 1; must be an array");
  EXPECT_EQ(spoilt("units", Json::parse("[1, 2]")), "units[0]: 1; must be a string");
  EXPECT_EQ(spoilt("units", Json::parse(R"(["s"])")), "units: 1 units for 2 columns; must be one per column");
  EXPECT_EQ(spoilt("rows", Json::parse("[[0, 1], 2]")), "rows[1]: 2; must be an array of numbers");
  EXPECT_EQ(spoilt("rows", Json::parse(R"([[0, 1], [0, "x"]])")), "rows[1][1]: \"x\"; must be a number or null");
  EXPECT_EQ(spoilt("rows", Json::parse("[[0, 1], [2]]")), "rows[1]: 1 numbers for 2 columns; must be one per column");
  EXPECT_EQ(spoilt("x", 1), "x: unknown field; must be one of schema, kind, cell, name, columns, units, rows");
}

TEST(Series, RaggedOneIsNotWritten) {
  Series series = some_series();
  series.rows[0].push_back(2);
  EXPECT_EQ(message_of([&] { to_json(series); }), "rows[0]: 3 numbers for 2 columns; must be one per column");
}

TEST(Begin, ReadsBack) {
  Json const json = to_json(Begin{"c", "b"});
  EXPECT_EQ(json.dump(), R"({"schema":1,"kind":"begin","cell":"c","build":"b"})");
  Begin const back = begin_from_json(through_text(json));
  EXPECT_EQ(back.cell, "c");
  EXPECT_EQ(back.build, "b");
}

TEST(Meta, ReadsBack) {
  Meta const meta{{"compiler", "g++ 12"}, {"cpu", "a \"fast\" one"}};
  Json const json = to_json(meta);
  EXPECT_EQ(json.dump(), R"({"schema":1,"kind":"meta","compiler":"g++ 12","cpu":"a \"fast\" one"})");
  EXPECT_EQ(meta_from_json(through_text(json)), meta);
}

TEST(Meta, MalformedInputIsNamed) {
  Json json = to_json(Meta{});
  json["cores"] = 2;
  EXPECT_EQ(message_of([&] { meta_from_json(json); }), "cores: 2; must be a string");
  EXPECT_EQ(message_of([] {
              to_json(Meta{{"kind", "x"}});
            }),
            "kind: a name that every record has; must have another name in a meta");
}

TEST(Record, RepetitionsOfATimeComeBackAsTheyWere) {
  Record record = full_record();
  record.cpu_time_s->samples = {1.5, 1.0 / 3, 1.25};
  EXPECT_EQ(record_from_json(through_text(to_json(record))).cpu_time_s->samples, record.cpu_time_s->samples);
}

}  // namespace
