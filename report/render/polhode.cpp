#include "report/render/polhode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "report/render/render.hpp"

namespace polhode::report {
namespace {

/// Positions of the moments in rising order.
std::array<std::size_t, 3> rising(Triple const& inertia) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return inertia[i]; });
  return order;
}

/// The eye of the static picture, and the axes of its plane.
constexpr Triple eye{0.62, 0.62, 0.48}, right{-0.7071, 0.7071, 0}, up{-0.34, -0.34, 0.877};
constexpr double picture = 380, half = picture / 2;

double dot(Triple const& a, Triple const& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// A stretch of a curve, in pixels.
std::string path(std::vector<Triple> const& points, double scale, std::string_view look) {
  std::string d;
  for (Triple const& p : points) {
    d += fmt::format("{}{:.1f} {:.1f}", d.empty() ? "M" : "L", half + scale * dot(p, right), half - scale * dot(p, up));
  }
  return fmt::format("<path d=\"{}\" {}/>\n", d, look);
}

/// The curve in two looks: what faces the eye, and what the ellipsoid hides. The outward normal is (J1 w1, J2 w2, J3
/// w3).
std::string both_sides(RateCurve const& curve, Triple const& inertia, double scale, std::string_view look) {
  std::string out;
  std::vector<Triple> stretch;
  bool facing = true;
  auto const flush = [&] {
    std::string const opacity = facing ? "" : " stroke-opacity=\"0.25\"";
    if (stretch.size() > 1) out += path(stretch, scale, std::string(look) + opacity);
  };
  for (Triple const& p : curve) {
    bool const front = dot({inertia[0] * p[0], inertia[1] * p[1], inertia[2] * p[2]}, eye) >= 0;
    if (!stretch.empty() && front != facing) {
      stretch.push_back(p);
      flush();
      stretch.clear();
    }
    facing = front;
    stretch.push_back(p);
  }
  flush();
  return out;
}

/// The outline of the ellipsoid: the rates whose normal is square to the eye.
RateCurve outline(Triple const& a) {
  RateCurve curve;
  // on the unit sphere u = w / a the normal is u / a: the outline is the great circle square to eye / a
  Triple const n{eye[0] / a[0], eye[1] / a[1], eye[2] / a[2]};
  double const length = std::hypot(n[0], n[1], n[2]), flat = std::hypot(n[0], n[1]);
  Triple const e1{-n[1] / flat, n[0] / flat, 0};
  Triple const m{n[0] / length, n[1] / length, n[2] / length};
  Triple const e2{m[1] * e1[2] - m[2] * e1[1], m[2] * e1[0] - m[0] * e1[2], m[0] * e1[1] - m[1] * e1[0]};
  for (int i = 0; i <= 96; ++i) {
    double const phi = 2 * std::numbers::pi * i / 96, c = std::cos(phi), s = std::sin(phi);
    curve.push_back({a[0] * (c * e1[0] + s * e2[0]), a[1] * (c * e1[1] + s * e2[1]), a[2] * (c * e1[2] + s * e2[2])});
  }
  return curve;
}

}  // namespace

Triple PrincipalAxes::components(Triple const& w) const {
  return {dot(axes[0], w), dot(axes[1], w), dot(axes[2], w)};
}

PrincipalAxes principal_axes(std::array<double, 6> const& inertia) {
  auto const& [xx, yy, zz, xy, xz, yz] = inertia;
  std::array<Triple, 3> a{{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}}, rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  constexpr int sweeps = 12;  // converges quadratically: half as many do
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (auto const& [p, q] : {std::pair{0U, 1U}, {0U, 2U}, {1U, 2U}}) {
      if (a[p][q] == 0) continue;
      // the smaller of the two rotations: axes stay near those of the body
      double const tau = (a[q][q] - a[p][p]) / (2 * a[p][q]);
      double const t = (tau < 0 ? -1 : 1) / (std::abs(tau) + std::hypot(1, tau)), c = 1 / std::hypot(1, t), s = t * c;
      auto const turn = [&](double& x, double& y) { std::tie(x, y) = std::pair(c * x - s * y, s * x + c * y); };
      for (std::size_t k = 0; k < 3; ++k) turn(a[k][p], a[k][q]);
      for (std::size_t k = 0; k < 3; ++k) {
        turn(a[p][k], a[q][k]);
        turn(rows[p][k], rows[q][k]);
      }
      a[p][q] = a[q][p] = 0;
    }
  }
  return {{a[0][0], a[1][1], a[2][2]}, rows};
}

double FreeSpin::energy_twice() const {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += inertia[i] * omega0[i] * omega0[i];
  return sum;
}

double FreeSpin::momentum_squared() const {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum += inertia[i] * omega0[i] * inertia[i] * omega0[i];
  return sum;
}

Triple FreeSpin::semi_axes() const {
  double const e = energy_twice();
  return {std::sqrt(e / inertia[0]), std::sqrt(e / inertia[1]), std::sqrt(e / inertia[2])};
}

std::vector<RateCurve> polhodes(Triple const& inertia, double e, double l2, std::size_t points) {
  auto const [least, middle, most] = rising(inertia);
  double const j1 = inertia[least], j2 = inertia[middle], j3 = inertia[most];
  if (!(j1 > 0) || !(e > 0) || !(j3 > j1) || l2 < e * j1 || l2 > e * j3) return {};
  // Around the axis of the greatest moment above the separatrix, around that of the least below it.
  bool const about_most = j3 > j2 && (l2 >= e * j2 || j1 == j2);
  std::size_t const axis = about_most ? most : least, a = about_most ? least : middle, b = about_most ? middle : most;
  double const j = inertia[axis];
  // The energy times J less L^2 has no part along the axis: an ellipse across it, and the energy gives the rest.
  double const c = std::abs(e * j - l2);
  double const ra = std::sqrt(c / (inertia[a] * std::abs(j - inertia[a])));
  double const rb = std::sqrt(c / (inertia[b] * std::abs(j - inertia[b])));
  std::vector<RateCurve> curves;
  for (double const sign : {1.0, -1.0}) {
    RateCurve curve;
    for (std::size_t i = 0; i <= points; ++i) {
      double const phi = 2 * std::numbers::pi * static_cast<double>(i % points) / static_cast<double>(points);
      Triple w{};
      w[a] = ra * std::cos(phi);
      w[b] = rb * std::sin(phi);
      w[axis] = sign * std::sqrt(std::max(0.0, (e - inertia[a] * w[a] * w[a] - inertia[b] * w[b] * w[b]) / j));
      curve.push_back(w);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

std::vector<RateCurve> polhode_family(FreeSpin const& spin, std::size_t points) {
  auto const [least, middle, most] = rising(spin.inertia);
  double const e = spin.energy_twice(), j1 = spin.inertia[least], j2 = spin.inertia[middle], j3 = spin.inertia[most];
  std::vector<RateCurve> family;
  // L^2 / 2T between the moments; squares, since the curves' radii go with the root of the distance from an axis
  std::vector<double> levels{j2};
  for (double const share : {0.3, 0.55, 0.8}) {
    if (j2 > j1) levels.push_back(j1 + share * share * (j2 - j1));
    if (j3 > j2) levels.push_back(j3 - share * share * (j3 - j2));
  }
  for (double const level : levels) {
    for (RateCurve& curve : polhodes(spin.inertia, e, e * level, points)) family.push_back(std::move(curve));
  }
  return family;
}

RateCurve own_polhode(FreeSpin const& spin, std::size_t points) {
  auto curves = polhodes(spin.inertia, spin.energy_twice(), spin.momentum_squared(), points);
  if (curves.empty()) return {};
  // The two mirror each other in the origin's plane: the motion's own is on the side of its rate.
  Triple sum{};
  for (Triple const& w : curves[0]) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] += w[i];
  }
  return dot(sum, spin.omega0) < 0 ? curves[1] : curves[0];
}

std::string polhode_svg(FreeSpin const& spin, std::string_view title) {
  Triple const axes = spin.semi_axes();
  double const largest = *std::ranges::max_element(axes);
  if (!(largest > 0) || !std::isfinite(largest)) return "";
  double const scale = 0.62 * half / largest;
  std::string out = fmt::format(
      "<svg viewBox=\"0 0 {0} {0}\" width=\"{0}\" height=\"{0}\" role=\"img\"><title>{1}</title>\n"
      "<g fill=\"none\" stroke=\"currentColor\" stroke-linejoin=\"round\">\n",
      picture, escape_html(title));
  for (std::size_t i = 0; i < 3; ++i) {
    Triple tip{};
    tip[i] = 1.35 * largest;
    out += path({Triple{}, tip}, scale, "stroke-opacity=\"0.5\"");
    out += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" stroke=\"none\" fill=\"currentColor\" font-size=\"13\" "
        "text-anchor=\"middle\">&#969;{}</text>\n",
        half + 1.08 * scale * dot(tip, right), half - 1.08 * scale * dot(tip, up) + 4, "xyz"[i]);
  }
  out += path(outline(axes), scale, "stroke-opacity=\"0.7\" fill=\"currentColor\" fill-opacity=\"0.06\"");
  for (RateCurve const& curve : polhode_family(spin)) {
    out += both_sides(curve, spin.inertia, scale, "stroke-width=\"1\"");
  }
  out += both_sides(own_polhode(spin), spin.inertia, scale, "stroke=\"#D55E00\" stroke-width=\"2.6\"");
  out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"#D55E00\" stroke=\"none\"/>\n",
                     half + scale * dot(spin.omega0, right), half - scale * dot(spin.omega0, up));
  return out + "</g></svg>";
}

}  // namespace polhode::report
