#include "bench/process/provenance.hpp"

#include <benchmark/benchmark.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sched.h>
#include <sys/utsname.h>

#include <Eigen/Core>
#include <boost/version.hpp>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/process/additions.hpp"
#include "bench/process/machine.hpp"
#include "build_info.hpp"  // written by the build: version, commit, flags

#ifdef POLHODE_HAS_SUNDIALS
#include <sundials/sundials_version.h>
#endif
#ifdef POLHODE_HAS_GSL
#include <gsl/gsl_version.h>
#endif

namespace polhode::bench {
namespace {

std::string libraries() {
  std::string list =
      fmt::format("eigen {}.{}.{}, boost {}.{}, fmt {}.{}.{}, nlohmann_json {}.{}.{}", EIGEN_WORLD_VERSION,
                  EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000,
                  FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100, NLOHMANN_JSON_VERSION_MAJOR,
                  NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
#ifdef POLHODE_HAS_SUNDIALS
  std::array<char, 64> sundials{};
  SUNDIALSGetVersion(sundials.data(), int(sundials.size()));
  list += fmt::format(", sundials {}", sundials.data());
#endif
#ifdef POLHODE_HAS_GSL
  list += fmt::format(", gsl {}", GSL_VERSION);
#endif
  return list;
}

/// "integrators heun; problems damped_body": what this binary adds to Polhode's catalogues. Empty if nothing.
std::string added() {
  Additions const& all = additions();
  std::string text;
  if (!all.integrators.empty()) text = fmt::format("integrators {}", fmt::join(all.integrators, " "));
  if (!all.problems.empty())
    text += fmt::format("{}problems {}", text.empty() ? "" : "; ", fmt::join(all.problems, " "));
  return text;
}

}  // namespace

std::string version() {
  return build_info::version;
}

std::string version_text() {
  std::string text = fmt::format("polhode {} ({}{})\n{}\n{}\n", build_info::version, build_info::commit,
                                 build_info::dirty ? ", modified" : "", build_info::compiler, libraries());
  if (std::string const what = added(); !what.empty()) text += "added: " + what + "\n";
#ifdef POLHODE_HAS_GSL
  text += "Licence: MIT for Polhode's own code; this binary links GSL and is therefore under GPL-3-or-later.\n";
#else
  text += "Licence: MIT; this binary links no GPL code.\n";
#endif
  return text;
}

std::string const& build_id() {
  static std::string const id = [] {
    std::ifstream program("/proc/self/exe", std::ios::binary);
    return results::hash_of(program);
  }();
  return id;
}

results::Meta provenance() {
  results::Meta meta{{"version", build_info::version},
                     {"build", build_id()},
                     {"git_commit", build_info::commit},
                     {"git_dirty", build_info::dirty ? "true" : "false"},
                     {"compiler", build_info::compiler},
                     {"flags", build_info::flags},
                     {"fp_contract", "off"},
                     {"libraries", libraries()},
                     {"utc", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))}};
  auto const note = [&](std::string const& key, std::string const& value) {
    if (!value.empty()) meta[key] = value;
  };
  std::filesystem::path const processor = "/proc/cpuinfo";
  note("cpu_model", entry_of(processor, "model name"));
  note("cpu_cache", entry_of(processor, "cache size"));
  note("cpu_mhz", entry_of(processor, "cpu MHz"));  // as it says now: nominal in most virtual machines
  note("cpu_governor", first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor"));
  note("load", first_line("/proc/loadavg"));
  note("virtualised", is_virtual() ? "true" : "false");
  note("added", added());
  cpu_set_t cpus;
  if (sched_getaffinity(0, sizeof cpus, &cpus) == 0) note("cpus_available", std::to_string(CPU_COUNT(&cpus)));
  utsname system{};
  if (uname(&system) == 0) {
    note("host", system.nodename);
    note("kernel", fmt::format("{} {} {}", system.sysname, system.release, system.machine));
  }
  return meta;
}

std::string path_in_repository(std::filesystem::path const& file) {
  std::error_code none;
  std::filesystem::path const here = std::filesystem::current_path(none);
  auto const is_top = [&](std::filesystem::path const& folder) {
    return std::filesystem::exists(folder / ".git", none);
  };
  std::filesystem::path top = here;
  while (!is_top(top) && top.has_relative_path()) top = top.parent_path();
  std::filesystem::path const path = std::filesystem::relative(file, is_top(top) ? top : here, none);
  bool const inside = !file.empty() && !path.empty() && *path.begin() != "..";
  return inside ? path.generic_string() : "";
}

}  // namespace polhode::bench
