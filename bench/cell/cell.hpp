#pragma once
/// One cell, run: the record of what came of it, or its trajectory alone.
#include <atomic>
#include <limits>
#include <string>
#include <vector>

#include "bench/cell/prepare.hpp"
#include "bench/cell/references.hpp"
#include "results/record.hpp"

namespace polhode::bench {

/// What the accuracy pass gives.
struct Measured {
  results::Record record;
  results::Series drift{};
  results::Series invariants{};   ///< no rows unless the body is free
  History history{};              ///< at samples and output times
  std::vector<Column> columns{};  ///< of the history
};

/// How a method ended, as a record says it.
results::Status status_of(Status status);

/// Thrown by a run that was asked to stop: there is nothing to record.
struct Interrupted {};

/// When a run ends before its time.
struct Limits {
  double timeout = 0;                       ///< wall time [s]; 0 for none
  std::atomic<bool> const* stop = nullptr;  ///< set from outside: throw Interrupted soon
};

/// Runs and measures one cell. Failures of the run are statuses, never exceptions; `build` goes into the record.
Measured measure(PreparedCell const& prepared, References& references, std::string const& build, Limits const& limits);

/// The record of a cell of which nothing was measured: it was refused, or its process died.
results::Record unmeasured(PreparedCell const& prepared, std::string const& build, results::Status status,
                           std::string const& reason);

/// A trajectory without a reference: rows at output times, and how it ended.
struct Trajectory {
  History history;
  std::vector<Column> columns;  ///< of the history
  results::Status status = results::Status::ok;
  std::string reason;
  Outcome outcome;
  std::int64_t bodies = 0;
};
Trajectory simulate(PreparedCell const& prepared, Limits const& limits = {});

/// A history as rows of the record and of the report: the time in front, units beside the names. Of more than `most`
/// rows about as many are kept, evenly, and the last.
results::Series history_series(std::string const& cell, std::vector<Column> const& columns, History const& history,
                               std::size_t most = std::numeric_limits<std::size_t>::max());

/// Columns of a trajectory with their units: q1 .. q4, wx wy wz (and s1 s2 s3 where they are the state) of every body,
/// and the problem's own.
std::vector<Column> columns_of(PreparedCell const& prepared);

}  // namespace polhode::bench
