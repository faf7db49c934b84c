/// A picture as a gnuplot script, data included.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "report/render/palette.hpp"
#include "report/render/render.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

/// gnuplot's point types: circle, square, triangles up and down, diamond, pentagon; x, + and * have no inside. Colour
/// and symbol repeat together only after 144 curves, or 48 open ones.
constexpr std::array<int, 9> filled{7, 5, 9, 11, 13, 15, 2, 1, 3};
constexpr std::array<int, 6> open{6, 4, 8, 10, 12, 14};

// The layout, in pixels.
constexpr double plot_width = 300, wide_plot_width = 560, plot_height = 300, low_plot_height = 170;
constexpr double left = 84, right = 18, top = 16, bottom = 54, title_height = 20, letter = 7.6, key_line = 22.5;
/// A pixel of the SVG is a point of the PDF.
constexpr double points_per_inch = 72;
constexpr double poster_width = 1000, poster_height = 420, poster_left = 96, poster_right = 22, poster_top = 46,
                 poster_bottom = 146, poster_key = 84;

/// A gnuplot expression of a string. In single quotes nothing is expanded: no backticks, no macros, no escapes. Gnuplot
/// 5.4 stumbles over two doubled apostrophes in a row, so each stands in double quotes by itself.
std::string in_quotes(std::string_view raw) {
  std::string out = "'";
  for (char const c : one_line(raw)) {
    if (c == '\'') {
      out += "'.\"'\".'";
    } else {
      out += c;
    }
  }
  return out + "'";
}

struct Range {
  double low = 0, high = 0;
  bool any = false;

  void include(double v) {
    low = any ? std::min(low, v) : v;
    high = any ? std::max(high, v) : v;
    any = true;
  }
  /// Widens the range to `half` on either side of its middle.
  void centre(double half) {
    double const middle = (low + high) / 2;
    low = middle - half;
    high = middle + half;
  }
};

bool drawable(Panel const& panel, Point const& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && (!panel.x.log || p.x > 0) && (!panel.y.log || p.y > 0);
}

/// The ranges of one panel's data.
struct Extent {
  Range x, y;

  explicit Extent(Panel const& panel) {
    for (Curve const& curve : panel.curves) {
      for (Point const& p : curve.points) {
        if (!drawable(panel, p)) continue;
        x.include(p.x);
        y.include(p.y);
      }
    }
    if (!panel.equal_scale) return;
    double const half = std::max(x.high - x.low, y.high - y.low) / 2;
    x.centre(half);
    y.centre(half);
  }
};

/// Range, ticks and labels of one axis; on a logarithmic axis whole decades, at most nine of them labelled.
std::string axis_commands(char name, Axis const& axis, Range range) {
  std::string out = fmt::format("set {}label {} noenhanced\n", name, in_quotes(axis.label));
  if (!axis.log) {
    double const spare = range.high > range.low ? 0.04 * (range.high - range.low) : std::max(1.0, std::abs(range.low));
    return out + fmt::format(
                     "unset logscale {0}\nset format {0} '%g'\nset {0}tics autofreq\nset m{0}tics 2\n"
                     "set {0}range [{1}:{2}]\n",
                     name, range.low - spare, range.high + spare);
  }
  if (range.high > axis.least) range.low = std::max(range.low, axis.least);
  // A point on the frame would be cut in half; and with fewer than two decades labelled nobody could read the scale.
  double const spare = std::max(0.15, 0.03 * std::log10(range.high / range.low));
  double low = std::log10(range.low) - spare, high = std::log10(range.high) + spare;
  if (std::floor(high) - std::ceil(low) < 1) {
    low = std::floor(low);
    high = std::max(low + 1, std::ceil(high));
  }
  double const first = std::ceil(low), last = std::floor(high), step = std::floor((last - first + 8) / 9);
  return out + fmt::format(
                   "set logscale {0}\nset format {0} '10^{{%L}}'\nset {0}tics 1e{1}, 1e{2}, 1e{3}\n"
                   "set m{0}tics {4}\nset {0}range [{5}:{6}]\n",
                   name, first, step, last, step > 1 ? step : 10, std::pow(10, low), std::pow(10, high));
}

std::string line_look(Style const& style, bool poster) {
  return fmt::format("lw {} dt {} lc rgb '{}'", poster ? 2.6 : 1.8, static_cast<int>(style.dash) + 1,
                     curve_colours[static_cast<std::size_t>(style.index) % curve_colours.size()].light);
}

std::string point_look(Style const& style, bool is_grey, bool poster) {
  auto const index = static_cast<std::size_t>(style.index);
  int const symbol = style.open ? open[index % open.size()] : filled[index % filled.size()];
  return fmt::format("pt {} ps {} lw {} lc rgb '{}'", symbol, poster ? 0.9 : 0.7, poster ? 2.0 : 1.3,
                     is_grey ? pale.light : curve_colours[index % curve_colours.size()].light);
}

/// Points of a curve: a line runs through all of them, symbols are coloured or grey.
enum class Part { all, coloured, grey };

bool is_in(Part part, Panel const& panel, Point const& p) {
  return drawable(panel, p) && (part == Part::all || p.grey == (part == Part::grey));
}

bool has(Panel const& panel, Curve const& curve, Part part) {
  return std::ranges::any_of(curve.points, [&](Point const& p) { return is_in(part, panel, p); });
}

/// gnuplot's name for the points of the k-th curve of the i-th panel.
std::string block_name(std::size_t i, std::size_t k, Part part) {
  std::string_view const end = part == Part::all ? "" : part == Part::grey ? "_1" : "_0";
  return fmt::format("$p{}c{}{}", i, k, end);
}

std::string data_block(std::string const& name, Panel const& panel, Curve const& curve, Part part) {
  std::string out = fmt::format("{} << EOD\n", name);
  for (Point const& p : curve.points) {
    if (is_in(part, panel, p)) out += fmt::format("{} {}\n", p.x, p.y);
  }
  return out + "EOD\n";
}

struct Legend {
  std::vector<std::string> entries;  ///< gnuplot's keyentry clauses
  std::size_t longest = 0;

  void add(std::string_view look, std::string const& label) {
    entries.push_back(fmt::format("keyentry with {} title {}", look, in_quotes(label)));
    longest = std::max(longest, label.size());
  }
};

/// One entry for each label, though a curve may appear in every panel.
Legend legend_of(std::span<Panel const> panels, bool poster) {
  Legend legend;
  std::vector<std::string> seen;
  bool any_grey = false;
  for (Panel const& panel : panels) {
    for (Curve const& curve : panel.curves) {
      any_grey = any_grey || has(panel, curve, Part::grey);
      bool const listed = curve.label.empty() || std::ranges::find(seen, curve.label) != seen.end();
      if (!has(panel, curve, Part::all) || listed) continue;
      seen.push_back(curve.label);
      Style const& style = curve.style;
      if (!style.points) {
        legend.add("lines " + line_look(style, poster), curve.label);
      } else if (!style.line) {
        legend.add("points " + point_look(style, false, poster), curve.label);
      } else {
        legend.add(
            fmt::format("linespoints dt {} {}", static_cast<int>(style.dash) + 1, point_look(style, false, poster)),
            curve.label);
      }
    }
  }
  if (any_grey) legend.add("points " + point_look({}, true, poster), "below the reference's bar");
  return legend;
}

/// The clauses that draw the k-th curve of the i-th panel: its line, its points, its grey points.
void plot_clauses(std::vector<std::string>& out, Panel const& panel, std::size_t i, std::size_t k, bool poster) {
  Curve const& curve = panel.curves[k];
  // where two curves coincide, the symbols of both are seen
  std::size_t const first = k * static_cast<std::size_t>(curve.style.every) / panel.curves.size();
  if (!has(panel, curve, Part::all)) return;
  if (curve.style.line)
    out.push_back(fmt::format("{} with lines {} notitle", block_name(i, k, Part::all), line_look(curve.style, poster)));
  for (Part const part : {Part::coloured, Part::grey}) {
    if (!curve.style.points || !has(panel, curve, part)) continue;
    out.push_back(fmt::format("{} every {}::{} with points {} notitle", block_name(i, k, part), curve.style.every,
                              first, point_look(curve.style, part == Part::grey, poster)));
  }
}

/// The part of the panel where rounding rules, in light grey.
std::string rounding_object(Panel const& panel, Range y) {
  if (!panel.y.log || panel.rounding <= std::max(y.low, panel.y.least)) return "unset object\n";
  return fmt::format(
      "set object 1 rectangle from graph 0, graph 0 to graph 1, first {} behind fillcolor rgb '{}' "
      "fillstyle solid noborder\n",
      std::min(panel.rounding, y.high * 1.4), shade.light);
}

/// Where things are, as shares of the picture.
struct Layout {
  double width = 0, height = 0;
  struct Box {
    double left, right, bottom, top;
  };
  std::vector<Box> boxes;            ///< of each panel's frame
  std::string legend;                ///< of all panels together: gnuplot's `set key`; empty if each has its own
  std::vector<std::string> legends;  ///< of each panel
};

/// Panels in rows; the legend stands to their right, or in the place that they leave free.
Layout rows_of_panels(Figure const& figure, Legend const& legend) {
  int const columns = std::max(1, figure.columns);
  int const rows = (static_cast<int>(figure.panels.size()) + columns - 1) / columns;
  double const cell_width = (columns == 1 ? wide_plot_width : plot_width) + left + right;
  bool const titled = std::ranges::any_of(figure.panels, [](Panel const& panel) { return !panel.title.empty(); });
  double const above = top + (titled ? title_height : 0);
  double const cell_height = (rows > 2 ? low_plot_height : plot_height) + above + bottom;
  int const in_last_row = static_cast<int>(figure.panels.size()) % columns;
  double const key_x = (in_last_row > 0 ? in_last_row : columns) * cell_width + (in_last_row > 0 ? left : 4);
  double const key_y = (in_last_row > 0 ? (rows - 1) * cell_height : 0) + above;
  Layout at;
  at.width = std::max(columns * cell_width, key_x + 60 + letter * static_cast<double>(legend.longest));
  at.height = std::max(rows * cell_height, key_y + key_line * (static_cast<double>(legend.entries.size()) + 1));
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    double const x = static_cast<double>(static_cast<int>(i) % columns) * cell_width;
    double const y = at.height - static_cast<double>(static_cast<int>(i) / columns + 1) * cell_height;
    at.boxes.push_back({(x + left) / at.width, (x + cell_width - right) / at.width, (y + bottom) / at.height,
                        (y + cell_height - above) / at.height});
  }
  at.legend = fmt::format(
      "set key at screen {}, screen {} left top vertical Left reverse noenhanced samplen 2.5 spacing 1.15 textcolor "
      "rgb '{}'\n",
      key_x / at.width, 1 - key_y / at.height, letters);
  return at;
}

/// Panels beside each other, each with its legend below.
Layout poster(Figure const& figure) {
  Layout at{poster_width, poster_height, {}, {}, {}};
  auto const n = static_cast<double>(figure.panels.size());
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    double const x = static_cast<double>(i) / n, next = static_cast<double>(i + 1) / n;
    at.boxes.push_back({x + poster_left / at.width, next - poster_right / at.width, poster_bottom / at.height,
                        1 - poster_top / at.height});
    at.legends.push_back(
        fmt::format("set key at screen {}, screen {} left top vertical maxrows {} Left reverse noenhanced samplen 2 "
                    "spacing 1.1 width -3 textcolor rgb '{}'\n",
                    x + 30 / at.width, poster_key / at.height, figure.panels[i].curves.size() > 4 ? 3 : 2, letters));
  }
  return at;
}

std::string joined(std::vector<std::string> const& clauses) {
  return fmt::format("{}", fmt::join(clauses, ", \\\n  "));
}

std::string margins(Layout::Box const& box) {
  return fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen {}\n",
      box.left, box.right, box.bottom, box.top);
}

/// The legend as a plot of its own, as large as the picture: gnuplot leaves out entries that a lower one has no room
/// for.
std::string legend_plot(std::string const& place, std::vector<std::string> clauses) {
  if (place.empty() || clauses.empty()) return "";
  clauses.insert(clauses.begin(), "NaN notitle");
  return margins({0, 1, 0, 1}) +
         "unset border\nunset tics\nunset xlabel\nunset ylabel\nunset title\nunset object\nunset logscale\n"
         "set xrange [0:1]\nset yrange [0:1]\n" +
         place + "plot " + joined(clauses) + "\n";
}

}  // namespace

std::string gnuplot_script(Figure const& figure) {
  Range all_y;
  for (Panel const& panel : figure.panels) {
    Range const y = Extent(panel).y;
    if (!y.any) continue;
    all_y.include(y.low);
    all_y.include(y.high);
  }
  Legend const common = legend_of(figure.panels, figure.poster);
  Layout const at = figure.poster ? poster(figure) : rows_of_panels(figure, common);
  std::string data, plots;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    Panel const& panel = figure.panels[i];
    std::vector<std::string> clauses;
    for (std::size_t k = 0; k < panel.curves.size(); ++k) {
      Curve const& curve = panel.curves[k];
      for (Part const part : {Part::all, Part::coloured, Part::grey}) {
        if (part == Part::all || curve.style.points) data += data_block(block_name(i, k, part), panel, curve, part);
      }
      plot_clauses(clauses, panel, i, k, figure.poster);
    }
    if (clauses.empty()) continue;
    if (figure.poster) {
      Legend const own = legend_of({&panel, 1}, true);
      clauses.insert(clauses.end(), own.entries.begin(), own.entries.end());
    }
    Range const x_range = Extent(panel).x, y_range = figure.same_y ? all_y : Extent(panel).y;
    plots += margins(at.boxes[i]);
    plots += fmt::format("set title {} font ',{}' noenhanced\n", in_quotes(panel.title), figure.poster ? 17 : 13);
    plots +=
        axis_commands('x', panel.x, x_range) + axis_commands('y', panel.y, y_range) + rounding_object(panel, y_range);
    plots += figure.poster ? at.legends[i] : "unset key\n";
    plots += "plot " + joined(clauses) + "\n";
  }
  plots += legend_plot(at.legend, common.entries);
  return fmt::format(
      "# Draws {0}.svg: gnuplot {0}.gp\n# Draws {0}.pdf: gnuplot -e pdf=1 {0}.gp\n{1}"
      "if (!exists('pdf')) pdf = 0\n"
      "if (!pdf) set terminal svg size {2:.0f},{3:.0f} enhanced font 'sans-serif,{5}' background '{9}'\n"
      "if (!pdf) set output '{0}.svg'\n"
      "if (pdf) set terminal pdfcairo size {7:.2f}in,{8:.2f}in enhanced font 'sans-serif,{5}' fontscale 0.77 linewidth "
      "1.6\nif (pdf) set output '{0}.pdf'\n"
      "set border 31 lc rgb '{10}'\nset tics textcolor rgb '{11}'\n"
      "set grid xtics ytics lt 1 lw 0.6 lc rgb '{12}'\nset xlabel offset 0, 0.4\nset title offset 0, -0.4\nset "
      "ylabel offset {6}, 0\n"
      "set multiplot\n{4}unset multiplot\nset output\n",
      figure.name, data, at.width, at.height, plots, figure.poster ? 15 : 13, figure.poster ? 1.5 : 0,
      at.width / points_per_inch, at.height / points_per_inch, paper, frame, letters, grid);
}

}  // namespace polhode::report
