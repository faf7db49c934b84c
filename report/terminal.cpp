#include <fmt/format.h>

#include "report/comparison.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

std::string plain(Text const& text) {
  std::string out;
  for (Span const& span : text.spans) out += one_line(span.text);
  return out;
}

std::string render(Table const& table, results::Outlet const& outlet) {
  std::vector<results::TextColumn> columns;
  for (Column const& column : table.columns) {
    if (!column.csv_only) columns.push_back({one_line(column.title), column.number});
  }
  std::vector<std::vector<results::TextCell>> rows;
  for (auto const& row : table.rows) {
    rows.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!is_hidden(table, i)) rows.back().emplace_back(one_line(row[i].text));
    }
  }
  std::string const caption = plain(table.caption);
  return (caption.empty() ? "" : results::wrapped(caption, outlet) + "\n") +
         results::text_table(columns, rows, outlet) + "\n";
}

}  // namespace

std::string to_terminal(Document const& document, results::Outlet const& outlet) {
  std::string out;
  auto const print = Overload{
      [&](Heading const& heading) {
        out += results::toned(one_line(heading.text), results::Tone::strong, outlet) + "\n\n";
      },
      [&](Paragraph const& paragraph) { out += results::wrapped(plain(paragraph.text), outlet) + "\n\n"; },
      [&](Table const& table) { out += render(table, outlet); },
      [](Figure const&) {},
  };
  for (Block const& block : document.blocks) std::visit(print, block);
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace polhode::report
