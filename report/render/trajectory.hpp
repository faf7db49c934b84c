#pragma once
/// The picture of one run: attitude, body rates and what else its rows hold, against time.
#include <filesystem>
#include <string>

#include "report/document.hpp"
#include "results/record.hpp"

namespace polhode::report {

/// Panels from names and units of the columns, whatever the problem: t first, then q1 q2 q3 q4 (scalar last), wx wy wz
/// [rad/s] and others; of several bodies (b1. ...) the angles and rates of the first eight. Angles are from the
/// attitude of the first row. Long runs are thinned to some 2000 rows.
Figure trajectory_figure(results::Series const& rows, std::string const& title);

/// Draws it into `file`, an .svg or .pdf. Throws ReportError: gnuplot is missing or fails, or the file cannot be
/// written.
void plot_trajectory(results::Series const& rows, std::string const& title, std::filesystem::path const& file);

}  // namespace polhode::report
