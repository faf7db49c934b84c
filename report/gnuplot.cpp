#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "report/render.hpp"
#include "report/report.hpp"
#include "report/text.hpp"

extern char** environ;

namespace polhode::report {
namespace {

/// Okabe and Ito's colours without the yellow, which is lost on white: told apart by the colour-blind.
constexpr std::array<char const*, 7> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#56B4E9", "#E69F00", "#000000"};
/// gnuplot's point types, filled and open: circle, square, triangle up, triangle down, diamond, pentagon. A palette of
/// 7 and 6 symbols repeat together only after 42 curves.
constexpr std::array<int, 6> filled{7, 5, 9, 11, 13, 15};
constexpr std::array<int, 6> open{6, 4, 8, 10, 12, 14};
constexpr char const* grey = "#9A9A9A";

// The layout, in pixels.
constexpr double plot_width = 300, wide_plot_width = 560, plot_height = 300, low_plot_height = 170;
constexpr double left = 84, right = 18, top = 16, bottom = 54, letter = 7.6, key_line = 22.5;

/// A gnuplot string. In single quotes nothing is expanded: no backticks, no macros, no escapes.
std::string in_quotes(std::string_view raw) {
  std::string out = "'";
  for (char const c : one_line(raw)) {
    out += c;
    if (c == '\'') out += c;
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
  // A point on the frame would be cut in half; and with fewer than two decades labelled nobody could read the scale.
  double low = std::log10(range.low) - 0.15, high = std::log10(range.high) + 0.15;
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

std::string line_look(Style const& style) {
  return fmt::format("lw 1.8 dt {} lc rgb '{}'", static_cast<int>(style.dash) + 1,
                     colours[static_cast<std::size_t>(style.index) % colours.size()]);
}

std::string point_look(Style const& style, bool is_grey) {
  auto const& set = style.open ? open : filled;
  auto const index = static_cast<std::size_t>(style.index);
  return fmt::format("pt {} ps 0.7 lw 1.3 lc rgb '{}'", set[index % set.size()],
                     is_grey ? grey : colours[index % colours.size()]);
}

/// Data block `block` of a curve: the coloured points, or the grey ones; a line runs through both.
std::string data_block(std::string const& block, Panel const& panel, Curve const& curve, int mark) {
  std::string out = fmt::format("{} << EOD\n", block);
  for (Point const& p : curve.points) {
    if (drawable(panel, p) && (mark < 0 || p.grey == (mark == 1))) out += fmt::format("{} {}\n", p.x, p.y);
  }
  return out + "EOD\n";
}

bool has(Panel const& panel, Curve const& curve, int mark) {
  return std::ranges::any_of(curve.points,
                             [&](Point const& p) { return drawable(panel, p) && (mark < 0 || p.grey == (mark == 1)); });
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
Legend legend_of(Figure const& figure) {
  Legend legend;
  std::vector<std::string> seen;
  bool any_grey = false;
  for (Panel const& panel : figure.panels) {
    for (Curve const& curve : panel.curves) {
      any_grey = any_grey || has(panel, curve, 1);
      if (!has(panel, curve, -1) || std::ranges::find(seen, curve.label) != seen.end()) continue;
      seen.push_back(curve.label);
      Style const& style = curve.style;
      if (!style.points) {
        legend.add("lines " + line_look(style), curve.label);
      } else if (!style.line) {
        legend.add("points " + point_look(style, false), curve.label);
      } else {
        legend.add(fmt::format("linespoints dt {} {}", static_cast<int>(style.dash) + 1, point_look(style, false)),
                   curve.label);
      }
    }
  }
  if (any_grey) legend.add("points " + point_look({}, true), "below the reference's bar");
  return legend;
}

/// The clauses that draw one curve: its line, its points, its grey points.
void plot_clauses(std::vector<std::string>& out, std::string const& block, Panel const& panel, Curve const& curve) {
  if (!has(panel, curve, -1)) return;
  if (curve.style.line) out.push_back(fmt::format("{} with lines {} notitle", block, line_look(curve.style)));
  for (int const mark : {0, 1}) {
    if (!curve.style.points || !has(panel, curve, mark)) continue;
    out.push_back(fmt::format("{}_{} with points {} notitle", block, mark, point_look(curve.style, mark == 1)));
  }
}

std::string joined(std::vector<std::string> const& clauses) {
  std::string out;
  for (std::size_t i = 0; i < clauses.size(); ++i) out += (i > 0 ? ", \\\n  " : "") + clauses[i];
  return out;
}

/// Runs gnuplot on NAME.gp inside `folder`; returns what went wrong, or nothing.
std::string run_gnuplot(std::string const& name, std::filesystem::path const& folder) {
  std::string script = name + ".gp", program = "gnuplot", plain = "--default-settings";
  std::array<char*, 4> arguments{program.data(), plain.data(), script.data(), nullptr};
  std::string const log = name + ".log";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t child = 0;
  int const failure = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) return "gnuplot is not on the PATH";
  if (failure != 0) return fmt::format("gnuplot cannot be started: {}", std::strerror(failure));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  return fmt::format("gnuplot failed, see figures/{}", log);
}

}  // namespace

std::string gnuplot_script(Figure const& figure) {
  int const columns = std::max(1, figure.columns);
  int const rows = (static_cast<int>(figure.panels.size()) + columns - 1) / columns;
  double const cell_width = (columns == 1 ? wide_plot_width : plot_width) + left + right;
  double const cell_height = (rows > 2 ? low_plot_height : plot_height) + top + bottom;
  Legend const legend = legend_of(figure);
  // The legend stands to the right of the panels, or in the place that they leave free.
  int const in_last_row = static_cast<int>(figure.panels.size()) % columns;
  double const key_x = (in_last_row > 0 ? in_last_row : columns) * cell_width + (in_last_row > 0 ? left : 4);
  double const key_y = (in_last_row > 0 ? (rows - 1) * cell_height : 0) + top;
  double const width = std::max(columns * cell_width, key_x + 60 + letter * static_cast<double>(legend.longest));
  double const height =
      std::max(rows * cell_height, key_y + key_line * (static_cast<double>(legend.entries.size()) + 1));

  Range all_y;
  std::size_t last_drawn = 0;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    Range const y = Extent(figure.panels[i]).y;
    if (!y.any) continue;
    last_drawn = i;
    all_y.include(y.low);
    all_y.include(y.high);
  }
  std::string data, plots;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    Panel const& panel = figure.panels[i];
    std::vector<std::string> clauses;
    for (std::size_t k = 0; k < panel.curves.size(); ++k) {
      Curve const& curve = panel.curves[k];
      std::string const block = fmt::format("$p{}c{}", i, k);
      data += data_block(block, panel, curve, -1);
      for (int const mark : {0, 1}) {
        if (curve.style.points) data += data_block(fmt::format("{}_{}", block, mark), panel, curve, mark);
      }
      plot_clauses(clauses, block, panel, curve);
    }
    if (clauses.empty()) continue;
    // gnuplot drops what it would have to draw below the panel that it draws the legend with: so take the lowest.
    bool const last = i == last_drawn;
    if (last) clauses.insert(clauses.end(), legend.entries.begin(), legend.entries.end());
    Extent const extent(panel);
    double const x0 = static_cast<double>(static_cast<int>(i) % columns) * cell_width;
    double const y0 = height - static_cast<double>(static_cast<int>(i) / columns + 1) * cell_height;
    plots += fmt::format("set lmargin at screen {}\nset rmargin at screen {}\n", (x0 + left) / width,
                         (x0 + cell_width - right) / width);
    plots += fmt::format("set bmargin at screen {}\nset tmargin at screen {}\n", (y0 + bottom) / height,
                         (y0 + cell_height - top) / height);
    plots += axis_commands('x', panel.x, extent.x);
    plots += axis_commands('y', panel.y, figure.same_y ? all_y : extent.y);
    plots += last ? fmt::format(
                        "set key at screen {}, screen {} left top vertical Left reverse noenhanced samplen 2.5 "
                        "spacing 1.15 textcolor rgb '#333333'\n",
                        key_x / width, 1 - key_y / height)
                  : "unset key\n";
    plots += "plot " + joined(clauses) + "\n";
  }
  return fmt::format(
      "# Draws {0}.svg: gnuplot {0}.gp\n{1}"
      "set terminal svg size {2:.0f},{3:.0f} enhanced font 'sans-serif,13' background '#FDFDFC'\nset output '{0}.svg'\n"
      "set border 31 lc rgb '#555555'\nset tics textcolor rgb '#333333'\n"
      "set grid xtics ytics lt 1 lw 0.6 lc rgb '#DDDDDD'\nset xlabel offset 0, 0.4\n"
      "set multiplot\n{4}unset multiplot\nset output\n",
      figure.name, data, width, height, plots);
}

void draw(Figure& figure, std::filesystem::path const& folder) {
  std::filesystem::path const script = folder / (figure.name + ".gp");
  std::filesystem::path const picture = folder / (figure.name + ".svg");
  std::error_code ignored;
  std::filesystem::remove(picture, ignored);  // a picture of earlier records must not pass for this one
  std::ofstream out(script);
  out << gnuplot_script(figure);
  out.close();
  if (!out) throw ReportError(fmt::format("{}: cannot be written", script.string()));
  figure.why_not = run_gnuplot(figure.name, folder);
  if (!figure.why_not.empty()) return;
  std::filesystem::remove(folder / (figure.name + ".log"), ignored);
  std::ifstream in(picture);
  std::ostringstream svg;
  svg << in.rdbuf();
  if (svg.str().find("</svg>") == std::string::npos) {
    figure.why_not = "gnuplot left no complete picture";
    return;
  }
  figure.svg = svg.str();
}

}  // namespace polhode::report
