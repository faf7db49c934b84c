// Whether a machine is fit to take times on, told from files as Linux writes them.
#include "bench/process/doctor.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"

namespace polhode::bench {
namespace {

/// A folder with proc/ and sys/ of a quiet machine.
struct Machine : testing::Test {
  Machine() {
    write("proc/loadavg", "0.05 0.10 0.20 1/200 4711\n");
    write("proc/cpuinfo", "processor\t: 0\nflags\t\t: fpu sse2 avx2\n");
    write("proc/meminfo", "MemTotal:       33554432 kB\nMemAvailable:   16777216 kB\n");
    write("sys/devices/system/cpu/online", "0-7\n");
    write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
    write("sys/devices/system/cpu/intel_pstate/no_turbo", "1\n");
    write("sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count", "0\n");
    write("sys/fs/cgroup/cpu.max", "max 100000\n");
    write("sys/fs/cgroup/cpu.stat", "usage_usec 1\nnr_throttled 0\n");
  }
  void write(std::string const& name, std::string const& text) const { folder.write(name, text); }
  /// Troubles by the name of the finding; that there is one processor alone is this machine's, not the folder's.
  std::map<std::string, std::string> troubles() const {
    std::map<std::string, std::string> found;
    for (Finding const& finding : machine_state(root))
      if (!finding.trouble.empty() && finding.name != "processors") found[finding.name] = finding.value;
    return found;
  }
  polhode::test::TemporaryFolder folder;
  std::filesystem::path const root = folder.path;
};

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST_F(Machine, QuietIsFit) {
  EXPECT_THAT(troubles(), IsEmpty());
  auto const findings = machine_state(root);
  auto const memory = std::ranges::find(findings, "memory", &Finding::name);
  ASSERT_NE(memory, findings.end());
  EXPECT_EQ(memory->value, "16.0 GiB available");
}

TEST_F(Machine, EachTroubleIsFound) {
  write("proc/loadavg", "3.50 1 1 1/1 1\n");
  EXPECT_THAT(troubles(), ElementsAre(Pair("load", "3.50 in the last minute")));
  write("proc/loadavg", "0.00 1 1 1/1 1\n");
  write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
  EXPECT_THAT(troubles(), ElementsAre(Pair("governor", "powersave")));
  write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
  write("sys/devices/system/cpu/intel_pstate/no_turbo", "0\n");
  EXPECT_THAT(troubles(), ElementsAre(Pair("turbo", "on")));
  write("sys/devices/system/cpu/intel_pstate/no_turbo", "1\n");
  write("sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count", "12\n");
  EXPECT_THAT(troubles(), ElementsAre(Pair("thermal throttling", "12 times since boot")));
  write("sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count", "0\n");
  write("sys/fs/cgroup/cpu.max", "50000 100000\n");
  write("sys/fs/cgroup/cpu.stat", "nr_periods 9\nnr_throttled 7\n");
  EXPECT_THAT(troubles(), ElementsAre(Pair("processor quota", "50000 100000 us"), Pair("quota throttling", "7 times")));
  write("sys/fs/cgroup/cpu.max", "max 100000\n");
  write("sys/fs/cgroup/cpu.stat", "nr_throttled 0\n");
  write("proc/cpuinfo", "flags\t\t: fpu hypervisor sse2\n");
  EXPECT_THAT(troubles(), ElementsAre(Pair("virtual machine", "yes")));
}

TEST_F(Machine, WhatIsNotReadableIsNoTrouble) {
  std::filesystem::remove_all(root / "sys");
  std::filesystem::remove_all(root / "proc");
  EXPECT_THAT(troubles(), IsEmpty());
}

TEST(Timer, IsJudgedByItsResolutionAndScatter) {
  EXPECT_EQ(timer_finding({.resolution = 1e-8, .cost = 2e-8, .jitter = 0.01}).trouble, "");
  EXPECT_NE(timer_finding({.resolution = 1e-3, .cost = 2e-8, .jitter = 0.01}).trouble, "");
  EXPECT_NE(timer_finding({.resolution = 1e-8, .cost = 2e-8, .jitter = 0.2}).trouble, "");
}

TEST(Timer, IsMeasured) {
  TimerQuality const quality = timer_quality();
  EXPECT_GT(quality.resolution, 0);
  EXPECT_LT(quality.resolution, 1e-2);
  EXPECT_GT(quality.cost, 0);
  EXPECT_LT(quality.cost, 1e-3);
  EXPECT_GE(quality.jitter, 0);
}

TEST(Diagnosis, SaysFitOnlyWithoutTrouble) {
  std::vector<Finding> findings{{"a", "1", ""}, {"long name", "2", ""}};
  EXPECT_EQ(diagnosis_text(findings), "a          1\nlong name  2\nfit to take times on\n");
  EXPECT_TRUE(nlohmann::json::parse(diagnosis_json(findings)).at("fit"));
  findings[1].trouble = "too hot";
  EXPECT_THAT(diagnosis_text(findings), testing::HasSubstr("long name  2  !! too hot\nnot quite fit"));
  EXPECT_FALSE(nlohmann::json::parse(diagnosis_json(findings)).at("fit"));
}

}  // namespace
}  // namespace polhode::bench
