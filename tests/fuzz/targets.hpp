#pragma once
/// The readers of files that come from outside. Whatever the bytes, a reader returns or throws the exception of its
/// kind: anything else (another exception, a signal, a sanitizer's report) is a bug.
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "bench/suite.hpp"
#include "bench/trajectory.hpp"
#include "problems/graph.hpp"
#include "results/store.hpp"
#include "tests/small_vocabulary.hpp"

namespace polhode::fuzz {

/// One file of this process, written anew for each input.
class File {
 public:
  explicit File(char const* ending)
      : path(std::filesystem::temp_directory_path() / ("polhode_fuzz_" + std::to_string(::getpid()) + ending)) {}
  ~File() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  File(File const&) = delete;
  File& operator=(File const&) = delete;
  std::filesystem::path const& holding(std::string const& bytes) const {
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  std::filesystem::path path;
};

inline void suite(std::string const& bytes) {
  static File const file(".toml");
  static bench::Vocabulary const words = bench::test::small_vocabulary();
  try {
    static_cast<void>(bench::read_suite(file.holding(bytes), words));
  } catch (bench::SuiteError const&) {
  }
}
inline void records(std::string const& bytes) {
  static File const file(".jsonl");
  try {
    static_cast<void>(results::read(file.holding(bytes)));
  } catch (results::StoreError const&) {
  }
}
inline void trajectory(std::string const& bytes) {
  static bench::ColumnNames const wanted{.required = {"q1", "q2", "q3", "q4", "wx", "wy", "wz"}, .optional = {"s1"}};
  std::istringstream in(bytes);
  try {
    static_cast<void>(bench::read_trajectory(in, "f.csv", wanted));
  } catch (bench::TrajectoryError const&) {
  }
}
inline void graph(std::string const& bytes) {
  static File const file(".txt");
  try {
    Graph const read = graph_of(read_graph(file.holding(bytes)), 20);
    static_cast<void>(strongly_connected(read));
    static_cast<void>(connected(read));
  } catch (ParameterError const&) {
  }
}

struct Target {
  std::string_view name;  ///< of its corpus, too
  void (*run)(std::string const& bytes);
};
inline constexpr std::array targets{Target{"suite", suite}, Target{"records", records},
                                    Target{"trajectory", trajectory}, Target{"graph", graph}};

}  // namespace polhode::fuzz
