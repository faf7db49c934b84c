#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <future>
#include <span>
#include <sstream>
#include <thread>

#include "report/render.hpp"
#include "report/report.hpp"
#include "report/text.hpp"

extern char** environ;

namespace polhode::report {
namespace {

/// Okabe and Ito's colours without the yellow, which is lost on white, and darker ones of Tol's. Sixteen colours alone
/// cannot be told apart by the colour-blind: symbols help, and dashes.
constexpr std::array<char const*, 16> colours{"#56B4E9", "#E69F00", "#009E73", "#0072B2", "#000000", "#8C510A",
                                              "#CC79A7", "#882255", "#999933", "#332288", "#CC3311", "#117733",
                                              "#D55E00", "#44AA99", "#AA4499", "#6B6BD6"};
/// gnuplot's point types: circle, square, triangles up and down, diamond, pentagon; x, + and * have no inside. Colour
/// and symbol repeat together only after 144 curves, or 48 open ones.
constexpr std::array<int, 9> filled{7, 5, 9, 11, 13, 15, 2, 1, 3};
constexpr std::array<int, 6> open{6, 4, 8, 10, 12, 14};
constexpr char const* grey = "#9A9A9A";

// The layout, in pixels.
constexpr double plot_width = 300, wide_plot_width = 560, plot_height = 300, low_plot_height = 170;
constexpr double left = 84, right = 18, top = 16, bottom = 54, title_height = 20, letter = 7.6, key_line = 22.5;
/// Of an inch: a pixel of the SVG is a point of the PDF.
constexpr double points = 72;
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
                     colours[static_cast<std::size_t>(style.index) % colours.size()]);
}

std::string point_look(Style const& style, bool is_grey, bool poster) {
  auto const index = static_cast<std::size_t>(style.index);
  int const symbol = style.open ? open[index % open.size()] : filled[index % filled.size()];
  return fmt::format("pt {} ps {} lw {} lc rgb '{}'", symbol, poster ? 0.9 : 0.7, poster ? 2.0 : 1.3,
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
Legend legend_of(std::span<Panel const> panels, bool poster) {
  Legend legend;
  std::vector<std::string> seen;
  bool any_grey = false;
  for (Panel const& panel : panels) {
    for (Curve const& curve : panel.curves) {
      any_grey = any_grey || has(panel, curve, 1);
      bool const listed = curve.label.empty() || std::ranges::find(seen, curve.label) != seen.end();
      if (!has(panel, curve, -1) || listed) continue;
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

/// The clauses that draw one curve: its line, its points, its grey points.
void plot_clauses(std::vector<std::string>& out, std::string const& block, Panel const& panel, std::size_t k,
                  bool poster) {
  Curve const& curve = panel.curves[k];
  // where two curves coincide, the symbols of both are seen
  std::size_t const first = k * static_cast<std::size_t>(curve.style.every) / panel.curves.size();
  if (!has(panel, curve, -1)) return;
  if (curve.style.line) out.push_back(fmt::format("{} with lines {} notitle", block, line_look(curve.style, poster)));
  for (int const mark : {0, 1}) {
    if (!curve.style.points || !has(panel, curve, mark)) continue;
    out.push_back(fmt::format("{}_{} every {}::{} with points {} notitle", block, mark, curve.style.every, first,
                              point_look(curve.style, mark == 1, poster)));
  }
}

/// The part of the panel where rounding rules, in light grey.
std::string shade(Panel const& panel, Range y) {
  if (!panel.y.log || panel.rounding <= std::max(y.low, panel.y.least)) return "unset object\n";
  return fmt::format(
      "set object 1 rectangle from graph 0, graph 0 to graph 1, first {} behind fillcolor rgb '#EFEFEC' "
      "fillstyle solid noborder\n",
      std::min(panel.rounding, y.high * 1.4));
}

/// Where things are, as shares of the picture.
struct Layout {
  double width = 0, height = 0;
  struct Box {
    double left, right, bottom, top;
  };
  std::vector<Box> boxes;            ///< of each panel's frame
  std::vector<std::string> legends;  ///< of each panel: gnuplot's `set key`; of most, none
};

/// Panels in rows; the legend stands to their right, or in the place that they leave free.
Layout rows_of_panels(Figure const& figure, Legend const& legend, std::size_t last_drawn) {
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
    at.legends.emplace_back();
  }
  at.legends[last_drawn] = fmt::format(
      "set key at screen {}, screen {} left top vertical Left reverse noenhanced samplen 2.5 spacing 1.15 textcolor "
      "rgb '#333333'\n",
      key_x / at.width, 1 - key_y / at.height);
  return at;
}

/// Panels beside each other, each with its legend below.
Layout poster(Figure const& figure) {
  Layout at{poster_width, poster_height, {}, {}};
  auto const n = static_cast<double>(figure.panels.size());
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    double const x = static_cast<double>(i) / n, next = static_cast<double>(i + 1) / n;
    at.boxes.push_back({x + poster_left / at.width, next - poster_right / at.width, poster_bottom / at.height,
                        1 - poster_top / at.height});
    at.legends.push_back(
        fmt::format("set key at screen {}, screen {} left top vertical maxrows {} Left reverse noenhanced samplen 2 "
                    "spacing 1.1 width -3 textcolor rgb '#333333'\n",
                    x + 30 / at.width, poster_key / at.height, figure.panels[i].curves.size() > 4 ? 3 : 2));
  }
  return at;
}

std::string joined(std::vector<std::string> const& clauses) {
  std::string out;
  for (std::size_t i = 0; i < clauses.size(); ++i) out += (i > 0 ? ", \\\n  " : "") + clauses[i];
  return out;
}

/// Runs gnuplot on NAME.gp inside `folder`, once after each command of `before`; returns what went wrong, or nothing.
std::string run_gnuplot(std::string const& name, std::filesystem::path const& folder, std::vector<std::string> before) {
  std::string script = name + ".gp", program = "gnuplot", plain = "--default-settings", first = "-e";
  std::vector<char*> arguments{program.data(), plain.data()};
  for (std::string& command : before) {
    for (std::string* word : {&first, &command, &script}) arguments.push_back(word->data());
  }
  arguments.push_back(nullptr);
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
  Range all_y;
  std::size_t last_drawn = 0;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    Range const y = Extent(figure.panels[i]).y;
    if (!y.any) continue;
    last_drawn = i;
    all_y.include(y.low);
    all_y.include(y.high);
  }
  Legend const common = legend_of(figure.panels, figure.poster);
  Layout const at = figure.poster ? poster(figure) : rows_of_panels(figure, common, last_drawn);
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
      plot_clauses(clauses, block, panel, k, figure.poster);
    }
    if (clauses.empty()) continue;
    // gnuplot drops what it would have to draw below the panel that it draws the legend with: so take the lowest.
    if (!at.legends[i].empty()) {
      Legend const own = figure.poster ? legend_of({&panel, 1}, true) : common;
      clauses.insert(clauses.end(), own.entries.begin(), own.entries.end());
    }
    Range const x_range = Extent(panel).x, y_range = figure.same_y ? all_y : Extent(panel).y;
    Layout::Box const& box = at.boxes[i];
    plots += fmt::format("set lmargin at screen {}\nset rmargin at screen {}\n", box.left, box.right);
    plots += fmt::format("set bmargin at screen {}\nset tmargin at screen {}\n", box.bottom, box.top);
    plots += fmt::format("set title {} font ',{}' noenhanced\n", in_quotes(panel.title), figure.poster ? 17 : 13);
    plots += axis_commands('x', panel.x, x_range) + axis_commands('y', panel.y, y_range) + shade(panel, y_range);
    plots += at.legends[i].empty() ? "unset key\n" : at.legends[i];
    plots += "plot " + joined(clauses) + "\n";
  }
  return fmt::format(
      "# Draws {0}.svg: gnuplot {0}.gp\n# Draws {0}.pdf: gnuplot -e pdf=1 {0}.gp\n{1}"
      "if (!exists('pdf')) pdf = 0\n"
      "if (!pdf) set terminal svg size {2:.0f},{3:.0f} enhanced font 'sans-serif,{5}' background '#FDFDFC'\n"
      "if (!pdf) set output '{0}.svg'\n"
      "if (pdf) set terminal pdfcairo size {7:.2f}in,{8:.2f}in enhanced font 'sans-serif,{5}' fontscale 0.77 linewidth "
      "1.6\nif (pdf) set output '{0}.pdf'\n"
      "set border 31 lc rgb '#555555'\nset tics textcolor rgb '#333333'\n"
      "set grid xtics ytics lt 1 lw 0.6 lc rgb '#DDDDDD'\nset xlabel offset 0, 0.4\nset title offset 0, -0.4\nset "
      "ylabel offset {6}, 0\n"
      "set multiplot\n{4}unset multiplot\nset output\n",
      figure.name, data, at.width, at.height, plots, figure.poster ? 15 : 13, figure.poster ? 1.5 : 0,
      at.width / points, at.height / points);
}

void draw(Figure& figure, std::filesystem::path const& folder) {
  std::filesystem::path const script = folder / (figure.name + ".gp");
  std::filesystem::path const picture = folder / (figure.name + ".svg");
  std::error_code ignored;
  std::filesystem::path const print = folder / (figure.name + ".pdf");
  // pictures of earlier records must not pass for these
  std::filesystem::remove(picture, ignored);
  std::filesystem::remove(print, ignored);
  std::ofstream out(script);
  out << gnuplot_script(figure);
  out.close();
  if (!out) throw ReportError(fmt::format("{}: cannot be written", script.string()));
  if (!run_gnuplot(figure.name, folder, {"pdf = 0", "pdf = 1"}).empty()) {
    // A gnuplot without Cairo draws no PDF: the report is complete all the same.
    figure.why_not = run_gnuplot(figure.name, folder, {"pdf = 0"});
    if (!figure.why_not.empty()) return;
    std::filesystem::remove(print, ignored);
  }
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

void draw_all(std::vector<Figure*> const& figures, std::filesystem::path const& folder) {
  std::size_t const workers = std::min<std::size_t>(figures.size(), std::max(1U, std::thread::hardware_concurrency()));
  std::atomic<std::size_t> next = 0;
  auto const work = [&] {
    for (std::size_t i = next++; i < figures.size(); i = next++) draw(*figures[i], folder);
  };
  std::vector<std::future<void>> running;
  for (std::size_t i = 0; i < workers; ++i) running.push_back(std::async(std::launch::async, work));
  for (auto& one : running) one.get();
}

}  // namespace polhode::report
