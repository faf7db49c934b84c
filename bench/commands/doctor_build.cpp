/// What is built into this binary.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "bench/cell/cell.hpp"
#include "bench/job/channel.hpp"
#include "bench/process/data.hpp"
#include "bench/process/doctor.hpp"
#include "bench/process/provenance.hpp"
#include "integrators/ensemble.hpp"

namespace polhode::bench {
namespace {

/// Rivals by why they are not here; "" for those that are.
std::map<std::string, std::vector<std::string>> rivals() {
  std::map<std::string, std::vector<std::string>> by_reason;
  for (IntegratorWord const& word : vocabulary().integrators)
    if (word.rival) by_reason[word.not_built].push_back(word.name);
  return by_reason;
}

}  // namespace

std::vector<Finding> what_is_built() {
  results::Meta const meta = provenance();
  std::vector<Finding> findings;
  bool const dirty = meta.at("git_dirty") == "true";
  findings.push_back({"polhode",
                      fmt::format("{} ({}{}), build {}", meta.at("version"), meta.at("git_commit"),
                                  dirty ? ", modified" : "", meta.at("build")),
                      ""});
  findings.push_back({"compiler", meta.at("compiler"), ""});
  std::string const& flags = meta.at("flags");
  bool const optimised = flags.find("-O2") != std::string::npos || flags.find("-O3") != std::string::npos;
  findings.push_back({"flags", flags, optimised ? "" : "not optimised; build with the preset `bench`"});
  findings.push_back({"libraries", meta.at("libraries"), ""});
  for (auto const& [reason, names] : rivals())
    findings.push_back({reason.empty() ? "rivals" : "rivals left out",
                        fmt::format("{}{}", fmt::join(names, " "), reason.empty() ? "" : " (" + reason + ")"), ""});
#ifdef POLHODE_RACES
  findings.push_back({"timed runs", "built in", ""});
#else
  findings.push_back({"timed runs", "not built (POLHODE_RACES=OFF)", "nothing is timed"});
#endif
  std::string const mpi = mpi_version();
  findings.push_back({"mpi", mpi.empty() ? "not built (POLHODE_MPI=OFF): one machine, or shards" : mpi, ""});
  findings.push_back(
      {"vectors",
       fmt::format("{} bytes everywhere; ensembles {}, {} bytes on this machine", register_bytes,
                   chooses_registers ? "choose at run time" : "are compiled for one instruction set",
                   widest_registers() == Registers::of_the_unit ? register_bytes : int(widest_registers())),
       ""});
  bool const data = !suite_names().empty() && std::filesystem::is_directory(references_folder());
  findings.push_back(
      {"data", fmt::format("{} suites in {}", suite_names().size(), suites_folder().string()),
       data ? "" : "suites or references are missing: references are made on the fly; set POLHODE_DATA"});
  return findings;
}

}  // namespace polhode::bench
