#pragma once
/// What claims ask of a column against time.
#include <algorithm>
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
/// The time from which y stays below `bound`, by linear interpolation; nothing if it ends above.
inline std::optional<double> below_from(std::vector<double> const& t, std::vector<double> const& y, double bound) {
  std::size_t i = y.size();
  while (i > 0 && y[i - 1] < bound) --i;
  if (i == y.size()) return {};
  if (i == 0) return t.front();
  return t[i - 1] + (t[i] - t[i - 1]) * (y[i - 1] - bound) / (y[i - 1] - y[i]);
}

}  // namespace polhode::history
