#pragma once
/// The files that Polhode brings with it: suites and references.
#include <filesystem>
#include <string>
#include <vector>

namespace polhode::bench {

/// Their folders: in $POLHODE_DATA, else in share/polhode beside the installed binary, else in that of the Polhode that
/// a binary with additions was built against, else in the source tree.
std::filesystem::path suites_folder();
std::filesystem::path references_folder();

/// The names of the built-in suites, sorted.
std::vector<std::string> suite_names();
/// The suite of that name among the built-in ones, or that file. Throws UsageError for a name that is neither.
std::filesystem::path suite_file(std::string const& name_or_file);

}  // namespace polhode::bench
