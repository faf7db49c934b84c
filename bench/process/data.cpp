#include "bench/process/data.hpp"

#include <algorithm>
#include <cstdlib>

#include "bench/process/additions.hpp"
#include "bench/process/messages.hpp"
#include "build_info.hpp"  // written by the build: the source folder

namespace polhode::bench {
namespace {

std::filesystem::path executable() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

std::filesystem::path data_folder(char const* inside_share, char const* inside_source) {
  if (char const* chosen = std::getenv("POLHODE_DATA")) return std::filesystem::path(chosen) / inside_share;
  auto const installed = executable().parent_path().parent_path() / "share" / "polhode" / inside_share;
  if (std::filesystem::is_directory(installed)) return installed;
  if (!additions().data.empty()) return std::filesystem::path(additions().data) / inside_share;
  return std::filesystem::path(build_info::source_folder) / inside_source;
}

}  // namespace

std::filesystem::path suites_folder() {
  return data_folder("suites", "bench/suites");
}
std::filesystem::path references_folder() {
  return data_folder("reference", "results/reference");
}

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  if (!std::filesystem::is_directory(suites_folder())) return names;
  for (auto const& entry : std::filesystem::directory_iterator(suites_folder()))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

std::filesystem::path suite_file(std::string const& name_or_file) {
  std::filesystem::path const built_in = suites_folder() / (name_or_file + ".toml");
  bool const is_name = name_or_file.find_first_of("./") == std::string::npos;
  if (is_name && std::filesystem::exists(built_in)) return built_in;
  if (!is_name || std::filesystem::exists(name_or_file)) return name_or_file;
  throw UsageError(unknown("suite", name_or_file, suite_names()));
}

}  // namespace polhode::bench
