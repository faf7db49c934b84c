#pragma once
/// What is known of each paper before anything is computed: who wrote it, where its data come from, what it states,
/// what is wrong in print. One Paper per problem, in `papers*.cpp`; nothing here was measured.
#include <string_view>
#include <vector>

namespace polhode::report {

/// Where a number comes from: the paper prints it, something printed implies it, or nothing does and we chose it.
enum class Source { printed, deduced, chosen };

std::string_view name_of(Source source);

struct Datum {
  std::string_view what, value;
  Source source;
  std::string_view how;  ///< why it is that; may be empty
};

/// What the paper states, and how a claim's value is read. Claims of records that are not listed are shown as recorded.
struct Statement {
  std::string_view of;    ///< one of the paper's cases; empty: of all of them
  std::string_view name;  ///< the claim's
  std::string_view words, unit;
  double factor = 1;  ///< from the record's unit
  bool once = false;  ///< the other cases' records repeat it: this row is enough
};

struct Erratum {
  std::string_view where, printed, correct;
};

/// One paper, whose runs are the records of one problem.
struct Paper {
  std::string_view problem;
  std::string_view title;                ///< of its section
  std::string_view citation;             ///< authors (year), journal
  std::string_view about;                ///< what it does, in a sentence
  std::vector<std::string_view> cases;   ///< words of the variants that a table of claims lists below each other
  std::vector<std::string_view> unsaid;  ///< words of variants that a title need not repeat
  std::vector<std::string_view> apart;   ///< words of variants that are no part of the table of claims
  std::vector<Datum> data;
  std::vector<Statement> statements;
  std::vector<Erratum> errata;
};

Paper const& tether_capture();
Paper const& quaternion_sync();
Paper const& group_consensus();
Paper const& dead_zone();
Paper const& so3_cooperative();

}  // namespace polhode::report
