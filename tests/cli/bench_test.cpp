/// polhode-bench as a script meets it.
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "results/benchmarks.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode {
namespace {

struct Printed {
  int code = -1;
  std::string out;
};
Printed bench(std::string const& words) {
  Printed printed;
  std::FILE* const pipe = ::popen((std::string(POLHODE_BENCH_BINARY) + " " + words + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return printed;
  char part[4096];
  for (std::size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) printed.out.append(part, n);
  int const status = ::pclose(pipe);
  printed.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return printed;
}
std::string const brief = " --benchmark_min_time=0.001 --benchmark_repetitions=2 --benchmark_filter=";

TEST(CliBench, JsonIsNothingButJson) {
  Printed const printed = bench("--benchmark_format=json" + brief + "^twin/");
  ASSERT_EQ(printed.code, 0);
  auto const json = nlohmann::json::parse(printed.out);
  EXPECT_FALSE(json.at("benchmarks").empty());
}
TEST(CliBench, TheTableEndsWithTheRatios) {
  Printed const printed = bench(brief + "'^twin/|^ensemble/free_body/(rk4|odeint_rk4)$'");
  ASSERT_EQ(printed.code, 0);
  EXPECT_NE(printed.out.find("ratios of median times"), std::string::npos);
  EXPECT_NE(printed.out.find("generic source / written by hand"), std::string::npos);
  EXPECT_NE(printed.out.find("ensemble / Odeint's loop"), std::string::npos);
}
TEST(CliBench, EveryRepetitionIsPrintedIfAskedFor) {
  Printed const few = bench("--benchmark_format=json" + brief + "^twin/");
  Printed const all = bench("--benchmark_format=json --benchmark_report_aggregates_only=false" + brief + "^twin/");
  auto const count = [](Printed const& printed) { return nlohmann::json::parse(printed.out).at("benchmarks").size(); };
  EXPECT_EQ(count(all), count(few) + 2 * 2) << "two benchmarks, two repetitions";
}
TEST(CliBench, TheFolderGetsWhatWasMeasured) {
  test::TemporaryFolder const top;
  std::filesystem::path const folder = top.path / "bench out";
  Printed const printed = bench("--out '" + folder.string() + "'" + brief + "^twin/");
  ASSERT_EQ(printed.code, 0);
  results::Benchmarks const read = results::read_benchmarks(folder);
  ASSERT_EQ(read.all.size(), 2U);
  EXPECT_TRUE(read.meta.contains("compiler"));
  results::Benchmark const* generic = read.find("twin/free_body/rk4/generic");
  ASSERT_NE(generic, nullptr);
  EXPECT_EQ(generic->time.repetitions, 2);
  EXPECT_EQ(generic->time.samples.size(), 2U);
  EXPECT_NEAR(generic->counters.at("per_step"), generic->time.median / 5000, 1e-6 * generic->time.median);
}
TEST(CliBench, AFolderThatCannotBeIsAnError) {
  EXPECT_EQ(bench("--out").code, 2);
  EXPECT_EQ(bench("--out=").code, 2);
  EXPECT_EQ(bench("--out /dev/null/x" + brief + "^twin/").code, 5);
}

TEST(CliBench, AFilterThatMatchesNothingIsSaidSo) {
  EXPECT_EQ(bench(brief + "no_such_benchmark").code, 3);
}

}  // namespace
}  // namespace polhode
