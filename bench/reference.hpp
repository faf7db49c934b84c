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

#include "bench/problems.hpp"
#include "integrators/taylor.hpp"
#include "results/record.hpp"

namespace polhode::bench {

/// Attitude (body to inertial) and body rate [rad/s] in quadruple precision; rate 0 where it is a command, not a state.
struct QuadBody {
  Quat<Quad> q;
  Vec3<Quad> omega{};
};
/// One or many.
using QuadState = std::vector<QuadBody>;

/// A reference file that cannot be used: damaged, edited or stale. what() names the file and the remedy.
struct ReferenceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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
  /// Body rates are a part of the state.
  bool has_rates() const { return has_rates_; }
  /// Zeros of the switching functions, in order [s].
  std::vector<double> const& event_times() const { return event_times_; }

 private:
  std::vector<TaylorSegment<Quad, 32>> segments_;
  double t_end_ = 0, largest_rate_ = 0;
  bool has_rates_ = true;
  std::vector<double> event_times_;
};

/// How far the attitudes of the same body are apart [rad], at most.
double angle_between(QuadState const& a, QuadState const& b);

/// States of the same problem at its stops, by 8-stage Gauss on S3 with `divisions` steps from stop to stop.
std::vector<QuadState> solve_by_gauss(ChosenProblem const& problem, Schedule const& schedule, int divisions);

/// A reference with its proof.
struct Certificate {
  std::string id;  ///< hash of `subject`: problem, variant, parameters, horizon
  std::string subject;
  double bar = 0;                        ///< [rad]
  double disagreement = 0, halving = 0;  ///< two of its parts [rad]
  /// The third: Taylor against the closed form [rad]; null if the problem is not a free body in principal axes.
  std::optional<double> closed_form{};
  bool has_rates = true;        ///< of the states: see Reference
  std::vector<double> times{};  ///< where the states are stored [s]
  std::vector<QuadState> states{};
};

/// The canonical text of what a reference belongs to: a cell without its method.
std::string reference_subject(results::Cell const& cell);
/// Its hash, 16 hexadecimal digits.
std::string reference_id(results::Cell const& cell);

/// Proves a reference by the second method. `cell` names the problem; only its physics is used.
Certificate certify(results::Cell const& cell, ChosenProblem const& problem, Schedule const& schedule,
                    Reference const& reference);

/// results/reference/ID.json: decimal digits and hex floats, bar, hash of the contents.
void save(Certificate const& certificate, std::filesystem::path const& folder);
/// Reads it back. Throws ReferenceError if it is damaged or was edited by hand.
Certificate load(std::filesystem::path const& file);
/// Throws ReferenceError if the stored states are further from `reference` than the bar allows.
void check_fresh(Certificate const& certificate, Reference const& reference, std::filesystem::path const& file);

/// A reference ready for use, and its bar.
struct UsableReference {
  std::string id;
  double bar = 0;
  Reference reference;
};
/// From the committed certificate in `folder` if there is one, else certified on the fly.
std::shared_ptr<UsableReference const> obtain(results::Cell const& cell, ChosenProblem const& problem,
                                              Schedule const& schedule, std::filesystem::path const& folder);

}  // namespace polhode::bench
