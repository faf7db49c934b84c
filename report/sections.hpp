#pragma once
/// The sections of the report, in its order. Each appends to the document what the records hold, and says in a sentence
/// what they do not hold.
#include "report/document.hpp"
#include "report/facts.hpp"

namespace polhode::report {

void add_answer(Document& document, Facts const& facts);
void add_drift(Document& document, Facts const& facts);
void add_kept(Document& document, Facts const& facts);
void add_work_precision(Document& document, Facts const& facts);
void add_control_cases(Document& document, Facts const& facts);
void add_claims(Document& document, Facts const& facts);
void add_erratum(Document& document, Facts const& facts);
void add_sample_period(Document& document, Facts const& facts);
void add_orders(Document& document, Facts const& facts);
void add_failures(Document& document, Facts const& facts);
void add_references(Document& document, Facts const& facts);
void add_provenance(Document& document, Facts const& facts);

// Parts of the answer.
/// What an accuracy costs on the headline problems, in one sentence.
std::string cost_sentence(Facts const& facts);
/// The picture of norm drift and of cost, if the records hold its curves.
void add_headline(Document& document, Facts const& facts);
/// The table of winners.
void add_winners(Document& document, Facts const& facts);

/// The machine, and what a printed CPU time is: for the captions of tables of cost.
std::string timing_note(Facts const& facts);

/// The tether problem's three strategies, in the paper's order.
inline constexpr std::string_view control_cases[] = {"case1", "case2", "case3"};

/// Of each initial value problem with that case the most accurate successful run, preferably one with a history.
struct CaseRuns {
  std::string label;                                 ///< what the three cases share: gain set, sign, parameters
  std::string title;                                 ///< its short name, "g1" or "g1 as_printed"
  std::map<std::string, results::Record const*> of;  ///< "case1" -> its run
};
/// The tether problem's controlled runs, one entry per gain set, sign and set of parameters.
std::vector<CaseRuns> case_runs(Facts const& facts);

}  // namespace polhode::report
