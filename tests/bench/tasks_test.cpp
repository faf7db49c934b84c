// The cells of a suite on their way through a run.
#include "bench/job/tasks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace polhode::bench {
namespace {

SuiteCell free_body(double t_end, std::vector<std::string> const& tags, bool reference) {
  results::Cell cell;
  cell.problem = "free_body";
  cell.formulation = "quaternion";
  cell.integrator = "rk4";
  cell.h = 0.1;
  cell.t_end = t_end;
  return {.cell = cell, .tags = tags, .reference = reference};
}

Suite suite_of(std::vector<SuiteCell> const& cells) {
  Suite suite;
  suite.name = "mine";
  suite.cells = cells;
  return suite;
}

// Two sweeps of one problem, one of which writes its horizon out: neither may take from the other what it asks for.
TEST(Tasks, EqualCellsAreOneWithWhatEachAsksFor) {
  for (bool const written_first : {true, false}) {
    auto const tasks = tasks_of(
        suite_of({free_body(written_first ? 50 : 0, {}, true), free_body(written_first ? 0 : 50, {"history"}, false)}),
        "");
    ASSERT_EQ(tasks.size(), 1U);
    EXPECT_TRUE(tasks[0].keep_history);
    EXPECT_TRUE(tasks[0].prepared.reference);
    EXPECT_EQ(tasks[0].prepared.cell.t_end, 50);
  }
}

TEST(Tasks, ShardsAreDisjointAndTogetherTheWhole) {
  Suite const suite = suite_of({free_body(1, {}, true), free_body(2, {}, true), free_body(3, {}, true)});
  std::set<std::string> ids;
  for (int shard = 1; shard <= 2; ++shard) {
    auto tasks = tasks_of(suite, "");
    take_shard(tasks, shard, 2);
    EXPECT_EQ(tasks.size(), shard == 1 ? 2U : 1U);
    for (Task const& task : tasks) EXPECT_TRUE(ids.insert(task.id).second);
  }
  EXPECT_EQ(ids.size(), 3U);
  auto tasks = tasks_of(suite, "");
  EXPECT_THROW(take_shard(tasks, 4, 4), NothingSelected);
}

TEST(Tasks, MistakesAreTold) {
  Suite const suite = suite_of({free_body(1, {}, true)});
  EXPECT_THROW(tasks_of(suite, "("), UsageError);
  EXPECT_THROW(tasks_of(suite, "pd_slew"), NothingSelected);
  SuiteCell wrong = free_body(1, {}, true);
  wrong.cell.set["inertia"] = {1, 1, 3};
  EXPECT_THROW(tasks_of(suite_of({wrong}), ""), SuiteError);
}

}  // namespace
}  // namespace polhode::bench
