#pragma once
/// The renderers of a Document. Each escapes text for its own language; nothing from a record is trusted.
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "report/document.hpp"
#include "report/render/page.hpp"

namespace polhode::report {

std::string to_markdown(Document const& document);
/// One page without outside resources: style and pictures are inside, and what is interactive, if anything is.
std::string to_html(Document const& document, Interactive const& interactive = {});
/// RFC 4180, with a header line and full precision.
std::string to_csv(Table const& table);
/// Every point that is drawn: panel, curve, x, y, mark.
std::string to_csv(Figure const& figure);

std::string escape_markdown(std::string_view text);
std::string escape_html(std::string_view text);

/// The picture's complete gnuplot script, data included; it writes NAME.svg into its working folder.
std::string gnuplot_script(Figure const& figure);
/// Writes NAME.gp into `folder` and lets gnuplot draw it; fills `svg` or `why_not`. No shell takes part.
void draw(Figure& figure, std::filesystem::path const& folder);
/// The same for figures of different names, as many at a time as there are processors.
void draw_all(std::vector<Figure*> const& figures, std::filesystem::path const& folder);

}  // namespace polhode::report
