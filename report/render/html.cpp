#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "report/render/palette.hpp"
#include "report/render/render.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

constexpr char const* style = R"(
:root { color-scheme: light dark; --page: #ffffff; --ink: #1d2125; --quiet: #5b6269; --rule: #d5d9dd; --row: #f4f6f7; }
@media (prefers-color-scheme: dark) {
  :root { --page: #16191c; --ink: #e4e7ea; --quiet: #a2a9b0; --rule: #3a4046; --row: #1f2327; }
}
body { margin: 0 auto; padding: 1rem; max-width: 88rem; background: var(--page); color: var(--ink);
  font: 1rem/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; overflow-wrap: break-word; }
h1, h2, h3 { line-height: 1.25; }
p, figcaption { max-width: 50rem; }
h2 { margin-top: 2.5rem; border-top: 1px solid var(--rule); padding-top: 1rem; }
nav ul { columns: 18rem; list-style: none; padding: 0; }
a { color: inherit; }
figure { margin: 1.5rem 0; }
figcaption { color: var(--quiet); font-size: .9rem; margin: .4rem 0; }
.wide { overflow-x: auto; }
.wide svg { display: block; max-width: 100%; height: auto; border-radius: 6px; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .5rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--rule); }
td { max-width: 28rem; }
th { vertical-align: bottom; }
tr { background: var(--page); }
tbody tr:nth-child(even) { background: var(--row); }
:is(td, th):first-child { position: sticky; left: 0; background: inherit; }
.long { min-width: 11rem; }
.figure { white-space: nowrap; }
.number { text-align: right; }
.number, .short { white-space: nowrap; }
code { font: .9em ui-monospace, "SF Mono", Consolas, "DejaVu Sans Mono", monospace; }
@media (max-width: 46rem) { main > figure > .wide > svg { max-width: none; min-width: 44rem; } }
@media print { nav { display: none; } }
)";

/// The colours of curves as variables, --curve-0 and so on, for pictures of either kind.
std::string colour_variables() {
  std::string light, dark;
  auto const declare = [&](std::string const& name, Colour const& colour) {
    light += fmt::format(" --{}: {};", name, colour.light);
    dark += fmt::format(" --{}: {};", name, colour.dark);
  };
  for (std::size_t i = 0; i < curve_colours.size(); ++i) declare(fmt::format("curve-{}", i), curve_colours[i]);
  declare("pale", pale);
  declare("shade", shade);
  return fmt::format(":root {{ --curves: {};{} }}\n@media (prefers-color-scheme: dark) {{ :root {{{} }} }}\n",
                     curve_colours.size(), light, dark);
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// Escaped text in which no line ends within 1e-17: a browser breaks it behind the hyphen.
std::string unbroken(std::string const& text) {
  constexpr std::string_view part = "0123456789.";
  std::string out;
  std::size_t done = 0;
  for (auto at = text.find("e-"); at != std::string::npos; at = text.find("e-", at + 2)) {
    std::size_t const before = text.find_last_not_of(part, at == 0 ? 0 : at - 1);
    std::size_t const from = before == std::string::npos ? 0 : before + 1;
    std::size_t const to = std::min(text.find_first_not_of(part, at + 2), text.size());
    if (from >= at || to == at + 2 || from < done) continue;
    out +=
        fmt::format("{}<span class=\"figure\">{}</span>", text.substr(done, from - done), text.substr(from, to - from));
    done = to;
  }
  return out + text.substr(done);
}

std::string render(Text const& text) {
  std::string out;
  for (Span const& span : text.spans) {
    out += span.code ? fmt::format("<code>{}</code>", escape_html(span.text)) : unbroken(escape_html(span.text));
  }
  return out;
}

std::string made_by(std::string_view file) {
  return fmt::format("Data: <a href=\"{0}\">{0}</a>. Made by <code>polhode report DIR</code>.", file);
}

std::string render(Table const& table) {
  std::string out = fmt::format(
      "<figure id=\"table-{0}\">\n<figcaption><b>Table {0}.</b> {1}</figcaption>\n<div "
      "class=\"wide\"><table>\n<thead><tr>",
      table.name, render(table.caption));
  auto const attribute = [&](std::size_t column) {
    return column < table.columns.size() && table.columns[column].number ? " class=\"number\"" : "";
  };
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (is_hidden(table, i)) continue;
    out += fmt::format("<th scope=\"col\"{}>{}</th>", attribute(i), escape_html(table.columns[i].title));
  }
  out += "</tr></thead>\n<tbody>\n";
  for (auto const& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (is_hidden(table, i)) continue;
      bool const is_number = i < table.columns.size() && table.columns[i].number;
      char const* kind = is_number ? "number" : row[i].text.size() <= short_text ? "short" : "long";
      out += fmt::format("<td class=\"{}\">{}</td>", kind, unbroken(escape_html(row[i].text)));
    }
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n";
  if (table.has_file) out += fmt::format("<figcaption>{}</figcaption>\n", made_by("tables/" + table.name + ".csv"));
  return out + "</figure>\n";
}

/// "rgb(86,180,233)", as gnuplot writes #56B4E9.
std::string in_decimals(std::string_view hex) {
  auto const part = [&](std::size_t at) { return std::stoi(std::string(hex.substr(at, 2)), nullptr, 16); };
  return fmt::format("rgb({},{},{})", part(1), part(3), part(5));
}

/// The page's variables by gnuplot's colours.
std::map<std::string, std::string> variables_of_colours() {
  std::map<std::string, std::string> variables{{in_decimals(pale.light), "pale"}, {in_decimals(shade.light), "shade"},
                                               {in_decimals(paper), "page"},      {in_decimals(frame), "quiet"},
                                               {in_decimals(grid), "rule"},       {in_decimals(letters), "ink"}};
  for (std::size_t i = 0; i < curve_colours.size(); ++i)
    variables[in_decimals(curve_colours[i].light)] = fmt::format("curve-{}", i);
  return variables;
}

/// The picture in the page's colours, light or dark.
std::string in_colours_of_page(std::string svg) {
  static auto const variables = variables_of_colours();
  replace_all(svg, "\"black\"", "\"var(--ink)\"");
  replace_all(svg, paper, "var(--page)");
  std::string out;
  std::size_t done = 0;
  for (auto at = svg.find("rgb("); at != std::string::npos; at = svg.find("rgb(", done)) {
    std::size_t const end = std::min(svg.find(')', at), svg.size() - 1) + 1;
    std::string colour = svg.substr(at, end - at);
    std::erase(colour, ' ');
    auto const variable = variables.find(colour);
    out += svg.substr(done, at - done);
    out += variable == variables.end() ? svg.substr(at, end - at) : fmt::format("var(--{})", variable->second);
    done = end;
  }
  return out + svg.substr(done);
}

/// The picture without its XML prologue, and with ids that stay unique when many pictures share a page.
std::string inlined(Figure const& figure) {
  auto const start = figure.svg->find("<svg");
  if (start == std::string::npos) return "";
  std::string svg = figure.svg->substr(start);
  std::string const prefix = figure.name + "-";
  for (char const quote : {'"', '\''}) {
    replace_all(svg, fmt::format(" id={}", quote), fmt::format(" id={}{}", quote, prefix));
    replace_all(svg, fmt::format("href={}#", quote), fmt::format("href={}#{}", quote, prefix));
  }
  replace_all(svg, "url(#", "url(#" + prefix);
  return in_colours_of_page(std::move(svg));
}

/// Pictures in one page take no more than this [bytes]: further ones are named.
constexpr std::size_t most_pictures = 6'000'000;

/// `room` is what is left for pictures.
std::string render(Figure const& figure, std::size_t& room) {
  std::string const caption = render(figure.caption);
  std::string const data = made_by("figures/" + figure.name + ".csv");
  if (!figure.svg) {
    return fmt::format("<p id=\"figure-{0}\"><b>Figure {0}.</b> {1} The picture was not drawn: {2}. {3}</p>\n",
                       figure.name, caption, escape_html(figure.why_not), data);
  }
  if (figure.svg->size() > room) {
    return fmt::format(
        "<p id=\"figure-{0}\"><b>Figure {0}.</b> {1} The picture stands in <a "
        "href=\"figures/{0}.svg\">figures/{0}.svg</a>: "
        "this page holds no more. {2}</p>\n",
        figure.name, caption, data);
  }
  room -= figure.svg->size();
  return fmt::format(
      "<figure id=\"figure-{0}\">\n<div class=\"wide\">{1}</div>\n<figcaption><b>Figure {0}.</b> {2} "
      "{3}</figcaption>\n</figure>\n",
      figure.name, inlined(figure), caption, data);
}

std::string link_of(Interactive const& interactive) {
  return interactive.section.empty() ? "" : "<li><a href=\"#explore\">Explore the records</a></li>\n";
}

std::string contents(Document const& document, Interactive const& interactive) {
  std::string out = "<nav><ul>\n";
  int n = 0;
  for (Block const& block : document.blocks) {
    auto const* heading = std::get_if<Heading>(&block);
    if (heading != nullptr && heading->level == 2) {
      if (n == 1) out += link_of(interactive);
      out += fmt::format("<li><a href=\"#section-{}\">{}</a></li>\n", ++n, escape_html(heading->text));
    }
  }
  return out + "</ul></nav>\n";
}

}  // namespace

std::string escape_html(std::string_view raw) {
  std::string out;
  for (char const c : one_line(raw)) {
    std::string_view const entity = c == '"' ? "&quot;" : c == '\'' ? "&#39;" : entity_of(c);
    if (entity.empty())
      out += c;
    else
      out += entity;
  }
  return out;
}

std::string to_html(Document const& document, Interactive const& interactive) {
  std::string const title = escape_html(document.title);
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n"
      "<style>{1}{2}{4}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{3}<main>\n",
      title, style, colour_variables(), contents(document, interactive), interactive.style);
  int sections = 0;
  std::size_t room = most_pictures;
  auto const print = Overload{
      [&](Heading const& heading) {
        if (heading.level == 2 && sections == 1) out += interactive.section;
        std::string const id = heading.level == 2 ? fmt::format(" id=\"section-{}\"", ++sections) : "";
        out += fmt::format("<h{0}{1}>{2}</h{0}>\n", heading.level, id, escape_html(heading.text));
      },
      [&](Paragraph const& paragraph) { out += fmt::format("<p>{}</p>\n", render(paragraph.text)); },
      [&](Table const& table) { out += render(table); },
      [&](Figure const& figure) { out += render(figure, room); },
  };
  for (Block const& block : document.blocks) std::visit(print, block);
  return out + "</main>\n" + interactive.scripts + "</body>\n</html>\n";
}

}  // namespace polhode::report
