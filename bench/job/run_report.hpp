#pragma once
/// What a run says of its cells to somebody at a terminal: by problem how they ended, and what failed.
#include <string>

#include "results/store.hpp"
#include "results/terminal.hpp"

namespace polhode::bench {

/// A row for each problem with its cells by status, then the failures (refusals are none), 12 of them at most. Of the
/// records of that build.
std::string run_text(results::Contents const& contents, std::string const& build, results::Outlet const& outlet);

}  // namespace polhode::bench
