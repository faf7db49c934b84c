#pragma once
/// Results of a tiny suite, made once for all tests of a fixture.
#include <gtest/gtest.h>

#include "tests/cli/process.hpp"

namespace polhode::cli {

/// Line 1 to 8: 4 cells in one group, of which one is refused.
inline std::string const tiny_suite = R"(name = 'tiny'
timing = { min_time = 0.001, repetitions = 5 }
[[sweep]]
problem = 'free_body'
formulation = ['quaternion', 's3']
integrator = ['rk4', 'gauss2']
h = 0.1
t_end = 5
)";

/// `shared` has the records in results/; each test copies them into a `folder` of its own.
class TinyResults : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared = new Folder;
    shared->write("suite.toml", tiny_suite);
    Result const result = polhode(*shared, "run suite.toml --out results");
    ASSERT_EQ(result.code, 0) << result.err;
  }
  static void TearDownTestSuite() { delete shared; }

  void copy_results_to(char const* name) const {
    fs::copy(shared->path / "results", folder.path / name, fs::copy_options::recursive);
  }

  static inline Folder* shared = nullptr;
  Folder folder;
};

}  // namespace polhode::cli
