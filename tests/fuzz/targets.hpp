#pragma once
/// The readers of files that come from outside. Whatever the bytes, a reader returns or throws the exception of its
/// kind: anything else (another exception, a signal, a sanitizer's report) is a bug.
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bench/cell/certificate.hpp"
#include "bench/input/suite.hpp"
#include "bench/input/trajectory.hpp"
#include "problems/graph.hpp"
#include "results/benchmarks.hpp"
#include "results/ensemble_file.hpp"
#include "results/golden.hpp"
#include "results/store.hpp"
#include "tests/support/small_vocabulary.hpp"

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
    std::filesystem::remove(path);  // a file that is truncated and written again waits for the disk, a new one does not
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  std::filesystem::path path;
};

inline void suite(std::string const& bytes) {
  static File const file(".toml");
  static bench::Vocabulary const words = [] {
    bench::Vocabulary all = bench::test::small_vocabulary();
    all.problems.back().parameters.push_back({"graph", "", {}});
    return all;
  }();
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
  std::istringstream in(bytes);
  try {
    Graph const read = graph_of(read_graph(in, "f.txt"), 20);
    static_cast<void>(strong_connection_fault(read));
    static_cast<void>(node_apart(read));
  } catch (ParameterError const&) {
  }
}
inline void golden(std::string const& bytes) {
  static File const file(".jsonl");
  try {
    static_cast<void>(results::read_golden(file.holding(bytes)));
  } catch (results::StoreError const&) {
  }
}
/// A certificate, and the same with the hash that its contents call for: whoever edits one can compute that.
inline void reference(std::string const& bytes) {
  static File const file(".json");
  auto const load = [](std::string const& text) {
    try {
      static_cast<void>(bench::load(file.holding(text)));
    } catch (bench::ReferenceError const&) {
    }
  };
  load(bytes);
  constexpr int deepest = 20;  // to write what is deeper is the harness's trouble, not the reader's
  auto const shallow = [](int depth, nlohmann::ordered_json::parse_event_t, nlohmann::ordered_json&) {
    return depth <= deepest;
  };
  auto json = nlohmann::ordered_json::parse(bytes, shallow, false);
  if (!json.is_object()) return;
  json.erase("hash");
  auto const dump = [&] { return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace); };
  json["hash"] = results::hash_of(dump());
  load(dump());
}
inline void catalogue(std::string const& bytes) {
  try {
    static_cast<void>(results::catalogue_from(bytes));
  } catch (std::invalid_argument const&) {
  }
}
inline void benchmarks(std::string const& bytes) {
  try {
    static_cast<void>(results::benchmarks_from(bytes));
  } catch (std::invalid_argument const&) {
  }
}
inline void ensemble(std::string const& bytes) {
  try {
    static_cast<void>(results::ensemble_from(bytes));
  } catch (std::invalid_argument const&) {
  }
}

struct Target {
  std::string_view name;  ///< of its corpus, too
  void (*run)(std::string const& bytes);
};
inline constexpr std::array targets{
    Target{"suite", suite},         Target{"records", records},       Target{"trajectory", trajectory},
    Target{"graph", graph},         Target{"golden", golden},         Target{"reference", reference},
    Target{"catalogue", catalogue}, Target{"benchmarks", benchmarks}, Target{"ensemble", ensemble}};

inline Target const& target_named(std::string_view name) {
  for (Target const& target : targets)
    if (target.name == name) return target;
  throw std::invalid_argument("no reader is called " + std::string(name));
}

}  // namespace polhode::fuzz
