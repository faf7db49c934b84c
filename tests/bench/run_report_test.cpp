/// What a run says at a terminal.
#include "bench/job/run_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace polhode::bench {
namespace {

using results::Status;
using testing::HasSubstr;
using testing::Not;

results::Record ended(std::string const& problem, Status status, std::string const& build = "b") {
  results::Record record;
  record.of.problem = problem;
  record.of.integrator = "rk4";
  record.of.formulation = "s3";
  record.of.h = 0.1;
  record.status = status;
  record.build = build;
  record.reason = status == Status::ok ? "" : "because";
  return record;
}

TEST(RunReport, ProblemsByStatusThenFailures) {
  results::Contents contents;
  contents.records = {ended("pd_slew", Status::ok), ended("free_body", Status::refused),
                      ended("free_body", Status::diverged), ended("free_body", Status::ok, "older")};
  std::string const text = run_text(contents, "b", {});
  EXPECT_EQ(text,
            "problem    cells  ok  diverged  refused\n"
            "pd_slew        1   1         0        0\n"
            "free_body      2   0         1        1\n"
            "\n"
            "run                           status    reason\n"
            "free_body//s3/rk4/none/h=0.1  diverged  because\n"
            "\n");
  EXPECT_THAT(run_text(contents, "b", {0, true}), HasSubstr("\033[31mdiverged\033[0m"));
  EXPECT_EQ(run_text(contents, "another", {}), "");
}

TEST(RunReport, OfManyFailuresTheFirst) {
  results::Contents contents;
  for (int i = 0; i < 20; ++i) contents.records.push_back(ended("free_body", Status::timeout));
  EXPECT_THAT(run_text(contents, "b", {}), HasSubstr("and 8 more\n"));
  contents.records = {ended("free_body", Status::ok)};
  EXPECT_THAT(run_text(contents, "b", {}), Not(HasSubstr("reason")));
}

}  // namespace
}  // namespace polhode::bench
