#pragma once
/// The sections of the report, in its order. Each appends to the document what the records hold, and says in a sentence
/// what they do not hold.
#include "report/cases.hpp"
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
void add_sync(Document& document, Facts const& facts);
void add_consensus(Document& document, Facts const& facts);
/// The steady rates against the tolerance: part of the swarm's section.
void add_tolerance(Document& document, Facts const& facts);
void add_dead_zone(Document& document, Facts const& facts);
void add_so3(Document& document, Facts const& facts);
/// Orders, drift and surfaces: part of the section on SO(3).
void add_so3_orders(Document& document, Facts const& facts);
void add_classics(Document& document, Facts const& facts);
void add_constrained(Document& document, Facts const& facts);
void add_integrators(Document& document, Facts const& facts);
/// What is kept of a free motion against time: part of the section on integrators.
void add_conservation(Document& document, Facts const& facts);
void add_orders(Document& document, Facts const& facts);
void add_speed(Document& document, Facts const& facts);
/// Quantiles, histograms and worst samples of an ensemble; nothing if the folder has none.
void add_ensembles(Document& document, Facts const& facts);
void add_failures(Document& document, Facts const& facts);
void add_references(Document& document, Facts const& facts);
void add_provenance(Document& document, Facts const& facts);

// Parts of the answer.
/// Which method for which need, as a table with its rules.
void add_needs(Document& document, Facts const& facts);
/// What an accuracy costs on the headline problems, in one sentence.
std::string cost_sentence(Facts const& facts);
/// The picture of norm drift and of cost, if the records hold its curves.
void add_headline(Document& document, Facts const& facts);
/// The table of winners.
void add_winners(Document& document, Facts const& facts);

/// The machine, and what a printed CPU time is: for the captions of tables of cost.
std::string timing_note(Facts const& facts);

// Parts of a paper's section.
/// The heading and what the paper is; if there are runs, where its data come from and what is wrong in print.
void add_paper_head(Document& document, Facts const& facts, Paper const& paper);
/// What the paper states against its runs, as a table: a row for each case and claim, a column for whatever its cases
/// share. Statements about all cases are asked of each.
Table claim_table(Paper const& paper, std::vector<CaseRuns> const& sets, std::string name, std::string caption);
/// The same of the paper's own parameters, with what was run.
void add_paper_claims(Document& document, Facts const& facts, Paper const& paper);
/// "1.23: yes": a claim's value and whether it bears the paper out.
Entry verdict_of(results::Record const* run, std::string_view claim, double factor = 1);

}  // namespace polhode::report
