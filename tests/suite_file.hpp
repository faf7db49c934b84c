#pragma once
/// Suites for tests: written to a temporary file and read with the small vocabulary.
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

#include "bench/suite.hpp"
#include "tests/small_vocabulary.hpp"

namespace polhode::bench::test {

/// A file that is there as long as the object is.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string const& text) {
    static std::atomic<int> count = 0;
    auto const name = "polhode_suite_" + std::to_string(getpid()) + "_" + std::to_string(count++) + ".toml";
    path = std::filesystem::temp_directory_path() / name;
    std::ofstream(path, std::ios::binary) << text;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  TemporaryFile(TemporaryFile const&) = delete;
  TemporaryFile& operator=(TemporaryFile const&) = delete;

  std::filesystem::path path;
};

inline Suite read(std::string const& text) {
  TemporaryFile const file(text);
  return read_suite(file.path, small_vocabulary());
}

/// Line 1 of most suites here.
inline std::string const name_line = "name = 'test'\n";
/// Lines 1 to 5: a suite that is good.
inline std::string const good = name_line + "[[sweep]]\nproblem = 'free_body'\nintegrator = 'rk4'\nh = 0.1\n";
/// A suite of one sweep, of which the lines from 3 on are given.
inline std::string sweep(std::string const& lines) {
  return name_line + "[[sweep]]\n" + lines;
}

}  // namespace polhode::bench::test
