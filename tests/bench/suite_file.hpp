#pragma once
/// Suites for tests: written to a temporary file and read with the small vocabulary.
#include <filesystem>
#include <string>

#include "bench/input/suite.hpp"
#include "tests/support/small_vocabulary.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::bench::test {

/// A suite's file that goes with the object.
struct TemporaryFile {
  explicit TemporaryFile(std::string const& text) : path(folder.write("suite.toml", text)) {}

  polhode::test::TemporaryFolder folder;
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
