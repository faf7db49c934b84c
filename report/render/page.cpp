#include "report/render/page.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "report/render/render.hpp"
#include "report/text.hpp"

namespace polhode::report {
namespace {

constexpr char const* heading = "<section id=\"explore\">\n<h2>Explore the records</h2>\n";

/// For whom there are no scripts: the motion's polhode, and where to look.
std::string still_picture(std::vector<NamedSpin> const& spins) {
  if (spins.empty()) return "";
  NamedSpin const& first = spins.front();
  return fmt::format(
      "<figure class=\"still\">\n<div class=\"wide\">{}</div>\n<figcaption>Polhodes on the inertia ellipsoid of {}: "
      "the body rate without torque runs around the axis of the greatest or of the least moment of inertia; in colour "
      "the polhode of the motion itself, with its start. {}From the integrals of motion, not from a "
      "run.</figcaption>\n</figure>\n",
      polhode_svg(first.spin, "Polhodes of " + first.label), escape_html(first.label),
      first.has_products ? "In principal axes: the inertia has products. " : "");
}

}  // namespace

Interactive interactive_part(Facts const& facts, PageAssets const& assets) {
  if (facts.runs.empty()) return {};
  std::string const still = still_picture(free_spins(facts));
  if (assets.plotly.empty()) {
    return {std::string(assets.style),
            fmt::format("{}<p>This page has no interactive part: polhode was built without plotly. Install npm, run "
                        "<code>bench/install report</code>, build again and repeat <code>polhode report DIR</code>. "
                        "Everything below is complete.</p>\n{}</section>\n",
                        heading, still),
            ""};
  }
  return {std::string(assets.style),
          fmt::format("{}<noscript><p>The interactive part needs scripts, which are off. Everything below is complete "
                      "without.</p></noscript>\n{}<div id=\"panels\"></div>\n</section>\n",
                      heading, still),
          fmt::format("<script type=\"application/json\" id=\"polhode-data\">{}</script>\n"
                      "<script type=\"text/javascript\">{}</script>\n<script type=\"module\">\n{}</script>\n",
                      script_safe(page_data(facts)), assets.plotly, assets.code)};
}

}  // namespace polhode::report
