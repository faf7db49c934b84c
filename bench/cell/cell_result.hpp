#pragma once
/// What is written of one measured cell: its record and, before it, its series. As lines of JSON it passes between
/// processes.
#include <string>
#include <vector>

#include "bench/cell/cell.hpp"

namespace polhode::bench {

struct CellResult {
  std::vector<results::Series> series;  ///< in the order in which they are written
  results::Record record;
};

/// Keeps what is written: the drift, and if histories are wanted the trajectory, thinned to about 500 rows, and the
/// invariants.
CellResult result_of(Measured measured, bool keep_history);

/// The lines that a results file would hold, and back. Throws std::invalid_argument for a text that is torn.
std::string to_text(CellResult const& result);
CellResult cell_result_from(std::string const& text);

}  // namespace polhode::bench
