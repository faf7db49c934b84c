// The memory of a run grows with its cells by a few kB each, whatever they do. bench/README.md has the figures.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cli/process.hpp"

namespace polhode::cli {
namespace {

/// A suite of so many cells that take a millisecond each.
std::string suite_of(int cells, std::string const& more) {
  std::string steps;
  for (int i = 0; i < cells; ++i) steps += fmt::format("{}{}", i == 0 ? "" : ", ", 0.002 + 1e-7 * i);
  return "name = 'many'\ntiming = { enabled = false }\n[[sweep]]\nproblem = 'free_body'\nformulation = 'quaternion'\n"
         "integrator = 'rk4'\nt_end = 1\nreference = false\n" +
         more + "h = [" + steps + "]\n";
}

/// The memory of a run of such a suite, and of one more that finds nothing to do [kB].
struct Memory {
  long run, resume;
};
Memory memory_of(Folder const& folder, int cells, std::string const& more) {
  std::string const name = fmt::format("{}-{}", cells, more.empty() ? "plain" : "kept");
  folder.write(name + ".toml", suite_of(cells, more));
  Result const first = polhode(folder, fmt::format("run {0}.toml --out {0} --threads 1", name));
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out, fmt::format("{}: {} cells: {} ok, 0 refused, 0 failed, 0 already done\n", name, cells, cells));
  Result const second = polhode(folder, fmt::format("run {0}.toml --out {0} --threads 1", name));
  EXPECT_EQ(second.code, 0) << second.err;
  return {first.memory, second.memory};
}

TEST(CliMemory, OfCellsIsAFewKilobytesEach) {
  Folder const folder;
  constexpr int few = 100, many = 1100;
  Memory const less = memory_of(folder, few, ""), more = memory_of(folder, many, "");
  EXPECT_LT(less.run, 40'000);                              // 16 MB were measured
  EXPECT_LT(more.run - less.run, 12 * (many - few));        // 6.5 kB each were measured
  EXPECT_LT(more.resume - less.resume, 25 * (many - few));  // 7 kB each
  EXPECT_GT(more.run - less.run, many - few);               // what is measured is this process
}

TEST(CliMemory, OfHistoriesIsBounded) {
  Folder const folder;
  constexpr int few = 10, many = 210;
  std::string const kept = "tags = ['history']\n";
  Memory const less = memory_of(folder, few, kept), more = memory_of(folder, many, kept);
  EXPECT_LT(more.run - less.run, 120 * (many - few));        // 500 rows of 12 numbers are 48 kB
  EXPECT_LT(more.resume - less.resume, 250 * (many - few));  // 43 kB each were measured
}

}  // namespace
}  // namespace polhode::cli
