#pragma once
/// What a report consists of, before anybody decides how it looks: the sections build a Document once, and each
/// renderer (Markdown, HTML, CSV, gnuplot) reads it. Text is stored unescaped; escaping is the renderer's business.
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace polhode::report {

/// A piece of running text.
struct Span {
  std::string text;
  bool code = false;
};

/// Running text; converts from a plain string.
struct Text {
  std::vector<Span> spans;

  Text() = default;
  Text(std::string plain) : spans{{std::move(plain)}} {}
  Text(char const* plain) : spans{{plain}} {}
  Text(std::vector<Span> pieces) : spans(std::move(pieces)) {}
};

struct Heading {
  int level = 2;
  std::string text;
};

struct Paragraph {
  Text text;
};

/// One entry of a table: as it is read, and in full precision for the CSV file (empty: the same).
struct Entry {
  std::string text;
  std::string exact;
  std::string interval = {};  ///< where it lies, in the same unit: "12.1, 12.6"; printed in papers' tables

  Entry() = default;
  Entry(std::string shown, std::string in_csv = "") : text(std::move(shown)), exact(std::move(in_csv)) {}
  Entry(char const* shown) : text(shown) {}
};

struct Column {
  std::string title;
  bool number = false;    ///< aligned to the right
  bool csv_only = false;  ///< in the CSV file alone
};

struct Table {
  std::string name;  ///< of its file, tables/NAME.csv: chosen by the report, never taken from a record
  Text caption = {};
  std::vector<Column> columns = {};
  std::vector<std::vector<Entry>> rows = {};
  bool has_file = true;  ///< tables/NAME.csv stands beside the document
};

struct Point {
  double x = 0, y = 0;
  bool grey = false;  ///< not to be trusted: below what the reference can resolve
};

enum class Dash { solid, dashed, dotted, dash_dot };

/// How a curve is told from the others: by colour and symbol, which follow from the index, and by its line.
struct Style {
  int index = 0;
  Dash dash = Dash::solid;
  bool open = false;   ///< open symbols instead of filled ones
  bool points = true;  ///< symbols at the points; a densely sampled history has none
  bool line = true;
  int every = 1;  ///< a symbol at each so many points
};

struct Curve {
  std::string label;  ///< in the legend; empty: none is needed
  Style style = {};
  std::vector<Point> points = {};
};

struct Axis {
  std::string label;
  bool log = false;
  double least = 0;  ///< nothing below is shown, on a logarithmic axis
};

struct Panel {
  Axis x, y;
  std::vector<Curve> curves = {};
  bool equal_scale = false;  ///< one metre is as long in x as in y
  double rounding = 0;       ///< y below which the picture is shaded: rounding rules there
  std::string title = {};    ///< above the panel
};

struct Figure {
  std::string name;  ///< of its files, figures/NAME.*: chosen by the report, never taken from a record
  Text caption = {};
  std::vector<Panel> panels = {};
  int columns = 1;                      ///< panels beside each other
  bool same_y = false;                  ///< all panels have the same range of y
  bool poster = false;                  ///< large type, thick lines, and a legend under each panel: to be shown alone
  std::optional<std::string> svg = {};  ///< what gnuplot drew; absent if it could not
  std::string why_not = {};             ///< why there is no picture
};

using Block = std::variant<Heading, Paragraph, Table, Figure>;

struct Document {
  std::string title;
  std::vector<Block> blocks = {};
  int sections = 0;  ///< so far

  /// A heading of level 2 with its number.
  void section(std::string const& text) { heading(2, std::to_string(++sections) + ". " + text); }
  void heading(int level, std::string text) { blocks.emplace_back(Heading{level, std::move(text)}); }
  void say(Text text) { blocks.emplace_back(Paragraph{std::move(text)}); }
  void add(Table table) { blocks.emplace_back(std::move(table)); }
  void add(Figure figure) { blocks.emplace_back(std::move(figure)); }
};

/// One function for all kinds of block, from one for each: std::visit(Overload{...}, block).
template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;  // g++ knows that by itself, clang 16 does not

/// Texts of a table up to this length stay on one line.
inline constexpr std::size_t short_text = 36;

/// True if that column is for the CSV file alone.
inline bool is_hidden(Table const& table, std::size_t column) {
  return column < table.columns.size() && table.columns[column].csv_only;
}
/// True if there is something to draw.
bool has_points(Figure const& figure);

}  // namespace polhode::report
