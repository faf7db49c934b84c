#pragma once
/// What claims ask of a column against time.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace polhode::history {

/// The greatest rise of y above an earlier value.
inline double rise(std::vector<double> const& y) {
  double low = y.front(), most = 0;
  for (double value : y) {
    most = std::max(most, value - low);
    low = std::min(low, value);
  }
  return most;
}
/// The greatest fall below an earlier value.
inline double fall(std::vector<double> y) {
  for (double& value : y) value = -value;
  return rise(y);
}
/// How far y travels, there and back: the sum of |changes| from row to row.
inline double total_variation(std::vector<double> const& y) {
  double sum = 0;
  for (std::size_t i = 1; i < y.size(); ++i) sum += std::fabs(y[i] - y[i - 1]);
  return sum;
}
/// The time from which y stays below `bound`, by linear interpolation; nothing if it ends above.
inline std::optional<double> below_from(std::vector<double> const& t, std::vector<double> const& y, double bound) {
  std::size_t i = y.size();
  while (i > 0 && y[i - 1] < bound) --i;
  if (i == y.size()) return {};
  if (i == 0) return t.front();
  return t[i - 1] + (t[i] - t[i - 1]) * (y[i - 1] - bound) / (y[i - 1] - y[i]);
}

}  // namespace polhode::history
