#pragma once
/// The report of a result folder: Markdown, a self-contained HTML page, CSV tables and SVG figures, made from records
/// alone. It knows no problem and no method; README.md says what each section is made of.
#include <filesystem>
#include <stdexcept>

#include "results/store.hpp"

namespace polhode::report {

/// The report cannot be written; what() names the file and what is wrong.
struct ReportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes report.md, report.html, tables/*.csv and *.tex, and figures/* (SVG, PDF, data) into `out`, which is made if
/// it does not exist. Files of an earlier report are overwritten. Figures are drawn by gnuplot; without it their data
/// are written and the report says so. Whatever the records do not hold is said in a sentence. Throws ReportError.
void write_report(results::Contents const& contents, std::filesystem::path const& out);

}  // namespace polhode::report
