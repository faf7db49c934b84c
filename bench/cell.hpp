#pragma once
/// One cell, from words to a record: the user's words become a problem, a plan and a schedule; the run is measured.
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "bench/measure.hpp"
#include "bench/vocabulary.hpp"

namespace polhode::bench {

/// The words of both catalogues, in catalogue order.
Vocabulary const& vocabulary();

/// A cell made ready: everything checked, nothing run.
struct PreparedCell {
  results::Cell cell;     ///< canonical, horizon filled in
  results::Cell physics;  ///< what it is held against: the cell without words that only drive the run
  std::unique_ptr<ChosenProblem> problem;
  Plan plan;
  Schedule schedule;
  std::string refusal;    ///< why it does not run; empty if it does
  bool reference = true;  ///< errors are wanted
};

/// Checks words and numbers and builds the problem. every [s]: output times, 0 for none but the end.
/// Throws UsageError: unknown words, broken parameter rules, an h that does not divide the sample period or `every`.
PreparedCell prepare(results::Cell cell, double every = 0);

/// A reference, or why there is none.
struct FoundReference {
  std::shared_ptr<UsableReference const> reference;
  std::string why_none;
};

/// References by subject, each made once and shared between threads.
class References {
 public:
  explicit References(std::filesystem::path committed) : committed_(std::move(committed)) {}
  /// `whole` [s]: a longer horizon whose committed reference serves, too. Throws ReferenceError if a committed one is
  /// damaged or stale.
  FoundReference of(PreparedCell const& prepared, double whole = 0);

 private:
  struct Slot {
    std::once_flag made;
    std::string why_none;
    std::shared_ptr<UsableReference const> reference;
  };
  std::filesystem::path committed_;
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Slot>> slots_;
};

/// What the accuracy pass gives.
struct Measured {
  results::Record record;
  results::Series drift;
  results::Series invariants;   ///< no rows unless the body is free
  History history;              ///< at samples and output times
  std::vector<Column> columns;  ///< of the history
};

/// What a problem is to be, by a cell's variant, parameters and step.
Choice choice_of(results::Cell const& cell);
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

/// The record of a cell that does not run.
results::Record refused(PreparedCell const& prepared, std::string const& build);

/// A trajectory without a reference: rows at output times, and how it ended.
struct Trajectory {
  History history;
  std::vector<Column> columns;  ///< t first
  results::Status status = results::Status::ok;
  std::string reason;
  Outcome outcome;
};
Trajectory simulate(PreparedCell const& prepared, Limits const& limits = {});

/// Columns of a trajectory with their units: q1 .. q4, wx wy wz (and s1 s2 s3 where they are the state) of every body,
/// and the problem's own.
std::vector<Column> columns_of(PreparedCell const& prepared);

}  // namespace polhode::bench
