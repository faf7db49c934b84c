#include "bench/input/suite.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "tests/bench/suite_file.hpp"

namespace polhode::bench {
namespace {

using namespace test;

/// One word per cell: what distinguishes the cells of a test.
template <class Part>
std::vector<std::string> listed(Suite const& suite, Part const& part) {
  std::vector<std::string> words;
  for (auto const& one : suite.cells) words.push_back(part(one.cell));
  return words;
}

std::string control(results::Cell const& cell) {
  std::string text = cell.integrator;
  if (cell.h) text += " h " + std::to_string(*cell.h);
  if (cell.rtol) text += " rtol " + std::to_string(*cell.rtol);
  if (cell.atol) text += " atol " + std::to_string(*cell.atol);
  return text;
}

using Texts = std::vector<std::string>;

TEST(GoodSuite, AReferenceIsMadeForACellIfAnyOfItsSweepsWantsOne) {
  std::string const sweep = "[[sweep]]\nproblem = \"free_body\"\nformulation = \"quaternion\"\nintegrator = \"rk4\"\n";
  auto const suite = read("name = \"mine\"\n" + sweep + "h = [0.1, 0.2]\nreference = false\n" + sweep + "h = 0.2\n");
  ASSERT_EQ(suite.cells.size(), 2u);
  EXPECT_FALSE(suite.cells[0].reference);
  EXPECT_TRUE(suite.cells[1].reference);
}

TEST(GoodSuite, TheWholeFormat) {
  std::string const text = R"(# All that a suite can say.
name = "mine"
[timing]
enabled = false
min_time = 0.5
repetitions = 7
[[sweep]]
problem     = ["free_body"]
variant     = [""]
formulation = ["quaternion", "s3"]
integrator  = ["rk4", "gauss2"]
policy      = ["none", "project"]
h           = { logspace = [0.0125, 0.1], count = 4 }
t_end       = 50.0
set         = [{ inertia = [0.6, 0.8, 1.0] }, {}]
seed        = [1, -7]
tags        = ["quick"]
[[expect]]
select = { integrator = "gauss2" }
norm_drift = { max = 1e-13 }
order = { nominal = true, within = 0.2 }
min_cells = 4
xfail = "a reason"
)";
  auto const suite = read(text);
  EXPECT_EQ(suite.name, "mine");
  EXPECT_EQ(suite.text, text);
  EXPECT_FALSE(suite.timing.enabled);
  EXPECT_EQ(suite.timing.min_time, 0.5);
  EXPECT_EQ(suite.timing.repetitions, 7);
  ASSERT_EQ(suite.cells.size(), 2 * 2 * 2 * 4 * 2 * 2);

  auto const& [first, tags, reference] = suite.cells.front();
  EXPECT_TRUE(reference);
  EXPECT_EQ(first.problem, "free_body");
  EXPECT_EQ(first.variant, "");
  EXPECT_EQ(first.formulation, "quaternion");
  EXPECT_EQ(first.integrator, "rk4");
  EXPECT_EQ(first.policy, "none");
  EXPECT_EQ(first.h, 0.0125);
  EXPECT_EQ(first.rtol, std::nullopt);
  EXPECT_EQ(first.t_end, 50.0);
  EXPECT_EQ(first.set.at("inertia"), (std::vector<double>{0.6, 0.8, 1.0}));
  EXPECT_EQ(first.seed, 1);
  EXPECT_EQ(tags, Texts{"quick"});
  EXPECT_TRUE(suite.cells.back().cell.set.empty());
  EXPECT_EQ(suite.cells.back().cell.seed, -7);

  std::set<std::string> ids;
  for (auto const& one : suite.cells) ids.insert(results::cell_id(one.cell));
  EXPECT_EQ(ids.size(), suite.cells.size());

  ASSERT_EQ(suite.expectations.size(), 1);
  auto const& expectation = suite.expectations.front();
  EXPECT_EQ(expectation.line, 18);
  EXPECT_EQ(expectation.select, (Selector{{"integrator", "gauss2"}}));
  EXPECT_EQ(expectation.min_cells, 4);
  EXPECT_EQ(expectation.xfail, "a reason");
  ASSERT_EQ(expectation.bounds.size(), 2);
  EXPECT_EQ(expectation.bounds[0].field, "norm_drift");
  EXPECT_EQ(expectation.bounds[0].max, 1e-13);
  EXPECT_EQ(expectation.bounds[0].min, std::nullopt);
  EXPECT_EQ(expectation.bounds[1].field, "order");
  EXPECT_TRUE(expectation.bounds[1].nominal);
  EXPECT_EQ(expectation.bounds[1].within, 0.2);
}

TEST(GoodSuite, Defaults) {
  auto const suite = read(sweep("problem = ['free_body', 'pd_slew']\nintegrator = 'rk4'\nh = 1\n"));
  EXPECT_TRUE(suite.timing.enabled);
  EXPECT_EQ(suite.timing.min_time, 0.02);
  EXPECT_EQ(suite.timing.repetitions, 5);
  auto const places =
      listed(suite, [](auto const& cell) { return cell.problem + "/" + cell.variant + "/" + cell.formulation; });
  EXPECT_EQ(places, (Texts{"free_body//quaternion", "free_body//s3", "pd_slew/plain/quaternion"}));
  for (auto const& [cell, tags, reference] : suite.cells) {
    EXPECT_EQ(cell.policy, "none");
    EXPECT_EQ(cell.h, 1.0);
    EXPECT_EQ(cell.t_end, 0) << "the problem's own";
    EXPECT_EQ(cell.seed, 1);
    EXPECT_TRUE(tags.empty());
  }
}

TEST(GoodSuite, LogspaceIsGeometricWithExactEnds) {
  auto const suite =
      read(sweep("problem = 'pd_slew'\nintegrator = 'rk4'\nh = { logspace = [0.0125, 0.1], count = 4 }\n"));
  ASSERT_EQ(suite.cells.size(), 4);
  EXPECT_EQ(suite.cells[0].cell.h, 0.0125);
  EXPECT_EQ(suite.cells[1].cell.h, 0.025) << "the number that a person would write";
  EXPECT_EQ(suite.cells[2].cell.h, 0.05);
  EXPECT_EQ(suite.cells[3].cell.h, 0.1);

  auto const falling =
      read(sweep("problem = 'pd_slew'\nintegrator = 'dopri5'\nrtol = { logspace = [0.3, 7e-13], count = 100 }\n"));
  ASSERT_EQ(falling.cells.size(), 100);
  EXPECT_EQ(falling.cells.front().cell.rtol, 0.3);
  EXPECT_EQ(falling.cells.back().cell.rtol, 7e-13);
  double const ratio = std::pow(7e-13 / 0.3, 1.0 / 99);
  for (std::size_t i = 1; i < 100; ++i) {
    EXPECT_NEAR(*falling.cells[i].cell.rtol / *falling.cells[i - 1].cell.rtol, ratio, 1e-13);
  }
}

TEST(GoodSuite, EachIntegratorGetsTheControlsThatSuitIt) {
  auto const suite = read(sweep(R"(problem = 'pd_slew'
integrator = ['rk4', 'dopri5', 'cvode_bdf']
h = [0.5, 0.25]
rtol = 0.125
)"));
  std::string const adaptive = " rtol 0.125000 atol 0.001250";
  EXPECT_EQ(listed(suite, control), (Texts{"rk4 h 0.500000", "rk4 h 0.250000", "dopri5 h 0.500000", "dopri5 h 0.250000",
                                           "dopri5" + adaptive, "cvode_bdf" + adaptive}));

  auto const fixed = read(sweep("problem = 'pd_slew'\nintegrator = ['rk4', 'cvode_bdf']\nh = 0.5\n"));
  EXPECT_EQ(listed(fixed, control), Texts{"rk4 h 0.500000"});

  auto const floors =
      read(sweep("problem = 'pd_slew'\nintegrator = 'dopri5'\nrtol = [0.5, 0.25]\natol = [0.125, 1]\n"));
  EXPECT_EQ(listed(floors, control),
            (Texts{"dopri5 rtol 0.500000 atol 0.125000", "dopri5 rtol 0.500000 atol 1.000000",
                   "dopri5 rtol 0.250000 atol 0.125000", "dopri5 rtol 0.250000 atol 1.000000"}));
}

TEST(GoodSuite, VariantsBecomeCanonicalAndDuplicatesOne) {
  auto const suite = read(sweep(R"(problem = 'tether_capture'
variant = ['', 'case1', 'g1,case1', 'as_printed,case2']
formulation = 's3'
integrator = 'rk4'
h = 0.5
)"));
  EXPECT_EQ(listed(suite, [](auto const& cell) { return cell.variant; }), (Texts{"case1,g1", "case2,g1,as_printed"}));
}

TEST(GoodSuite, WildcardsStandForEveryIntegratorThatMatches) {
  auto const suite = read(sweep("problem = 'pd_slew'\nintegrator = ['[rg]*', 'rk4']\nh = 0.5\n"));
  EXPECT_EQ(listed(suite, [](auto const& cell) { return cell.integrator; }), (Texts{"rk4", "gauss2"}));
}

TEST(GoodSuite, DuplicatesUniteTheirTags) {
  std::string const second =
      "[[sweep]]\nproblem = 'free_body'\nintegrator = 'rk4'\nformulation = 's3'\nh = [0.1, 0.2]\n";
  auto const suite = read(good + "tags = ['a', 'b']\n" + second + "tags = ['b', 'c']\n");
  ASSERT_EQ(suite.cells.size(), 3);
  EXPECT_EQ(suite.cells[0].tags, (Texts{"a", "b"}));
  EXPECT_EQ(suite.cells[1].tags, (Texts{"a", "b", "c"})) << "in both sweeps";
  EXPECT_EQ(suite.cells[2].tags, (Texts{"b", "c"}));
}

/// What is left of a sweep after an exclusion, as "problem integrator h".
Texts left_after(std::string const& exclusion) {
  auto const suite = read(sweep(R"(problem = ['free_body', 'pd_slew']
formulation = 'quaternion'
integrator = ['rk4', 'gauss2']
h = [0.5, 0.25]
t_end = [10, 20]
tags = 'first'
)" + exclusion));
  std::set<std::string> left;
  for (auto const& [cell, tags, reference] : suite.cells) {
    left.insert(cell.problem.substr(0, 2) + " " + cell.integrator.substr(0, 1) + " " +
                (*cell.h == 0.5 ? "long" : "short"));
  }
  return Texts(left.begin(), left.end());
}

TEST(GoodSuite, Exclusions) {
  EXPECT_EQ(left_after("").size(), 8);
  EXPECT_EQ(left_after("[[exclude]]\nproblem = 'free*'\nintegrator = '[!g]*'\n"),
            (Texts{"fr g long", "fr g short", "pd g long", "pd g short", "pd r long", "pd r short"}));
  Texts const without_long{"fr g short", "fr r short", "pd g short", "pd r short"};
  for (std::string const h : {"0.5", "0.50", "5e-1", "'0.5'", "'5e-1'", "'0.5*'", "0.5000000000000001"}) {
    EXPECT_EQ(left_after("[[exclude]]\nh = " + h + "\n"), without_long) << h;
  }
  EXPECT_EQ(left_after("[[exclude]]\nh = 0.50000001\n").size(), 8);
  EXPECT_EQ(left_after("[[exclude]]\nt_end = 10\n[[exclude]]\nt_end = 20.0\nproblem = 'pd_slew'\n"),
            (Texts{"fr g long", "fr g short", "fr r long", "fr r short"}));
  EXPECT_EQ(left_after("[[exclude]]\nrtol = '*'\n").size(), 8) << "null answers to nothing";
  EXPECT_TRUE(left_after("[[exclude]]\ntag = 'f?rst'\n").empty()) << "a suite without cells is not a bad suite";
}

TEST(GoodSuite, Expectations) {
  auto const suite = read(good + R"(tags = ['quick']
[[expect]]
select = { tag = "quick", h = 0.10 }
steps.golden = true
steps.rel = 0.02
status = { is = "ok" }
rejected = { is = 0 }
attitude_error_max = { min = 1e-9, max = 1, golden = true, digits = 2, abs = 1e-15 }
[[expect]]
select = {}
order = { min = 3.5, max = 4.5 }
)");
  ASSERT_EQ(suite.expectations.size(), 2);
  auto const& [first, second] = std::pair(suite.expectations[0], suite.expectations[1]);
  EXPECT_EQ(first.select, (Selector{{"tag", "quick"}, {"h", "0.1"}}));
  EXPECT_EQ(first.min_cells, 1);
  EXPECT_EQ(first.xfail, std::nullopt);
  ASSERT_EQ(first.bounds.size(), 4);
  auto const bound = [&, &bounds = first.bounds](std::string const& field) {
    return *std::find_if(bounds.begin(), bounds.end(), [&](auto const& one) { return one.field == field; });
  };
  EXPECT_TRUE(bound("steps").golden);
  EXPECT_EQ(bound("steps").rel, 0.02);
  EXPECT_EQ(bound("status").is, "ok");
  EXPECT_EQ(bound("rejected").is, "0");
  EXPECT_EQ(bound("attitude_error_max").min, 1e-9);
  EXPECT_EQ(bound("attitude_error_max").digits, 2);
  EXPECT_EQ(bound("attitude_error_max").abs, 1e-15);

  EXPECT_EQ(second.line, 14);
  EXPECT_TRUE(second.select.empty());
  EXPECT_FALSE(second.bounds.front().nominal);
  EXPECT_EQ(second.bounds.front().max, 4.5);
}

TEST(Matches, EveryKey) {
  SuiteCell cell;
  cell.cell.problem = "tether_capture";
  cell.cell.variant = "case2,g1,as_printed";
  cell.cell.formulation = "s3";
  cell.cell.integrator = "dopri5";
  cell.cell.rtol = 1e-6;
  cell.cell.atol = 1e-8;
  cell.cell.set["inertia"] = {1, 2, 2.5};
  cell.cell.set["sample_period"] = {0.1};
  cell.cell.seed = 3;
  cell.tags = {"quick", "paper"};
  std::vector<Selector> const yes{
      {},
      {{"problem", "tether*"}, {"policy", "none"}, {"formulation", "s3"}},
      {{"variant", "case2,g1,as_printed"}},
      {{"variant", "case2"}},
      {{"variant", "as_printed,case2"}},
      {{"variant", "case[12]"}},
      {{"variant", "case2*"}},
      {{"rtol", "0.000001"}, {"atol", "1e-08"}},
      {{"rtol", "1e-*"}},
      {{"set", "inertia=1,2,2.5;sample_period=0.1"}},
      {{"set", "*sample_period=*"}},
      {{"seed", "3"}, {"t_end", "0"}, {"tag", "paper"}},
  };
  std::vector<Selector> const no{
      {{"problem", "tether"}},
      {{"problem", "tether*"}, {"policy", "project"}},
      {{"variant", "case"}},
      {{"variant", "case2,g2"}},
      {{"variant", ""}},
      {{"rtol", "1e-7"}},
      {{"h", "*"}},
      {{"set", ""}},
      {{"seed", "4"}},
      {{"tag", "full"}},
  };
  for (auto const& selector : yes) EXPECT_TRUE(matches(selector, cell)) << ::testing::PrintToString(selector);
  for (auto const& selector : no) EXPECT_FALSE(matches(selector, cell)) << ::testing::PrintToString(selector);
}

TEST(GoodSuite, ByteOrderMarkAndWindowsLineEnds) {
  auto const suite =
      read("\xEF\xBB\xBFname = 'a'\r\n[[sweep]]\r\nproblem = 'pd_slew'\r\nintegrator = 'rk4'\r\nh = 1\r\n");
  EXPECT_EQ(suite.cells.size(), 1);
}

TEST(GoodSuite, ALargeProductIsQuick) {
  auto const begin = std::chrono::steady_clock::now();
  auto const suite = read(sweep(R"(problem = 'free_body'
integrator = ['rk4', 'gauss2']
policy = ['none', 'project']
h = { logspace = [1e-3, 1], count = 10000 }
[[exclude]]
h = 1
integrator = 'rk*'
)"));
  std::chrono::duration<double> const elapsed = std::chrono::steady_clock::now() - begin;
  EXPECT_EQ(suite.cells.size(), 80'000 - 4);
  // About 0.3 s; the bound is wide enough for the sanitizers on a busy machine.
  EXPECT_LT(elapsed.count(), 30);
}

}  // namespace
}  // namespace polhode::bench
