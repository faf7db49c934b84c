#pragma once
/// The integrators as JSON: for `polhode list integrators --json`, and beside the records of a run.
#include <string>

namespace polhode::bench {

/// An array of `{name, family, order, adaptive_only, rival, preserves, needs, needs_problem, source, pitfall}`, in the
/// order of the catalogue.
std::string catalogue_text();

}  // namespace polhode::bench
