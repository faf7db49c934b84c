#include "bench/process/machine.hpp"

#include <algorithm>
#include <fstream>

namespace polhode::bench {

std::string first_line(std::filesystem::path const& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string entry_of(std::filesystem::path const& file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(key)) return line.substr(std::min(line.size(), line.find_first_not_of(" \t:", key.size())));
  return {};
}

bool is_virtual(std::filesystem::path const& root) {
  return entry_of(root / "proc/cpuinfo", "flags").find(" hypervisor") != std::string::npos;
}

}  // namespace polhode::bench
