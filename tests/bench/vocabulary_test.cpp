#include "bench/input/vocabulary.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/complaint.hpp"
#include "tests/support/small_vocabulary.hpp"

namespace polhode::bench {
namespace {

using results::Cell;
using test::small_vocabulary;

constexpr double inf = std::numeric_limits<double>::infinity();

std::string complaint(std::function<void()> const& action) {
  return polhode::test::complaint_of<UsageError>(action);
}

TEST(Nearest, Table) {
  struct Row {
    std::string word;
    std::vector<std::string> known;
    std::string nearest;
  };
  std::vector<Row> const rows{
      {"gaus2", {"gauss1", "gauss2", "rk4"}, "gauss2"},  // a letter is missing
      {"gausss2", {"gauss1", "gauss2"}, "gauss2"},       // one too many
      {"guass2", {"gauss2", "cf4"}, "gauss2"},           // neighbours swapped: one edit, not two
      {"ab", {"ba"}, "ba"},                              //
      {"case4", {"case1", "case2"}, "case1"},            // a tie goes to the first
      {"rk5", {"dopri5", "rk4"}, "rk4"},                 //
      {"rk4", {"rk4"}, "rk4"},                           // itself
      {"rk", {"abcd", "rk41"}, "rk41"},                  // two edits are always near
      {"rk", {"rk412"}, ""},                             // three are not, in a short word
      {"project_multiplayer", {"none", "project_multiplier"}, "project_multiplier"},  // a third of a long word
      {"energy_momentum", {"rate_error_max"}, ""},                                    //
      {"anything", {}, ""},                                                           //
      {"", {"", "rk4"}, ""},                                 // the empty word is never proposed
      {std::string(1'000'000, 'x'), {"rk4", "gauss2"}, ""},  // and does not take an hour
  };
  for (auto const& row : rows) EXPECT_EQ(nearest(row.word, row.known), row.nearest) << row.word.substr(0, 40);
}

TEST(Unknown, NamesTheNearestOrAll) {
  EXPECT_EQ(unknown("integrator", "gaus2", {"rk4", "gauss2"}), "unknown integrator 'gaus2'; did you mean 'gauss2'?");
  EXPECT_EQ(unknown("policy", "euler", {"none", "project"}), "unknown policy 'euler'; choose from none, project");
  EXPECT_EQ(unknown("key", "h", {"hh"}, "in [[sweep]]"), "unknown key 'h' in [[sweep]]; did you mean 'hh'?");
  EXPECT_EQ(unknown("variant", "g1", {}, "of free_body"), "unknown variant 'g1' of free_body; there are none");
}

TEST(Quote, KeepsAMessageOnOneShortLine) {
  EXPECT_EQ(quote("rk4"), "'rk4'");
  EXPECT_EQ(quote("a\nb\x1b[0m\x7f"), "'a?b?[0m?'");
  EXPECT_EQ(quote(std::string(1000, 'x')), "'" + std::string(60, 'x') + "...'");
  // 59 letters and a character of two bytes: not cut in two.
  EXPECT_EQ(quote(std::string(59, 'x') + "\u00e9" + "yyy"), "'" + std::string(59, 'x') + "...'");
}

TEST(CanonicalVariant, Table) {
  auto const vocabulary = small_vocabulary();
  struct Row {
    std::string problem, selection, canonical;
  };
  std::vector<Row> const rows{
      {"tether_capture", "", "case1,g1"},
      {"tether_capture", "  ", "case1,g1"},
      {"tether_capture", "case2", "case2,g1"},
      {"tether_capture", "g2", "case1,g2"},
      {"tether_capture", "g2,free", "free,g2"},
      {"tether_capture", " g2 , free ", "free,g2"},
      {"tether_capture", "as_printed,case2", "case2,g1,as_printed"},
      {"tether_capture", "coupled,raw_q0,as_printed,g2,case3", "case3,g2,as_printed,raw_q0,coupled"},
      {"pd_slew", "", "plain"},
      {"pd_slew", "gyrostat", "gyrostat"},
      {"free_body", "", ""},
  };
  for (auto const& row : rows) {
    auto const& problem = vocabulary.problem(row.problem);
    EXPECT_EQ(canonical_variant(problem, row.selection), row.canonical) << row.selection;
    EXPECT_EQ(canonical_variant(problem, row.canonical), row.canonical) << "canonical text is a fixed point";
  }
}

TEST(CanonicalVariant, Complaints) {
  auto const vocabulary = small_vocabulary();
  struct Row {
    std::string problem, selection, message;
  };
  std::vector<Row> const rows{
      {"tether_capture", "case4", "unknown variant 'case4' of tether_capture; did you mean 'case1'?"},
      {"tether_capture", "as_prnted", "unknown variant 'as_prnted' of tether_capture; did you mean 'as_printed'?"},
      {"tether_capture", "case1,case2", "variant 'case1,case2': case1 and case2 exclude each other; give one"},
      {"tether_capture", "g2,free,g1", "variant 'g2,free,g1': g2 and g1 exclude each other; give one"},
      {"tether_capture", "g1,g1", "variant 'g1,g1': g1 is given twice"},
      {"tether_capture", "case1,,g2", "variant 'case1,,g2': a word is missing beside a comma"},
      {"tether_capture", "case1,", "variant 'case1,': a word is missing beside a comma"},
      {"free_body", "case1", "unknown variant 'case1' of free_body; there are none"},
      {"pd_slew", "delayed", "unknown variant 'delayed' of pd_slew; choose from plain, gyrostat"},
  };
  for (auto const& row : rows) {
    auto const& problem = vocabulary.problem(row.problem);
    EXPECT_EQ(complaint([&] { canonical_variant(problem, row.selection); }), row.message);
  }
}

Cell good_cell() {
  Cell cell;
  cell.problem = "tether_capture";
  cell.formulation = "s3";
  cell.integrator = "dopri5";
  cell.h = 0.1;
  return cell;
}

TEST(CheckWords, Complaints) {
  auto const vocabulary = small_vocabulary();
  struct Row {
    std::function<void(Cell&)> spoil;
    std::string message;
  };
  std::vector<Row> const rows{
      {[](Cell& c) { c.problem = "fre_body"; }, "unknown problem 'fre_body'; did you mean 'free_body'?"},
      {[](Cell& c) { c.integrator = "gaus2"; }, "unknown integrator 'gaus2'; did you mean 'gauss2'?"},
      {[](Cell& c) { c.formulation = "s4"; }, "unknown formulation 's4' of tether_capture; did you mean 's3'?"},
      {[](Cell& c) { c.formulation = ""; }, "unknown formulation '' of tether_capture; did you mean 's3'?"},
      {[](Cell& c) { c.policy = "projct"; }, "unknown policy 'projct'; did you mean 'project'?"},
      {[](Cell& c) { c.variant = "case4"; }, "unknown variant 'case4' of tether_capture; did you mean 'case1'?"},
      {[](Cell& c) { c.set["inertai"] = {1}; },
       "unknown parameter 'inertai' of tether_capture; did you mean 'inertia'?"},
      {[](Cell& c) { c.set["inertia"] = {}; }, "parameter inertia: no value; give at least one number"},
      {[](Cell& c) {
         c.set["inertia"] = {1, -inf, 1};
       },
       "parameter inertia: -inf is not a finite number"},
      {[](Cell& c) { c.h = -0.1; }, "h = -0.1: a step size is a positive finite number of seconds"},
      {[](Cell& c) { c.h = 0; }, "h = 0: a step size is a positive finite number of seconds"},
      {[](Cell& c) { c.h = inf; }, "h = inf: a step size is a positive finite number of seconds"},
      {[](Cell& c) { c.t_end = -1; }, "t_end = -1: a horizon is a positive finite number of seconds"},
      {[](Cell& c) { c.t_end = std::numeric_limits<double>::quiet_NaN(); },
       "t_end = nan: a horizon is a positive finite number of seconds"},
      {[](Cell& c) { c.rtol = 1e-6; }, "give h or rtol, not both"},
      {[](Cell& c) { c.h.reset(); }, "give h (fixed steps) or rtol (adaptive)"},
      {[](Cell& c) { c.atol = 1e-6; }, "give h or rtol (and atol), not h and atol"},
      {[](Cell& c) { c.h.reset(), c.atol = 1e-6; }, "atol without rtol: give both, or rtol alone"},
      {[](Cell& c) { c.h.reset(), c.rtol = -1e-6; }, "rtol = -1e-06: a tolerance is a positive finite number"},
      {[](Cell& c) { c.h.reset(), c.rtol = 1e-6, c.atol = 0; }, "atol = 0: a tolerance is a positive finite number"},
      {[](Cell& c) { c.integrator = "rk4", c.h.reset(), c.rtol = 1e-6; },
       "rk4 has no error estimate: give h, not rtol"},
      {[](Cell& c) { c.integrator = "cvode_bdf"; }, "cvode_bdf chooses its own steps: give rtol (and atol), not h"},
  };
  for (auto const& row : rows) {
    Cell cell = good_cell();
    row.spoil(cell);
    EXPECT_EQ(complaint([&] { check_words(vocabulary, cell); }), row.message);
  }
}

TEST(CheckWords, CompletesACell) {
  auto const vocabulary = small_vocabulary();
  Cell cell = good_cell();
  cell.variant = "as_printed,case2";
  cell.policy = "project";
  cell.set["inertia"] = {1, 2, 3};
  check_words(vocabulary, cell);
  EXPECT_EQ(cell.variant, "case2,g1,as_printed");
  EXPECT_EQ(cell.h, 0.1);
  EXPECT_EQ(cell.atol, std::nullopt);

  cell.h.reset();
  cell.rtol = 1e-6;
  check_words(vocabulary, cell);
  EXPECT_EQ(cell.atol, 1e-6 * 1e-2) << "the default";

  cell.atol = 1e-12;
  cell.integrator = "cvode_bdf";
  check_words(vocabulary, cell);
  EXPECT_EQ(cell.atol, 1e-12) << "what is given is kept; and what is not built is still a known word";
}

TEST(Vocabulary, FindsItsEntries) {
  auto const vocabulary = small_vocabulary();
  EXPECT_EQ(vocabulary.problem("pd_slew").name, "pd_slew");
  EXPECT_TRUE(vocabulary.integrator("cvode_bdf").adaptive);
  EXPECT_EQ(complaint([&] { vocabulary.problem("pendulum"); }),
            "unknown problem 'pendulum'; choose from tether_capture, free_body, pd_slew");
  EXPECT_EQ(complaint([] { Vocabulary{}.integrator("rk4"); }), "unknown integrator 'rk4'; there are none");
}

}  // namespace
}  // namespace polhode::bench
