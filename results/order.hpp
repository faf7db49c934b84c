#pragma once
/// The measured order of a method: the slope of log(error) against log(h), where it is one.
/// Errors that are the reference's, or round-off's, or too large for the leading term to rule are dropped first; then
/// the longest stretch of steps over which the local slopes agree is fitted. `check` gates on it and reports show it.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace polhode::results {

/// The error of one run with fixed steps.
struct OrderPoint {
  double h = 0;      ///< [s]
  double error = 0;  ///< e.g. the attitude error at the end [rad]
  double bar = 0;    ///< error bar of the reference, in the same unit; 0 if it is exact
};

/// Which points tell something, and when slopes are one slope.
struct OrderRules {
  double bars = 10;          ///< an error counts from so many bars of the reference on
  double round_off = 1e-12;  ///< an error counts from here on
  double asymptotic = 0.1;   ///< above, the leading term does not rule
  double agreement = 0.1;    ///< local slopes of a stretch lie within this part of each other
};

/// The line through the points of one stretch.
struct OrderFit {
  double slope = 0;
  std::optional<double> half_width;  ///< of the 95% interval; absent for two points, which always lie on a line
  std::size_t points = 0;            ///< that were fitted
  double h_low = 0, h_high = 0;      ///< the smallest and the largest step that was fitted [s]
};

/// A fit, or why there is none.
struct OrderResult {
  std::optional<OrderFit> fit;
  std::string reason;  ///< empty if there is a fit
};

/// Least squares over the longest stretch of usable points whose local slopes agree; of stretches of one length, the
/// one with the smallest steps. Two usable points are fitted as they are. The points come in any order; a step that
/// comes twice, or a number that is not positive and finite, is left out.
OrderResult fit_order(std::vector<OrderPoint> points, OrderRules const& rules = {});

}  // namespace polhode::results
