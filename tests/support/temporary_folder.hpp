#pragma once
/// A folder that goes with its test, and what stands in the files that were written there.
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <system_error>

namespace polhode::test {

/// Byte for byte; empty if the file cannot be read.
inline std::string text_of(std::filesystem::path const& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A new, empty folder that goes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = std::filesystem::temp_directory_path() / "polhode_XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) throw std::system_error(errno, std::generic_category(), name);
    path = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  TemporaryFolder(TemporaryFolder const&) = delete;
  TemporaryFolder& operator=(TemporaryFolder const&) = delete;

  /// Writes a file below, in folders that are made if need be. Returns its path.
  std::filesystem::path write(std::filesystem::path const& name, std::string const& text) const {
    std::filesystem::path file = path / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
    return file;
  }
  /// Every file and folder below, with what the files hold.
  std::map<std::string, std::string> contents() const {
    std::map<std::string, std::string> all;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(path))
      all[std::filesystem::relative(entry.path(), path)] = entry.is_regular_file() ? text_of(entry.path()) : "";
    return all;
  }

  std::filesystem::path path;
};

}  // namespace polhode::test
