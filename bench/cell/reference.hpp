#pragma once
/// Certified references: what every run is held against. Two independent methods in quadruple precision on different
/// formulations, Taylor series on flat quaternions and 8-stage Gauss on the group S3, and for free bodies the closed
/// form; each finds the zeros of switching functions for itself. The error bar is the greatest of their disagreements
/// and of Gauss's change on halving its step. No competitor is ever the reference.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/cell/certificate.hpp"
#include "bench/solve/problems.hpp"
#include "integrators/taylor.hpp"
#include "results/record.hpp"

namespace polhode::bench {

/// A problem whose solution cannot be certified: too stiff, or without a series. what() says why.
struct Uncertified : ReferenceError {
  using ReferenceError::ReferenceError;
};

/// The solution of one problem with one choice, as a chain of Taylor segments: at(t) is exact to quadruple precision at
/// any time of the horizon.
class Reference {
 public:
  /// Solves `problem` over its schedule. Throws Uncertified if the series does not converge.
  static Reference solve(ChosenProblem const& problem, Schedule const& schedule);

  QuadState at(double t) const;
  double t_end() const { return t_end_; }
  /// max |omega| over the stops and segments [rad/s]: the scale of the rate error.
  double largest_rate() const { return largest_rate_; }
  Layout const& layout() const { return layout_; }
  /// Zeros of the switching functions, in order [s].
  std::vector<double> const& event_times() const { return event_times_; }

 private:
  std::vector<TaylorSegment<Quad, 32>> segments_;
  double t_end_ = 0, largest_rate_ = 0;
  Layout layout_;
  std::vector<double> event_times_;
};

/// The canonical text of what a reference belongs to: a cell without its method.
std::string reference_subject(results::Cell const& cell);
/// Its hash, 16 hexadecimal digits.
std::string reference_id(results::Cell const& cell);

/// Proves a reference by the second method. `cell` names the problem; only its physics is used.
Certificate certify(results::Cell const& cell, ChosenProblem const& problem, Schedule const& schedule,
                    Reference const& reference);

/// A reference ready for use, and its bar.
struct UsableReference {
  std::string id;
  double bar = 0;
  Reference reference;
};
/// From the committed certificate in `folder` if there is one, else certified on the fly. `whole` [s]: that of this
/// longer horizon serves, too, if there is one: its bar holds for the part.
std::shared_ptr<UsableReference const> obtain(results::Cell const& cell, ChosenProblem const& problem,
                                              Schedule const& schedule, std::filesystem::path const& folder,
                                              double whole = 0);

}  // namespace polhode::bench
