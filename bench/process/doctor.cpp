#include "bench/process/doctor.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "bench/process/clock.hpp"
#include "bench/process/machine.hpp"
#include "results/record.hpp"

namespace polhode::bench {
namespace {

namespace fs = std::filesystem;

double number_in(std::string const& text) {
  return text.empty() ? std::nan("") : std::strtod(text.c_str(), nullptr);
}

double percentile(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, std::size_t(part * double(values.size())))];
}

Finding processors(fs::path const& root) {
  Finding finding{"processors", first_line(root / "sys/devices/system/cpu/online"), ""};
  cpu_set_t cpus;
  int const usable = sched_getaffinity(0, sizeof cpus, &cpus) == 0 ? CPU_COUNT(&cpus) : 0;
  finding.value = fmt::format("{} usable (online {})", usable, finding.value.empty() ? "unknown" : finding.value);
  if (usable == 1) finding.trouble = "the only processor serves everything else, too";
  return finding;
}

Finding load_of(fs::path const& root) {
  std::string const line = first_line(root / "proc/loadavg");
  double const running = number_in(line);
  Finding finding{"load", "not readable", ""};
  if (std::isfinite(running)) finding.value = fmt::format("{:.2f} in the last minute", running);
  constexpr double quiet = 0.5;
  if (running > quiet) finding.trouble = "others are computing; wait until the load is below 0.5";
  return finding;
}

void add_frequency(std::vector<Finding>& findings, fs::path const& root) {
  fs::path const cpu = root / "sys/devices/system/cpu";
  if (std::string const governor = first_line(cpu / "cpu0/cpufreq/scaling_governor"); !governor.empty())
    findings.push_back({"governor", governor,
                        governor == "performance" ? ""
                                                  : "the frequency follows the load; `cpupower frequency-set -g "
                                                    "performance` holds it"});
  else
    findings.push_back({"governor", "not readable", ""});
  std::string const no_turbo = first_line(cpu / "intel_pstate/no_turbo"), boost = first_line(cpu / "cpufreq/boost");
  if (no_turbo.empty() && boost.empty()) return;
  bool const turbo = no_turbo == "0" || boost == "1";
  findings.push_back(
      {"turbo", turbo ? "on" : "off", turbo ? "the frequency depends on temperature and neighbours" : ""});
}

void add_throttling(std::vector<Finding>& findings, fs::path const& root) {
  if (std::string const count = first_line(root / "sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count");
      !count.empty())
    findings.push_back({"thermal throttling", count + " times since boot",
                        number_in(count) > 0 ? "the processor has been too hot" : ""});
  fs::path const group = root / "sys/fs/cgroup";
  if (std::string const quota = first_line(group / "cpu.max"); !quota.empty() && !quota.starts_with("max"))
    findings.push_back({"processor quota", quota + " us", "the container is stopped when it has used its share"});
  if (double const throttled = number_in(entry_of(group / "cpu.stat", "nr_throttled")); throttled > 0)
    findings.push_back(
        {"quota throttling", fmt::format("{:.0f} times", throttled), "the container has been stopped for its quota"});
}

}  // namespace

TimerQuality timer_quality() {
  constexpr clockid_t clock = CLOCK_PROCESS_CPUTIME_ID;
  TimerQuality quality{.resolution = 1};
  constexpr int readings = 20'000;
  double const begun = seconds_of(clock);
  double last = begun;
  for (int i = 0; i < readings; ++i) {
    double const now = seconds_of(clock);
    if (now > last) quality.resolution = std::min(quality.resolution, now - last);
    last = now;
  }
  quality.cost = (last - begun) / readings;

  std::vector<double> pieces;
  volatile double sink = 0;
  constexpr int repetitions = 200, work = 300'000;
  for (int i = 0; i < repetitions; ++i) {
    double const start = seconds_of(clock);
    double x = 1;
    for (int k = 0; k < work; ++k) x = x * 1.0000001 + 1e-9;
    sink = x;
    pieces.push_back(seconds_of(clock) - start);
  }
  static_cast<void>(sink);
  quality.jitter = percentile(pieces, 0.95) / percentile(pieces, 0.5) - 1;
  return quality;
}

Finding timer_finding(TimerQuality const& quality) {
  constexpr double steady = 0.05, fine = 1e-6;
  Finding finding{"timer",
                  fmt::format("CPU clock resolves {:.0f} ns, a reading costs {:.0f} ns, equal work scatters by {:.1f}%",
                              1e9 * quality.resolution, 1e9 * quality.cost, 100 * quality.jitter),
                  ""};
  if (quality.resolution > fine) finding.trouble = "the clock is too coarse for solves of microseconds";
  if (quality.jitter > steady) finding.trouble = "equal work does not take equal time: something else is going on";
  return finding;
}

std::vector<Finding> machine_state(fs::path const& root) {
  std::vector<Finding> findings;
  findings.push_back(processors(root));
  findings.push_back(load_of(root));
  add_frequency(findings, root);
  add_throttling(findings, root);
  findings.push_back({"virtual machine", is_virtual(root) ? "yes" : "no",
                      is_virtual(root) ? "neighbours cannot be seen from here" : ""});
  double const available = number_in(entry_of(root / "proc/meminfo", "MemAvailable")) / (1 << 20);
  if (std::isfinite(available)) findings.push_back({"memory", fmt::format("{:.1f} GiB available", available), ""});
  return findings;
}

std::string diagnosis_text(std::vector<Finding> const& findings) {
  std::size_t width = 0, troubles = 0;
  for (Finding const& finding : findings) width = std::max(width, finding.name.size());
  std::string text;
  for (Finding const& finding : findings) {
    text += fmt::format("{:<{}}  {}{}\n", finding.name, width, finding.value,
                        finding.trouble.empty() ? "" : "  !! " + finding.trouble);
    troubles += !finding.trouble.empty();
  }
  return text + (troubles == 0
                     ? "fit to take times on\n"
                     : fmt::format("not quite fit to take times on: {} line(s) with !! (errors and counts do not "
                                   "depend on any of this)\n",
                                   troubles));
}

std::string diagnosis_json(std::vector<Finding> const& findings) {
  nlohmann::ordered_json json{
      {"schema", results::schema}, {"fit", true}, {"findings", nlohmann::ordered_json::array()}};
  for (Finding const& finding : findings) {
    if (!finding.trouble.empty()) json["fit"] = false;
    json["findings"].push_back({{"name", finding.name}, {"value", finding.value}, {"trouble", finding.trouble}});
  }
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace polhode::bench
