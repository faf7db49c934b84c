// Statuses, and what a cell is called.
#include "results/record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include "tests/results/record_samples.hpp"

namespace {

using namespace polhode::results;
using namespace polhode::results::test;

// --- Statuses --------------------------------------------------------------------------------------------------------

TEST(Status, EveryNameLeadsBack) {
  for (int i = 0; i <= static_cast<int>(Status::refused); ++i) {
    Status const status = static_cast<Status>(i);
    EXPECT_EQ(status_of(name_of(status)), status);
  }
  EXPECT_EQ(name_of(Status::ok), "ok");
  EXPECT_EQ(name_of(Status::nonlinear_fail), "nonlinear_fail");
}

TEST(Status, UnknownNameListsTheKnown) {
  EXPECT_EQ(message_of([] { status_of("fine"); }),
            "status: \"fine\"; must be one of ok, inaccurate, diverged, step_underflow, max_steps, nonlinear_fail, "
            "stalled, timeout, crashed, refused");
}

// --- Cells -----------------------------------------------------------------------------------------------------------

TEST(Cell, CanonicalTextAndIdArePinned) {
  EXPECT_EQ(canonical_text(some_cell()),
            "problem=\"tether_capture\"\nvariant=\"case2,g1\"\nformulation=\"s3\"\nintegrator=\"cf4\"\n"
            "policy=\"project\"\nh=0.10000000000000001\nrtol=9.9999999999999995e-07\natol=1.0000000000000001e-09\n"
            "set={\"inertia\":[0.5,0.84999999999999998,1,],\"rho\":[0.25,],}\nseed=-7\nt_end=50\n");
  EXPECT_EQ(cell_id(some_cell()), "84dcc7b7eb630e16");  // computed by another implementation of FNV-1a
}

TEST(Cell, EveryMemberChangesTheId) {
  std::map<std::string, std::function<void(Cell&)>> const changes{
      {"problem", [](Cell& c) { c.problem += "x"; }},
      {"variant", [](Cell& c) { c.variant = ""; }},
      {"formulation", [](Cell& c) { c.formulation = "so3"; }},
      {"integrator", [](Cell& c) { c.integrator = "cf5"; }},
      {"policy", [](Cell& c) { c.policy = "none"; }},
      {"h", [](Cell& c) { c.h = std::nextafter(*c.h, 1.0); }},
      {"rtol", [](Cell& c) { c.rtol = std::nextafter(*c.rtol, 1.0); }},
      {"atol", [](Cell& c) { c.atol = std::nextafter(*c.atol, 1.0); }},
      {"set", [](Cell& c) { c.set["inertia"][1] = std::nextafter(0.85, 1.0); }},
      {"seed", [](Cell& c) { c.seed = 7; }},
      {"t_end", [](Cell& c) { c.t_end = std::nextafter(50.0, 51.0); }},
  };
  std::set<std::string> ids{cell_id(some_cell())};
  Cell const cell = some_cell();
  for_each_cell_field(cell, [&](std::string const& name, std::string const&, auto const&) {
    ASSERT_TRUE(changes.contains(name)) << name;
    Cell changed = some_cell();
    changes.at(name)(changed);
    EXPECT_TRUE(ids.insert(cell_id(changed)).second) << name;
  });
  EXPECT_EQ(ids.size(), changes.size() + 1);
}

TEST(Hash, OfAStreamIsThatOfItsText) {
  EXPECT_EQ(hash_of("foobar"), "85944171f73967e8");  // a known answer of FNV-1a, 64 bits
  for (std::size_t const size : {0, 1, 1 << 16, 200'000}) {
    std::string text(size, 'a');
    if (size > 0) text.back() = '\n';
    std::istringstream in(text);
    EXPECT_EQ(hash_of(in), hash_of(text)) << size;
  }
}

TEST(Cell, WhatLooksAlikeHasAnIdOfItsOwn) {
  std::vector<std::function<void(Cell&)>> const changes{
      [](Cell& c) { c.h.reset(); },
      [](Cell& c) { c.h = 0; },
      [](Cell& c) { c.set.clear(); },
      [](Cell& c) {
        c.set = {{"a", {1, 2}}};
      },
      [](Cell& c) {
        c.set = {{"a", {12}}};
      },
      [](Cell& c) {
        c.set = {{"a", {1}}, {"b", {2}}};
      },
      [](Cell& c) {
        c.set = {{"a", {}}};
      },
      [](Cell& c) { c.problem = "a\nvariant=b"; },
      [](Cell& c) { c.problem = "a\"\nvariant=\"b"; },
  };
  std::set<std::string> ids;
  for (auto const& change : changes) {
    Cell cell = some_cell();
    change(cell);
    ids.insert(cell_id(cell));
  }
  EXPECT_EQ(ids.size(), changes.size());
}

}  // namespace
