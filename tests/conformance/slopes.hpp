#pragma once
/// Slopes of doubly logarithmic plots.
#include <vector>

namespace polhode::test {

/// A run of an order plot.
struct OrderPoint {
  double log_h, log_error;
};

/// Least squares.
inline double slope_of(std::vector<OrderPoint> const& points) {
  double const n = double(points.size());
  double h = 0, e = 0, hh = 0, he = 0;
  for (OrderPoint const& p : points) {
    h += p.log_h / n;
    e += p.log_error / n;
  }
  for (OrderPoint const& p : points) {
    hh += (p.log_h - h) * (p.log_h - h);
    he += (p.log_h - h) * (p.log_error - e);
  }
  return he / hh;
}

}  // namespace polhode::test
