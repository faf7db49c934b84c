#include <fmt/format.h>

#include <cctype>

#include "report/render/render.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0;
}

/// A code span whose fence is longer than any run of backticks inside.
std::string code_span(std::string_view text) {
  std::size_t longest = 0, current = 0;
  for (char const c : text) {
    current = c == '`' ? current + 1 : 0;
    longest = std::max(longest, current);
  }
  std::string const fence(longest + 1, '`');
  std::string const pad = longest > 0 ? " " : "";
  return fence + pad + one_line(text) + pad + fence;
}

std::string render(Text const& text) {
  std::string out;
  for (Span const& span : text.spans) out += span.code ? code_span(span.text) : escape_markdown(span.text);
  return out;
}

/// In a row a bar ends the entry, even where it is otherwise harmless.
std::string render_entry(std::string_view text) {
  std::string out;
  for (char const c : escape_markdown(text)) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

std::string render(Table const& table) {
  std::string out = fmt::format("**Table {}.** {}\n\n|", escape_markdown(table.name), render(table.caption));
  for (Column const& column : table.columns) {
    if (!column.csv_only) out += fmt::format(" {} |", render_entry(column.title));
  }
  out += "\n|";
  for (Column const& column : table.columns) {
    if (!column.csv_only) out += column.number ? "---:|" : "---|";
  }
  for (auto const& row : table.rows) {
    out += "\n|";
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (!is_hidden(table, i)) out += fmt::format(" {} |", render_entry(row[i].text));
    }
  }
  if (!table.has_file) return out + "\n\n";
  return out + fmt::format("\n\nFull precision: [tables/{0}.csv](tables/{0}.csv). Made by `polhode report DIR`.\n\n",
                           table.name);
}

std::string render(Figure const& figure) {
  std::string out;
  if (figure.svg) out += fmt::format("![{0}](figures/{0}.svg)\n\n", figure.name);
  out += fmt::format("**Figure {}.** {} ", escape_markdown(figure.name), render(figure.caption));
  if (!figure.svg) out += fmt::format("The picture was not drawn: {}. ", escape_markdown(figure.why_not));
  return out + fmt::format("Data: [figures/{0}.csv](figures/{0}.csv). Made by `polhode report DIR`.\n\n", figure.name);
}

}  // namespace

std::string escape_markdown(std::string_view raw) {
  std::string const text = one_line(raw);
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char const c = text[i];
    bool const inside = i > 0 && i + 1 < text.size() && is_word(text[i - 1]) && is_word(text[i + 1]);
    switch (c) {
      case '&':
      case '<':
      case '>':
        out += entity_of(c);
        break;
      case '_':  // between letters it is no emphasis, and names stay readable
        out += inside ? "_" : "\\_";
        break;
      case ']':  // a link needs what follows
        if (i + 1 < text.size() && std::string_view("([:").find(text[i + 1]) != std::string_view::npos) out += '\\';
        out += c;
        break;
      case '\\':
      case '`':
      case '*':
      case '~':
      case '$':
        out += '\\';
        out += c;
        break;
      case '#':
      case '+':
      case '-':  // these begin a heading or a list
        if (i == 0) out += '\\';
        out += c;
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string to_markdown(Document const& document) {
  std::string out = fmt::format("# {}\n\n", escape_markdown(document.title));
  auto const print = Overload{
      [&](Heading const& heading) {
        out += fmt::format("{} {}\n\n", std::string(static_cast<std::size_t>(heading.level), '#'),
                           escape_markdown(heading.text));
      },
      [&](Paragraph const& paragraph) { out += render(paragraph.text) + "\n\n"; },
      [&](Table const& table) { out += render(table); },
      [&](Figure const& figure) { out += render(figure); },
  };
  for (Block const& block : document.blocks) std::visit(print, block);
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

}  // namespace polhode::report
