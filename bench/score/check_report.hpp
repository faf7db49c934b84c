#pragma once
/// What a check found, for its readers: a terminal, a log, CI servers (JUnit XML, GitHub), a summary page (Markdown).
#include <string>
#include <vector>

#include "bench/score/check.hpp"
#include "results/terminal.hpp"

namespace polhode::bench {

/// What was checked.
struct CheckSubject {
  std::string suite;  ///< its name
  std::string file;   ///< its copy in the result folder
  std::string build;  ///< whose records
  std::string made;   ///< when and of which commit, as far as known
  std::size_t records = 0, cells = 0;
  std::string source{};  ///< its file in the repository of whoever ran it; empty if unknown
};

/// An aligned table, then every failure, then the count.
std::string table_text(CheckSubject const& subject, std::vector<Row> const& rows, results::Outlet const& outlet);
/// One testsuite, one testcase for each row. Text that XML cannot hold is replaced.
std::string junit_text(CheckSubject const& subject, std::vector<Row> const& rows);
std::string markdown_text(CheckSubject const& subject, std::vector<Row> const& rows);
/// Failures as workflow commands of GitHub ("::error file=...,line=...::..."), in the file that one can edit if it is
/// known; one line each, at most 10, for GitHub shows no more of a step.
std::string github_text(CheckSubject const& subject, std::vector<Row> const& rows);

}  // namespace polhode::bench
