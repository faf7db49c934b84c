#pragma once
/// The document of a comparison of two sets of records (results/compare.hpp), and its texts.
#include <cstddef>
#include <string>

#include "report/document.hpp"
#include "results/compare.hpp"
#include "results/terminal.hpp"

namespace polhode::report {

/// What is shown first matters most: statuses, verdicts of claims, errors and counts, times, and the cells of one set
/// alone. A table has at most `most_rows` rows and says how many are left; 0: all.
Document document_of(results::Comparison const& comparison, std::size_t most_rows = 0);

std::string comparison_markdown(results::Comparison const& comparison);
std::string comparison_html(results::Comparison const& comparison);
/// For a terminal: its width, its colours, and tables of 30 rows at most.
std::string comparison_text(results::Comparison const& comparison, results::Outlet const& outlet);

/// Any document for a terminal, without figures.
std::string to_terminal(Document const& document, results::Outlet const& outlet);

}  // namespace polhode::report
