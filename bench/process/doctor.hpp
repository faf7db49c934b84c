#pragma once
/// What is built into this binary, and whether this machine is fit to take times on.
#include <filesystem>
#include <string>
#include <vector>

namespace polhode::bench {

/// One line of the diagnosis.
struct Finding {
  std::string name, value;
  std::string trouble;  ///< why times taken here would suffer; empty if they do not
};

/// How well a fixed piece of work can be timed.
struct TimerQuality {
  double resolution = 0;  ///< smallest difference of two readings of the CPU clock [s]
  double cost = 0;        ///< of a reading [s]
  double jitter = 0;      ///< 95th percentile over median of equal pieces of work, less 1
};
/// Takes about 0.2 s.
TimerQuality timer_quality();

/// Compiler, flags, libraries, what rivals there are and are not, vector registers, where the data are.
std::vector<Finding> what_is_built();
/// Processors, load, frequency, throttling, memory; what the machine does not tell is absent. `root` is / but for
/// tests: the folder that has proc/ and sys/.
std::vector<Finding> machine_state(std::filesystem::path const& root);
/// The timer, judged.
Finding timer_finding(TimerQuality const& quality);

/// One line each, and the verdict; the same as JSON: {schema, fit, findings: [{name, value, trouble}]}.
std::string diagnosis_text(std::vector<Finding> const& findings);
std::string diagnosis_json(std::vector<Finding> const& findings);

}  // namespace polhode::bench
