#include "report/render/trajectory.hpp"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "report/render/render.hpp"
#include "report/report.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bodies = 8, most_rows = 2000;

/// The columns by name, thinned rows.
class Rows {
 public:
  explicit Rows(results::Series const& series) : series_(series) {
    for (std::size_t i = 0; i < series.columns.size(); ++i) index_[series.columns[i]] = i;
    std::size_t const stride = std::max<std::size_t>(1, series.rows.size() / most_rows);
    for (std::size_t i = 0; i < series.rows.size(); ++i) {
      if (i % stride == 0 || i + 1 == series.rows.size()) kept_.push_back(&series.rows[i]);
    }
  }
  bool has(std::string const& name) const { return index_.contains(name); }
  std::string const& unit(std::string const& name) const { return series_.units[index_.at(name)]; }
  std::vector<std::string> const& names() const { return series_.columns; }

  /// f(value of a row) against time.
  template <class F>
  std::vector<Point> points(F f) const {
    std::vector<Point> all;
    for (auto const* row : kept_) all.push_back({(*row)[0], f(*row)});
    return all;
  }
  std::vector<Point> column(std::string const& name, double scale = 1) const {
    std::size_t const i = index_.at(name);
    return points([&](auto const& row) { return scale * row[i]; });
  }
  /// Those names of a body.
  template <std::size_t N>
  std::optional<std::array<std::size_t, N>> columns(std::string const& body, std::array<char const*, N> names) const {
    std::array<std::size_t, N> found{};
    for (std::size_t k = 0; k < N; ++k) {
      auto const at = index_.find(body + names[k]);
      if (at == index_.end()) return {};
      found[k] = at->second;
    }
    return found;
  }
  bool empty() const { return kept_.empty(); }
  std::vector<double> const& first() const { return *kept_.front(); }

 private:
  results::Series const& series_;
  std::map<std::string, std::size_t> index_;
  std::vector<std::vector<double> const*> kept_;
};

Curve curve(std::string label, int index, std::vector<Point> points) {
  // blue, vermilion, green, purple first: far apart for everybody
  constexpr std::array<int, 8> colours{3, 12, 2, 6, 5, 0, 4, 1};
  Style style{.index = colours[static_cast<std::size_t>(index) % colours.size()], .points = false};
  style.dash = static_cast<Dash>(index % 4);
  return {std::move(label), style, std::move(points)};
}

Panel panel(std::string y) {
  return {.x = {"t [s]"}, .y = {std::move(y)}};
}

/// The angle of q0^-1 q, q normalised [deg].   2 atan2(|v|, |s|), which is exact for small and large ones alike
double angle_between(std::array<double, 4> const& a, std::array<double, 4> const& b) {
  double const s = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  // vector part of conj(a) b, scalar last
  double const x = a[3] * b[0] - b[3] * a[0] - (a[1] * b[2] - a[2] * b[1]);
  double const y = a[3] * b[1] - b[3] * a[1] - (a[2] * b[0] - a[0] * b[2]);
  double const z = a[3] * b[2] - b[3] * a[2] - (a[0] * b[1] - a[1] * b[0]);
  return degrees(2 * std::atan2(std::sqrt(x * x + y * y + z * z), std::abs(s)));
}

using Four = std::array<std::size_t, 4>;

std::vector<Point> angle_of(Rows const& rows, Four const& q) {
  auto const attitude = [&](std::vector<double> const& row) {
    return std::array<double, 4>{row[q[0]], row[q[1]], row[q[2]], row[q[3]]};
  };
  std::array<double, 4> const start = attitude(rows.first());
  return rows.points([&](auto const& row) { return angle_between(start, attitude(row)); });
}

/// "b1.", "b2.", ... or "" for the only one.
std::vector<std::string> bodies_of(Rows const& rows) {
  if (rows.has("q1")) return {""};
  std::vector<std::string> bodies;
  while (bodies.size() < most_bodies && rows.has(fmt::format("b{}.q1", bodies.size() + 1)))
    bodies.push_back(fmt::format("b{}.", bodies.size() + 1));
  return bodies;
}

void add_one_body(Figure& figure, Rows const& rows) {
  Panel quaternion = panel("q1 q2 q3 (x y z), q4 (scalar)");
  for (int i = 0; i < 4; ++i) {
    std::string const label = i < 3 ? std::string(1, "xyz"[i]) : "scalar";
    quaternion.curves.push_back(curve(label, i, rows.column(fmt::format("q{}", i + 1))));
  }
  figure.panels.push_back(std::move(quaternion));
}

void add_angles(Figure& figure, Rows const& rows, std::vector<std::string> const& bodies) {
  Panel angle = panel("angle from the start [deg]");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    auto const q = rows.columns<4>(bodies[i], {"q1", "q2", "q3", "q4"});
    std::string const label = bodies[i].empty() ? "" : bodies[i].substr(0, bodies[i].size() - 1);
    if (q) angle.curves.push_back(curve(label, static_cast<int>(i), angle_of(rows, *q)));
  }
  figure.panels.push_back(std::move(angle));
}

void add_rates(Figure& figure, Rows const& rows, std::vector<std::string> const& bodies) {
  double const degree = degrees(1);
  Panel rates = panel(bodies.size() == 1 ? "body rate [deg/s]" : "|body rate| [deg/s]");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    auto const w = rows.columns<3>(bodies[i], {"wx", "wy", "wz"});
    if (!w) continue;
    if (bodies.size() == 1) {
      for (int k = 0; k < 3; ++k) {
        std::string const axis(1, "xyz"[k]);
        rates.curves.push_back(curve(axis, k, rows.column(bodies[i] + "w" + axis, degree)));
      }
    } else {
      rates.curves.push_back(curve(
          bodies[i].substr(0, bodies[i].size() - 1), static_cast<int>(i),
          rows.points([&](auto const& row) { return degree * std::hypot(row[(*w)[0]], row[(*w)[1]], row[(*w)[2]]); })));
    }
  }
  if (!rates.curves.empty()) figure.panels.push_back(std::move(rates));
}

/// The name of a body's column without its body.
std::string_view own_name(std::string_view name) {
  auto const dot = name.find('.');
  return name.starts_with('b') && dot != std::string_view::npos ? name.substr(dot + 1) : name;
}

/// What a column is a component of, and which: torque_x is the x of torque, s1 the s1 of s.
struct Component {
  std::string of, which;
};

Component component_of(std::string_view full) {
  std::string const name(own_name(full));
  if (name != full) return {name, std::string(full)};  // of one body among several
  bool const axis = name.back() >= 'x' && name.back() <= 'z';
  if (axis && name.size() == 1) return {"position", name};
  if (axis && name.size() == 2 && name[0] == 'v') return {"velocity", name.substr(1)};
  if (axis && name.size() > 2 && name[name.size() - 2] == '_')
    return {name.substr(0, name.size() - 2), name.substr(name.size() - 1)};
  auto const digits = name.find_last_not_of("0123456789");
  return {digits == std::string::npos ? name : name.substr(0, digits + 1), std::string(full)};
}

bool is_shown_above(std::string_view name) {
  static constexpr std::array<std::string_view, 7> shown{"q1", "q2", "q3", "q4", "wx", "wy", "wz"};
  return name == "t" || std::ranges::find(shown, own_name(name)) != shown.end();
}

void add_others(Figure& figure, Rows const& rows) {
  std::vector<std::pair<std::string, Panel>> panels;
  for (std::string const& name : rows.names()) {
    if (is_shown_above(name)) continue;
    auto const [of, which] = component_of(name);
    auto found = std::ranges::find(panels, of, &std::pair<std::string, Panel>::first);
    if (found == panels.end()) {
      std::string const& unit = rows.unit(name);
      panels.emplace_back(of, panel(unit.empty() ? of : fmt::format("{} [{}]", of, unit)));
      found = panels.end() - 1;
    }
    std::vector<Curve>& curves = found->second.curves;
    if (curves.size() < most_bodies) curves.push_back(curve(which, static_cast<int>(curves.size()), rows.column(name)));
  }
  for (auto& [of, own] : panels) {
    if (own.curves.size() == 1) own.curves.front().label.clear();  // the axis says it
    figure.panels.push_back(std::move(own));
  }
}

/// A folder that goes with the object.
struct Scratch {
  fs::path path;
  Scratch() {
    std::string name = fs::temp_directory_path() / "polhode_plot_XXXXXX";
    if (::mkdtemp(name.data()) == nullptr) throw ReportError(name + ": cannot be made");
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Scratch(Scratch const&) = delete;
  Scratch& operator=(Scratch const&) = delete;
};

}  // namespace

Figure trajectory_figure(results::Series const& series, std::string const& title) {
  Figure figure{.name = "trajectory", .caption = title};
  Rows const rows(series);
  if (rows.empty()) return figure;
  std::vector<std::string> const bodies = bodies_of(rows);
  if (bodies == std::vector<std::string>{""}) add_one_body(figure, rows);
  if (!bodies.empty()) add_angles(figure, rows, bodies);
  add_rates(figure, rows, bodies);
  add_others(figure, rows);
  if (!figure.panels.empty()) figure.panels.front().title = title;
  figure.columns = figure.panels.size() > 4 ? 2 : 1;
  return figure;
}

void plot_trajectory(results::Series const& series, std::string const& title, fs::path const& file) {
  Figure figure = trajectory_figure(series, title);
  if (!has_points(figure)) throw ReportError(fmt::format("{}: not drawn: the run has no rows", file.string()));
  Scratch const scratch;
  draw(figure, scratch.path);
  if (!figure.svg) throw ReportError(fmt::format("{}: not drawn: {}", file.string(), figure.why_not));
  fs::path const drawn = scratch.path / ("trajectory" + file.extension().string());
  std::error_code error;
  if (!fs::exists(drawn, error)) throw ReportError(fmt::format("{}: not drawn: gnuplot has no Cairo", file.string()));
  fs::copy_file(drawn, file, fs::copy_options::overwrite_existing, error);
  if (error) throw ReportError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

}  // namespace polhode::report
