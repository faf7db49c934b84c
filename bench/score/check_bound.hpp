#pragma once
/// One value held against one bound. A part of check.cpp in a file of its own.
#include <string>

#include "bench/score/check.hpp"

namespace polhode::bench {

/// How a value stands to its bound.
struct Held {
  double excess = 0;       ///< orders values: above 0 the bound is broken, the largest is the worst
  std::string value;       ///< for a reader; "null", "not run", "diverged: ..."
  std::string run;         ///< run_name of the cell; of an order, of its first cell
  std::string id;          ///< of that cell
  bool missing = false;    ///< there is no record
  bool comparable = true;  ///< false: null on both sides, which agrees and shows nothing
};

/// "<= 1e-13", "from 1 to 2", "= ok", "golden within 2%", "nominal +- 0.2".
std::string text_of(Bound const& bound);

/// The record's name of a field: norm_drift is norm_drift_max.
std::string record_field(std::string const& field);

/// Holds one record against a bound on a field of records.
Held hold(Bound const& bound, CheckedCell const& cell, GoldenByCell const& golden);

/// Fits the order of every method among the selected cells, and holds each against the bound.
std::vector<Held> hold_orders(Bound const& bound, std::vector<CheckedCell const*> const& cells,
                              Vocabulary const& vocabulary);

}  // namespace polhode::bench
