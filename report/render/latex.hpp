#pragma once
/// Tables as LaTeX with the booktabs package, for a paper to input. A file says in its first lines what it needs.
#include <string>
#include <string_view>

#include "report/document.hpp"

namespace polhode::report {

/// A table environment with caption and label (tab:polhode-NAME), or a longtable if it has more rows than a page.
/// Numbers stand in mathematics ("4.1e-9" as 4.1 times a power of 10) with the digits that the other renderers print,
/// and with their interval where the entry has one.
std::string to_latex(Table const& table);

/// Text that LaTeX prints as it is, in any encoding of fonts. Nothing in it is a command; characters that pdfLaTeX does
/// not know are named by their number.
std::string escape_latex(std::string_view text);

}  // namespace polhode::report
