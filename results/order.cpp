#include "results/order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace polhode::results {
namespace {

bool is_positive(double number) {
  return std::isfinite(number) && number > 0;
}

bool is_usable(OrderPoint const& point, OrderRules const& rules) {
  double const bar = std::isfinite(point.bar) ? point.bar : 0;
  double const floor = std::max(rules.bars * bar, rules.round_off);
  return is_positive(point.h) && is_positive(point.error) && point.error > floor && point.error < rules.asymptotic;
}

/// The slopes between neighbours.
std::vector<double> local_slopes(std::vector<OrderPoint> const& points) {
  std::vector<double> slopes;
  for (std::size_t i = 1; i < points.size(); ++i) {
    slopes.push_back(std::log(points[i].error / points[i - 1].error) / std::log(points[i].h / points[i - 1].h));
  }
  return slopes;
}

/// Slopes first, first + 1, ... first + count - 1.
struct Stretch {
  std::size_t first = 0, count = 0;
};

/// The longest stretch of slopes that agree; the first of several, since the smallest steps come first.
Stretch longest_agreement(std::vector<double> const& slopes, double agreement) {
  Stretch best;
  for (std::size_t first = 0; first < slopes.size(); ++first) {
    double low = slopes[first];
    double high = slopes[first];
    std::size_t end = first;
    for (; end < slopes.size(); ++end) {
      low = std::min(low, slopes[end]);
      high = std::max(high, slopes[end]);
      bool const agree = low > 0 && high <= (1 + agreement) * low;
      if (!agree) break;
    }
    if (end - first > best.count) best = {first, end - first};
  }
  return best;
}

/// Two-sided 95% quantile of Student's t.
double student(std::size_t freedom) {
  return boost::math::quantile(boost::math::students_t(static_cast<double>(freedom)), 0.975);
}

OrderFit least_squares(std::vector<OrderPoint> const& points) {
  auto const n = static_cast<double>(points.size());
  double x_mean = 0;
  double y_mean = 0;
  for (OrderPoint const& point : points) {
    x_mean += std::log(point.h) / n;
    y_mean += std::log(point.error) / n;
  }
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (OrderPoint const& point : points) {
    double const x = std::log(point.h) - x_mean;
    double const y = std::log(point.error) - y_mean;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  OrderFit fit;
  fit.slope = xy / xx;
  fit.points = points.size();
  fit.h_low = points.front().h;
  fit.h_high = points.back().h;
  if (points.size() > 2) {
    double const variance = std::max(0.0, yy - fit.slope * xy) / (n - 2);
    fit.half_width = student(points.size() - 2) * std::sqrt(variance / xx);
  }
  return fit;
}

/// Steps that are equal but for rounding would make a slope of noise.
void drop_equal_steps(std::vector<OrderPoint>& points) {
  auto const same = [](OrderPoint const& a, OrderPoint const& b) { return b.h <= a.h * (1 + 1e-9); };
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
}

}  // namespace

OrderResult fit_order(std::vector<OrderPoint> points, OrderRules const& rules) {
  std::size_t const given = points.size();
  std::erase_if(points, [&](OrderPoint const& point) { return !is_usable(point, rules); });
  std::ranges::stable_sort(points, {}, &OrderPoint::h);
  drop_equal_steps(points);
  if (points.size() < 2) {
    return {{},
            fmt::format("{} of {} steps have an error above round-off and the reference's bar and below {} rad; two "
                        "are needed",
                        points.size(), given, rules.asymptotic)};
  }
  std::vector<double> const slopes = local_slopes(points);
  Stretch const stretch = longest_agreement(slopes, rules.agreement);
  bool const no_two_agree = stretch.count < 2 && slopes.size() > 1;
  if (stretch.count == 0 || no_two_agree) {
    return {{}, fmt::format("no two neighbouring slopes agree: {:.2f}", fmt::join(slopes, ", "))};
  }
  auto const begin = points.begin() + static_cast<std::ptrdiff_t>(stretch.first);
  auto const end = begin + static_cast<std::ptrdiff_t>(stretch.count) + 1;
  return {least_squares({begin, end}), ""};
}

}  // namespace polhode::results
