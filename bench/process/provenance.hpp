#pragma once
/// Where a number comes from: binary, compiler, libraries, machine. Goes into the meta record of every file.
#include <filesystem>
#include <string>

#include "results/record.hpp"

namespace polhode::bench {

/// The version of this program.
std::string version();
/// What `--version` prints: version, commit, compiler, libraries, and what their licences mean for this binary.
std::string version_text();
/// Identifies this very binary: the hash of the executable. Records of another build are never taken for its own.
std::string const& build_id();
/// Everything known about this process and machine; what the machine does not tell is absent.
results::Meta provenance();
/// Where a file stands in the repository in which the run is started, or, without one, below the folder where it is;
/// empty for one outside. There a CI server marks what `check` finds.
std::string path_in_repository(std::filesystem::path const& file);

}  // namespace polhode::bench
