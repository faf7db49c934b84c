#pragma once
/// The interactive part of the report's page: its data, made from the records here, and its code (report/page/*), which
/// the build puts into the binary. The page loads nothing: code, library and data stand in it.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "report/facts.hpp"
#include "report/render/polhode.hpp"

namespace polhode::report {

/// What the build embedded.
struct PageAssets {
  std::string_view style, code;
  std::string_view plotly;  ///< the library, with its notice; empty if the build did not find it
};
PageAssets page_assets();

/// What the page's code knows of the records; report/README.md says what it holds. Numbers of records as they are
/// recorded, histories thinned and rounded to be drawn.
nlohmann::json page_data(Facts const& facts);

/// The motions without torque whose body the records name: by problem, variant and parameters.
struct NamedSpin {
  std::string label;
  FreeSpin spin;
  PrincipalAxes body;         ///< where the spin's axes are
  bool has_products = false;  ///< the inertia is not diagonal: the axes are not those of the body
};
std::vector<NamedSpin> free_spins(Facts const& facts);

/// JSON that may stand in a script element: no text of a record can end it.
std::string script_safe(nlohmann::json const& json);

/// What the renderer puts into the page besides the document.
struct Interactive {
  std::string style;    ///< CSS
  std::string section;  ///< HTML, after the document's first section
  std::string scripts;  ///< HTML, at the end of the body
};
/// The interactive part, or a sentence that says why there is none: `assets` has no library, or there are no runs.
Interactive interactive_part(Facts const& facts, PageAssets const& assets);

}  // namespace polhode::report
