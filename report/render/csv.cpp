#include <fmt/format.h>
#include <algorithm>

#include "report/render/render.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

/// Quoted when needed. A text that a spreadsheet would run as a formula is kept as text by a leading apostrophe.
std::string field(std::string_view raw, bool number = false) {
  std::string text = one_line(raw);
  if (!number && !text.empty() && std::string_view("=+-@").find(text.front()) != std::string_view::npos) {
    text = fmt::format("'{}", text);
  }
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char const c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

bool has_points(Figure const& figure) {
  return std::ranges::any_of(figure.panels, [](Panel const& panel) {
    return std::ranges::any_of(panel.curves, [](Curve const& curve) { return !curve.points.empty(); });
  });
}

std::string to_csv(Table const& table) {
  std::string out;
  for (std::size_t i = 0; i < table.columns.size(); ++i)
    out += fmt::format("{}{}", i > 0 ? "," : "", field(table.columns[i].title));
  out += '\n';
  for (auto const& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0) out += ',';
      bool const number = !row[i].exact.empty();
      std::string const& text = number ? row[i].exact : row[i].text;
      if (text != absent) out += field(text, number);
    }
    out += '\n';
  }
  return out;
}

std::string to_csv(Figure const& figure) {
  std::string out = "panel,curve,x,y,mark\n";
  for (Panel const& panel : figure.panels) {
    std::string const name = field(fmt::format("{} against {}", panel.y.label, panel.x.label));
    for (Curve const& curve : panel.curves) {
      std::string const label = field(curve.label);
      for (Point const& point : curve.points) {
        out += fmt::format("{},{},{},{},{}\n", name, label, exact(point.x), exact(point.y), point.grey ? "grey" : "");
      }
    }
  }
  return out;
}

}  // namespace polhode::report
