// What a run is held against, or why it is held against nothing.
#include "bench/cell/references.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "bench/input/cell_flags.hpp"
#include "bench/process/data.hpp"

namespace polhode::bench {
namespace {

// Its segments, of seconds, are nothing beside the horizon. It once ended the whole run.
TEST(References, AProblemWhoseSeriesDoesNotArriveHasNone) {
  results::Cell cell;
  cell.problem = "free_body";
  cell.formulation = "quaternion";
  cell.integrator = "rk4";
  cell.h = 1e9;
  cell.t_end = 1e12;
  References references("no committed ones");
  auto const [reference, why_none] = references.of(prepare(cell));
  EXPECT_EQ(reference, nullptr);
  EXPECT_THAT(why_none, testing::HasSubstr("no useful radius of convergence"));
}

// Without one, whoever scores a trajectory waits for it to be made.
TEST(References, EveryProblemsDefaultHasACommittedOne) {
  std::set<std::string> const without{"dead_zone"};  // as printed, it is too stiff to be certified
  for (ProblemWord const& problem : vocabulary().problems) {
    results::Cell cell;
    cell.problem = problem.name;
    std::string const id = reference_id(prepare(physics_alone(cell)).physics);
    bool const committed = std::filesystem::exists(references_folder() / (id + ".json"));
    EXPECT_EQ(committed, !without.contains(problem.name)) << problem.name;
  }
}

}  // namespace
}  // namespace polhode::bench
