#pragma once
/// What a run leaves for claims: columns against time, and what claims ask of them.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace polhode {

/// Columns against time, as `simulate` prints them: rows[i] belongs to times[i].
struct History {
  std::vector<double> times;         ///< [s]
  std::vector<std::string> columns;  ///< q1 q2 q3 q4 wx wy wz and the problem's own
  std::vector<std::vector<double>> rows;
  std::vector<double> events{};  ///< times of located state events [s], the first 256

  /// The values of one column. Throws std::out_of_range for an unknown name.
  std::vector<double> column(std::string const& name) const {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns[i] != name) continue;
      std::vector<double> values;
      for (auto const& row : rows) values.push_back(row[i]);
      return values;
    }
    throw std::out_of_range("no column " + name);
  }
  /// The last row is at `time` [s] or later; times of outputs are rounded.
  bool reaches(double time) const { return !times.empty() && times.back() >= time * (1 - 1e-9); }
  /// The row at `time` [s].
  std::optional<std::size_t> row_at(double time) const {
    auto const found = std::find_if(times.begin(), times.end(), [&](double t) { return std::fabs(t - time) < 1e-9; });
    if (found == times.end()) return {};
    return std::size_t(found - times.begin());
  }
};

}  // namespace polhode

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
/// First time at which y falls to 0, by linear interpolation; nothing if it never does.
inline std::optional<double> first_zero(std::vector<double> const& t, std::vector<double> const& y) {
  for (std::size_t i = 1; i < y.size(); ++i)
    if (y[i - 1] > 0 && y[i] <= 0) return t[i - 1] + (t[i] - t[i - 1]) * y[i - 1] / (y[i - 1] - y[i]);
  return {};
}
/// Interior maxima that stand out of their surroundings by more than `least`.
inline int maxima(std::vector<double> const& y, double least) {
  int count = 0;
  double low = y.front(), high = y.front();
  bool rising = true;
  for (double value : y) {
    if (rising) {
      high = std::max(high, value);
      if (value < high - least) {
        count += high > low + least ? 1 : 0;
        rising = false;
        low = value;
      }
    } else {
      low = std::min(low, value);
      if (value > low + least) {
        rising = true;
        high = value;
      }
    }
  }
  return count;
}

}  // namespace polhode::history
